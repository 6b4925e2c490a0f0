"""The run file: what it may contain, and the plan that it makes."""
