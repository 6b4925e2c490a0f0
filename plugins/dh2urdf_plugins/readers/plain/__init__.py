"""The fast way through plain tables, which ends in columns."""
