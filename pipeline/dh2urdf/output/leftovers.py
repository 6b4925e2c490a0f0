"""Files of the last run into a place that a new run has no part in: they are removed at its end, and nothing else is.

Those of a manipulator that has failed in the new run stay as they were: it has a part in them.

The manifest of the last run names them, with the hashes of their bytes. A file that has other bytes by now is
somebody's work, and stays; so does one that the new run reads.
"""

from __future__ import annotations

from collections import Counter
from contextlib import suppress
from dataclasses import replace
from hashlib import sha256
from typing import TYPE_CHECKING, Any, BinaryIO

import orjson

from dh2urdf.errors import OutputError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.output.journal import MANIFEST
from dh2urdf.output.seen_names import SeenNames
from dh2urdf.output.store import checked
from dh2urdf.output.whole_files import READ_AT_ONCE

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from dh2urdf.output.store import Store


@dataclass(frozen=True, slots=True, kw_only=True)
class Leftovers:
    """What became of the files of the last run that the new one has no part in.

    Attributes:
        removed: how many were removed.
        kept: how many were left because the user asked for it.
        changed: how many were left because they have other bytes than the last run wrote.
    """

    removed: int = 0
    kept: int = 0
    changed: int = 0

    @property
    def told(self) -> str | None:
        """All of it as one line; None where there is nothing to tell."""
        parts = [
            *([f"{self.removed:,} removed"] if self.removed else []),
            *([f"{self.kept:,} kept"] if self.kept else []),
            *([f"{self.changed:,} kept, since they were changed"] if self.changed else []),
        ]
        return f"files of an earlier run: {', '.join(parts)}" if parts else None


def clear_leftovers(store: Store, reports: Store, rows: BinaryIO, *, keep: bool, keep_meshes: bool) -> Leftovers:
    """Remove what the manifest of the last run names and a new manifest does not.

    Args:
        store: the place of the files.
        reports: the place of the manifest.
        rows: the new manifest, which is not in its place yet.
        keep: count the files, and remove none.
        keep_meshes: leave copies of meshes alone: descriptions may name them as originals.

    Raises:
        OutputError: a file cannot be removed, or the old manifest cannot be read.
    """
    if not reports.size(MANIFEST) or _is_same(reports, rows):
        return Leftovers()
    found: Counter[str] = Counter()
    named, failed, digests = _of_new(rows)
    shards: dict[str, bool] = {}
    meshes: dict[str, str] = {}
    with reports.open(MANIFEST) as stream:
        for row in map(_LastRow, stream):
            if failed.known([row.name]):
                continue
            meshes |= {} if keep_meshes else row.meshes
            names = _left(row.names(), named)
            if not row.shards.isdisjoint(names):
                for shard in row.shards.intersection(names):
                    shards[shard] = shards.get(shard, True) and row.is_whole_in(store, shard)
            elif row.files and not names.isdisjoint(row.files):
                whole = row.is_whole(store, names)
                _clear(store, names.difference(row.meshes), found, keep=keep, whole=whole)
    for shard, whole in shards.items():
        _clear(store, [shard], found, keep=keep, whole=whole)
    for name in _left(meshes, named):
        if meshes[name] not in digests:
            _clear(store, [name], found, keep=keep, whole=_digest(store, name) == meshes[name])
    return Leftovers(**found)


def _of_new(rows: BinaryIO) -> tuple[SeenNames, SeenNames, set[str]]:
    """The files that a new manifest names, the manipulators that failed, and the hashes of the meshes."""
    rows.seek(0)
    named, failed = SeenNames(), SeenNames()
    digests: set[str] = set()
    for row in map(_LastRow, rows):
        named.add(map(_key, row.names()))
        failed.add([row.name] if row.failed else [])
        digests.update(row.meshes.values())
    return named, failed, digests


