"""The emitter `srdf`: what MoveIt has to know of a robot besides its URDF."""
