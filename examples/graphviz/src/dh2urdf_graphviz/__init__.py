"""An emitter for dh2urdf: the kinematic tree as a graph."""
