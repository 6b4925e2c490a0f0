"""A run's output at an address that fsspec knows: an object store, most of all.

An object appears whole or not at all, which is what a store promises. Other file systems behind an address, such as
``sftp://``, may show a file that is being written: one that a killed run left so is found by its hash and made again
when the run is resumed.
"""

from __future__ import annotations

import os
import re
import tempfile
from contextlib import contextmanager, nullcontext, suppress
from errno import ENOENT, ETIMEDOUT
from glob import has_magic
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from dh2urdf.errors import Dh2UrdfError, MissingDependencyError, OutputError
from dh2urdf.output.whole_files import NOT_THERE, checked, staging
from dh2urdf.source import Messages, printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from contextlib import AbstractContextManager

say = Messages(__file__)

_S3 = ("s3", "s3a")
_S3_LIMITS = {"connect_timeout": 5, "read_timeout": 10, "retries": {"mode": "standard", "total_max_attempts": 3}}
"""Of each request to S3 [s, s]: three tries, with random pauses of at most 1 and 2 s. The defaults wait a minute for
each of five tries, and s3fs has all of them five times."""
_PATIENCE = 60
"""After so long whatever was asked is given up [s], a second later for each megabyte to be sent. The limits above do
not count while a server gives no leave to send (100 Continue), or takes nothing of what is sent."""
_BLOCK = 1 << 23
"""How much of a remote file is read at once [byte]."""
_LONGEST_ANSWER = 300
"""Of what a remote place says, so much is repeated."""


