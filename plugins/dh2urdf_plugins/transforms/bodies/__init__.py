"""Bodies of links that are more than one solid for each segment."""
