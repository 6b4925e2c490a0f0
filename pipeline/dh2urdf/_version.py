"""The version of the project, on its own so that no module needs the whole package for it."""

__version__ = "0.1.0"
