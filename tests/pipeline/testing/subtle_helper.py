"""A helper of a plugin's module, in which its heavy import hides."""

from __future__ import annotations

import numpy as np


def require() -> None:
    """It is there."""
    np.zeros(1)
