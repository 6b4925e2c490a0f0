"""What the fields of records and the arguments of functions accept, and what becomes of it."""
