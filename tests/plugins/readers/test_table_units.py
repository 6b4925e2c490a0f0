"""Every quantity follows the unit that the table states for its kind, in every place, through every reader; or is refused.

The oracle is arithmetic with exact fractions, by the definitions of the units. It shares nothing with the readers.
"""

import json
import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
from pyarrow import parquet as pq

from dh2urdf.errors import TableError
from dh2urdf.manipulator import DHRow, Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.table import TableOptions

INCH, POUND, GRAVITY = Fraction("0.0254"), Fraction("0.45359237"), Fraction("9.80665")
LENGTHS = {"mm": Fraction(1, 1000), "in": INCH}
ANGLES = {"deg": 90, "rev": Fraction(1, 4)}
RATES = {"deg/s": 90, "rpm": 15, "1/min": 15}
SPEEDS = {"mm/s": Fraction(1, 1000), "m/min": Fraction(1, 60), "in/s": INCH}
MASSES = {"g": Fraction(1, 1000), "lb": POUND, "t": Fraction(1000)}
TORQUES = {"N·mm": Fraction(1, 1000), "kNm": Fraction(1000), "lbf·in": POUND * GRAVITY * INCH, "kgf·cm": GRAVITY / 100}
FORCES = {"kN": Fraction(1000), "lbf": POUND * GRAVITY}
INERTIAS = {"kg·mm²": Fraction(1, 10**6), "g·cm²": Fraction(1, 10**7), "lb·in²": POUND * INCH**2}
DAMPING, LINEAR = {"N·mm·s/rad": Fraction(1, 1000)}, {"N·s/mm": Fraction(1000)}

KEYS = {
    **dict.fromkeys(("a", "d", "radius", "com_x"), ("length", LENGTHS, LENGTHS)),
    **dict.fromkeys(("alpha", "theta"), ("angle", ANGLES, ANGLES)),
    **dict.fromkeys(("offset", "upper"), ("angle|length", ANGLES, LENGTHS)),
    "velocity": ("velocity", RATES, SPEEDS),
    **dict.fromkeys(("effort", "friction"), ("effort", TORQUES, FORCES)),
    "mass": ("mass", MASSES, MASSES),
    "ixx": ("inertia", INERTIAS, INERTIAS),
    "armature": ("inertia|mass", INERTIAS, MASSES),
    "damping": ("damping", DAMPING, LINEAR),
}
"""By field: its key of `units`, and its units in the row of a joint that turns and of one that slides."""
GETTERS: dict[str, Callable[[DHRow], float | None]] = {
    **{name: lambda row, name=name: getattr(row.limits, name) for name in ("upper", "velocity", "effort")},
    "com_x": lambda row: row.com and row.com[0],
    "ixx": lambda row: row.inertia and row.inertia.ixx,
}
NUMBER = "3.7"
CASES = [
    pytest.param(field, kind, unit, id=f"{field} of {kind} in {unit}")
    for field, (_, turning, sliding) in KEYS.items()
    for kind, units in (("revolute", turning), ("prismatic", sliding))
    for unit in units
]


def exact(field: str, kind: str, unit: str) -> float:
    """The number in SI units."""
    units = KEYS[field][1 if kind == "revolute" else 2]
    if units in (ANGLES, RATES):
        return float(Fraction(NUMBER)) / float(units[unit]) * (math.pi / 2)
    return float(Fraction(NUMBER) * units[unit])


def cells_of(field: str, kind: str, number: str) -> dict[str, str]:
    """The cells of a row in which one field has a number, and every other number names its unit or is 0."""
    cells = {"type": kind, "a": "0.3 m", "alpha": "0", "d": "0.1 m"}
    cells |= {"upper": {"lower": "0", "upper": number}, "com_x": {"com_x": number, "com_y": "0", "com_z": "0"}}.get(
        field, {field: number}
    )
    if field == "ixx":
        cells |= {"mass": "2 kg", "iyy": number, "izz": number}
    return cells


