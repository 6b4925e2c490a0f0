"""The pages of tables are true: every example is read, every word is known, every bound is the constant's."""

import csv as python_csv
import datetime as dt
import math
import re
import shlex
import sys
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pyarrow as pa
import pytest
from pyarrow import parquet as pq

from dh2urdf import errors
from dh2urdf.documents import composer as yaml_composer, text_files as textfiles
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Inertia, JointType, Limits, LinkGeometry, Manipulator
from dh2urdf.quantities import UNITS, grammar as expressions, unit_word
from dh2urdf.rotations import RigidTransform
from dh2urdf.stages import Reader
from dh2urdf.testing.oracle import table_pose
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.comments import declared, top
from dh2urdf_plugins.readers.header import units as table_units, words as header_words
from dh2urdf_plugins.readers.rows import rows
from dh2urdf_plugins.readers.sources import (
    delimited,
    parquet as parquet_sizes,
    texts as source_texts,
    workbook as xlsx_file,
)
from dh2urdf_plugins.readers.table import TableOptions
from dh2urdf_plugins.readers.tables import row_table
from dh2urdf_plugins.readers.words import bounds as table_bounds, fields, names

DOCS = Path(__file__).parents[1] / "docs"
PAGES = (DOCS / "tables.md", *sorted((DOCS / "tables").glob("*.md")))
TEXT = "\n".join(page.read_text("utf-8") for page in PAGES)

# --- The page's own notation ------------------------------------------------------------------------------------------

