"""Which joint values bring an arm to a pose, and how well it can move from there."""
