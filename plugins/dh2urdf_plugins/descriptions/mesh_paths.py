"""The files that a description means by the addresses of its meshes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


def mesh_finder(folder: Path, packages: Mapping[str, Path]) -> Callable[[str], Path | None]:
    """What finds the file of an address: a path from the description's folder, or in a package.

    The packages are those that the user names, the one that the file is in, and a folder of the package's name above.
    """

    def find(address: str) -> Path | None:
        scheme, separator, rest = address.partition("://")
        if not separator:
            return _file(folder / address)
        if scheme == "file":
            return _file(Path(unquote(rest)))
        if scheme not in ("package", "model"):
            return None
        name, _, inner = rest.partition("/")
        roots = [packages[name]] if name in packages else []
        roots += [above / name for above in (folder, *folder.parents)]
        roots += [above for above in (folder, *folder.parents) if above.name == name]
        return next((path for root in roots if (path := _file(root / inner))), None)

    return find


def _file(path: Path) -> Path | None:
    try:
        return path if path.is_file() else None
    except (OSError, ValueError):
        return None
