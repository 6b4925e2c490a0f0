"""Rows that are no joints, fixed rows without a type, and numbers in place of names."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf_plugins.readers.plain.rows import PlainRows
from dh2urdf_plugins.readers.rows.names import are_joints, is_base, kind_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.stages import Rejected

    Read = Callable[..., list[Manipulator | Rejected]]

TOTALS = (
    "Total TOTAL: Sum sum_a Mean Average avg Summe Gesamt Gesamtlänge Mittelwert max min Σ somme suma media totale moyenne "
    "promedio Subtotal std max_reach Mediana Grand_Total Ergebnis Resultado 合计 平均 合計 Итого Среднее Razem Średnia Toplam 합계"
).replace("sum_a", "Sum_of_all")
FRAMES = (
    "base Base ground world_joint Basis Sockel tip Flansch Werkzeug Endeffektor tool_joint EE_frame TCP-offset fixed "
    "end_effector outil herramienta utensile flangia bride pinza organe_terminal bâti suelo fixed_joint hand eef_joint "
    "ToolFlange toolTip --- ... – nan None note Einheiten sensor camera 6->G 6→T 末端 工具 法兰 ベース фланец схват основание "
    "narzędzie podstawa takım taban エンドエフェクタ ベース 툴 말단"
).replace("ベース", "베이스")
SLIDES = "Prismatic prismatic_joint_3 P p3 P_3 d3 d₃* D1 slide Slider linear_axis Linear-rail Schubgelenk translation_2 vertical_lift torso_lift_joint rail base_rail Track Hubachse"
JOINTS = (
    "wrist_flange_rotation base_yaw base_rotation shoulder_pan_joint elbow quill tool_roll gripper_rotation poignet "
    "shoulder_lift lift lift_joint PR1 dof3 pitch deflect linear_yaw slider_crank max_planck_joint J1 A1 joint_0 hip knee bend_joint meander summit_joint minion IV lift_pitch tracker 0->1 6->7 stop pump A1_R"
)


@pytest.mark.parametrize("name", TOTALS.split())
def test_totals_are_known_by_their_names(name: str) -> None:
    """In the languages of the spreadsheets."""
    assert kind_of(name) == "total"


@pytest.mark.parametrize("name", FRAMES.split())
def test_frames_are_known_by_their_names(name: str) -> None:
    """Whatever their case, separators and accents are."""
    assert kind_of(name) == "frame"


@pytest.mark.parametrize("name", JOINTS.split())
def test_joints_are_joints(name: str) -> None:
    """A name has to consist of such words, not to have one in it."""
    assert kind_of(name) is None
    assert are_joints([name.lower(), "joint_1"], typed=False)


@pytest.mark.parametrize("name", SLIDES.split())
def test_joints_that_slide_are_known_by_their_names(name: str) -> None:
    """A word for them, the P of R, R, P, or the variable d3 beside θ1; a type column decides."""
    assert kind_of(name) == "slide"
    assert not are_joints([name.lower(), "joint_1"], typed=False)
    assert are_joints([name.lower(), "joint_1"], typed=True)


@pytest.mark.parametrize(
    "name",
    [
        *(
            "J2 prismatic",
            "q2 (prismatic)",
            "J2_prismatic",
            "Joint 2 (P)",
            "axis 3 [P]",
            "joint2_p",
            "J2-P",
            "Lift column",
        ),
        *(
            "E1 (linear track)",
            "guida lineare",
            "直动关节",
            "поступательная пара",
            "призматический шарнир",
            "przesuwny",
        ),
        *("prizmatik mafsal", "直動関節", "スライド", "직동 관절"),
    ],
)
def test_a_name_that_says_that_its_joint_slides_is_refused_without_a_type(name: str, read: Read) -> None:
    """The joint was revolute, without a word; a type decides."""
    (arm,) = read(f"joint,a,alpha,d\nJ1,0.3,0,0\n{name},0.2,0,0\n", convention="standard")
    assert not isinstance(arm, Manipulator)
    assert "by its name it hardly is a revolute joint" in arm.problems[0].message
    (arm,) = read(f"joint,type,a,alpha,d\nJ1,R,0.3,0,0\n{name},R,0.2,0,0\n", convention="standard")
    assert isinstance(arm, Manipulator)
    assert arm.rows[1].joint == name


@pytest.mark.parametrize("name", ["0", "base", "0 (from base)", "Base link", "fixed base", "Sockel"])
def test_row_0_is_the_base(name: str) -> None:
    """As makers call it."""
    assert is_base(name)
    assert not is_base("1")


def table(names: list[str], form: str) -> tuple[str, str]:
    """A table without types whose rows are called so, and the suffix of its file."""
    if form == "yaml":
        joints = [{"name": name, "a": 0.1 * k, "alpha": 0, "d": 0.2} for k, name in enumerate(names, start=1)]
        return json.dumps({"convention": "standard", "joints": joints}), ".yaml"
    header = {"joint": "joint", "link": "link", "unnamed": "", "unknown": "Bezeichnung", "last": "a,alpha,d,remarks"}
    if form == "last":
        rows = [f"{0.1 * k:g},0,0.2,{name}" for k, name in enumerate(names, start=1)]
        return "\n".join([header[form], *rows]), ".csv"
    rows = [f"{name},{0.1 * k:g},0,0.2" for k, name in enumerate(names, start=1)]
    return "\n".join([f"{header[form]},a,alpha,d", *rows]), ".csv"


@pytest.mark.parametrize("many", [1, 300])
@pytest.mark.parametrize(
    ("last", "joints"),
    [
        ("base,revolute,0.1,0,0.1", 3),
        ("flange_joint,fixed,0.1,0,0.1", 3),
        ("Total,revolute,0.7,0,0.9", 3),
        ("Total,revolute,0.5,0,0.3", None),
        ("Mean,fixed,0.25,0,0.15", None),
        ("max,R,0.3,0,0.2", None),
        ("Total,,0.5,0,0.3", None),
        ("base,,0.1,0,0.1", None),
    ],
)
def test_a_type_decides_but_for_sums(last: str, joints: int | None, many: int, read: Read) -> None:
    """A row that is called Total, and is one by its numbers, is no joint whatever its type is: alone and among many."""
    rows = ["one,revolute,0.2,0,0.1", "two,revolute,0.3,0,0.2", last]
    lines = [f"r{robot},{row}" for robot in range(many) for row in rows]
    arms = read("\n".join(["robot,joint,type,a,alpha,d", *lines]), convention="standard")
    assert len(arms) == many
    assert {len(arm.rows) if isinstance(arm, Manipulator) else None for arm in arms} == {joints}


KINOVA = """{header}
{zero},0,pi,0,{first}
1,0,pi/2,-0.2848,q1
2,0,pi/2,-0.0118,q2 + pi
3,0,pi/2,-0.4208,q3 + pi
"""


@pytest.mark.parametrize(
    ("header", "zero"),
    [
        ("i,a,alpha,d,theta", "0"),
        ("i,a,alpha,d,theta", "0 (from base)"),
        ("i,a,alpha,d,theta", "base"),
        ("joint,a,alpha,d,theta", "0"),
        ("link,a,alpha,d,theta", "0"),
        ("joint,a,alpha,d,theta", "base"),
        ("joint,a,alpha,d,theta", "Base frame"),
        ("link,a,alpha,d,theta", "ground"),
    ],
)
def test_row_0_of_a_table_with_variables_is_fixed(header: str, zero: str, read_one: Callable[..., Manipulator]) -> None:
    """As Kinova prints it: its theta has no variable, and q1 is in the second row."""
    arm = read_one(KINOVA.format(header=header, zero=zero, first="0"))
    assert [row.type for row in arm.rows] == [JointType.FIXED, *[JointType.REVOLUTE] * 3]
    assert [row.offset for row in arm.rows] == [0, 0, math.pi, math.pi]
    assert [row.joint for row in arm.rows][1:] == ["joint_1", "joint_2", "joint_3"]
    assert any("it is fixed" in notice.message for notice in arm.notices)


def test_a_fixed_row_0_is_read_with_its_type(read_one: Callable[..., Manipulator]) -> None:
    """Without any variable."""
    arm = read_one("i,type,a,alpha,d\n0,fixed,0,pi,0\n1,R,0.1,0,0\n2,R,0.1,0,0\n")
    assert [row.joint for row in arm.rows] == ["joint_0", "joint_1", "joint_2"]


def test_a_flange_beside_variables_is_fixed(read: Read) -> None:
    """As Franka prints it, with a notice; in YAML too."""
    rows = [{"name": f"j{k}", "a": 0.1, "alpha": 0, "d": 0, "theta": f"q{k}"} for k in (1, 2)]
    flange = {"name": "Flansch", "a": 0, "alpha": 0, "d": 0.107, "theta": 0}
    text = "\n".join(["joint,a,alpha,d,theta", *(",".join(map(str, row.values())) for row in (*rows, flange))])
    for arm in (
        *read(text, convention="standard"),
        *read(json.dumps({"convention": "standard", "joints": [*rows, flange]}), ".yaml"),
    ):
        assert isinstance(arm, Manipulator)
        assert [str(row.type) for row in arm.rows] == ["revolute", "revolute", "fixed"]
        assert "it is fixed" in arm.notices[0].message


@pytest.mark.parametrize("header", ["joint", "Joint", "link", "JOINT NAME"])
@pytest.mark.parametrize("numbers", [["1", "2", "3"], ["1.0", "2.0", "3.0"], ["01", "02", "03"]])
@pytest.mark.parametrize("form", ["csv", "careful", "json"])
def test_numbers_are_made_names(
    header: str, numbers: list[str], form: str, read: Read, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a notice; a robot description has no joint named 1."""
    field = "link" if header == "link" else "joint"
    if form == "careful":
        monkeypatch.setattr(PlainRows, "read", lambda *_arguments: None)
    if form == "json":
        joints = [{field if field == "link" else "name": number, "a": 0, "alpha": 0, "d": 1} for number in numbers]
        (arm,) = read(json.dumps({"convention": "standard", "joints": joints}), ".json")
    else:
        rows = [f"{number},0,0,1" for number in numbers]
        (arm,) = read("\n".join([f"{header},a,alpha,d", *rows]), convention="standard")
    assert isinstance(arm, Manipulator)
    assert [getattr(row, field) for row in arm.rows] == [f"{field}_{number.removesuffix('.0')}" for number in numbers]
    (notice,) = arm.notices
    assert notice.message.startswith(f"the column of {field}s holds numbers")


