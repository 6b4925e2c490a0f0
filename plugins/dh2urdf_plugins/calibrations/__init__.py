"""Calibrations: differences between the rows of an arm and those of its data sheet."""
