"""Reads SDF back: elements, nested models, and the robot."""
