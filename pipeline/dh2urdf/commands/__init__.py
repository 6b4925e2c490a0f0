"""What the command line, the Python API and the studio do: one way for each command."""