@pytest.mark.parametrize("names", [["J1", "J2"], ["A1", "B1"], ["I", "II"], ["007", "épaule"], ["1a", "2a"]])
def test_other_names_are_kept(names: list[str], read_one: Callable[..., Manipulator]) -> None:
    """Letter for letter."""
    arm = read_one("\n".join(["joint,a,alpha,d", *(f"{name},0,0,1" for name in names)]))
    assert [row.joint for row in arm.rows] == names


@pytest.mark.parametrize(
    ("axes", "said"),
    [
        (["Z", "Y", "Y", "X"], "axes, not names, and is left out: 'Z'"),
        (["z", "z", "z"], "axes, not names, and is left out: 'z'"),
        (["+Z", "+Y"], "axes, not names, and is left out: '+Z'"),
        (["Z", "-Z"], "'-Z' seems to be a direction, and is where the name of the joint should be"),
        (["z", "y", "−y"], "'−y' seems to be a direction"),
        (["X", "Y", "Z"], None),
        (["X", "Y", "Z", "C"], None),
    ],
)
def test_axes_are_no_names(axes: list[str], said: str | None, read: Read) -> None:
    """``Eje | Z | Y | Y | X`` beside the parameters; the joints of a gantry are called X, Y, Z."""
    (arm,) = read("\n".join(["Axis,a,alpha,d", *(f"{axis},0,0,1" for axis in axes)]), convention="standard")
    if said is None:
        assert isinstance(arm, Manipulator)
        assert [row.joint for row in arm.rows] == axes
        assert [notice.message for notice in arm.notices if "and have no types" not in notice.message] == []
    elif "direction" in said:
        assert not isinstance(arm, Manipulator)
        assert any(said in problem.message for problem in arm.problems)
    else:
        assert isinstance(arm, Manipulator)
        assert [row.joint for row in arm.rows] == [f"joint_{number}" for number in range(1, len(axes) + 1)]
        assert [notice.message for notice in arm.notices] == [f"the column of joints holds {said}"]


