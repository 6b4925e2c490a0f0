"""What commands print for people: progress, summaries, findings."""
