"""The mathematics of the way back: the Denavit-Hartenberg table of a chain of joints."""