def _clear(store: Store, names: Iterable[str], found: Counter[str], *, keep: bool, whole: bool) -> None:
    """Removes files that the last run wrote, if they are there and nobody has changed them."""
    for name in names:
        if store.size(name) is None or store.is_protected(name):
            continue
        if not whole:
            found["changed"] += 1
        elif keep:
            found["kept"] += 1
        else:
            try:
                store.remove(name)
            except OutputError as error:
                hint = "`--keep` leaves files of an earlier run where they are"
                raise OutputError([replace(problem, suggestion=hint) for problem in error.problems]) from error
            found["removed"] += 1


def _is_same(store: Store, rows: BinaryIO) -> bool:
    """Whether the manifest in a store is the new one."""
    rows.seek(0)
    with store.open(MANIFEST) as stream:
        while block := stream.read(READ_AT_ONCE):
            if rows.read(len(block)) != block:
                return False
    return not rows.read(1)


def _left(names: Iterable[str], named: SeenNames) -> set[str]:
    """Those of some names that the new manifest has not; where a file system ignores case, one name is the other."""
    keys = {name: _key(name) for name in names}
    known = named.known(set(keys.values()))
    return {name for name, key in keys.items() if key not in known}


def _key(name: str) -> str:
    return name.casefold()


def _digest(store: Store, name: str, offset: int = 0, size: int | None = None) -> str | None:
    """The hash of a file, or of some of it; None where it cannot be read."""
    try:
        return sha256(store.read(name, offset=offset, size=size)).hexdigest()
    except OutputError:
        return None


class _LastRow:
    """The files that a row of a manifest names; none where the line is no row.

    Attributes:
        name: of the manipulator.
        failed: whether nothing was made of it.
        files: files of their own, with the hashes of their bytes.
        shards: tar files that hold the others.
        pictures: pictures beside the files.
        meshes: copies of meshes with their hashes, which rows share.
    """

    def __init__(self, line: bytes) -> None:
        self.name, self.failed = "", False
        self.files: dict[str, str] = {}
        self.shards: set[str] = set()
        self.pictures: set[str] = set()
        self.meshes: dict[str, str] = {}
        self._members: list[tuple[str, range, str]] = []
        with suppress(orjson.JSONDecodeError, KeyError, TypeError, AttributeError, OutputError):
            self._take(orjson.loads(line))  # If not, it is the manifest of something else.

    def _take(self, row: Any) -> None:  # noqa: ANN401 - what JSON has
        files = [file for file in row["files"] if "shard" not in file]
        members = [file for file in row["files"] if "shard" in file]
        own = {checked(file["path"]): str(file["sha256"]) for file in files}
        inside = [(checked(m["shard"]), range(m["offset"], m["offset"] + m["bytes"]), m["sha256"]) for m in members]
        meshes = {checked(mesh["path"]): str(mesh["sha256"]) for mesh in row.get("meshes", ())}
        pictures = [report["picture"] for report in row["loaders"].values() if report["picture"]]
        # In a shard, pictures are members. Files in folders of their own lie below the pictures.
        beside = "".join(min(own, key=lambda name: name.count("/"), default="").rpartition("/")[:2])
        self.pictures = {checked(f"{beside}{name}") for name in pictures} if own else set()
        self.name, self.failed = str(row["name"]), row["status"] != "ok"
        self.files, self.meshes, self._members = own, meshes, inside
        self.shards = {shard for shard, _, _ in inside}

    def names(self) -> Iterator[str]:
        """The names of all files in the store."""
        yield from self.files
        yield from self.shards
        yield from self.pictures
        yield from self.meshes

    def is_whole(self, store: Store, names: Collection[str]) -> bool:
        """Whether some of its own files have the bytes that they were written with."""
        return all(_digest(store, name) in (digest, None) for name, digest in self.files.items() if name in names)

    def is_whole_in(self, store: Store, shard: str) -> bool:
        """Whether its files in a shard have the bytes that they were written with."""
        return all(
            _digest(store, name, part.start, part.stop - part.start) == digest
            for name, part, digest in self._members
            if name == shard
        )
