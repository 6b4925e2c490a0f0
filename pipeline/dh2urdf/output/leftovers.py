"""Files of the last run into a place that a new run has no part in: they are removed at its end, and nothing else is.

Those of a manipulator that has failed in the new run stay as they were: it has a part in them.

The manifest of the last run names them, with the hashes of their bytes. A file that has other bytes by now is
somebody's work, and stays; so does one that the new run reads.
"""

from __future__ import annotations

from collections import Counter
from contextlib import suppress
from dataclasses import replace
from hashlib import file_digest, sha256
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import orjson

from dh2urdf.errors import OutputError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.output.journal import MANIFEST
from dh2urdf.output.name_set import NameSet
from dh2urdf.output.whole_files import checked

if TYPE_CHECKING:
    from collections.abc import Iterable
    from io import BytesIO

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
    named, failed, digests = _of_new(rows)
    found: Counter[str] = Counter()
    shards: dict[str, bool] = {}
    meshes: dict[str, str] = {}
    with reports.open(MANIFEST) as stream:
        for row in map(_Row, stream):
            if failed.known([row.name]):
                continue
            left = _left(row.names, named)
            meshes |= {} if keep_meshes else {name: row.meshes[name] for name in left.intersection(row.meshes)}
            if inside := left.intersection(row.members):
                for name in inside:
                    shards[name] = shards.get(name, True) and row.is_whole_in(store, name)
            elif not left.isdisjoint(row.files):
                own = [(name, digest) for name, digest in row.files.items() if name in left]
                whole = all(_digest(store, name) in (digest, None) for name, digest in own)
                _clear(store, left.difference(row.meshes), found, keep=keep, whole=whole)
    for shard, whole in shards.items():
        _clear(store, [shard], found, keep=keep, whole=whole)
    for name, digest in meshes.items():
        if digest not in digests:
            _clear(store, [name], found, keep=keep, whole=_digest(store, name) == digest)
    return Leftovers(**found)


def _of_new(rows: BinaryIO) -> tuple[NameSet, NameSet, set[str]]:
    """The files that a new manifest names, the manipulators that failed, and the hashes of the meshes."""
    named, failed, digests = NameSet(), NameSet(), set[str]()
    rows.seek(0)
    for row in map(_Row, rows):
        named.add(name.casefold() for name in row.names)
        failed.add([row.name] if row.failed else [])
        digests.update(row.meshes.values())
    return named, failed, digests


def _is_same(store: Store, rows: BinaryIO) -> bool:
    """Whether the manifest in a store is the new one."""
    rows.seek(0)
    with store.open(MANIFEST) as stream:
        old, new = [file_digest(cast("BytesIO", each), "sha256").digest() for each in (stream, rows)]
        return old == new


def _left(names: Iterable[str], named: NameSet) -> set[str]:
    """Those of some names that the new manifest has not; where a file system ignores case, one name is the other."""
    keys = {name: name.casefold() for name in names}
    known = named.known(set(keys.values()))
    return {name for name, key in keys.items() if key not in known}


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


def _digest(store: Store, name: str) -> str | None:
    """The hash of a file; None where it cannot be read."""
    try:
        return sha256(store.read(name)).hexdigest()
    except OutputError:
        return None


class _Row:
    """The files that a row of a manifest names; none where the line is no row.

    Attributes:
        name: of the manipulator.
        failed: whether nothing was made of it.
        files: files of their own, with the hashes of their bytes.
        members: of each shard, the places of its files in it, with their hashes.
        meshes: copies of meshes with their hashes, which rows share.
        names: the names of all files in the store, those of shards and pictures too.
    """

    def __init__(self, line: bytes) -> None:
        self.name, self.failed = "", False
        self.files: dict[str, str] = {}
        self.members: dict[str, list[tuple[int, int, str]]] = {}
        self.meshes: dict[str, str] = {}
        self.names: set[str] = set()
        with suppress(orjson.JSONDecodeError, KeyError, TypeError, AttributeError, OutputError):
            self._take(orjson.loads(line))  # If not, it is the manifest of something else.

    def _take(self, row: Any) -> None:  # noqa: ANN401 - what JSON has
        files: dict[str, str] = {}
        members: dict[str, list[tuple[int, int, str]]] = {}
        for file in row["files"]:
            if "shard" in file:
                place = file["offset"] + 0, file["bytes"] + 0, file["sha256"]
                members.setdefault(checked(file["shard"]), []).append(place)
            else:
                files[checked(file["path"])] = str(file["sha256"])
        meshes = {checked(mesh["path"]): str(mesh["sha256"]) for mesh in row.get("meshes", ())}
        # In a shard, pictures are members. Files in folders of their own lie below the pictures.
        beside = "".join(min(files, key=lambda name: name.count("/"), default="").rpartition("/")[:2])
        pictures = [report["picture"] for report in row["loaders"].values() if report["picture"]]
        own = {checked(f"{beside}{name}") for name in pictures} if files else set()
        self.name, self.failed = str(row["name"]), row["status"] != "ok"
        self.files, self.members, self.meshes = files, members, meshes
        self.names = {*files, *members, *own, *meshes}

    def is_whole_in(self, store: Store, shard: str) -> bool:
        """Whether its files in a shard have the bytes that they were written with."""
        with suppress(OutputError), store.open(shard) as stream:
            for offset, size, digest in self.members[shard]:
                stream.seek(offset)
                if sha256(stream.read(size)).hexdigest() != digest:
                    return False
            return True
        return False
