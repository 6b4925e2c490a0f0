"""What a run reports when it is done."""
