"""Calls of stages in child processes: forks of an interpreter that is kept, which are watched."""
