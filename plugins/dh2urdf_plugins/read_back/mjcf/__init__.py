"""Reads MJCF back: elements, included files, shapes, masses, and the robot."""