class Files:
    """Writes tables in each format and reads them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def read(
        self,
        form: str,
        cells: Mapping[str, str],
        *,
        headers: Mapping[str, str] | None = None,
        said: Mapping[str, Any] | None = None,
        count: int = 1,
        **options: Any,
    ) -> list[Manipulator | Rejected]:
        path = self.folder / f"arm.{form}"
        said = {"convention": "standard", **(said or {})}
        names = {name: f"{name} [{headers[name]}]" if name in (headers or {}) else name for name in cells}
        if form == "csv":
            top = [f"# {key}: {json.dumps(value, ensure_ascii=False)}" for key, value in said.items()]
            rows = [",".join([f"r{k}", *cells.values()]) for k in range(count)]
            path.write_text("\n".join([*top, ",".join(["robot", *names.values()]), *rows]), "utf-8")
            return list(stages.CSV.read(path, TableOptions(**options)))
        if form == "parquet":
            columns = {"robot": [f"r{k}" for k in range(count)]}
            columns |= {names[name]: [text] * count for name, text in cells.items()}
            metadata = {f"dh2urdf.{key}": json.dumps(value) for key, value in said.items()}
            pq.write_table(pa.table(columns).replace_schema_metadata(metadata), path)
            return list(stages.PARQUET.read(path, TableOptions(**options)))
        robots = [{**said, "name": f"r{k}", "joints": [dict(cells)]} for k in range(count)]
        table = {"robots": robots} if count > 1 else robots[0]
        path.write_text(json.dumps(table), "utf-8")  # JSON is YAML
        return list(stages.YAML.read(path, TableOptions(**options)))

    def row(self, *arguments: Any, **more: Any) -> DHRow:
        """The row of every one of the arms, which are alike."""
        arms = self.read(*arguments, **more)
        rows = set()
        for arm in arms:
            assert isinstance(arm, Manipulator), [str(problem) for problem in arm.problems]
            (row,) = arm.rows
            rows.add(repr([getattr(row, name) for name in row.__slots__ if name != "mark"]))
        assert len(rows) == 1
        return row

    def errors(self, *arguments: Any, **more: Any) -> list[str]:
        try:
            (arm,) = self.read(*arguments, **more)
        except TableError as error:
            return [str(problem) for problem in error.problems]
        return [str(problem) for problem in getattr(arm, "problems", ())]


@pytest.fixture
def files(tmp_path: Path) -> Files:
    return Files(tmp_path)


def value_of(row: DHRow, field: str) -> float | None:
    return GETTERS.get(field, lambda row: getattr(row, field))(row)


def key_of(field: str, kind: str) -> str:
    return KEYS[field][0].split("|")[-1 if kind == "prismatic" else 0]


@pytest.mark.parametrize(("field", "kind", "unit"), CASES)
@pytest.mark.parametrize("form", ["csv", "yaml", "json", "parquet"])
def test_a_number_follows_its_unit_in_every_place(form: str, field: str, kind: str, unit: str, files: Files) -> None:
    """In the cell, in the statement `units`, by the option, in the header; alone, and as one of many in a file."""
    wanted = exact(field, kind, unit)
    cells, own = cells_of(field, kind, NUMBER), cells_of(field, kind, f"{NUMBER} {unit}")
    units = {key_of(field, kind): unit}
    said: list[dict[str, Any]] = [{"said": {"units": units}}, {"units": units}]
    if form in ("csv", "parquet"):
        names = ("ixx", "iyy", "izz") if field == "ixx" else ("lower", "upper") if field == "upper" else (field,)
        names = ("com_x", "com_y", "com_z") if field == "com_x" else names
        said.append({"headers": dict.fromkeys(names, unit)})
    for count in (1, 3):
        assert value_of(files.row(form, own, count=count), field) == wanted
        for place in said:
            assert value_of(files.row(form, cells, count=count, **place), field) == wanted


@pytest.mark.parametrize("form", ["csv", "yaml", "parquet"])
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_geometry_gives_its_unit_to_what_depends_on_it_or_refuses_it(form: str, kind: str, files: Files) -> None:
    """Lengths and angles, and speeds, follow mm and deg; what may be in another unit is refused, but 0."""
    units = {"units": {"length": "mm", "angle": "deg"}}
    for field in KEYS:
        numbers = cells_of(field, kind, NUMBER)
        key = key_of(field, kind)
        follows = key in ("length", "angle", "velocity", "mass") or field == "effort"
        errors = files.errors(form, numbers, said=units)
        assert bool(errors) is not follows, (field, errors)
        if not follows:
            assert all("has no unit" in error for error in errors)
            zeros = cells_of(field, kind, "0")
            if field != "ixx":
                assert files.errors(form, zeros, said=units) == []
        elif key in ("length", "angle", "velocity"):
            unit = {"length": "mm", "angle": "deg", "velocity": "deg/s" if kind == "revolute" else "mm/s"}[key]
            assert value_of(files.row(form, numbers, said=units), field) == exact(field, kind, unit)


@pytest.mark.parametrize("form", ["csv", "parquet"])
@pytest.mark.parametrize("where", ["statement", "option"])
def test_base_and_tool_follow_the_headers(form: str, where: str, files: Files) -> None:
    """As the rows do; where the headers have several units, numbers without one are refused."""
    cells = {"type": "R", "a": "300", "alpha": "90", "d": "100"}
    headers = {"a": "mm", "alpha": "deg", "d": "mm"}
    placed = {"base": {"xyz": [0, 0, 300], "rpy": [0, 0, 90]}, "tool": {"xyz": [0, 0, 100]}}
    given: dict[str, Any] = {"said": placed} if where == "statement" else placed
    (arm,) = files.read(form, cells, headers=headers, **given)
    assert isinstance(arm, Manipulator)
    assert arm.base.translation == (0.0, 0.0, 0.3)
    assert arm.base.rotation == (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    assert arm.tool.translation == (0.0, 0.0, 0.1)
    mixed = files.errors(form, cells | {"d": "10"}, headers=headers | {"d": "cm"}, **given)
    assert len(mixed) >= 2
    matrix = [[1, 0, 0, 300], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    (arm,) = files.read(form, cells, headers=headers, said={"base": matrix, "defaults": {"geometry": {"radius": 40}}})
    assert isinstance(arm, Manipulator)
    assert (arm.base.translation, arm.geometry.radius) == ((0.3, 0.0, 0.0), 0.04)


@pytest.mark.parametrize("count", [1, 40])
@pytest.mark.parametrize(
    ("cells", "headers", "said"),
    [
        ({"lower": "-180°", "upper": "180°", "velocity": "180"}, {}, None),
        ({"offset": "90°", "velocity": "180"}, {}, None),
        ({"lower": "-180", "upper": "180", "velocity": "180"}, {"lower": "deg", "upper": "deg"}, None),
        ({"lower": "-180", "upper": "180", "velocity": "180"}, {}, {"angle": "deg"}),
        ({"lower": "-180°", "upper": "180°", "velocity": "pi"}, {}, None),
    ],
)
def test_a_speed_beside_degrees_is_never_radians_in_silence(
    cells: dict[str, str], headers: dict[str, str], said: dict[str, str] | None, count: int, files: Files
) -> None:
    """It follows what is declared, or is refused: by a header, or by the cells of its own row. π needs no unit."""
    row = {"type": "R", "a": "0.3", "alpha": "0", "d": "0", **cells}
    arms = files.read("csv", row, headers=headers, said={"units": said} if said else {}, count=count)
    for arm in arms:
        if said or cells["velocity"] == "pi":
            assert isinstance(arm, Manipulator)
            assert arm.rows[0].limits.velocity == math.pi
        else:
            assert any("has no unit" in str(problem) for problem in getattr(arm, "problems", ())), arm


@pytest.mark.parametrize(("kind", "unit"), [("revolute", "N"), ("revolute", "kN"), ("prismatic", "Nm")])
@pytest.mark.parametrize("form", ["csv", "yaml", "parquet"])
def test_a_force_is_no_torque(form: str, kind: str, unit: str, files: Files) -> None:
    """In a cell, a header or a statement."""
    for field in ("effort", "friction"):
        assert files.errors(form, cells_of(field, kind, f"80 {unit}"))
        assert files.errors(form, cells_of(field, kind, "80"), said={"units": {"effort": unit}})
        if form != "yaml":
            assert files.errors(form, cells_of(field, kind, "80"), headers={field: unit})


@pytest.mark.parametrize(
    "table",
    [
        "a, alpha, d\n300 mm, 90°, 0\n0, pi/2, 0",
        "type, a, alpha, d, lower, upper\nR, 0.3, 0, 0, -170°, 170°\nP, 0.2, 0, 0, 0, 0.5",
        "# units: mm, deg\na, alpha, d\n300, 90, 0\n0.2 m, 1 rad, 0",
        "a [mm], alpha [deg], d\n300, 90, 0\n0.2 m, 1 rad, 0",
    ],
)
def test_what_is_sure_beside_cells_with_units_gets_none(read_one: Callable[..., Manipulator], table: str) -> None:
    assert "bare-beside-cells" not in [notice.code for notice in read_one(table).notices]


@pytest.mark.parametrize("words", ["mm / deg", "mm and degrees", "[mm, deg]"])
def test_units_in_words_are_read_in_yaml_as_in_a_comment(words: str, read_one: Callable[..., Manipulator]) -> None:
    arms = [
        read_one(f"units: {words}\njoints: [{{a: 300, alpha: 90, d: 0}}]", ".yaml"),
        read_one(f"# units: {words}\na,alpha,d\n300,90,0\n"),
    ]
    assert [(arm.rows[0].a, arm.rows[0].alpha) for arm in arms] == [(0.3, math.pi / 2)] * 2
