"""What commands print: as plain data, and as text."""
