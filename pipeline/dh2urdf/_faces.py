"""Names that are imported when they are asked for: those of packages, and the functions that methods call."""

from __future__ import annotations

import sys

TYPE_CHECKING = False  # The name is what type checkers know; the module `typing` alone costs more than this one.
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import TypeAlias, TypeVar

    T = TypeVar("T")
    Face: TypeAlias = tuple[list[str], Callable[[str], object], Callable[[], list[str]]]


def face(package: str, modules: Mapping[str, str], wholes: tuple[str, ...] = ()) -> Face:
    """The ``__all__``, ``__getattr__`` and ``__dir__`` of a package (PEP 562).

    Args:
        package: its name.
        modules: the names that each module of it gives, separated by spaces, by the path of the module in the package.
        wholes: modules that it gives themselves.
    """
    places = {name: module for module, names in modules.items() for name in names.split()}
    known = sorted({*places, *wholes})

    def value_of(name: str) -> object:
        from importlib import import_module

        if name not in known:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module = import_module(f"{package}.{places.get(name, name)}")
        value = getattr(module, name) if name in places else module
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*known, *(name for name in vars(sys.modules[package]) if name.startswith("__"))})

    return known, value_of, names


def function_of(place: str) -> Callable[..., T]:
    """The function of a higher layer that a method of a record calls, imported when the method is called.

    Args:
        place: its module in the package and its name, such as ``kinematics.pose_arrays.table_pose``.
    """
    from importlib import import_module

    module, _, name = place.rpartition(".")
    function: Callable[..., T] = getattr(import_module(f"dh2urdf.{module}"), name)
    return function
