"""Files of the last run into a place that a new run has no part in: they are removed at its end, and nothing else is.

Those of a manipulator that has failed in the new run stay as they were: it has a part in them. The manifest of the last
run names the files with the hashes of their bytes. A file that has other bytes by now is somebody's work, and stays; so
does one that the new run reads.
"""

from __future__ import annotations

from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, replace
from hashlib import file_digest, sha256
from typing import TYPE_CHECKING, BinaryIO, NamedTuple, cast

import orjson

from dh2urdf.errors import OutputError
from dh2urdf.output.journal import MANIFEST
from dh2urdf.output.whole_files import NameSet, checked

if TYPE_CHECKING:
    from io import BytesIO

    from dh2urdf.output.store import Store


@dataclass(frozen=True, slots=True, kw_only=True)
class Leftovers:
    """How many files of the last run were removed, kept as the user asked, or kept since they were changed."""

    removed: int = 0
    kept: int = 0
    changed: int = 0

    @property
    def told(self) -> str | None:
        """All of it as one line; None where there is nothing to tell."""
        words = {"removed": self.removed, "kept": self.kept, "kept, since they were changed": self.changed}
        parts = [f"{count:,} {what}" for what, count in words.items() if count]
        return f"files of an earlier run: {', '.join(parts)}" if parts else None


def clear_leftovers(  # noqa: C901 - own files, members of shards, and copies of meshes
    store: Store, reports: Store, rows: BinaryIO, *, keep: bool, keep_meshes: bool
) -> Leftovers:
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
    if not reports.size(MANIFEST):
        return Leftovers()
    with reports.open(MANIFEST) as old:
        rows.seek(0)
        if len({file_digest(cast("BytesIO", each), "sha256").digest() for each in (old, rows)}) == 1:
            return Leftovers()
    named, failed, of_meshes = NameSet(), NameSet(), set[str]()
    rows.seek(0)
    for row in map(_row, rows):
        named.add(name.casefold() for name in (*row.files, *row.members, *row.meshes))
        failed.add([row.name] if row.failed else [])
        of_meshes.update(row.meshes.values())
    found: Counter[str] = Counter()
    shared: dict[str, bool] = {}  # what several rows name, and whether it is as it was written
    with reports.open(MANIFEST) as stream:
        for row in map(_row, stream):
            if failed.known([row.name]):
                continue
            for name, digest in row.files.items():
                if not named.known([name.casefold()]):
                    _clear(store, name, found, keep=keep, whole=_digest(store, name) == digest)
            for shard, members in row.members.items():
                shared[shard] = shared.get(shard, True) and _is_whole(store, shard, members)
            if not keep_meshes:
                copies = {name: digest for name, digest in row.meshes.items() if digest not in of_meshes}
                shared |= {name: _digest(store, name) == digest for name, digest in copies.items()}
    for name, whole in shared.items():
        if not named.known([name.casefold()]):
            _clear(store, name, found, keep=keep, whole=whole)
    return Leftovers(**found)


def _clear(store: Store, name: str, found: Counter[str], *, keep: bool, whole: bool) -> None:
    """Remove a file that the last run wrote, if it is there and nobody has changed it."""
    if store.size(name) is None or store.is_protected(name):
        return
    if whole and not keep:
        try:
            store.remove(name)
        except OutputError as error:
            hint = "`--keep` leaves files of an earlier run where they are"
            raise OutputError([replace(problem, suggestion=hint) for problem in error.problems]) from error
    found["changed" if not whole else "kept" if keep else "removed"] += 1


def _digest(store: Store, name: str) -> str | None:
    """Return the hash of a file; None where it cannot be read."""
    with suppress(OutputError):
        return sha256(store.read(name)).hexdigest()
    return None


def _is_whole(store: Store, shard: str, members: list[tuple[int, int, str]]) -> bool:
    """Whether files in a shard have the bytes that they were written with."""
    with suppress(OutputError), store.open(shard) as stream:
        for offset, size, digest in members:
            stream.seek(offset)
            if sha256(stream.read(size)).hexdigest() != digest:
                return False
        return True
    return False


class _Row(NamedTuple):
    """The files that a row of a manifest names; none where the line is no row.

    Attributes:
        name: of the manipulator.
        failed: whether nothing was made of it.
        files: files and pictures of their own, with the hashes of their bytes.
        members: of each shard, the places of its files in it, with their hashes.
        meshes: copies of meshes with their hashes, which rows share.
    """

    name: str
    failed: bool
    files: dict[str, str]
    members: dict[str, list[tuple[int, int, str]]]
    meshes: dict[str, str]


def _row(line: bytes) -> _Row:
    with suppress(orjson.JSONDecodeError, KeyError, TypeError, AttributeError, OutputError):
        row = orjson.loads(line)
        files: dict[str, str] = {}
        members: dict[str, list[tuple[int, int, str]]] = {}
        for file in row["files"]:
            if "shard" in file:
                place = file["offset"] + 0, file["bytes"] + 0, file["sha256"]
                members.setdefault(checked(file["shard"]), []).append(place)
            else:
                files[checked(file["path"])] = str(file["sha256"])
        # In a shard, pictures are members. Files in folders of their own lie below the pictures.
        beside = "".join(min(files, key=lambda name: name.count("/"), default="").rpartition("/")[:2])
        pictures = row.get("pictures", {}).items() if files else ()
        files |= {checked(f"{beside}{name}"): str(digest) for name, digest in pictures}
        meshes = {checked(mesh["path"]): str(mesh["sha256"]) for mesh in row.get("meshes", ())}
        return _Row(str(row["name"]), row["status"] != "ok", files, members, meshes)
    return _Row("", False, {}, {}, {})  # It is the manifest of something else.
