"""What the fields of records accept, and what becomes of it."""
