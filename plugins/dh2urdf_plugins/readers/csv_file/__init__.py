"""CSV files as text."""
