"""The walk along a chain of moves and turns, from which all poses of tables and of chains of joints come."""
