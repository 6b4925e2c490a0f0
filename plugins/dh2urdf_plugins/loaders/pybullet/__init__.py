"""PyBullet, as a loader."""
