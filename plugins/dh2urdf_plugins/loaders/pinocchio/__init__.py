"""Pinocchio, as a loader."""
