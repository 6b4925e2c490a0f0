"""What the readers of SDF and MJCF do with faults of these files."""
