"""One manipulator on its way: transform, check, emit, prove, load."""
