"""Which links of a robot need no collision check: the pairs that MoveIt's setup assistant finds, without MoveIt."""
