"""CoppeliaSim, as a loader."""
