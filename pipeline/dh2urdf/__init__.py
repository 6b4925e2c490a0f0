"""Turns tables of Denavit-Hartenberg parameters into robot descriptions that are provably the same arm.

What this module names is imported when it is asked for: `import dh2urdf` costs nothing.
"""

from __future__ import annotations

import sys

from dh2urdf._version import __version__ as __version__

TYPE_CHECKING = False  # The name is what type checkers know; the module `typing` alone costs more than this one.
if TYPE_CHECKING:
    import collections.abc


def late_names(
    package: str, modules: dict[str, str]
) -> tuple[list[str], collections.abc.Callable[[str], object], collections.abc.Callable[[], list[str]]]:
    """Return the ``__all__``, ``__getattr__`` and ``__dir__`` of a package that imports its names late (PEP 562).

    Args:
        package: its name.
        modules: the names that each of its modules gives, separated by spaces; under "" modules that it gives whole.
    """
    places = {name: module for module, names in modules.items() for name in names.split()}

    def value_of(name: str) -> object:
        from importlib import import_module

        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module = places[name]
        value = getattr(import_module(f"{package}.{module}"), name) if module else import_module(f"{package}.{name}")
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*places, *(name for name in vars(sys.modules[package]) if name.startswith("__"))})

    return sorted(places), value_of, names


if TYPE_CHECKING:
    from dh2urdf import errors as errors, kinematics as kinematics, results as results
    from dh2urdf.api import (
        check as check,
        convert as convert,
        extract as extract,
        read as read,
        read_all as read_all,
        run as run,
    )
    from dh2urdf.commands.convert import Conversion as Conversion
    from dh2urdf.commands.given_tables import from_screws as from_screws
    from dh2urdf.commands.toolbox_robots import from_roboticstoolbox as from_roboticstoolbox
    from dh2urdf.errors import Dh2UrdfError as Dh2UrdfError, TableWarning as TableWarning
    from dh2urdf.kinematics.inverse import (
        InverseSolution as InverseSolution,
        inverse_kinematics as inverse_kinematics,
    )
    from dh2urdf.manipulator import (
        Convention as Convention,
        DHRow as DHRow,
        Inertia as Inertia,
        JointType as JointType,
        Limits as Limits,
        LinkGeometry as LinkGeometry,
        Manipulator as Manipulator,
    )
    from dh2urdf.robot import Robot as Robot
    from dh2urdf.rotations import RigidTransform as RigidTransform
    from dh2urdf.stages import Rejected as Rejected

else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "api": "check convert extract read read_all run",
            "commands.convert": "Conversion",
            "commands.given_tables": "from_screws",
            "commands.toolbox_robots": "from_roboticstoolbox",
            "errors": "Dh2UrdfError TableWarning",
            "kinematics.inverse": "InverseSolution inverse_kinematics",
            "manipulator": "Convention DHRow Inertia JointType Limits LinkGeometry Manipulator",
            "robot": "Robot",
            "rotations": "RigidTransform",
            "stages": "Rejected",
            "": "errors kinematics results",
        },
    )
    __all__ += ["__version__"]
