"""Expands a stranger's xacro: the real xacro, in a child process without rights, whose expressions we evaluate."""
