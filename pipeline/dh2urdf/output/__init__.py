"""Files that are written whole or not at all, and under which names they go where."""
