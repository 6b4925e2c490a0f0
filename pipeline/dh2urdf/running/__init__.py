"""A run: its batches, its workers, and what earlier runs left."""
