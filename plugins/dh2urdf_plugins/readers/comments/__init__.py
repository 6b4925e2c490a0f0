"""The top of a table and its comments: declarations, phrases that are such, and prose that contradicts the table."""
