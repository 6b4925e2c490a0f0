"""Calls in child processes, which may crash, hang or leave: of any function, and of a loader."""

from __future__ import annotations

from dh2urdf.child_calls import ChildFailure, ChildResult, run_in_child
from dh2urdf.interpreter import KEPT_OUTPUT
from dh2urdf.loads import load_in_child

__all__ = ["KEPT_OUTPUT", "ChildFailure", "ChildResult", "load_in_child", "run_in_child"]
