"""The way back: the Denavit-Hartenberg table of a chain of any robot description."""
