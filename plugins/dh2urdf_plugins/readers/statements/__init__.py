"""What a table states besides its rows: base, tool, payload and shapes."""
