"""Packages for ROS 2, semantic descriptions for MoveIt, and tables for papers and scripts: files made of templates."""
