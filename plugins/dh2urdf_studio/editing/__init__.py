"""The table that is edited in the studio: its texts, their history, and what they become."""
