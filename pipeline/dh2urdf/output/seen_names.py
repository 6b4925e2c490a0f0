"""Which names were seen before, of any number of them, in memory that does not grow with it."""

from __future__ import annotations

from contextlib import contextmanager
from itertools import islice
from typing import TYPE_CHECKING

from dh2urdf.errors import OutputError
from dh2urdf.source import Problem

if TYPE_CHECKING:
    import sqlite3
    from collections.abc import Collection, Iterable, Iterator

RECENT = 30_000
"""Names that are held in memory: some 4 MB. Most runs have fewer, and need no database."""
_ASKED_AT_ONCE = 500
"""Names in one question to the database; old versions take 999."""


class SeenNames:
    """A set of names that only grows.

    Up to `RECENT` of them are held in memory; whenever there are more, they go to a temporary database, which the
    system removes with the process, however that ends. In batches a name costs some 2 µs, alone 5 µs.
    """

    def __init__(self, *, recent: int = RECENT) -> None:
        """Starts without a name; `recent` is how many are held in memory."""
        self._limit = recent
        self._recent: set[str] = set()
        self._database: sqlite3.Connection | None = None

    def known(self, names: Collection[str]) -> set[str]:
        """Those of some names that were added before.

        Raises:
            OutputError: the temporary database cannot be read.
        """
        found = self._recent.intersection(names)
        if self._database is None:
            return found
        asked = map(_key, names)
        with _reporting_errors():
            while some := list(islice(asked, _ASKED_AT_ONCE)):
                places = ",".join("?" * len(some))
                rows = self._database.execute(f"SELECT name FROM names WHERE name IN ({places})", some)  # noqa: S608 - ?,?
                found.update(name.decode(errors="surrogatepass") for (name,) in rows)
        return found

    def add(self, names: Iterable[str]) -> None:
        """Remembers some names.

        Raises:
            OutputError: the temporary folder is full, or nothing can be written there.
        """
        self._recent.update(names)
        if len(self._recent) > self._limit:
            self._store()

    def _store(self) -> None:
        """Moves the names in memory to the database: sorted, so that neighbours land on the same of its pages."""
        with _reporting_errors():
            if self._database is None:
                self._database = _database()
            keys = sorted(map(_key, self._recent))
            self._database.executemany("INSERT OR IGNORE INTO names VALUES (?)", zip(keys, strict=True))
        self._recent.clear()


def _key(name: str) -> bytes:
    """A name as the database holds it: any text, also one that is no UTF-8."""
    return name.encode(errors="surrogatepass")


def _database() -> sqlite3.Connection:
    """A database in a file without a name, in the system's temporary folder; what a crash leaves of it is of no use."""
    import sqlite3

    # An executor may take the tasks of a run in a thread of its own.
    database = sqlite3.connect("", isolation_level=None, check_same_thread=False)
    database.executescript(
        "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA locking_mode = EXCLUSIVE;"
        "PRAGMA cache_size = -2000;"  # kB
        "CREATE TABLE names (name BLOB PRIMARY KEY) WITHOUT ROWID; BEGIN"
    )
    return database


@contextmanager
def _reporting_errors() -> Iterator[None]:
    """Turn what the database declares about its file into one line.

    Raises:
        OutputError: it raised anything.
    """
    import sqlite3  # 2 ms, for runs of many names only

    try:
        yield
    except sqlite3.Error as error:
        message = f"the names of the run cannot be kept in the temporary folder: {error}"
        suggestion = "SQLITE_TMPDIR names another temporary folder"
        raise OutputError(Problem(message=message, suggestion=suggestion)) from error
