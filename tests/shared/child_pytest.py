"""pytest in a process of its own, for tests that are part of a test."""

ADDOPTS = "-p no:anyio -p no:hypothesispytest"
"""Its PYTEST_ADDOPTS: without plugins of this project's own tests, a third of a second of each such process."""
