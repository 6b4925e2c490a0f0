import math
from collections.abc import Callable

import numpy as np
import pytest

from dh2urdf.kinematics import angle_error, forward_kinematics, position_error
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.plugin_system import Catalog
from dh2urdf.rotations import RigidTransform
from dh2urdf.table_text import TableText
from dh2urdf.table_text.texts import table_text
from dh2urdf_studio.editing.conversions import with_convention, with_units
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.reading import make
from dh2urdf_studio.editing.session import Session
from reference_arms import ReferenceRobot

Arms = Callable[..., Manipulator]

OTHER = {Convention.STANDARD: Convention.MODIFIED, Convention.MODIFIED: Convention.STANDARD}
ARM = Manipulator(
    name="arm",
    convention=Convention.STANDARD,
    rows=(
        DHRow(
            joint="one",
            link="link_1",
            a=0.3,
            alpha=0.7,
            d=0.2,
            mass=3.0,
            com=(-0.1, 0.02, 0.03),
            inertia=Inertia(ixx=0.02, iyy=0.03, izz=0.04, ixy=0.001, ixz=0.002, iyz=0.003),
            limits=Limits(lower=-1.0, upper=2.0, velocity=3.0, effort=4.0),
        ),
        DHRow(joint="two", link="link_2", type=JointType.PRISMATIC, a=0.1, alpha=-1.1, d=0.0, theta=0.4, offset=0.05),
        DHRow(
            joint="three", link="link_3", a=0.0, alpha=0.3, d=-0.1, offset=0.2, sign=-1, mass=1.0, com=(0.0, 0.1, 0.0)
        ),
    ),
    base=RigidTransform.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)),
    tool=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.1)),
)


def assert_same_motion(one: Manipulator, other: Manipulator) -> None:
    for scale in (0.0, 0.4, -1.3):
        q = [scale * (number + 1) % 2.0 for number in range(len(one.moving_rows))]
        here, there = forward_kinematics(one, q), forward_kinematics(other, q)
        assert position_error(here, there) <= 1e-12 * max(1.0, sum(abs(row.a) + abs(row.d) for row in one.rows))
        assert angle_error(here, there) <= 1e-9


class TestConvention:
    def test_a_published_arm_is_the_same_arm(self, reference_robot: ReferenceRobot, arm_of: Arms) -> None:
        """T(q) of a table in the other convention is T(q) of the table, and of the table converted back."""
        arm = reference_robot.manipulator
        there = with_convention(table_text(arm), arm, OTHER[arm.convention])
        converted = arm_of(there)
        assert converted.convention is OTHER[arm.convention]
        assert_same_motion(arm, converted)
        back = arm_of(with_convention(there, converted, arm.convention))
        assert_same_motion(arm, back)

    def test_texts_move_as_they_are(self, arm_of: Arms) -> None:
        """`pi/2` stays `pi/2` in the row where it goes; nothing is left for base or tool where the ends are plain."""
        rows = ({"a": "0", "alpha": "pi/2", "d": "0.1"}, {"a": "0.3", "alpha": "0", "d": "0"})
        table = TableText(name="x", convention="standard", rows=rows)
        there = with_convention(table, arm_of(table), Convention.MODIFIED)
        assert [(row["a"], row["alpha"], row["d"]) for row in there.rows] == [("0", "0", "0.1"), ("0", "pi/2", "0")]
        assert (there.base, there.tool) == ("", "{xyz: [0.3, 0, 0]}")
        assert with_convention(there, arm_of(there), Convention.STANDARD) == table

    def test_bodies_stay_where_they_are(self, catalog: Catalog, arm_of: Arms) -> None:
        """Centres of mass and inertias, given in DH frames, are the same bodies of the robot in either convention."""
        table = table_text(ARM)
        arm = arm_of(table)
        there = arm_of(with_convention(table, arm, Convention.MODIFIED))
        for one, other in zip(_bodies(arm, catalog), _bodies(there, catalog), strict=True):
            assert one == pytest.approx(other, abs=1e-12)


def _bodies(arm: Manipulator, catalog: Catalog) -> list[list[float]]:
    """Mass, centre of mass and inertia of the links whose rows give them, in frames parallel to the base."""
    robot, _ = make(arm, "exact", table_text(arm), catalog)
    assert robot is not None
    links = {link.name: link.inertial for link in robot.links}
    origins = {joint.child: np.array(joint.origin.xyz) for joint in robot.joints}
    one, three = links["link_1"], links["link_3"]
    assert one is not None
    assert three is not None
    i, there = one.inertia, sum(origins[f"link_{number}"] for number in (1, 2, 3))
    return [
        [one.mass, *(origins["link_1"] + one.com), i.ixx, i.iyy, i.izz, i.ixy, i.ixz, i.iyz],
        [three.mass, *(there + three.com)],
    ]