BLOCK = re.compile(
    r"(?:^<!-- example(?P<name>[^:\n]*): (?P<says>[^\n]*) -->\n)?^```(?P<form>\w+)\n(?P<body>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
OUTCOME = re.compile(
    r"(?P<outcome>accepted|notice|refused)(?:: (?P<count>\d+) manipulators)?(?: (?P<quote>['\"])(?P<message>.*)(?P=quote))?"
    r"(?: with (?P<options>[^;]+))?(?:; same (?P<what>arm|table) as (?P<other>[\w ]+))?"
)
TABLE = re.compile(r"<!-- table (?P<name>[\w ]+) -->\n\|.*\|\n\|[-|]+\|\n(?P<rows>(?:\|.*\|\n)+)")


@dataclass(frozen=True)
class Example:
    """A block of the page and what the comment above it declares about it."""

    name: str
    form: str
    body: str
    outcome: str
    count: int = 1
    message: str = ""
    options: dict[str, str] = field(default_factory=dict)
    what: str = ""
    other: str = ""


def _examples() -> Iterator[Example]:
    for block in BLOCK.finditer(TEXT):
        if block["form"] in ("csv", "yaml", "json"):
            said = OUTCOME.fullmatch(block["says"] or "")
            assert said, f"no outcome is said of\n{block[0]}"
            line = TEXT[: block.start("body")].count("\n") + 1
            options = dict(option.split("=") for option in (said["options"] or "").split())
            yield Example(
                name=block["name"].strip() or f"line {line}",
                form=block["form"],
                body=block["body"],
                outcome=said["outcome"],
                count=int(said["count"] or 1),
                message=said["message"] or "",
                options=options,
                what=said["what"] or "",
                other=said["other"] or "",
            )


EXAMPLES = {example.name: example for example in _examples()}
TABLES = {
    table["name"]: [[cell.strip() for cell in line.strip("|").split("|")] for line in table["rows"].splitlines()]
    for table in TABLE.finditer(TEXT)
}


def code(cell: str) -> list[str]:
    """The pieces of code in a cell of the page."""
    return re.findall(r"`([^`]+)`", cell)


def one_code(cell: str) -> str:
    (piece,) = code(cell)
    return piece


def of_tables(*wanted: str) -> list[Any]:
    """The rows of some tables of the page as parameters of a test."""
    return [
        pytest.param(*row, id=f"{name}: {' '.join(row)}".replace("`", "")) for name in wanted for row in TABLES[name]
    ]


# --- Reading ----------------------------------------------------------------------------------------------------------


class Outcome:
    """What came of a table: its manipulators, or what was said against it."""

    def __init__(self, path: Path, options: dict[str, str]) -> None:
        known: tuple[Reader[Any], ...] = (stages.CSV, stages.PARQUET, stages.XLSX, stages.YAML)
        reader = next(each for each in known if path.suffix in each.suffixes)
        self.arms: list[Manipulator] = []
        self.errors: list[str] = []
        try:
            for result in reader.read(path, reader.options(**options)):
                if isinstance(result, Manipulator):
                    self.arms.append(result)
                else:
                    self.errors += map(str, result.problems)
        except TableError as error:
            self.errors += map(str, error.problems)
        self.notices = [str(notice) for arm in self.arms for notice in arm.notices]

    def arm(self) -> Manipulator:
        """The one manipulator, of which there is nothing to say."""
        assert (self.errors, self.notices) == ([], [])
        (arm,) = self.arms
        return arm


@pytest.fixture
def read(tmp_path: Path) -> Callable[..., Outcome]:
    """Reads a table; its file is always called `arm`, so that equal tables are equal manipulators."""

    meshes = tmp_path / "meshes"
    meshes.mkdir()
    for name in ("base.stl", "arm.dae", "arm.stl"):
        (meshes / name).write_text(name)

    def read_table(content: str | bytes, form: str = "csv", **options: str) -> Outcome:
        path = tmp_path / f"arm.{form}"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return Outcome(path, options)

    return read_table


def table_of(header: str, row: str, statements: str = "# convention: standard\n") -> str:
    return f"{statements}{header}\n{row}\n"


# --- Examples ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("example", [pytest.param(example, id=name) for name, example in EXAMPLES.items()])
def test_every_example_comes_out_as_it_says(example: Example, read: Callable[..., Outcome]) -> None:
    """Accepted without a word, accepted with the notice, or refused with the message; and the same arm where it says so."""
    found = read(example.body, example.form, **example.options)
    if example.outcome == "refused":
        assert any(example.message in error for error in found.errors), found.errors
        return
    assert found.errors == []
    assert len(found.arms) == example.count
    if example.outcome == "notice":
        (notice,) = found.notices
        assert example.message in notice
    else:
        assert found.notices == []
    if example.other:
        other = EXAMPLES[example.other]
        twin = read(other.body, other.form, **other.options).arm()
        (arm,) = found.arms
        if example.what == "table":
            assert arm == twin
        for q in ([0.0, 0.0, 0.0, 0.0], [0.3, -1.1, 0.2, 2.5], [-2.0, 0.7, -0.15, -0.4]):
            moving = len(twin.moving_rows)
            assert len(arm.moving_rows) == moving
            np.testing.assert_allclose(table_pose(arm, q[:moving]), table_pose(twin, q[:moving]), rtol=0, atol=1e-14)


QUARTER = math.pi / 2
R, P, F = JointType.REVOLUTE, JointType.PRISMATIC, JointType.FIXED
MEANT = {
    "plain": [(R, 0, QUARTER, 0.12, 0, 1), (R, 0.3, 0, 0, 0, 1), (P, 0, 0, 0.05, 0, 1), (R, 0.04, -QUARTER, 0, 0, 1)],
    "craig": [(R, 0, 0, 0.3, 0, 1), (R, 0, -QUARTER, 0, 0, 1), (R, 0.4, 0, 0, 0, 1)],
    "turned": [(R, 0.3, 0, 0.1, QUARTER, 1), (F, 0, 0, 0.2, 0, 1), (P, 0, QUARTER, 0, 0.1, -1)],
    "placed": [(R, 0.3, QUARTER, 0, 0, 1)],
    "kinds": [(R, 0.3, QUARTER, 0, QUARTER / 2, 1), (P, 0, 0, 0.1, 0.05, 1)],
}
"""Type, a [m], alpha [rad], d [m], offset and sign of every row of the tables that others are compared with."""


@pytest.mark.parametrize("name", MEANT)
def test_the_tables_that_others_are_compared_with_mean_this(name: str, read: Callable[..., Outcome]) -> None:
    """Row by row, with the convention, the base and the tool."""
    arm = read(EXAMPLES[name].body).arm()
    assert [(row.type, row.a, row.alpha, row.d, row.offset, row.sign) for row in arm.rows] == MEANT[name]
    assert {row.theta for row in arm.rows} == {0.0}
    assert arm.convention is (Convention.MODIFIED if name == "craig" else Convention.STANDARD)
    placed = name == "placed"
    assert arm.base == RigidTransform.from_xyz_rpy((0, 0, 0.3 if placed else 0), (0, 0, QUARTER if placed else 0))
    assert arm.tool == RigidTransform.from_xyz_rpy((0, 0, 0.1 if placed else 0), (0, 0, 0))


def test_every_key_of_yaml_means_what_the_page_says(read: Callable[..., Outcome]) -> None:
    """In SI units, with what the defaults declare about the joint that does not."""
    arm = read(EXAMPLES["every key"].body, "yaml").arm()
    shoulder, elbow = arm.rows
    assert (arm.name, arm.base_mass, arm.density) == ("my arm", 4, 2700)
    assert (arm.base_geometry, arm.geometry) == (
        LinkGeometry(shape="cylinder", radius=0.06),
        LinkGeometry(shape="capsule", radius=0.04),
    )
    assert arm.base == RigidTransform.from_xyz_rpy((0, 0, 0.3), (0, 0, QUARTER))
    assert arm.tool.translation == (0, 0, 0.1)
    assert (shoulder.a, shoulder.alpha, shoulder.d, shoulder.offset, shoulder.sign) == (0.3, QUARTER, 0.12, QUARTER, -1)
    assert shoulder.limits == Limits(
        lower=-math.pi, upper=math.pi, velocity=QUARTER, effort=150, acceleration=5 * QUARTER, jerk=100 * QUARTER
    )
    assert (shoulder.com, shoulder.radius, shoulder.friction) == ((-0.15, 0, 0), 0.05, 0.1)
    assert (shoulder.damping, elbow.damping) == (1.5, 0.5)
    assert (shoulder.armature, arm.visuals, arm.collisions) == (0.02, True, True)
    assert [Path(mesh.file.path).name for mesh in (shoulder.visual, shoulder.collision) if mesh] == [
        "arm.dae",
        "arm.stl",
    ]
    assert shoulder.visual.pose == RigidTransform.from_xyz_rpy((-0.3, 0, 0), (0, 0, QUARTER))
    assert shoulder.visual.scale == (0.001, 0.001, 0.001)
    assert arm.base_visual == arm.base_collision
    assert elbow.visual is elbow.collision is None
    assert shoulder.inertia == elbow.inertia == Inertia(ixx=0.005, iyy=0.03, izz=0.03)


def test_no_block_and_no_table_goes_untested() -> None:
    """All fences are blocks that are known, and all tables but those of reasons and of meshes have a test."""
    found = list(BLOCK.finditer(TEXT))
    assert TEXT.count("```") == 2 * len(found)
    others = [block["form"] for block in found if block["form"] not in ("csv", "yaml", "json")]
    assert sorted(others) == ["python", "sh", "text"]
    assert len(EXAMPLES) == len(found) - 3, "two examples have one name"
    assert TEXT.count("<!-- example") == len(EXAMPLES)
    assert TEXT.count("<!-- table") == len(TABLES)
    assert len(re.findall(r"^\|[-|]+\|$", TEXT, re.MULTILINE)) == len(TABLES) + 2


def test_the_parquet_file_is_the_table_above_it(
    read: Callable[..., Outcome], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The one block of Python writes a file with the manipulators of the CSV example."""
    monkeypatch.chdir(tmp_path)
    (script,) = (block["body"] for block in BLOCK.finditer(TEXT) if block["form"] == "python")
    exec(script, {})  # noqa: S102 - a block of the page
    assert list(stages.PARQUET.read(tmp_path / "arms.parquet", TableOptions())) == read(EXAMPLES["many"].body).arms


@pytest.mark.parametrize(("cells", "meaning"), of_tables("parquet"))
def test_cells_of_parquet_are_read_as_the_page_says(cells: str, meaning: str, tmp_path: Path) -> None:
    """Each kind of cell in a column that shows what becomes of it."""
    tried: dict[str, tuple[str, list[Any], Any]] = {
        "whole numbers, floats, decimals": ("a", pa.array([0.1], pa.float32()), 0.10000000149011612),
        "text, also dictionary-encoded": ("alpha", pa.array(["pi/2"]).dictionary_encode(), QUARTER),
        "whole numbers in a column of words": ("sigma", [1.0, None], P),
        "truth values": ("flip", [True], -1),
        "null": ("a", [None], "a is empty"),
        "NaN": ("mass", [math.nan], "'nan'"),
        "lists": ("d", [[0.5]], "holds list"),
        "moments, bytes": ("d", [b"0.5"], "holds binary"),
    }
    name, column, expected = tried[cells]
    columns = {"a": [0.0] * len(column), "alpha": [0.0] * len(column), "d": [0.0] * len(column), name: column}
    pq.write_table(pa.table(columns), tmp_path / "arm.parquet")
    found = Outcome(tmp_path / "arm.parquet", {"convention": "standard"})
    if "refused" in meaning:
        assert any(str(expected) in error for error in found.errors)
    else:
        (arm,) = found.arms
        assert getattr(arm.rows[0], {"flip": "sign", "sigma": "type"}.get(name, name)) == expected


@pytest.mark.parametrize(("cell", "meaning"), of_tables("xlsx"))
def test_cells_of_workbooks_are_read_as_the_page_says(cell: str, meaning: str, tmp_path: Path) -> None:
    """Each kind of cell as `a` of the first of two joints."""
    tried: dict[str, tuple[Any, str, str, Any]] = {
        "`0.089159`, shown as 0.09": (0.089159, "0.00", "", 0.089159),
        '`425` with the number format `0" mm"`': (425, '0" mm"', "", 0.425),
        "`0.05` with the number format `0%`": (0.05, "0%", "", "shows a percentage"),
        '`0.05` with the number format `[<1]0.00" m";0" mm"`': (0.05, '[<1]0.00" m";0" mm"', "", "shows one unit for"),
        "`0.05` with the number format `;;;`": (0.05, ";;;", "", "shows nothing"),
        "`0.05` with the number format `-0.00`": (0.05, "-0.00", "", "shows another sign"),
        "the text `-0,425`": ("-0,425", "General", "", -0.425),
        "a formula": (0.25, "General", "<f>1/4</f>", 0.25),
        "a formula without a value": ("=1/4", "General", "", "a formula without a value"),
        "`#REF!`": ("#REF!", "General", "", "the error #REF!"),
        "a date": (dt.date(2024, 2, 1), "yyyy-mm-dd", "", "holds a date"),
        "merged down a column": (0.25, "General", "A2:A3", 0.25),
        "merged across columns": (0.25, "General", "A2:B2", "merged across several columns"),
    }
    value, number_format, more, expected = tried[cell]
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    for row in (["a", "alpha", "d"], [value, 0, 0], [1, 0, 0]):
        sheet.append(row)
    sheet["A2"].number_format = number_format
    if ":" in more:
        sheet.merge_cells(more)
    path = tmp_path / "arm.xlsx"
    book.save(path)
    if more.startswith("<f>"):
        with zipfile.ZipFile(path) as archive:
            parts = {name: archive.read(name) for name in archive.namelist()}
        part = "xl/worksheets/sheet1.xml"
        parts[part] = parts[part].replace(b"<v>0.25</v>", f"{more}<v>0.25</v>".encode())
        with zipfile.ZipFile(path, "w") as archive:
            for name, content in parts.items():
                archive.writestr(name, content)
    found = Outcome(path, {"convention": "standard"})
    if "refused" in meaning:
        assert any(str(expected) in error for error in found.errors)
    else:
        (arm,) = found.arms
        assert [row.a for row in arm.rows] == [expected, expected if more == "A2:A3" else 1.0]


def test_the_command_is_the_table_with_its_base_and_tool(cli: Callable[..., Any], tmp_path: Path) -> None:
    """The one command of the page gives the URDF of the example above it."""
    body = EXAMPLES["placed"].body
    header = body.index("a, ")
    (command,) = (block["body"] for block in BLOCK.finditer(TEXT) if block["form"] == "sh")
    _, *words = shlex.split(command)
    (tmp_path / "arm.csv").write_text(body[header:], "utf-8")
    said_by_options = cli(*words).stdout
    (tmp_path / "arm.csv").write_text(body, "utf-8")
    assert said_by_options == cli("convert", "arm.csv").stdout


# --- Rows -------------------------------------------------------------------------------------------------------------


def _row(header: str, row: str, top: str = "") -> list[tuple[str, str]]:
    above = "# convention: standard\n" + (f"{one_code(top)}\n" if "`" in top else "")
    return [(table_of(one_code(header), one_code(row), above), "csv")]


TRIED: dict[str, Callable[..., list[tuple[str, str]]]] = {
    **dict.fromkeys(
        ("unknown", "notices", *(f"refused {what}" for what in ["variables", "limits", "masses", "names", "rows"])),
        _row,
    ),
    "doubtful units": lambda top, header, row: _row(header, row, top),
    "refused yaml": lambda joints: [(f"convention: standard\n{one_code(joints)}\n", "yaml")],
    "refused numbers": lambda cell: [
        (table_of("a;alpha;d;theta", cells), "csv") for cells in (f"{one_code(cell)};0;0;0", f"0;0;0;{one_code(cell)}")
    ],
    "refused ranges": lambda cell: [(table_of("a;alpha;d;range [deg]", f"0;0;0;{one_code(cell)}"), "csv")],
}
"""The tables of the page that say what is refused or noticed: what is read for a line of each, and in which form."""


@pytest.mark.parametrize(("name", "line"), [(name, line) for name in TRIED for line in TABLES[name]])
def test_every_line_is_refused_or_noticed_as_it_says(name: str, line: list[str], read: Callable[..., Outcome]) -> None:
    """With the message that the page quotes."""
    *cells, said = line
    for content, form in TRIED[name](*cells):
        found = read(content, form)
        if said == "accepted":
            found.arm()
            continue
        assert any(one_code(said) in each for each in found.notices + found.errors), found.errors
        assert bool(found.errors) is (name != "notices")


@pytest.mark.parametrize(
    ("column", "cell", "number"),
    [("theta", *line) for line in TABLES["angles"]] + [("a", *line) for line in TABLES["lengths"]],
)
def test_every_number_is_the_one_beside_it(column: str, cell: str, number: str, read: Callable[..., Outcome]) -> None:
    """In a table with semicolons, so that a decimal comma is one."""
    cells = {"a": "0", "alpha": "0", "d": "0", "theta": "0", column: one_code(cell)}
    (row,) = read(table_of(";".join(cells), ";".join(cells.values()))).arm().rows
    assert getattr(row, column) == pytest.approx(float(number), abs=5e-7)


@pytest.mark.parametrize("symbol", [pytest.param(tuple(row), id=row[2]) for row in TABLES["symbols"]])
def test_every_symbol_is_the_offset_and_sign_beside_it(
    symbol: tuple[str, str, str, str, str], read: Callable[..., Outcome]
) -> None:
    """In the first row of a table; the parameter itself is 0 then."""
    kind, column, cell, offset, sign = symbol
    cells = {"type": kind, "a": "0", "alpha": "0", "d": "0", "theta": "0", column: one_code(cell)}
    (row,) = read(table_of(",".join(cells), ",".join(cells.values()))).arm().rows
    assert row.offset == pytest.approx(float(offset), abs=5e-7)
    assert row.sign == int(sign)
    assert (row.d, row.theta) == (0.0, 0.0)


# --- Words ------------------------------------------------------------------------------------------------------------


def test_every_field_is_in_the_page() -> None:
    """In the order of the code; the headers are made from the vocabulary."""
    assert [name for name, *_ in TABLES["fields"]] == list(fields.FIELDS)


def test_a_line_of_the_vocabulary_is_a_word_everywhere(
    monkeypatch: pytest.MonkeyPatch, read: Callable[..., Outcome]
) -> None:
    """A word that is added to a line names its field, and is in the documentation."""
    sys.path.insert(0, str(DOCS / "generators"))
    import vocabulary_pages

    words = fields.vocabulary()
    with monkeypatch.context() as patch:
        patch.setitem(words["fields"]["a"], "de", f"{words['fields']['a']['de']}, schrumm")
        for remembered in (fields.header_fields, header_words.field_of, header_words.read_header):
            remembered.cache_clear()
        assert read(table_of("schrumm [mm],alpha,d", "300,0,0")).arm().rows[0].a == 0.3
        assert "`schrumm`" in vocabulary_pages.languages()
    for remembered in (fields.header_fields, header_words.field_of, header_words.read_header):
        remembered.cache_clear()


@pytest.mark.parametrize(("cell", "lower", "upper"), of_tables("ranges"))
def test_every_range_is_the_two_bounds_beside_it(
    cell: str, lower: str, upper: str, read: Callable[..., Outcome]
) -> None:
    """In CSV and as a text of YAML."""
    bounds = [pytest.approx(math.radians(float(number)), abs=1e-12) for number in (lower, upper)]
    text = one_code(cell)
    of_csv = read(table_of("a;alpha;d;Range [deg]", f"0;0;0;{text}")).arm()
    joint = f'{{a: 0, alpha: 0, d: 0, range: "{text}"}}'
    of_yaml = read(f"convention: standard\nunits: {{angle: deg}}\njoints: [{joint}]\n", "yaml").arm()
    for arm in (of_csv, of_yaml):
        assert [arm.rows[0].limits.lower, arm.rows[0].limits.upper] == bounds


@pytest.mark.parametrize("name", [line[0] for line in TABLES["fields"]])
def test_the_example_of_every_field_is_a_value_of_it(name: str, read: Callable[..., Outcome]) -> None:
    """Accepted without a word, beside the fields that it cannot be without; six parameters with a notice."""
    examples = {line[0]: one_code(line[1]) for line in TABLES["fields"]}
    cells = {"convention": "standard", "a": "0.3", "alpha": "0", "d": "0", name: examples[name]}
    if name in ("beta", "gamma", "b"):
        cells |= {"convention": "modified", "gamma": examples["gamma"]}
        (notice,) = read(table_of(",".join(cells), ",".join(cells.values()), "")).notices
        assert "beta, gamma and b are part of the base" in notice
        return
    for group in (("lower", "upper"), fields.COM, ("mass", *fields.INERTIA), ("mass", "inertia")):
        if name in group and name != "mass":
            cells |= {other: examples[other] for other in group}
    rows = [",".join(cells.values())]
    rows += [",".join({**cells, name: ""}.values())] if name == "follows" else []  # the leader
    read(table_of(",".join(cells), "\n".join(rows), "")).arm()


@pytest.mark.parametrize(("convention", "formula"), of_tables("conventions"))
def test_every_word_for_a_convention_means_it(convention: str, formula: str) -> None:
    """The order of the four elementary transforms is that of the kinematics."""
    known = [word for word, meant in fields.words_for("conventions").items() if meant == convention]
    assert {fields.convention_of(f"{word} convention") for word in known} == {Convention(convention)}
    assert formula.startswith("Rz(theta)" if convention == "standard" else "Rx(alpha)")


def test_every_word_for_a_type_means_it() -> None:
    """In any language."""
    assert all(fields.joint_type(word) == kind for word, kind in fields.words_for("types").items())


def test_every_unit_that_the_code_knows_is_in_the_page() -> None:
    """Word by word, in both directions, with what it measures."""
    page = {word: (what, symbol) for what, symbol, words in TABLES["units"] for word in code(words)}
    for word, (what, symbol) in page.items():
        unit = UNITS[unit_word(word)]
        assert (unit.dimension, unit.symbol) == (what, symbol)
    assert {unit_word(word) for word in page} == {unit_word(word) for word in UNITS}


@pytest.mark.parametrize(("key", "example", "_holds"), of_tables("keys of units"))
def test_every_key_of_units_takes_the_unit_beside_it(
    key: str, example: str, _holds: str, read: Callable[..., Outcome]
) -> None:
    """In the order of the code, and as a comment line."""
    assert [one_code(line[0]) for line in TABLES["keys of units"]] == list(table_units.UNIT_KEYS)
    said = f"# convention: standard\n# units: {{{one_code(key)}: {one_code(example)}}}\n"
    read(table_of("a,alpha,d", "0,0,0", said)).arm()


# --- Files ------------------------------------------------------------------------------------------------------------

PLAIN = EXAMPLES["plain"].body
ACCENTED = PLAIN.replace("elbow", "épaule")
ENCODED = {
    "UTF-8": ACCENTED.encode(),
    "UTF-8 with a byte order mark": ACCENTED.encode("utf-8-sig"),
    "UTF-16 with a byte order mark": ACCENTED.encode("utf-16"),
    "line ends LF": ACCENTED.encode(),
    "line ends CR LF": ACCENTED.replace("\n", "\r\n").encode(),
    "line ends CR": ACCENTED.replace("\n", "\r").encode(),
    "Latin-1 or Windows-1252 with a letter beyond ASCII": ACCENTED.encode("latin-1"),
    "UTF-32": ACCENTED.encode("utf-32"),
    "an Excel workbook that was renamed": b"PK\x03\x04\x14\x00\x06\x00",
    "an empty file": b"",
}


@pytest.mark.parametrize(("file", "outcome"), of_tables("encodings"))
def test_every_encoding_comes_out_as_it_says(file: str, outcome: str, read: Callable[..., Outcome]) -> None:
    """The first table of the page with an é in it, as bytes."""
    found = read(ENCODED[file])
    if outcome == "accepted":
        assert [row.joint for row in found.arm().rows] == ["shoulder", "épaule", "slide", "wrist"]
    else:
        assert any(one_code(outcome) in error for error in found.errors), found.errors


@pytest.mark.parametrize(("place", "example"), [line[:2] for line in TABLES["places of units"]])
def test_every_place_of_a_unit_is_read(
    place: str, example: str, read: Callable[..., Outcome], cli: Callable[..., Any], tmp_path: Path
) -> None:
    """A length in mm and an angle in degrees, said in each of the places."""
    pieces = code(example)
    convention = "# convention: standard\n"
    if place == "the command line":
        (tmp_path / "arm.csv").write_text(table_of("a,alpha,d", "300,90,0"))
        said_there = cli("convert", "arm.csv", *shlex.split(" ".join(pieces))).stdout
        (tmp_path / "arm.csv").write_text(table_of("a,alpha,d", "0.3,pi/2,0"))
        assert said_there == cli("convert", "arm.csv").stdout
        return
    found = {
        "the number": lambda: [read(table_of("a,alpha,d", ",".join((*pieces, "0"))))],
        "the header": lambda: [read(table_of(",".join((*pieces, "d [mm]")), "300,90,0"))],
        "a comment line": lambda: [read(table_of("a,alpha,d", "300,90,0", f"{convention}{it}\n")) for it in pieces],
        "the YAML key": lambda: [
            read(f"convention: standard\n{it}\njoints: [{{a: 300, alpha: 90, d: 0}}]", "yaml") for it in pieces
        ],
        "options of the reader": lambda: [
            read(table_of("a,alpha,d", "300,90,0"), **dict(piece.split(": ") for piece in pieces))
        ],
    }[place]()
    for outcome in found:
        (row,) = outcome.arm().rows
        assert (row.a, row.alpha) == (0.3, math.pi / 2)


# --- Bounds -----------------------------------------------------------------------------------------------------------

CONSTANTS = {
    "characters in a line of a CSV file": (delimited, "MAX_LINE"),
    "characters in the header of a CSV file": (source_texts, "MAX_HEADER"),
    "columns of a table": (table_bounds, "MAX_COLUMNS"),
    "characters in the header of one column, and in a cell that a field has": (table_bounds, "MAX_TEXT"),
    "characters in a comment line with a statement": (declared, "MAX_STATEMENT"),
    "rows above the header that are no comments": (top, "MAX_TITLES"),
    "characters in a number or an expression": (expressions, "MAX_CHARACTERS"),
    "brackets inside each other in an expression": (expressions, "MAX_NESTING"),
    "characters in a name": (names, "MAX_NAME"),
    "joints of a manipulator": (row_table, "MAX_JOINTS"),
    "bytes in a workbook, unpacked": (xlsx_file, "MAX_UNPACKED"),
    "parts of a workbook": (xlsx_file, "MAX_PARTS"),
    "rows of a sheet, also of such as hold nothing": (xlsx_file, "MAX_ROW"),
    "columns of a sheet": (xlsx_file, "MAX_COLUMN"),
    "bytes of a column in one row group of a Parquet file, unpacked": (parquet_sizes, "MAX_UNPACKED"),
    "bytes of a text that several rows of a Parquet file share": (parquet_sizes, "MAX_CELL"),
    "bytes in a YAML file": (textfiles, "MAX_BYTES"),
    "mappings and lists inside each other in YAML": (yaml_composer, "MAX_DEPTH"),
    "values that YAML aliases stand for": (yaml_composer, "MAX_ALIASED"),
    "further such values, for each character before the alias": (yaml_composer, "MAX_ALIASED_PER_CHARACTER"),
    "errors of a manipulator after which reading it stops": (rows, "MAX_PROBLEMS"),
}
OTHERS = {
    "characters in a cell of a CSV file": python_csv.field_size_limit(),
    "problems that are printed": errors.SCREENFUL,
    "length of an arm, or of its base and tool [m]": int(row_table.MEASURABLE_ARM),
    "turns in an angle of the table": round(table_bounds.LARGEST_ANGLE / math.tau),
    "turns in `alpha` without a declared unit": round(table_bounds.FULL_TURN / math.tau),
    "turns in a limit without a declared unit": round(rows.LARGEST_LIMIT / math.tau),
}


def test_every_bound_is_the_one_of_the_code() -> None:
    """Line by line, none more and none less; in the text too."""
    bounds = OTHERS | {what: getattr(module, name) for what, (module, name) in CONSTANTS.items()}
    assert dict(TABLES["bounds"]) == {what: f"{bound:,}" for what, bound in bounds.items()}
    words = " ".join(TEXT.split())
    assert f"at most {errors.SCREENFUL} are printed" in words
    assert (
        f"longer than {table_bounds.LONGEST_ARM:g} m or shorter than {1000 * table_bounds.SHORTEST_ARM:g} mm" in words
    )
