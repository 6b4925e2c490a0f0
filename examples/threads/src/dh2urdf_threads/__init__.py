"""An executor for dh2urdf: the threads of one process."""
