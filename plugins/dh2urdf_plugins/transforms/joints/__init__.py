"""What a joint has that its row leaves open."""
