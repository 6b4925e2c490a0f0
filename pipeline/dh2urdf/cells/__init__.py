"""Several arms in one robot description."""
