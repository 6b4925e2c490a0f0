"""What travels between a run, its workers and its report."""
