"""MuJoCo, as a loader."""
