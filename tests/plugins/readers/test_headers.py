"""Columns by the headers that makers write, through every reader: read, refused with the field that was meant, or named."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import pyarrow as pa
import pytest
from pyarrow import parquet as pq

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Inertia, Manipulator
from dh2urdf_plugins.readers import csv, parquet, yaml
from dh2urdf_plugins.readers.header.words import misspelt, read_header, suspected
from dh2urdf_plugins.readers.plain.rows import PlainRows
from dh2urdf_plugins.readers.table import TableOptions
from dh2urdf_plugins.readers.tables.cell_groups import GroupError, split_cell
from dh2urdf_plugins.readers.words.fields import FIELDS
from dh2urdf_plugins.readers.words.unheld import UNHELD

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.stages import Rejected

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


FORMS = {"csv": (_csv, csv), "json": (_json, yaml), "parquet": (_parquet, parquet)}


@pytest.fixture(params=FORMS)
def read(request: pytest.FixtureRequest, tmp_path: Path) -> Read:
    """Reads a table of one row, which is given by its headers; a file that is refused as a whole has no rows either."""
    write, reader = FORMS[request.param]

    def read_row(cells: dict[str, str]) -> Manipulator | Rejected:
        (arm,) = reader.READER.read(write(tmp_path / "arm", {"a": "0.3", "alpha": "0", "d": "0", **cells}), OPTIONS)
        return arm

    return read_row


def words(arm: Manipulator | Rejected) -> str:
    """Everything that is said of a table."""
    return "\n".join(map(str, (*getattr(arm, "problems", ()), *arm.notices)))


TURN = math.radians(170)
BODY = {"mass": "2"}
READ: list[tuple[dict[str, str], dict[str, Any]]] = [
    *(
        ({header: "2.5"}, {"velocity": 2.5})
        for header in (
            *(
                "speed",
                "max speed",
                "Max. Speed",
                "vel",
                "vel_max",
                "qd_max",
                "q_dot_max",
                "q̇max",
                "θ̇_max",
                r"\dot{q}_{max}",
            ),
            *("joint speed", "Joint velocity", "maximum angular velocity", "ω_max", "Speed (max)", "speed limit"),
            *(
                "vitesse",
                "Vitesse maximale",
                "velocidad máxima",
                "VELOCIDAD MAXIMA",
                "velocità massima",
                "Geschwindigkeit",
            ),
            *("max. Winkelgeschwindigkeit", "Achsgeschwindigkeit"),
        )
    ),
    *(
        ({header: "40"}, {"effort": 40.0})
        for header in (
            *(
                "torque",
                "max torque",
                "tau_max",
                "τ_max",
                "tau",
                "Peak torque",
                "joint torque limit",
                "max force",
                "couple",
            ),
            *("Couple max.", "coppia massima", "par máximo", "Drehmoment", "max. Drehmoment", "Torque¹"),
        )
    ),
    *(
        ({header: "2"}, {"mass": 2.0})
        for header in (
            "weight",
            "link mass",
            "mass of link",
            "m_i",
            "mᵢ",
            "mass_i",
            "Masse",
            "Gewicht",
            "poids",
            "peso",
        )
    ),
    *(
        ({header: cell}, {"lower": -TURN, "upper": TURN})
        for header in ("Range", "joint limits", "q_lim", "Motion range", "Arbeitsbereich", "plage", "rango", "Límites")
        for cell in ("±170°", "[-170 deg, 170 deg]")
    ),
    *(
        ({low: "-1", high: "2"}, {"lower": -1.0, "upper": 2.0})
        for low, high in (
            *(("θ_i min", "θ_i max"), ("θi_min", "θi_max"), ("q_i,min", "q_{i,max}"), ("q_{min,i}", "q_{max,i}")),
            ("q⁻", "q⁺"),
            *(("theta_min", "theta_max"), ("min", "max"), ("lo", "hi"), ("low", "high"), ("minimum", "maximum")),
            *(("min_angle", "max_angle"), ("θmin", "θmax"), ("Min. Position", "Max. Position"), ("q_{min}", "q_{max}")),
            *(("untere Grenze", "obere Grenze"), ("limite inférieure", "limite supérieure"), ("mínimo", "máximo")),
            *(
                ("Límite inferior", "Límite superior"),
                ("limite inferiore", "limite superiore"),
                ("min. Winkel", "max. Winkel"),
            ),
        )
    ),
    *(
        ({header: cell}, {"com": (0.0, -0.02, 0.1)})
        for header in (
            "Center of Mass",
            "CoM",
            "cog",
            "Centre of gravity",
            "Schwerpunkt",
            "Centre de masse",
            "baricentro",
        )
        for cell in ("[0, -0.02, 0.1]", "0; -0.02; 0.1", "0 -0.02 0.1", "x=0, y=-0.02, z=0.1", "(0, -20 mm, 100 mm)")
    ),
    *(
        (dict(zip(headers, ("0", "-0.02", "0.1"), strict=True)), {"com": (0.0, -0.02, 0.1)})
        for headers in (
            ("cx", "cy", "cz"),
            ("xc", "yc", "zc"),
            ("com x", "com y", "com z"),
            ("x_com", "y_com", "z_com"),
        )
    ),
    *(
        ({**BODY, header: cell}, {"inertia": Inertia(ixx=0.01, iyy=0.02, izz=0.025, ixy=0.001)})
        for header in ("Inertia Matrix", "Inertia Tensor", "Trägheitstensor", "matrice d'inertie", "Matriz de inercia")
        for cell in ("[[0.01, 0.001, 0], [0.001, 0.02, 0], [0, 0, 0.025]]", "0.01 0.001 0; 0.001 0.02 0; 0 0 0.025")
    ),
    (
        {**BODY, "I_xx": "0.01", "Iyy": "0.02", "J_zz": "0.025", "I12": "0.001"},
        {"inertia": Inertia(ixx=0.01, iyy=0.02, izz=0.025, ixy=0.001)},
    ),
    ({**BODY, "inertia": "diag(0.01, 0.02, 0.025)"}, {"inertia": Inertia(ixx=0.01, iyy=0.02, izz=0.025)}),
    *(
        ({header: "-1"}, {"sign": -1})
        for header in ("joint sign", "Direction of rotation", "Vorzeichen", "Drehrichtung", "signe")
    ),
    *(({header: "0.5"}, {"damping": 0.5}) for header in ("viscous friction", "joint damping", "Dämpfung", "Daempfung")),
    *(({header: "0.5"}, {"friction": 0.5}) for header in ("Coulomb friction", "joint friction", "frottement sec")),
    *(
        ({header: "A1"}, {"joint": "A1"})
        for header in ("Gelenk", "Achse", "Axe", "Axis", "Eje", "Asse", "Giunto", "Articulation", "Articulación")
    ),
]


@pytest.mark.parametrize(("cells", "meaning"), READ, ids=[str(cells) for cells, _ in READ])
def test_a_header_that_makers_write_is_read(cells: dict[str, str], meaning: dict[str, Any], read: Read) -> None:
    """By every reader, as the field that it means, without a word."""
    if "Achsgeschwindigkeit" in cells:
        cells = {"Achs-Geschwindigkeit": cells["Achsgeschwindigkeit"]}
    arm = read(cells)
    assert isinstance(arm, Manipulator), words(arm)
    (row,) = arm.rows
    found = {name: getattr(row.limits if hasattr(row.limits, name) else row, name) for name in meaning}
    assert found == {
        name: pytest.approx(value, abs=1e-15) if isinstance(value, float) else value for name, value in meaning.items()
    }
    assert words(arm) == ""


REFUSED = [
    *((header, "3", "velocity") for header in ("nominal speeds", "Motordrehzahl", "vel2", "slew_speed")),
    *((header, "3", "effort") for header in ("Par", "moment", "Haltemoment", "forceTotal")),
    *((header, "3", "mass") for header in ("total mass", "Gesamtmasse")),
    *((header, "3", "limits") for header in ("soft limit", "Drehbereich", "min2")),
    *((header, "3", "inertia") for header in ("inertia about flange", "Trägheitsmoment Motor")),
    *((header, "3", "offset") for header in ("encoder offsets", "zeroing", "Nullpunktversatz", "décalage")),
    *((header, "3", "sign") for header in ("motor direction", "Wickelrichtung")),
    *((header, "3", "which no") for header in ("max acceleration", "Beschleunigung", "jerk")),
    *((header, "3", "the inertia of a rotor") for header in ("rotor inertia", "motor inertia", "Rotorträgheit")),
    *(
        (header, "3", "the ratio of a gear")
        for header in ("gear ratio", "ratio", "Ratio (i)", "G", "Übersetzung", "reduction ratio")
    ),
    *((header, "3", "may be theta, d or an offset") for header in ("theta_home", "zero offset", "theta0", "home")),
    *((header, "3", "a torque that may not be the largest") for header in ("rated torque", "nominal torque")),
    *((header, "3", "convention") for header in ("μ_j", "mu")),
    *((header, "3", "a limit of acceleration") for header in ("qdd_max", "q̈max")),
    *((header, "3", "may be theta, d or an offset") for header in ("initial", "Start angle", "value")),
    *((header, "yes", "type") for header in ("is rotational", "rotates", "translational")),
    *((header, "3", "theta") for header in ("θ ref", "nominal_theta", "theta right", "θ_i0", "thetaRest")),
    *((header, "3", "alpha") for header in ("alpha right", "alphaLeft")),
    *(("theta as drawn", cell, "theta") for cell in ("q1 + 0.1", "-q1", "q2")),
    ("q", "q1 - 0.1", "the joint variable"),
    *(("controller", cell, "a joint variable with an offset or a sign") for cell in ("-J5", "-(J2+J3)", "J2 + J3")),
    *((header, "3", "theta") for header in ("theta [deg]!", "theta_i [rad]]", "theta (deg) x")),
    ("Tc", "3", "a friction of the motor or of the joint"),
    ("roll", "3", "a turn of a frame beside the DH parameters"),
    ("x", "3", "a coordinate that may be of a frame or of a centre of mass"),
    ("XX", "3", "may be about the frame's origin"),
    ("lc", "3", "the distance of a centre of mass"),
    ("qd", "3", "a speed that may not be a limit"),
    ("j", "3", "the number of a row, or an inertia"),
    *((header, "3", "the symbol of a quantity") for header in ("c", "k", "ζ")),
]


@pytest.mark.parametrize(("header", "cell", "said"), REFUSED)
def test_a_header_that_looks_like_a_field_is_refused(header: str, cell: str, said: str, read: Read) -> None:
    """With the field that was probably meant, or with what it is; by every reader."""
    arm = read({header: cell})
    assert not isinstance(arm, Manipulator)
    (problem,) = arm.problems
    assert header in str(problem)
    if "is no key of a joint" not in problem.message or said in FIELDS:
        assert said in f"{problem.field} {problem}"


@pytest.mark.parametrize("header", [header for header, _, _ in REFUSED])
def test_the_same_without_a_value_is_silent(header: str, tmp_path: Path) -> None:
    """An empty column has nothing to lose: a template may have it."""
    (arm,) = csv.READER.read(_csv(tmp_path / "arm", {"a": "0.3", "alpha": "0", "d": "0", header: ""}), OPTIONS)
    assert (isinstance(arm, Manipulator), words(arm)) == (True, "")


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        ({"xyz [mm]": "3"}, "a coordinate that may be of a frame or of a centre of mass"),
        ({"foo (deg)": "3"}, "has the unit 'deg', but no field is called so"),
        ({"foo_mm": "3"}, "has the unit 'mm', but no field is called so"),
        ({"I [kg·m²]": "3"}, "has the unit 'kg·m2', but no field is called so"),
        ({"foo": "180 deg"}, "'180 deg' is a quantity, but no field is called 'foo'"),
        ({"foo": "3.5 kg"}, "'3.5 kg' is a quantity, but no field is called 'foo'"),
        ({"weight [N]": "3"}, "'N' is a unit of force, and one of mass is needed"),
        ({"a2": "0.3", "length [mm]": "3"}, "two columns are a"),
        ({"Range": "±1", "lower": "0"}, "two columns are lower"),
        ({"r": "[0, 0, 0.1]"}, "if r is the centre of mass, call it com"),
        ({"speed [deg/s]": "1", "velocity [rad/s]": "1"}, "two columns are velocity"),
        ({"theta_min": "-1", "theta_max": "1", "offset": "0.5"}, "may bound theta or the joint variable q"),
        ({"theta_min": "-1", "theta_max": "1", "theta": "-q1"}, "may bound theta or the joint variable q"),
        ({**BODY, "inertia": "0.1 0 0 0.1 0 0.1"}, "six numbers, whose order is not known"),
        ({**BODY, "inertia": "0.1"}, "one number, not a matrix"),
        ({**BODY, "inertia": "0.1, 0.1, 0.1"}, "if it is a diagonal matrix, write diag(…)"),
        ({**BODY, "inertia": "[[1, 2, 0], [0, 1, 0], [0, 0, 1]]"}, "is not symmetric: ixy is '2' and '0'"),
        ({"com": "0.1 0.2"}, "holds 2 numbers, and a centre of mass has three"),
    ],
    ids=str,
)
def test_a_column_of_doubtful_meaning_is_refused(cells: dict[str, str], said: str, tmp_path: Path) -> None:
    """What has a unit measures something; what can be read in two ways is not read."""
    path = _csv(tmp_path / "arm", {"a": "0.3", "alpha": "0", "d": "0", **cells})
    try:
        (arm,) = csv.READER.read(path, OPTIONS)
    except TableError as error:
        assert said in str(error)
        return
    assert not isinstance(arm, Manipulator)
    assert said in words(arm)


@pytest.mark.parametrize(
    "header",
    [
        *(
            "supplier",
            "Comment",
            "speed source",
            "note on limits",
            "Hersteller",
            "part no.",
            "design",
            "signal",
            "information",
        ),
        *(
            "dimensions",
            "administrator",
            "partner",
            "height",
            "orange",
            "power",
            "Material",
            "coupling type name",
            "grad",
            "sumber",
        ),
    ],
)
def test_other_columns_are_left_out_with_one_notice(header: str, tmp_path: Path) -> None:
    """Whatever is near a word of a field only by its letters."""
    path = _csv(tmp_path / "arm", {"a": "0.3", "alpha": "0", "d": "0", header: "x", "remark": "y", "empty": ""})
    (arm,) = csv.READER.read(path, OPTIONS)
    assert isinstance(arm, Manipulator), words(arm)
    (notice,) = arm.notices
    assert notice.message == f"the columns '{header}', 'remark' are left out: no fields are called so"
    assert notice.accepted is None


@pytest.mark.parametrize("header", ["_max acceleration [rad/s²]", "_speed", "_foo (deg)", "_a"])
def test_a_column_is_left_out_on_purpose(header: str, read: Read) -> None:
    """By every reader, with a notice that names it."""
    arm = read({header: "5 deg"})
    assert isinstance(arm, Manipulator), words(arm)
    (notice,) = arm.notices
    assert notice.message.endswith(f"'{header}' is left out, as the _ at the beginning asks for")
    assert arm.rows[0].a == 0.3


# --- Many manipulators ------------------------------------------------------------------------------------------------

MANY = "robot,type,a,alpha,d,speed,info\n"


def test_a_column_that_later_holds_something_is_spoken_of(tmp_path: Path) -> None:
    """With the first manipulator that has it, and no other; until then the fast path reads the rows."""
    rows = "".join(f"r{k},R,0.3,0,0,{k % 3 + 1},{'x' if k > 400 else ''}\n" for k in range(800))
    (tmp_path / "arms.csv").write_text(MANY + rows)
    arms = list(csv.READER.read(tmp_path / "arms.csv", OPTIONS))
    assert all(isinstance(arm, Manipulator) for arm in arms)
    assert [arm.name for arm in arms if arm.notices] == ["r401"]
    assert [arm.rows[0].limits.velocity for arm in arms if isinstance(arm, Manipulator)] == [
        k % 3 + 1 for k in range(800)
    ]


def test_a_quantity_in_a_column_that_is_left_out_is_found_on_the_fast_path(tmp_path: Path) -> None:
    """In the row that has it; the others are read."""
    rows = "".join(f"r{k},R,0.3,0,0,1,{'90 deg' if k == 500 else 'x'}\n" for k in range(800))
    (tmp_path / "arms.csv").write_text(MANY + rows)
    arms = list(csv.READER.read(tmp_path / "arms.csv", OPTIONS))
    assert [arm.name for arm in arms if not isinstance(arm, Manipulator)] == ["r500"]


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        ("active", ("1", "0")),
        ("variable", ("q1", "q1 - 90")),
        ("Variable", ("θ1", "-θ1")),
        ("DH variable", ("J1", "-(J2 + J3)")),
    ],
)
def test_what_a_column_that_is_left_out_says_is_found_on_the_fast_path(
    header: str, cells: tuple[str, str], tmp_path: Path
) -> None:
    """Whether a joint is driven, and its offset or direction: the rows before were read by the same fast path."""
    rows = "".join(f"r{k},R,0.3,0,0,1,{cells[k == 500]}\n" for k in range(800))
    (tmp_path / "arms.csv").write_text(MANY.replace("info", header) + rows)
    arms = list(csv.READER.read(tmp_path / "arms.csv", OPTIONS))
    assert [arm.name for arm in arms if not isinstance(arm, Manipulator)] == ["r500"]


@pytest.mark.parametrize("header", ["q", "theta variable", "joint variable", "Variable"])
def test_the_variable_of_the_row_says_nothing_new(header: str, tmp_path: Path) -> None:
    """``θ = 90°`` beside ``q2``, as controllers' tables have them, is one angle and its variable."""
    text = f"i,a,alpha,d,theta,{header}\n1,0,0,0.2,0,q1\n2,0.1,pi/2,0,pi/2,q2\n"
    if header == "theta variable":
        text = text.replace("theta,theta", "offset,theta")
    (tmp_path / "arm.csv").write_text(text)
    (arm,) = csv.READER.read(tmp_path / "arm.csv", OPTIONS)
    assert isinstance(arm, Manipulator), words(arm)
    assert [row.theta + row.offset for row in arm.rows] == [0.0, pytest.approx(math.pi / 2, abs=1e-15)]


