"""What a run says of itself when it is done."""