class TestUnits:
    def test_a_published_arm_is_the_same_arm(self, reference_robot: ReferenceRobot, arm_of: Arms) -> None:
        """The table in millimetres and degrees has the same numbers, to the rounding of a degree."""
        arm = reference_robot.manipulator
        there = with_units(table_text(arm), arm, "mm", "deg")
        converted = arm_of(there)
        for one, other in zip(arm.rows, converted.rows, strict=True):
            assert (one.a, one.d) == (other.a, other.d)
            for name in ("alpha", "theta", "offset"):
                assert math.isclose(getattr(one, name), getattr(other, name), rel_tol=1e-15)
        assert_same_motion(arm, converted)

    def test_cells_with_a_unit_stay(self, arm_of: Arms) -> None:
        """Only texts without a unit are written anew, symbols of the joint variable kept in them."""
        fields = ("type", "a", "alpha", "d", "theta", "lower", "upper")

        def rows(*texts: str) -> tuple[dict[str, str], ...]:
            return tuple(dict(zip(fields, text.split("|"), strict=True)) for text in texts)

        typed = rows("R|0.3|90°|120 mm|q1 - pi/2|-pi|pi", "P|1/4|-pi/2|0.1 - q2|0|0|0.2")
        table = TableText(name="x", convention="standard", base="{xyz: [0, 0, 0.3]}", rows=typed)
        there = with_units(table, arm_of(table), "mm", "deg")
        assert there.rows == rows("R|300|90°|120 mm|q1 - 90|-180|180", "P|250|-90|-q2 + 100|0|0|200")
        assert there.base == "{xyz: [0, 0, 300]}"
        assert arm_of(there) == arm_of(table)


def _there_and_back(session: Session) -> None:
    """Through all units and the other convention, and back by another way."""
    for length, angle in (("mm", "rad"), ("mm", "deg"), ("cm", "deg"), ("m", "deg"), ("m", "rad")):
        session.set_units(length, angle, convert=True)
    convention = Convention(session.table.convention)
    session.set_convention(OTHER[convention], convert=True)
    session.set_units("mm", "deg", convert=True)
    session.set_convention(convention, convert=True)
    session.set_units("m", "rad", convert=True)


@pytest.mark.parametrize("file", ["ur5.csv", "panda.yaml", "scara.csv", "stanford.csv", "track.csv"])
def test_what_was_typed_comes_back(file: str, catalog: Catalog) -> None:
    """`pi` as a velocity is no 3.14 after a look at the table in degrees: every text is as it was typed."""
    session = Session(catalog, gallery_table(file, catalog))
    table = session.table
    _there_and_back(session)
    assert session.table == table


def test_expressions_come_back(catalog: Catalog) -> None:
    """So do thirds, sums, variables, zeros that are typed, masses, the base and the tool."""
    typed = {"joint": "one", "type": "R", "a": "1/3", "alpha": "0.37*pi", "d": "0.1 + 0.02", "theta": "-q1 + 1/7"}
    more = {"lower": "-7/3", "upper": "0.30", "mass": "3.761", "com_x": "0", "com_y": "-0.02561", "com_z": "0.00193"}
    slides = {"joint": "two", "type": "P", "a": "0.10", "alpha": "-pi/2", "d": "q2 + 1/3", "theta": "0"}
    table = TableText(
        name="arm",
        convention="standard",
        base="{xyz: [0, 0, 1/3], rpy: [0, 0, pi]}",
        tool="{xyz: [0, 0.50, 0]}",
        payload="{mass: 2, com: [0, 0, 50 mm]}",
        rows=({**typed, **more}, slides),
    )
    session = Session(catalog, table)
    assert session.convertible is not None
    _there_and_back(session)
    assert session.table == table


COMMAS = (
    {"a": "0,5", "alpha": "-1,25", "d": "−0,3", "theta": "0,75", "lower": "-2,5", "upper": "2,5", "velocity": "1,5"},
    {"type": "P", "a": "0,3", "alpha": "0,5 rad", "d": "-0,25", "theta": "1,5", "lower": "0", "upper": "0,4"},
)