@pytest.mark.parametrize("numbers", [["3", "4"], ["10", "20"], ["101", "102"]])
def test_numbers_that_rise_from_elsewhere_are_those_of_motors(
    numbers: list[str], read_one: Callable[..., Manipulator]
) -> None:
    """They count no rows, and name the joints."""
    arm = read_one("\n".join(["joint,a,alpha,d", *(f"{number},0,0,1" for number in numbers)]))
    assert [row.joint for row in arm.rows] == [f"joint_{number}" for number in numbers]
    assert len(arm.notices) == 1


def test_a_table_of_a_million_rows_reads_alike(read: Read) -> None:
    """An arm with numbers for names in the middle of others gets the same names as alone."""
    lines = [f"r{robot},{joint},R,0.1,0,0" for robot in range(300) for joint in ("j1", "j2")]
    lines[300:300] = ["odd,1,R,0.1,0,0", "odd,2,R,0.1,0,0"]
    arms = read("\n".join(["robot,joint,type,a,alpha,d", *lines]), convention="standard")
    (odd,) = (arm for arm in arms if arm.name == "odd")
    assert isinstance(odd, Manipulator)
    assert [row.joint for row in odd.rows] == ["joint_1", "joint_2"]


def test_notes_below_the_rows_are_refused(read: Read) -> None:
    """A footnote is no row, and says nothing to a reader."""
    for note in ("* measured", "* measured,,", "Note: by hand,,", "---,---,---", "...,...,..."):
        try:
            (arm,) = read(f"a,alpha,d\n0.3,0,0\n{note}\n", convention="standard")
        except TableError:
            continue
        assert not isinstance(arm, Manipulator)


