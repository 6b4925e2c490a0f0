"""Tables as texts: written in a format and read again, letter for letter."""

import tempfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Mark
from dh2urdf.stages import Reader, WritesTables
from dh2urdf.table_text import FIELDS, TableText
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.table import TableOptions
from dh2urdf_plugins.readers.words.comment_lines import SIGNS

READERS = {"csv": stages.CSV, "yaml": stages.YAML}
TABLES = Path(__file__).parents[3] / "configs" / "tables"


def written(table: TableText, reader: Reader[Any], folder: Path) -> Path:
    writes = reader.can(WritesTables)
    path = folder / f"arm{reader.suffixes[0]}"
    path.write_bytes(writes.write([table]).content)
    return path


def read(path: Path, reader: Reader[Any]) -> Manipulator:
    (arm,) = reader.read(path, TableOptions())
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    return arm


@pytest.mark.parametrize("table", sorted(TABLES.iterdir()), ids=lambda path: path.name)
@pytest.mark.parametrize("form", READERS)
def test_the_texts_of_a_file_come_back(table: Path, form: str, tmp_path: Path) -> None:
    """What is in the cells of the project's own tables is reported as it stands, and written in either format."""
    own = next(reader for reader in READERS.values() if table.suffix in reader.suffixes)
    (texts,) = own.can(WritesTables).texts(table)
    path = written(texts, READERS[form], tmp_path)
    assert read(path, READERS[form]) == read(table, own)
    assert list(READERS[form].can(WritesTables).texts(path)) == [texts]


CELLS = st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]) | st.just(" "), min_size=1, max_size=12)
# In a row that lacks numbers, a first cell that begins like a comment makes the row one, in quotes or not.
TYPED = CELLS.map(str.strip).filter(lambda text: bool(text) and not text.startswith(SIGNS))
ROWS = st.dictionaries(st.sampled_from(FIELDS), TYPED, min_size=1)


@given(st.lists(ROWS, min_size=1, max_size=4), st.sampled_from(["csv", "yaml"]))
def test_any_cells_come_back(rows: list[dict[str, str]], form: str) -> None:
    """Whatever is typed into cells, wrong or right, is in the file so that the format tells it again."""
    table = TableText(name="x", convention="standard", rows=tuple(rows))
    with tempfile.TemporaryDirectory() as folder:
        path = written(table, READERS[form], Path(folder))
        (found,) = READERS[form].can(WritesTables).texts(path)
    # An empty text and one that is not there are the same, and so are spaces around one.
    assert [dict(sorted(row.items())) for row in found.rows] == [dict(sorted(row.items())) for row in rows]


def test_places_are_those_of_the_reader(tmp_path: Path) -> None:
    """Where the written CSV says that a cell is, there the reader finds what is wrong with it."""
    rows = (
        {"joint": 'a "b", c', "a": "0", "alpha": "wrong", "d": "0"},
        {"joint": "#2", "a": "1", "alpha": "0", "d": "no"},
    )
    table = TableText(name="x", convention="standard", base="{xyz: 3}", rows=rows)
    writes = stages.CSV.can(WritesTables)
    file = writes.write([TableText(**{**_said(table), "base": ""})])
    path = tmp_path / "x.csv"
    path.write_bytes(file.content)
    (arm,) = stages.CSV.read(path, TableOptions())
    assert not isinstance(arm, Manipulator)
    assert [file.at(problem.mark) for problem in arm.problems] == [(0, "alpha"), (1, "d")]
    assert writes.write([table]).at(Mark(file="x", line=3, column=9)) == (None, "base")


def _said(table: TableText) -> dict[str, Any]:
    return {name: getattr(table, name) for name in table.__dataclass_fields__}


def test_several_manipulators_are_as_many_tables_of_texts(tmp_path: Path) -> None:
    """A CSV file with a column of robots has the texts of each of them."""
    path = tmp_path / "two.csv"
    path.write_text("# convention: standard\nrobot,a,alpha,d\nx,1,pi/2,0\ny,2,0,0\n")
    tables = list(stages.CSV.can(WritesTables).texts(path))
    assert [(table.name, *table.rows) for table in tables] == [
        ("x", {"a": "1", "alpha": "pi/2", "d": "0"}),
        ("y", {"a": "2", "alpha": "0", "d": "0"}),
    ]


def test_headers_with_units_are_the_units_of_the_table(tmp_path: Path) -> None:
    """`a [mm]` and `alpha [deg]` are reported as the units of all lengths and angles."""
    path = tmp_path / "mm.csv"
    path.write_text("# convention: DH\na [mm],alpha [deg],d [mm]\n300,90,0\n")
    writes = stages.CSV.can(WritesTables)
    (table,) = writes.texts(path)
    assert (table.convention, table.length_unit, table.angle_unit) == ("standard", "mm", "deg")
    assert read(written(table, stages.CSV, tmp_path), stages.CSV).rows[0].a == 0.3
