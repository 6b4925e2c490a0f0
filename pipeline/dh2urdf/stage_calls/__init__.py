"""Calls of stages: what goes into them, what comes out, and whose fault it is when one fails."""
