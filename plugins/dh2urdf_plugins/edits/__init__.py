"""Edits: changes of a table before the transform, and of a robot after it."""
