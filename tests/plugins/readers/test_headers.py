"""Columns by the headers that makers write, through every reader: read, refused with the field that was meant, or named."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
from pyarrow import parquet as pq

from dh2urdf.manipulator import Inertia, JointType, Manipulator
from dh2urdf.source import Problem
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.rows.cells import split_cell
from dh2urdf_plugins.readers.table import TableOptions
from dh2urdf_plugins.readers.words.fields import FIELDS

Read = Callable[[dict[str, str]], Manipulator | Rejected]

OPTIONS = TableOptions(convention="standard")


def _csv(path: Path, cells: dict[str, str]) -> Path:
    path = path.with_suffix(".csv")
    rows = ([f'"{text}"' for text in some] for some in (cells.keys(), cells.values()))
    path.write_text("".join(f"{','.join(row)}\n" for row in rows), "utf-8")
    return path


def _json(path: Path, cells: dict[str, str]) -> Path:
    path = path.with_suffix(".json")
    path.write_text(json.dumps({"joints": [cells]}), "utf-8")
    return path


def _parquet(path: Path, cells: dict[str, str]) -> Path:
    path = path.with_suffix(".parquet")
    pq.write_table(pa.table({header: [text] for header, text in cells.items()}), path)
    return path


FORMS = {"csv": (_csv, stages.CSV), "json": (_json, stages.YAML), "parquet": (_parquet, stages.PARQUET)}


@pytest.fixture(params=FORMS)
def read(request: pytest.FixtureRequest, tmp_path: Path) -> Read:
    """Reads a table of one row, which is given by its headers; a file that is refused as a whole has no rows either."""
    write, reader = FORMS[request.param]

    def read_row(cells: dict[str, str]) -> Manipulator | Rejected:
        (arm,) = reader.read(write(tmp_path / "arm", {"a": "0.3", "alpha": "0", "d": "0", **cells}), OPTIONS)
        return arm

    return read_row


def words(arm: Manipulator | Rejected) -> str:
    """Everything that is said of a table."""
    return "\n".join(map(str, (*getattr(arm, "problems", ()), *arm.notices)))


def each(headers: str, cell: str, meaning: dict[str, Any]) -> list[tuple[dict[str, str], dict[str, Any]]]:
    """One case for each of some headers."""
    return [({header: cell}, meaning) for header in headers.split("; ")]


TURN = math.radians(170)
BODY = {"mass": "2"}
TENSOR = Inertia(ixx=0.01, iyy=0.02, izz=0.025, ixy=0.001)
READ = [
    *each(
        r"speed; max speed; Max. Speed; vel_max; q_dot_max; q̇max; θ̇_max; \dot{q}_{max}; ω_max", "2.5", {"velocity": 2.5}
    ),
    *each("Speed (max); vitesse; VELOCIDAD MAXIMA; max. Winkelgeschwindigkeit; 最大速度", "2.5", {"velocity": 2.5}),
    *each("torque; τ_max; joint torque limit; couple; par máximo; max. Drehmoment; Torque¹", "40", {"effort": 40.0}),
    *each("weight; link mass; mass of link; m_i; mᵢ; Masse; peso; 质量", "2", {"mass": 2.0}),
    *each("Range; joint limits; q_lim; Arbeitsbereich; plage; Límites", "±170°", {"lower": -TURN, "upper": TURN}),
    *each("Center of Mass; CoM; cog; Schwerpunkt; baricentro", "x=0, y=-0.02, z=0.1", {"com": (0.0, -0.02, 0.1)}),
    *each(
        "Inertia Matrix; Trägheitstensor", "[[0.01, 0.001, 0], [0.001, 0.02, 0], [0, 0, 0.025]]", {"inertia": TENSOR}
    ),
    *each("joint sign; Direction of rotation; Vorzeichen; signe", "-1", {"sign": -1}),
    *each("viscous friction; joint damping; Daempfung", "0.5", {"damping": 0.5}),
    *each("Coulomb friction; frottement sec", "0.5", {"friction": 0.5}),
    *each("Gelenk; Achse; Axe; Axis; Eje; Giunto; Articulación; 关节", "A1", {"joint": "A1"}),
    *(
        ({low: "-1", high: "2"}, {"lower": -1.0, "upper": 2.0})
        for low, high in (
            *(("θ_i min", "θ_i max"), ("q_{i,min}", "q_{i,max}"), ("q⁻", "q⁺"), ("min", "max"), ("θmin", "θmax")),
            *(("untere Grenze", "obere Grenze"), ("limite inférieure", "limite supérieure"), ("下限", "上限")),
        )
    ),
    ({"cx": "0", "y_com": "-0.02", "com z": "0.1"}, {"com": (0.0, -0.02, 0.1)}),
    ({"I_xx": "0.01", "Iyy": "0.02", "J_zz": "0.025", "I12": "0.001"}, {"inertia": TENSOR}),
]


@pytest.mark.parametrize(("cells", "meaning"), READ, ids=[str(cells) for cells, _ in READ])
def test_a_header_that_makers_write_is_read(cells: dict[str, str], meaning: dict[str, Any], read: Read) -> None:
    """By every reader, as the field that it means, without a word."""
    arm = read({**BODY, **cells} if "inertia" in meaning else cells)
    assert isinstance(arm, Manipulator), words(arm)
    (row,) = arm.rows
    found = {name: getattr(row.limits if hasattr(row.limits, name) else row, name) for name in meaning}
    assert found == {
        name: pytest.approx(value, abs=1e-15) if isinstance(value, float) else value for name, value in meaning.items()
    }
    assert words(arm) == ""


REFUSED = [
    *(
        (header, "3")
        for header in ("foo", "total mass", "θ ref", "c", "Jm", "foo (deg)", "rotor inertia", "theta0", "j")
    ),
    *((header, "yes") for header in ("passive", "is_fixed", "coupled")),
    ("movable", "no"),
    *(("foo", cell) for cell in ("q1 + 0.1", "-q1", "d1", "180 deg", "±170°", "-170 to 170 deg", "pi/2", "3.5 kg")),
]


@pytest.mark.parametrize(("header", "cell"), REFUSED)
def test_a_column_with_values_is_refused(header: str, cell: str, read: Read) -> None:
    """Numbers, units and joint variables, with how to leave the column out; by every reader."""
    arm = read({header: cell})
    assert not isinstance(arm, Manipulator)
    (problem,) = arm.problems
    if problem.code != "unknown-key":
        assert (problem.code, problem.field, problem.found) == ("unknown-column", header, cell)
        assert isinstance(read({header: ""}), Manipulator)


@pytest.mark.parametrize("header", ["supplier", "Parent", "height", "Motion"])
@pytest.mark.parametrize("cell", ["base", "upper arm, 7075 aluminium", "1st", "0->1"])
def test_a_column_of_text_is_left_out_with_one_notice(header: str, cell: str, tmp_path: Path) -> None:
    """Nothing in it decides anything."""
    path = _csv(tmp_path / "arm", {"a": "0.3", "alpha": "0", "d": "0", header: cell, "remark": "y", "empty": ""})
    (arm,) = stages.CSV.read(path, OPTIONS)
    assert isinstance(arm, Manipulator), words(arm)
    (notice,) = arm.notices
    assert (notice.code, notice.mark.column) == ("columns-left-out", 1 + len('"a","alpha","d",'))
    assert arm.rows[0].type is JointType.REVOLUTE


def test_a_column_is_left_out_on_purpose(read: Read) -> None:
    """By every reader, and without a notice: its author asked for it."""
    arm = read({"_a": "5 deg"})
    assert isinstance(arm, Manipulator), words(arm)
    assert arm.notices == ()
    assert arm.rows[0].a == 0.3


# --- What columns mean beside each other ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("header", "convention", "meant"),
    [
        ("alpha_j,d_j,theta_j,r_j", "modified", (0.35, 0.2)),
        ("alpha,d,theta,r", "standard", (0.2, 0.35)),
        ("alpha,d,theta,a", "modified", (0.2, 0.35)),
    ],
)
@pytest.mark.parametrize("declared", ["key", "option", "sentence"])
def test_the_letters_of_khalil(
    header: str, convention: str, meant: tuple[float, float], declared: str, tmp_path: Path
) -> None:
    """In the modified convention d is the length and r the offset, where no column is called a."""
    top = {"key": f"# convention: {convention}\n", "sentence": f"# {convention} DH\n", "option": ""}[declared]
    (tmp_path / "arm.csv").write_text(f"{top}{header}\n0,0.35,0,0.2\n")
    options = TableOptions(convention=convention if declared == "option" else None)
    (arm,) = stages.CSV.read(tmp_path / "arm.csv", options)
    assert isinstance(arm, Manipulator), words(arm)
    assert (arm.rows[0].a, arm.rows[0].d) == meant


@pytest.mark.parametrize(
    ("header", "cells", "kinds"),
    [
        ("sigma", "0 1 0", "RPR"),
        ("σ", "0 1 2", "RPF"),
        ("R", "true false true", "RPR"),
        ("prismatic", "0 1 0", "RPR"),
        ("Joint type", "R P Rotational", "RPR"),
    ],
)
def test_the_types_of_a_column(header: str, cells: str, kinds: str, tmp_path: Path) -> None:
    """Codes under σ, and truth values under R, mean one thing."""
    rows = "".join(f"0.3,0,0,{cell}\n" for cell in cells.split())
    (tmp_path / "arm.csv").write_text(f"a,alpha,d,{header}\n{rows}")
    (arm,) = stages.CSV.read(tmp_path / "arm.csv", OPTIONS)
    assert isinstance(arm, Manipulator), words(arm)
    assert "".join(row.type.value[0] for row in arm.rows).upper() == kinds


# --- Many manipulators ------------------------------------------------------------------------------------------------

MANY = "robot,type,a,alpha,d,speed,info\n"


def test_a_column_that_later_holds_something_is_spoken_of(tmp_path: Path) -> None:
    """With the first manipulator that has it, and no other; a value in it is found on the fast path."""
    rows = "".join(
        f"r{k},R,0.3,0,0,{k % 3 + 1},{'90 deg' if k == 500 else 'x' if k > 400 else ''}\n" for k in range(800)
    )
    (tmp_path / "arms.csv").write_text(MANY + rows)
    arms = list(stages.CSV.read(tmp_path / "arms.csv", OPTIONS))
    assert [arm.name for arm in arms if arm.notices] == ["r401"]
    assert [arm.name for arm in arms if not isinstance(arm, Manipulator)] == ["r500"]


def test_known_headers_and_notes_go_the_fast_way(tmp_path: Path, fast: list[int]) -> None:
    """After the first manipulator, whose notice says that a column is left out; the last one is a batch by itself."""
    rows = "".join(f"r{k},R,0.3,0,0,1,no {k}\n" for k in range(400))
    (tmp_path / "arms.csv").write_text(MANY + rows)
    assert len(list(stages.CSV.read(tmp_path / "arms.csv", OPTIONS))) == 400
    assert sum(fast) >= 398


# --- Texts ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "comma", "bounds"),
    [
        ("-170,5 .. 170,5", True, ["-170,5", "170,5"]),
        ("[-170,5; 170,5]", True, ["-170,5", "170,5"]),
        ("-170, 170", True, ["-170", "170"]),
        ("-170,170", True, None),
        ("-170 à 170 deg", True, ["-170 deg", "170 deg"]),
        ("+/-170,5 deg", True, ["-170,5 deg", "170,5 deg"]),
        ("±170, 120", True, None),
        ("min: -170,5, max: 170,5", True, ["-170,5", "170,5"]),
        ("", True, []),
        ("-170.5,170.5", True, ["-170.5", "170.5"]),
        ("±170,5", False, ["-170,5", "170,5"]),
        ("±1,250", False, None),
        ("-170,170", False, ["-170", "170"]),
    ],
)
def test_a_decimal_comma_is_no_separator(text: str, comma: bool, bounds: list[str] | None) -> None:  # noqa: FBT001
    """Between semicolons a comma separates bounds only with a space behind it, or beside a decimal point."""
    found = split_cell(FIELDS["limits"], text, decimal_comma=comma)
    assert (None if isinstance(found, Problem) else [*found.values()]) == bounds
