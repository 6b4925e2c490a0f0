"""Rows of joints, one by one."""
