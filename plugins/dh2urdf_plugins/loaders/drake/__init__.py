"""Drake, as a loader."""
