"""Which names were seen before, of any number of them, in memory that does not grow with it."""

from __future__ import annotations

from contextlib import contextmanager, suppress
from itertools import islice
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import OutputError
from dh2urdf.source import Problem

if TYPE_CHECKING:
    import sqlite3
    from collections.abc import Collection, Iterable, Iterator
    from typing import BinaryIO

RECENT = 30_000
"""Names that are held in memory: some 4 MB. Most runs have fewer, and need no database."""
HASHED = 1_000_000
"""Names of which hashes are held in memory beyond these: 8 MB."""
_ASKED_AT_ONCE = 500
"""Names in one question to the database; old versions take 999."""


class SeenNames:
    """A set of names that only grows.

    Up to `RECENT` of them are held in memory. Whenever there are more, they are written to a temporary file, and their
    hashes are held: in nearly all runs no name comes again, and the hashes show that. As soon as a hash comes again, or
    there are too many, the names go to a temporary database, which knows. The system removes both with the process,
    however that ends. In batches a name costs some 0.5 µs, and with the database 2 µs; alone 5 µs.
    """

    def __init__(self, *, recent: int = RECENT, hashed: int = HASHED) -> None:
        """Starts without a name; `recent` is how many are held in memory, `hashed` of how many more the hashes are."""
        self._limit, self._hashed = recent, hashed
        self._recent: set[str] = set()
        self._hashes = _Hashes()
        self._file: BinaryIO | None = None
        self._database: sqlite3.Connection | None = None

    def known(self, names: Collection[str]) -> set[str]:
        """Those of some names that were added before.

        Raises:
            OutputError: the temporary file or database cannot be written or read.
        """
        found = self._recent.intersection(names)
        if self._database is None:
            if not self._hashes.may_have(names):
                return found
            self._begin_database()
        asked = map(_key, names)
        with _reporting_errors():
            assert self._database is not None  # noqa: S101 - it has just begun
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
        """Moves the names in memory to the file, or to the database."""
        import pickle
        from tempfile import TemporaryFile

        if self._database is None and len(self._hashes) + len(self._recent) > self._hashed:
            self._begin_database()
        keys = list(map(_key, self._recent))
        with _reporting_errors():
            if self._database is not None:
                _insert(self._database, keys)
            else:
                self._file = self._file or TemporaryFile()  # noqa: SIM115 - it is closed when its names go to the database
                pickle.dump(keys, self._file)
                self._hashes.add(self._recent)
        self._recent.clear()

    def _begin_database(self) -> None:
        """Moves the names in the file to a database."""
        import pickle

        with _reporting_errors():
            database = _database()
            if self._file is not None:
                self._file.seek(0)
                with suppress(EOFError):
                    while True:
                        _insert(database, pickle.load(self._file))  # noqa: S301 - written above
                self._file.close()
        self._database, self._file, self._hashes = database, None, _Hashes()


class _Hashes:
    """The hashes of names: sorted columns, each at least twice as long as the next."""

    def __init__(self) -> None:
        self._columns: list[Any] = []

    def __len__(self) -> int:
        return sum(map(len, self._columns))

    def add(self, names: Collection[str]) -> None:
        """Adds the hashes of some names."""
        import numpy as np

        column = np.sort(_hashes(names))
        while self._columns and len(self._columns[-1]) < 2 * len(column):
            column = np.sort(np.concatenate((self._columns.pop(), column)))
        self._columns.append(column)

    def may_have(self, names: Collection[str]) -> bool:
        """Whether one of some names was added, or another one of the same hash."""
        if not self._columns:
            return False
        import numpy as np

        wanted = np.sort(_hashes(names))
        return any(
            bool((column[np.minimum(column.searchsorted(wanted), len(column) - 1)] == wanted).any())
            for column in self._columns
        )


def _hashes(names: Collection[str]) -> Any:  # noqa: ANN401 - a column
    import numpy as np

    return np.fromiter(map(hash, names), np.int64, len(names))


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


def _insert(database: sqlite3.Connection, keys: list[bytes]) -> None:
    """Adds names to a database: sorted, so that neighbours land on the same of its pages."""
    keys.sort()
    database.executemany("INSERT OR IGNORE INTO names VALUES (?)", zip(keys, strict=True))


@contextmanager
def _reporting_errors() -> Iterator[None]:
    """Turn what the system or the database declares about a temporary file into one line.

    Raises:
        OutputError: it raised anything.
    """
    import sqlite3  # 2 ms, for runs of many names only

    try:
        yield
    except (OSError, sqlite3.Error) as error:
        message = f"the names of the run cannot be kept in the temporary folder: {error}"
        suggestion = "TMPDIR names another temporary folder, and SQLITE_TMPDIR another one for databases"
        raise OutputError(Problem(message=message, suggestion=suggestion)) from error
