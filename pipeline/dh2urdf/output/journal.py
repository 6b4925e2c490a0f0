"""What a run has done so far, kept where its output goes, so that another run can go on from there.

Workers write the row of every manipulator into the journal as soon as its files are in their place; a finished run
leaves a manifest in place of the journal. `Earlier` finds in both what is known of a manipulator. Nothing here is
trusted: before an old file is kept, its bytes are compared.
"""

from __future__ import annotations

import tempfile
from array import array
from contextlib import contextmanager
from hashlib import blake2b
from typing import IO, TYPE_CHECKING

import orjson

from dh2urdf.output.store import WORKING, LocalStore, Store
from dh2urdf.output.whole_files import reporting_os_errors, write_all

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import numpy as np
    from numpy.typing import NDArray

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

    def __init__(self, rows: IO[bytes], hashes: NDArray[np.uint64], places: NDArray[np.int64]) -> None:
        self._rows, self._hashes, self._places = rows, hashes, places

    def __len__(self) -> int:
        return len(self._hashes)

    def of(self, names: Sequence[str]) -> dict[int, tuple[bytes, ...]]:
        """What is known of manipulators of some names, newest first, by the place of the name."""
        import numpy as np

        wanted = np.array([_hash(name) for name in names], dtype=np.uint64)
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

    hashes, places, size = array("Q"), array("q"), 0
    with tempfile.TemporaryFile(prefix="dh2urdf-") as spool:
        for name in [*([MANIFEST] if store.size(MANIFEST) else []), *sorted(store.names(JOURNAL))]:
            with store.open(name) as stream:
                for line in stream:
                    try:
                        hashes.append(_hash(orjson.loads(line)["name"]))
                    except (orjson.JSONDecodeError, KeyError, TypeError, AttributeError):
                        continue  # The line that a process wrote when it was killed.
                    places.append(size)
                    whole = line if line.endswith(b"\n") else line + b"\n"
                    with reporting_os_errors(tempfile.gettempdir()):
                        write_all(spool.fileno(), whole)
                    size += len(whole)
        names, lines = np.frombuffer(hashes, dtype=np.uint64), np.frombuffer(places, dtype=np.int64)
        order = np.argsort(names, kind="stable")
        yield Earlier(spool, names[order], lines[order])


def _hash(name: str) -> int:
    return int.from_bytes(blake2b(name.encode(errors="surrogatepass"), digest_size=8).digest(), "little")
