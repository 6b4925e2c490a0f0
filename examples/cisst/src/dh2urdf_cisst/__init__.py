"""A reader for dh2urdf: kinematic files of cisst and of the da Vinci Research Kit."""