class RemoteStore:
    """What is below an address such as ``s3://bucket/prefix``.

    Credentials, endpoint and all other settings are those of fsspec and of the package behind it: of the environment,
    such as ``AWS_ENDPOINT_URL`` for an object store that is not Amazon's, and of their configuration files.

    Attributes:
        address: the address.
    """

    def __init__(self, address: str) -> None:
        """Raises what `open_store` raises."""
        self.address = address
        self._system: tuple[int, Any, str] = (-1, None, "")
        self._open_system()

    def __str__(self) -> str:
        return _without_password(self.address)

    def __reduce__(self) -> tuple[type[RemoteStore], tuple[str]]:
        return type(self), (self.address,)

    def write(self, name: str, content: bytes) -> None:
        """Write a file whole, in the place of an older one."""
        self._create(name, len(content), lambda system, key, **limit: system.pipe_file(key, content, **limit))

    def put(self, name: str, path: Path) -> None:
        """Put a finished file of a folder of `scratch` where it belongs, in the place of an older one."""
        size = path.stat().st_size
        self._create(name, size, lambda system, key, **limit: system.put_file(str(path), key, **limit))

    def _create(self, name: str, size: int, create: Callable[..., object]) -> None:
        with self._at(name, "write", size) as (system, key, limit):
            try:
                create(system, key, **limit)
            except FileNotFoundError:
                # Some file systems want a folder first. A bucket is not made: that it is not there is a mistake.
                top = re.match("/?[^/]*", key)
                if top is None or not system.exists(top.group()):
                    raise
                system.makedirs(key.rpartition("/")[0], exist_ok=True)
                create(system, key, **limit)

    def read(self, name: str) -> bytes:
        """Return the content of a file."""
        with self._at(name, "read") as (system, key, limit):
            return bytes(system.cat_file(key, **limit))

    @contextmanager
    def open(self, name: str) -> Iterator[BinaryIO]:
        """Open a file for reading from its beginning."""
        with self._at(name, "read") as (system, key, _), system.open(key, "rb", block_size=_BLOCK) as file:
            yield file

    def size(self, name: str) -> int | None:
        """Return the length of a file [byte]; None if there is no such file."""
        with self._at(name, "read") as (system, key, limit), suppress(*NOT_THERE):
            info = system.info(key, **limit)
            return int(info["size"]) if info["type"] == "file" else None
        return None

    def names(self, folder: str = "") -> Iterator[str]:
        """Yield the names of all files in a folder and below it, in no particular order; no folder is an empty one."""
        found: list[str] = []
        with self._at(folder or None, "read") as (system, top, limit), suppress(*NOT_THERE):
            found = system.find(top, **limit)
        root = self._open_system()[1]
        for key in found:
            yield key[len(root) + 1 :]

    def remove(self, name: str) -> None:
        """Remove a file, if it is there."""
        with self._at(name, "remove") as (system, key, limit), suppress(*NOT_THERE):
            system.rm_file(key, **limit)

    def remove_tree(self, folder: str) -> None:
        """Remove a folder and all in it, if it is there."""
        with self._at(folder, "remove") as (system, key, limit), suppress(*NOT_THERE):
            system.rm(key, recursive=True, **limit)

    def is_protected(self, _name: str) -> bool:
        """Return False: no input of a run is at an address."""
        return False

    def scratch(self) -> AbstractContextManager[Path]:
        """Yield a folder among the temporary ones of this machine."""
        return staging(Path(tempfile.gettempdir()))

    def lock(self) -> AbstractContextManager[None]:
        """Do nothing: an object store has no locks, and nothing half-written that would have to be removed."""
        return nullcontext()

    def _open_system(self) -> tuple[Any, str]:
        """Return the file system of fsspec and the path of the address in it."""
        process, system, root = self._system
        if process == os.getpid():
            system.invalidate_cache()  # What it remembers of folders may have changed since.
            return system, root
        # New, or a copy of one by a fork, where the threads of asynchronous file systems are missing.
        try:
            from fsspec.core import url_to_fs
        except ImportError as error:
            raise self._lacks("fsspec", error) from error
        limits = {"config_kwargs": _S3_LIMITS} if self._scheme in _S3 else {}
        with self._reporting("", "reach"):
            try:
                system, root = url_to_fs(self.address, **limits)
            except ImportError as error:
                raise self._lacks(getattr(error.__cause__ or error, "name", None) or self._scheme) from error
        root = root.rstrip("/")
        if not root or has_magic(root):
            raise OutputError(say("address-without-name", found=str(self)))
        if limits:
            system.retries = 1  # Each request has its own tries.
        self._system = os.getpid(), system, root
        return system, root

    @contextmanager
    def _at(self, name: str | None, doing: str, size: int = 0) -> Iterator[tuple[Any, str, dict[str, float]]]:
        """The file system of fsspec, the path of a file in it, and the time limit for sending so much [byte].

        File systems that are not asynchronous take no limit. Without a name, the path is that of the store.
        """
        system, root = self._open_system()
        if name is not None and has_magic(checked(name)):  # fsspec would take it for the names of others.
            raise OutputError(say("name-is-pattern", found=name, store=str(self)))
        limit = {"timeout": _PATIENCE + size / 1e6} if system.async_impl else {}
        with self._reporting(name or "", doing):
            yield system, root if name is None else f"{root}/{name}", limit

    @property
    def _scheme(self) -> str:
        return self.address.partition("://")[0].casefold()

    def _lacks(self, package: str, reason: str | ImportError = "") -> MissingDependencyError:
        extra = "dh2urdf[remote]" if package in ("fsspec", "s3fs") else package
        return MissingDependencyError(f"output to {self._scheme}://", package, extra, reason)

    @contextmanager
    def _reporting(self, name: str, doing: str) -> Iterator[None]:
        """Turn whatever a remote place raises into one line: every file system has errors of its own."""
        try:
            yield
        except Dh2UrdfError:
            raise
        except Exception as error:
            place = f"{str(self).rstrip('/')}/{name}" if name else str(self)
            reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
            if isinstance(error, TimeoutError) and not str(error):
                reason = os.strerror(ETIMEDOUT)
            if isinstance(error, NOT_THERE) and name in reason:  # It is the path alone.
                reason = os.strerror(ENOENT)
            reason = printable(_without_password(" ".join(reason.split())))[:_LONGEST_ANSWER]
            raise OutputError(say("path-refused", doing=doing, path=place, reason=reason)) from error


def _without_password(text: str) -> str:
    """A text without what stands between ``://`` and ``@`` if there is a password in it."""
    return re.sub(r"(?<=://)[^\s@]*:[^\s@]*@", "…@", text)
