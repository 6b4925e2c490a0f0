"""The physics engines of CoppeliaSim."""

from __future__ import annotations

from typing import Literal, TypeAlias

Engine: TypeAlias = Literal["bullet", "ode", "vortex", "newton", "mujoco"]
