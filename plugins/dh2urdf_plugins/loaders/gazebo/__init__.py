"""Gazebo, as a loader."""