@pytest.mark.parametrize(
    ("rows", "types"),
    [
        ("0.3,0,0.1,θ1;0.2,pi,0,q2;0,0,d3,0", "RRP"),
        ("0.3,0,0.1,θ1*;0.2,pi,0,θ2* + pi/2;0,0,d3* + 0.05,pi/2", "RRP"),
        ("0,pi/2,q1,0;0,pi/2,q2,0", "PP"),
        ("0.3,0,d1,θ1;0,0,d2,0", ""),  # a length that is not said
        ("0.3,0,0.1,θ1;0,0,d2,", ""),
        ("0.3,0,0.1,0;0,0,d2,0", ""),
        ("0.3,0,0.1,θ1;0,0,d3,0", ""),
    ],
)
@pytest.mark.parametrize("form", ["csv", "yaml"])
def test_a_variable_in_d_makes_a_row_without_types_prismatic(rows: str, types: str, form: str, read: Read) -> None:
    """Where every row has one variable, as textbooks have them; it was refused."""
    cells = [row.split(",") for row in rows.split(";")]
    if form == "csv":
        text = "\n".join(["a,alpha,d,theta", *(",".join(row) for row in cells)])
    else:
        names = ("a", "alpha", "d", "theta")
        joints = [", ".join(f"{n}: {c}" for n, c in zip(names, row, strict=True) if c) for row in cells]
        text = f"joints: [{', '.join(f'{{{joint}}}' for joint in joints)}]"
    (arm,) = read(text, f".{form}", convention="standard")
    assert isinstance(arm, Manipulator) == bool(types)
    if isinstance(arm, Manipulator):
        assert "".join(row.type.value[0].upper() for row in arm.rows) == types
        slides = [notice.message for notice in arm.notices if "it is prismatic" in notice.message]
        assert len(slides) == types.count("P")


