"""Under which names the files of a run go into its store: all together, in folders, or in tar shards."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, NotRequired, TypeAlias, TypedDict

from dh2urdf.output.shards import ShardWriter, shard_stem
from dh2urdf.output.whole_files import safe_stem

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf.output.store import Store

DEFAULT_SIZE = 1000
"""Manipulators in one folder or shard: file systems and people are slow with folders of many thousand files."""
LARGEST = 10_000
"""Manipulators in one folder or shard at most: a worker holds a shard's descriptions until it is written."""


class Form(StrEnum):
    """How the files of a run lie."""

    FILES = "files"
    """All in one folder."""
    FOLDERS = "folders"
    """In folders of so many manipulators."""
    SHARDS = "shards"
    """In tar files of so many manipulators."""


class Stored(TypedDict):
    """Where a file is in the output of a run, as its manifest has it."""

    path: str
    shard: NotRequired[str]
    offset: NotRequired[int]


Put: TypeAlias = "Callable[[int, str, bytes], Stored]"
"""Puts a file of the manipulator of a number in its place, whole, and returns where that is, for the manifest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """How the files of a run lie in its store.

    Attributes:
        form: in which form.
        size: manipulators in one folder or shard.
    """

    form: Form = Form.FILES
    size: int = DEFAULT_SIZE

    @property
    def is_whole(self) -> bool:
        """Whether many are one file, and so there as a whole or not at all."""
        return self.form is Form.SHARDS

    @property
    def stem_of(self) -> Callable[[str], str]:
        """What gives the stem of a manipulator's files."""
        return shard_stem if self.is_whole else safe_stem

    @property
    def whole(self) -> int:
        """How many manipulators are written as a whole: those of a shard, otherwise each by itself."""
        return self.size if self.is_whole else 1

    def parts(self, count: int) -> list[range]:
        """Return the places in a batch of so many, cut where a shard ends; all together where there are none."""
        step = self.size if self.is_whole else max(1, count)
        return [range(start, min(start + step, count)) for start in range(0, count, step)]

    def folder(self, index: int) -> str:
        """Return the folder or shard of the manipulator of a number; empty where there is none."""
        match self.form:
            case Form.FILES:
                return ""
            case Form.FOLDERS:
                return f"{index // self.size:05d}"
            case Form.SHARDS:
                return f"{index // self.size:06d}.tar"

    def path(self, index: int, name: str) -> str:
        """Return the name of a file in the store, shards aside."""
        folder = self.folder(index)
        return f"{folder}/{name}" if folder else name

    @contextmanager
    def place(self, store: Store, first: int) -> Iterator[Put]:
        """Yield what puts files into the shard that begins with the manipulator of a number, or each in its place.

        Raises:
            OutputError: a file cannot be written.
        """

        def put(index: int, name: str, content: bytes) -> Stored:
            path = self.path(index, name)
            store.write(path, content)
            return {"path": path}

        if not self.is_whole:
            yield put
            return
        folder = self.folder(first)
        with ShardWriter(store, folder) as shard:
            yield lambda _index, name, content: {"path": name, "shard": folder, "offset": shard.add(name, content)}
