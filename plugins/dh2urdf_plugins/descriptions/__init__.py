"""Robot descriptions as inputs: which chain is the arm, what goes with it, and what a table has no place for."""
