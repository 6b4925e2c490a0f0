"""Turns tables of Denavit-Hartenberg parameters into robot descriptions that are provably the same arm.

What this module names is imported when it is asked for: `import dh2urdf` costs nothing.
"""

from __future__ import annotations

from dh2urdf._version import __version__

TYPE_CHECKING = False  # The name is what type checkers know; the module `typing` alone costs more than this one.
if TYPE_CHECKING:
    from dh2urdf import errors, kinematics, results
    from dh2urdf.api import check, convert, extract, read, read_all, run
    from dh2urdf.errors import Dh2UrdfError
    from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, LinkGeometry, Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.single_table import Conversion
    from dh2urdf.stages import Rejected

__all__ = [
    "Convention",
    "Conversion",
    "DHRow",
    "Dh2UrdfError",
    "Inertia",
    "JointType",
    "Limits",
    "LinkGeometry",
    "Manipulator",
    "Rejected",
    "RigidTransform",
    "Robot",
    "__version__",
    "check",
    "convert",
    "errors",
    "extract",
    "kinematics",
    "read",
    "read_all",
    "results",
    "run",
]

_MODULES = {
    "Convention": "manipulator",
    "Conversion": "single_table",
    "DHRow": "manipulator",
    "Dh2UrdfError": "errors",
    "Inertia": "manipulator",
    "JointType": "manipulator",
    "Limits": "manipulator",
    "LinkGeometry": "manipulator",
    "Manipulator": "manipulator",
    "Rejected": "stages",
    "RigidTransform": "rotations",
    "Robot": "robot",
    "check": "api",
    "convert": "api",
    "extract": "api",
    "read": "api",
    "read_all": "api",
    "run": "api",
}
"""Where the names are that are no modules themselves."""

if not TYPE_CHECKING:  # A type checker that saw this would take any name for one of them.

    def __getattr__(name: str) -> object:
        """What a name stands for, imported now (PEP 562)."""
        from importlib import import_module

        if name in _MODULES:
            value = getattr(import_module(f"dh2urdf.{_MODULES[name]}"), name)
        elif name in __all__:
            value = import_module(f"dh2urdf.{name}")
        else:
            raise AttributeError(f"module 'dh2urdf' has no attribute {name!r}")
        globals()[name] = value
        return value

    def __dir__() -> list[str]:
        """The names that are there, and those that would be imported."""
        return sorted({*globals(), *__all__})