@pytest.mark.parametrize("start", [("m", "rad"), ("mm", "rad"), ("cm", "rad")])
@pytest.mark.parametrize("convention", Convention)
def test_decimal_commas_are_converted(
    convention: Convention, start: tuple[str, str], catalog: Catalog, arm_of: Arms
) -> None:
    """Such cells stayed as they were: 0,5 m became 0,5 mm, though the same arm was promised."""
    table = TableText(convention=convention, length_unit=start[0], angle_unit=start[1], rows=COMMAS)
    session = Session(catalog, table)
    arm = arm_of(session.table)
    for units in (("mm", "deg"), ("cm", "rad"), ("m", "deg")):
        session.set_units(*units, convert=True)
        assert_same_motion(arm, now := arm_of(session.table))
        for row, other in zip(arm.rows, now.rows, strict=True):
            assert row.limits is not None
            assert other.limits is not None
            bounds = [(each.lower, each.upper, each.velocity or 0.0) for each in (row.limits, other.limits)]
            assert bounds[0] == pytest.approx(bounds[1], abs=1e-12)
    session.set_units(*start, convert=True)
    assert session.table == table


@pytest.mark.parametrize(
    "texts",
    [
        {
            "base": "{xyz: [0.1, 0, 5], rpy: [0, 0.3, pi/2]}",
            "tool": "{xyz: [0, 0, 5]}",
            "payload": "{mass: 2, com: [0, 0, 5]}",
        },
        {"base": "{mass: 3, geometry: {radius: 40}}", "defaults": "{geometry: {radius: 30}}"},
        {"tool": "{matrix: [[0, -1, 0, 12], [0.6, 0, -0.8, 0], [0.8, 0, 0.6, 7], [0, 0, 0, 1]]}"},
        {},
    ],
    ids=["all", "shapes", "matrix", "rows"],
)
@pytest.mark.parametrize("convention", Convention)
def test_a_converted_table_can_be_read(
    convention: Convention, texts: dict[str, str], catalog: Catalog, arm_of: Arms
) -> None:
    """Metres and radians are not declared: beside cells with a unit, the reader refused the converted base or speed."""
    one = {"a": "425 mm", "alpha": "90°", "d": "120", "lower": "-170°", "upper": "170°", "velocity": "2.5"}
    two = {"type": "P", "a": "12.5 cm", "alpha": "0.3", "d": "0", "theta": "0", "lower": "0", "upper": "200 mm"}
    table = TableText(convention=convention, length_unit="mm", rows=(one, {**two, "velocity": "100"}), **texts)  # type: ignore[arg-type]  # all are texts
    session = Session(catalog, table)
    arm = arm_of(table)
    for _ in range(2):
        session.set_units("m", "rad", convert=True)
        assert_same_motion(arm, arm_of(session.table))
        session.set_convention(OTHER[convention], convert=True)
        assert_same_motion(arm, arm_of(session.table))
        session.set_convention(convention, convert=True)
        session.set_units("mm", "rad", convert=True)
        assert session.table == table


@pytest.mark.parametrize("convention", [*Convention])
@pytest.mark.parametrize(
    "steps", [["cm rad", "other", "back"], ["other", "mm rad", "m deg", "cm rad", "back", "mm rad"]]
)
def test_a_row_has_its_a_and_alpha_back_in_other_units(
    convention: Convention, steps: list[str], catalog: Catalog, arm_of: Arms
) -> None:
    """Those of the first row, or of the last, were left in the base or the tool; the arm was the same."""
    rows = tuple({"a": a, "alpha": alpha, "d": "20"} for a, alpha in (("50", "33.3"), ("425.3", "90"), ("71", "-12.7")))
    ends = {"base": "{xyz: [10, 0, 300], rpy: [30, 0, 0]}", "tool": "{xyz: [0, 20, 100]}"}
    table = TableText(name="x", convention=str(convention), length_unit="mm", angle_unit="deg", rows=rows, **ends)
    session = Session(catalog, table)
    arm = arm_of(session.table)
    for step in steps:
        if step in ("other", "back"):
            session.set_convention(OTHER[convention] if step == "other" else convention, convert=True)
        else:
            session.set_units(*step.split(), convert=True)
        if step == "other":
            session.edit(1, "mass", "2")
    found = arm_of(session.table)
    assert_same_motion(found, arm)
    for new, old in zip(found.rows, arm.rows, strict=True):
        assert (new.a, new.alpha) == pytest.approx((old.a, old.alpha), rel=1e-12)
    assert found.base.translation == pytest.approx(arm.base.translation, rel=1e-12)
    assert found.tool.translation == pytest.approx(arm.tool.translation, rel=1e-12)


def test_an_edit_in_between_stays(catalog: Catalog) -> None:
    """What was typed in millimetres is not what was there before; the other cells of the row are."""
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    session.edit(1, "d", "1/3")
    session.set_units("mm", "rad", convert=True)
    session.edit(1, "a", "-426")
    session.edit(1, "joint", "upper")
    session.edit(2, "effort", "150.0")
    session.set_units("m", "rad", convert=True)
    assert {"joint": "upper", "a": "-0.426", "d": "1/3"}.items() <= session.table.rows[1].items()
    assert session.table.rows[2]["effort"] == "150.0"
