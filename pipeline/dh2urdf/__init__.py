"""Turns tables of Denavit-Hartenberg parameters into robot descriptions that are provably the same arm."""

__version__ = "0.1.0"
