"""Four stages for dh2urdf, each in a module of less than sixty lines."""
