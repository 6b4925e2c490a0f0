"""The headers of tables: which column holds what, in which unit."""
