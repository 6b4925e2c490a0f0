"""Where readers look for the files that a description names."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.documents import is_file, is_folder
from dh2urdf.meshes import FILE, PACKAGE, path_of_address

if TYPE_CHECKING:
    from collections.abc import Mapping

_MODEL = "model://"


def resolved(address: str, description: Path, packages: Mapping[str, Path]) -> Path | None:
    """The file that an address means, whether there is one or not; None where its package is not found."""
    folder = Path(os.path.abspath(description)).parent  # noqa: PTH100 - links in the path stay
    if not address.startswith(PACKAGE):
        return folder / path_of_address(address)
    package, _, rest = address.removeprefix(PACKAGE).partition("/")
    if not package:
        return None
    searched = [
        *(place for inner in (folder, *folder.parents) for place in (inner, inner.parent / package)),
        *(Path(entry) / package for entry in _entries("ROS_PACKAGE_PATH")),
        *(Path(entry) / "share" / package for entry in _entries("AMENT_PREFIX_PATH")),
    ]
    found = [place / rest for place in searched if place.name == package and is_folder(place)]
    if package in packages:
        found.append(packages[package] / rest)
    return next((file for file in found if is_file(file)), found[0] if found else None)


def _entries(variable: str) -> list[str]:
    return [entry for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def is_found_by_pybullet(address: str, description: Path) -> bool:
    """PyBullet knows no packages: it looks for the path behind `package://` in the folder and in all above it."""
    if address.startswith(FILE):
        address = path_of_address(address)
    rest = address.removeprefix(PACKAGE).removeprefix(_MODEL).lstrip("/")
    folder = Path(os.path.abspath(description)).parent  # noqa: PTH100 - links in the path stay
    return is_file(Path(address)) or any(is_file(above / rest) for above in (folder, *folder.parents))