def test_a_yaml_table_has_no_merged_cells(read_one: Callable[..., Manipulator]) -> None:
    """A key that only the first joint has is meant so."""
    joints = [{"a": 0.3, "alpha": 0, "d": 0, "limits": {"velocity": 1}}, *[{"a": 0.3, "alpha": 0, "d": 0}] * 2]
    assert read_one(json.dumps({"convention": "standard", "joints": joints}), ".json").notices == ()


@pytest.mark.parametrize(
    ("rows", "is_noticed"),
    [
        (["T,0,0,0.1,0", "R,0.3,0,0,0"], True),
        (["R,0,0,0.1,0", "t,0.3,0,0,0", "T,0,0,0,0"], True),
        (["R,0,0,0.1,q1", "T,0.3,0,d2,0"], False),
        (["P,0,0,0.1,0", "translational,0.3,0,0,0"], False),
        ([" T,0,0,0.1,0", "R ,0.3,0,0,0"], True),
    ],
)
def test_t_may_be_a_twisting_joint(rows: list[str], is_noticed: bool, read: Read) -> None:  # noqa: FBT001 - a case
    """In the notation of L, O, R, T and V joints T turns; here it slides, and a notice says so once."""
    (arm,) = read("\n".join(["type,a,alpha,d,theta", *rows]), convention="standard")
    assert isinstance(arm, Manipulator)
    assert {row.type for row in arm.rows} <= {JointType.PRISMATIC, JointType.REVOLUTE}
    assert [notice.message for notice in arm.notices] == ["T is read as a translation"] * is_noticed


@pytest.mark.parametrize(
    ("first", "second"),
    [
        *(("1 (base)", "2 (shoulder)"), ("Joint 1 (Sockel)", "Joint 2 (Schulter)"), ("base (1)", "shoulder (2)")),
        *(("1: base", "2: shoulder"), ("1 - base", "2 - shoulder"), ("J1 [base]", "J2 [shoulder]")),
    ],
)
@pytest.mark.parametrize("header", ["i", "joint", "#", "Axis"])
def test_joint_1_may_be_called_after_the_base(first: str, second: str, header: str, read: Read) -> None:
    """As that of the Braccio, where all rows have the numbers of joints: it was refused. There is a notice."""
    (arm,) = read(f"# convention: standard\n{header},a,alpha,d\n{first},0.3,0,0.1\n{second},0.2,0,0\n")
    assert isinstance(arm, Manipulator), arm.problems
    assert [(row.joint, row.type) for row in arm.rows] == [(first, JointType.REVOLUTE), (second, JointType.REVOLUTE)]
    if kind_of(first):
        (notice,) = arm.notices
        assert "called like a frame, and has the number of the first joint: it moves" in notice.message


@pytest.mark.parametrize("header", ["link", "body", "n", "k"])
def test_joint_1_may_be_called_after_the_base_in_a_column_of_links_or_rows(header: str, read: Read) -> None:
    """It was refused there."""
    (arm,) = read(f"# convention: standard\n{header},a,alpha,d\n1 (base),0.3,0,0.1\n2 (shoulder),0.2,0,0\n")
    assert isinstance(arm, Manipulator), arm.problems
    assert [row.type for row in arm.rows] == [JointType.REVOLUTE] * 2
    assert "has the number of the first joint: it moves" in arm.notices[0].message
    for first, second in (("1 (base)", "3 (shoulder)"), ("0 (base)", "1 (shoulder)"), ("1 (base)", "2 (joint 1)")):
        (rejected,) = read(f"# convention: standard\n{header},a,alpha,d\n{first},0.3,0,0.1\n{second},0.2,0,0\n")
        assert not isinstance(rejected, Manipulator)


def test_a_first_row_called_0_is_fixed_where_a_flange_follows_the_joints(read_one: Callable[..., Manipulator]) -> None:
    """Six errors spoke of rows that are counted from 1."""
    rows = "0,0,0,0.35,0\n1,0.1,pi/2,0.4,q1\n2,0.4,0,0,q2\nTCP,0,0,0.1,0\n"
    arm = read_one(f"joint,a,alpha,d,theta\n{rows}")
    assert [str(row.type) for row in arm.rows] == ["fixed", "revolute", "revolute", "fixed"]
