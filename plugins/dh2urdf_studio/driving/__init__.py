"""Joint values that other programs give to the robots of `dh2urdf view`, and ask for."""
