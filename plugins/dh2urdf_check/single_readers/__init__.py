"""Rules of what one reader alone does, and what it alone reads."""