def test_known_headers_and_notes_go_the_fast_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After the first manipulator, whose notice says that a column is left out."""
    rows = "".join(f"r{k},R,0.3,0,0,1,no {k}\n" for k in range(400))
    (tmp_path / "arms.csv").write_text(MANY + rows)
    fast = 0
    plain = PlainRows.read

    def counted(self: PlainRows, *arguments: Any) -> Any:
        nonlocal fast
        found = plain(self, *arguments)
        fast += len(found or ())
        return found

    monkeypatch.setattr(PlainRows, "read", counted)
    assert len(list(csv.READER.read(tmp_path / "arms.csv", OPTIONS))) == 400
    assert fast >= 399


# --- Texts ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "field", "unit"),
    [
        *(
            (text, "a", "mm")
            for text in ("a {mm}", "a <mm>", "a:mm", "a; mm", "a|mm", "DH a [mm]", "a¹ [mm]", "a [mm]†")
        ),
        *(
            (text, "a", None)
            for text in ("a*", "a†", "DH a", "dh_a", "DH parameter a", "a (DH)", "link length (a)", "a_i*")
        ),
        *((text, "alpha", None) for text in ("twist α", "α (twist)", "DH alpha", r"$\alpha_i$", "αᵢ")),
        ("d¹", "d", None),
        *((f"{name}/({unit})", field, unit) for name, field, unit in (("θ", "theta", "°"), ("di", "d", "mm"))),
        ("ω/(°/s)", "velocity", "°/s"),
        ("α/ [deg]", "alpha", "deg"),
        ("⍺ⱼ", "alpha", None),
        ("Link length a_i/mm", "a", "mm"),
        ("连杆长度ai/mm", "a", "mm"),
        ("CoG (x, y, z) [mm]", "com", "mm"),
        ("Inertia Tensor (3x3) [kg m²]", "inertia", "kg m2"),
        ("Torque (Nm)", "effort", "Nm"),
        ("max. Drehmoment [Nm]", "effort", "Nm"),
        ("effort [N]", "effort", "N"),
        ("Speed (max) [deg/s]", "velocity", "deg/s"),
        ("d1", None, None),
        ("grad", None, None),
        ("offset d", "d", None),
    ],
)
def test_brackets_marks_and_prefixes_change_nothing(text: str, field: str | None, unit: str | None) -> None:
    """Units in any brackets, footnotes, `DH` before a name, a symbol behind its words."""
    header = read_header(text)
    assert (header.field and header.field.name, header.unit) == (field, unit)


@pytest.mark.parametrize("name", ["mimic", "home", "stiffness", "coupled with"])
def test_a_footnote_behind_a_known_header_of_no_field_changes_nothing(name: str) -> None:
    """A header that other tables have, and no field holds, is known by its name."""
    assert read_header(name).key in UNHELD
    assert read_header(f"{name}¹") == read_header(f"{name}*") == read_header(name)


@pytest.mark.parametrize(
    "words_",
    ["jointsgn", "jointvelocty", "linkmas", "velocty", "torqe", "lenght", "limts", "intertia", "geschwindigkiet"],
)
def test_long_words_may_be_one_slip_away(words_: str) -> None:
    """They are surely meant, in any language."""
    assert misspelt(words_) is not None


@pytest.mark.parametrize(
    "text", ["comment", "design speed note", "information", "dimension", "administrator", "aluminium"]
)
def test_prose_is_no_suspect(text: str) -> None:
    """Short words count only as whole words."""
    assert suspected(text) is None


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("-170,5 .. 170,5", {"lower": "-170,5", "upper": "170,5"}),
        ("[-170,5; 170,5]", {"lower": "-170,5", "upper": "170,5"}),
        ("-170, 170", {"lower": "-170", "upper": "170"}),
        ("-170,170", None),
        ("0/340", {"lower": "0", "upper": "340"}),
        ("±pi/2", {"lower": "-pi/2", "upper": "pi/2"}),
        ("-pi/2..pi", {"lower": "-pi/2", "upper": "pi"}),
        ("-170 à 170 deg", {"lower": "-170 deg", "upper": "170 deg"}),
        ("±170,5", {"lower": "-170,5", "upper": "170,5"}),
        ("+/-170,5 deg", {"lower": "-170,5 deg", "upper": "170,5 deg"}),
        ("±170, 120", None),
        ("min: -170,5, max: 170,5", {"lower": "-170,5", "upper": "170,5"}),
        ("min: -170,5; max: 170", {"lower": "-170,5", "upper": "170"}),
        ("", {}),
    ],
)
def test_a_decimal_comma_is_no_separator(text: str, parts: dict[str, str] | None) -> None:
    """Between semicolons a comma separates bounds only with a space behind it."""
    found = split_cell(FIELDS["limits"], text, decimal_comma=True)
    assert (None if isinstance(found, GroupError) else found) == parts


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("±170,5", {"lower": "-170,5", "upper": "170,5"}),
        ("±1,250", None),
        ("min: -170,5, max: 170,5", {"lower": "-170,5", "upper": "170,5"}),
        ("min: -170,max: 170", {"lower": "-170", "upper": "170"}),
        ("-170,170", {"lower": "-170", "upper": "170"}),
    ],
)
def test_a_decimal_comma_in_quotes(text: str, parts: dict[str, str] | None) -> None:
    """Between commas it is read where it can be nothing else."""
    found = split_cell(FIELDS["limits"], text)
    assert (None if isinstance(found, GroupError) else found) == parts


@pytest.mark.parametrize("header", ["Offset d", "Offset (d)", "offset d [m]", "Offset d_i"])
def test_the_word_offset_beside_its_symbol_is_d(header: str, tmp_path: Path) -> None:
    """The advice was `offset`, which is added to theta."""
    path = tmp_path / "arm.csv"
    path.write_text(f"a,alpha,{header}\n0.3,0,0.1\n")
    (arm,) = csv.READER.read(path, OPTIONS)
    assert isinstance(arm, Manipulator)
    assert [(row.d, row.offset) for row in arm.rows] == [(0.1, 0.0)]


@pytest.mark.parametrize(
    ("header", "still", "moves"),
    [
        *((header, "no", "yes") for header in ("movable", "Active?", "is_active", "free", "can move", "mobile")),
        *((header, "0", "1") for header in ("DOF", "dofs", "degrees of freedom", "used", "independent")),
        *((header, "none", "M1") for header in ("motor", "Antrieb", "actuator")),
        *((header, "yes", "no") for header in ("fixed", "is_fixed", "passive?", "virtual", "dummy", "disabled")),
    ],
)
def test_a_column_of_what_moves_is_refused_where_one_joint_does_not(
    header: str, still: str, moves: str, tmp_path: Path
) -> None:
    """There was only the notice that the column is left out; `fixed` was refused where all is `no`, too."""
    for cells, refused in (((moves, still), True), ((moves, moves), False)):
        rows = "".join(f"0.3,0,0,{cell}\n" for cell in cells)
        (tmp_path / "arm.csv").write_text(f"a,alpha,d,{header}\n{rows}")
        (arm,) = csv.READER.read(tmp_path / "arm.csv", OPTIONS)
        assert isinstance(arm, Manipulator) is not refused
        assert not refused or "whether a joint moves by itself" in words(arm)


@pytest.mark.parametrize(("header", "cell"), [("revolute", "0"), ("Revolute?", "no"), ("is_prismatic", "yes")])
def test_a_type_in_another_form_is_refused(header: str, cell: str, tmp_path: Path) -> None:
    """`revolute` with 0 in every row was an arm of revolute joints, without a word."""
    (arm,) = csv.READER.read(_csv(tmp_path / "arm", {"a": "0.3", "alpha": "0", "d": "0", header: cell}), OPTIONS)
    assert not isinstance(arm, Manipulator)
    assert "type" in words(arm)


@pytest.mark.parametrize("header", ["#REF!", "#NAME?", "#WERT!"])
def test_a_header_that_is_an_error_of_a_spreadsheet_is_refused(header: str, tmp_path: Path) -> None:
    """As a column without a header is, where it holds anything: it may be any field."""
    cells = {"a": "0.3", "alpha": "0", "d": "0"}
    (arm,) = csv.READER.read(_csv(tmp_path / "arm", {**cells, header: "1.2"}), OPTIONS)
    assert not isinstance(arm, Manipulator)
    assert f"'{header}' is what a spreadsheet writes for an error" in words(arm)
    (arm,) = csv.READER.read(_csv(tmp_path / "arm", {**cells, header: ""}), OPTIONS)
    assert isinstance(arm, Manipulator)


def test_a_column_clockwise_is_a_direction(tmp_path: Path) -> None:
    (arm,) = csv.READER.read(_csv(tmp_path / "arm", {"a": "0.3", "alpha": "0", "d": "0", "clockwise": "yes"}), OPTIONS)
    assert not isinstance(arm, Manipulator)
    assert "'clockwise' seems to be sign" in words(arm)
