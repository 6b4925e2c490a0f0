"""What a run has done so far, kept where its output goes, so that another run goes on from there or clears it away.

Workers write the row of every manipulator into the journal as soon as its files are in their place; a finished run
leaves a manifest in place of the journal. `Earlier` finds in both what is known of a manipulator. Nothing here is
trusted: before an old file is kept, its bytes are compared.
"""

from __future__ import annotations

import tempfile
from array import array
from collections import Counter
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from hashlib import file_digest, sha256
from typing import IO, TYPE_CHECKING, BinaryIO, NamedTuple, cast

import orjson

from dh2urdf.errors import OutputError
from dh2urdf.output.store import WORKING, LocalStore, Store
from dh2urdf.output.whole_files import NameSet, checked, reporting_os_errors, write_all

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from io import BytesIO

    import numpy as np
    from numpy.typing import NDArray

    from dh2urdf.output.store import Store

MANIFEST = "manifest.jsonl"
"""The manifest of a finished run in its store."""
JOURNAL = f"{WORKING}/journal"
"""The folder of what runs that did not finish have done: a folder for each of them, numbered."""


def next_journal(store: Store) -> str:
    """The folder for the journal of a run that begins now."""
    numbers = [int(name.split("/")[2]) for name in store.names(JOURNAL)]
    return f"{JOURNAL}/{max(numbers, default=0) + 1:04d}"


class Journal:
    """Takes the rows of a batch: they are in the store before the next manipulator is begun, where that is cheap."""

    def __init__(self, store: Store, name: str) -> None:
        self._store, self._name = store, name
        self._waiting: list[bytes] = []

    def add(self, row: bytes, *, now: bool = False) -> None:
        """Takes a row; `now` where making its manipulator again would cost more than writing it by itself."""
        self._waiting.append(row)
        if now and isinstance(self._store, LocalStore):
            self.close()

    def close(self) -> None:
        """Writes the rows that are waiting; the only ones, where files cannot be written bit by bit."""
        if not self._waiting:
            return
        write = self._store.append if isinstance(self._store, LocalStore) else self._store.write
        write(self._name, b"".join(self._waiting))
        self._waiting = []


class Earlier:
    """The rows of earlier runs, on disk; in memory are 24 bytes for each."""

    def __init__(self, rows: IO[bytes], hashes: NDArray[np.int64], places: NDArray[np.int64]) -> None:
        self._rows, self._hashes, self._places = rows, hashes, places

    def __len__(self) -> int:
        return len(self._hashes)

    def of(self, names: Sequence[str]) -> dict[int, tuple[bytes, ...]]:
        """What is known of manipulators of some names, newest first, by the place of the name."""
        import numpy as np

        wanted = np.array([hash(name) for name in names], dtype=np.int64)
        first = np.searchsorted(self._hashes, wanted, "left")
        last = np.searchsorted(self._hashes, wanted, "right")
        found: dict[int, tuple[bytes, ...]] = {}
        for index in np.flatnonzero(first < last).tolist():
            lines = []
            for place in sorted(self._places[first[index] : last[index]])[::-1]:
                self._rows.seek(place)
                lines.append(self._rows.readline())
            found[index] = tuple(lines)
        return found


@contextmanager
def earlier_rows(store: Store) -> Iterator[Earlier]:
    """What earlier runs into a store have done, finished or not."""
    import numpy as np

    hashes, places, size = array("q"), array("q"), 0
    with tempfile.TemporaryFile(prefix="dh2urdf-") as spool:
        for name in [*([MANIFEST] if store.size(MANIFEST) else []), *sorted(store.names(JOURNAL))]:
            with store.open(name) as stream:
                for line in stream:
                    try:
                        hashes.append(hash(orjson.loads(line)["name"]))
                    except (orjson.JSONDecodeError, KeyError, TypeError):
                        continue  # The line that a process wrote when it was killed.
                    places.append(size)
                    whole = line if line.endswith(b"\n") else line + b"\n"
                    with reporting_os_errors(tempfile.gettempdir()):
                        write_all(spool.fileno(), whole)
                    size += len(whole)
        names, lines = np.frombuffer(hashes, dtype=np.int64), np.frombuffer(places, dtype=np.int64)
        order = np.argsort(names, kind="stable")
        yield Earlier(spool, names[order], lines[order])


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
    """Remove what the manifest of the last run names and a new manifest does not; nothing else is removed.

    Files of a manipulator that has failed in the new run stay as they were: it has a part in them. A file with other
    bytes than the manifest tells is somebody's work, and stays; so does one that the new run reads.

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
