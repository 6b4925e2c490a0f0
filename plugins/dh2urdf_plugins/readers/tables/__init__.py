"""Whole tables: from rows of cells to manipulators."""
