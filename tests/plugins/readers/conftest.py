import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.plain.rows import PlainRows
from dh2urdf_plugins.readers.table import TableOptions

sys.path.insert(0, str(Path(__file__).parent))  # spreadsheets, which these tests share


@pytest.fixture
def read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[Manipulator | Rejected]]:
    """Reads a table that is given as text or bytes; the file is called `arm`, in the test's folder."""
    monkeypatch.chdir(tmp_path)

    def read_table(content: str | bytes, suffix: str = ".csv", **options: str) -> list[Manipulator | Rejected]:
        path = Path(f"arm{suffix}")
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        reader = stages.CSV if suffix in stages.CSV.suffixes else stages.YAML
        return list(reader.read(path, TableOptions(**options)))

    return read_table


@pytest.fixture
def read_one(read: Callable[..., list[Manipulator | Rejected]]) -> Callable[..., Manipulator]:
    """Reads a table of one manipulator in the standard convention, which must be accepted."""

    def read_table(content: str | bytes, suffix: str = ".csv", **options: str) -> Manipulator:
        (arm,) = read(content, suffix, **{"convention": "standard", **options})
        assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
        return arm

    return read_table


@pytest.fixture
def fast(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many manipulators each fast reading gives; 0 where it leaves them to the careful one."""
    counts: list[int] = []
    plain = PlainRows.read

    def counted(self: PlainRows, *arguments: Any) -> Any:
        found = plain(self, *arguments)
        counts.append(sum(len(members) for members, _ in found or ()))
        return found

    monkeypatch.setattr(PlainRows, "read", counted)
    return counts
