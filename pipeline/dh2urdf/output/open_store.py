"""Which store an address stands for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dh2urdf.output.store import Store


def open_store(address: str | Path) -> Store:
    """The store at an address: a path, or anything that fsspec knows, such as ``s3://bucket/prefix``.

    Nothing is read or written yet.

    Raises:
        OutputError: there is no such kind of address.
        MissingDependencyError: a package that reaches such addresses is not installed.
    """
    scheme, separator, path = str(address).partition("://")
    if not separator or isinstance(address, Path):
        directory = Path(address)
    elif scheme.casefold() in ("file", "local"):
        directory = Path(path)
    else:
        from dh2urdf.output.remote_store import RemoteStore

        return RemoteStore(str(address))
    from dh2urdf.output.local_store import LocalStore

    return LocalStore(directory)
