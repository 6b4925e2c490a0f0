"""The stage ``table``: the DH tables of a robot, for papers and scripts."""
