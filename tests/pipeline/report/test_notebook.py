import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lxml import html

import dh2urdf
from dh2urdf import Convention, DHRow, JointType, Limits, Manipulator, Robot
from dh2urdf.fields import replace_unchecked
from dh2urdf.report import notebook
from dh2urdf.rotations import RigidTransform
from reference_arms import ReferenceRobot

TABLES = Path(__file__).parents[3] / "configs" / "tables"
HOSTILE = "<script>alert(1)</script>\u202e'\""


def chain(count: int, name: str = "chain") -> Manipulator:
    rows = tuple(DHRow(joint=f"joint_{i}", link=f"link_{i}", a=0.1, alpha=1.2, d=0.0) for i in range(1, count + 1))
    return Manipulator(name=name, convention=Convention.MODIFIED, rows=rows)


def robot_of(manipulator: Manipulator) -> Robot:
    return dh2urdf.convert(manipulator).robot


def cells(shown: str) -> list[list[str]]:
    """The texts of a table's cells, row by row."""
    return [
        [" ".join(cell.text_content().split()) for cell in row.xpath("./*[self::th or self::td]")]
        for row in html.fromstring(shown).xpath(".//tr")
    ]


@pytest.fixture
def no_matplotlib(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notebook, "find_spec", lambda _: None)


@pytest.mark.usefixtures("no_matplotlib")
class TestTables:
    def test_that_of_a_manipulator(self) -> None:
        """Convention, base and tool are above; lengths are in m, angles in rad and degrees, all with their units."""
        slide = DHRow(joint="slide", link="b", type=JointType.PRISMATIC, a=0, alpha=0, d=0.25, offset=0.1, sign=-1)
        turn = DHRow(joint="turn", link="a", a=0.5, alpha=math.pi / 2, d=-0.0, limits=Limits(lower=-1, upper=math.pi))
        base = RigidTransform.from_xyz_rpy((0.0, 0.0, 0.3))
        arm = Manipulator(name="arm", convention=Convention.STANDARD, rows=(turn, slide), base=base)
        shown = arm._repr_html_()
        table = ["no.", "joint", "type", "a [m]", "α [rad]", "d [m]", "θ [rad]", "offset [rad, m]", "sign"]
        assert cells(shown) == [
            [*table, "lower [rad, m]", "upper [rad, m]"],
            ["1", "turn", "revolute", "0.5", "1.5708 90°", "0", "0", "0", "1", "-1 -57.2958°", "3.14159 180°"],
            ["2", "slide", "prismatic", "0", "0", "0.25", "0", "0.1 m", "-1", "–", "–"],
        ]
        assert "arm standard convention · 2 rows · base xyz 0 0 0.3 m, rpy 0 0 0 rad" in " ".join(
            html.fromstring(shown).xpath(".//p")[0].text_content().split()
        )

    def test_a_long_one_is_cut(self) -> None:
        """A table of hundreds of rows scrolls; beyond a number that nobody reads, it says how many more there are."""
        assert len(cells(chain(100)._repr_html_())) == 101
        long = cells(chain(450)._repr_html_())
        assert len(long) == 1 + notebook.MOST_ROWS + 1
        assert long[-1] == ["… 250 more"]

    def test_names_are_text(self) -> None:
        """No name of a table becomes markup or turns the direction of the page."""
        row = DHRow(joint=HOSTILE, link="b", a=0.1, alpha=0.0, d=0.0)
        arm = Manipulator(name=HOSTILE, convention=Convention.STANDARD, rows=(row,))
        robot = robot_of(chain(1))
        (link, *links), joint = robot.links, replace(robot.joints[0], name=HOSTILE, parent=HOSTILE, child=HOSTILE)
        hostile = replace(robot, name=HOSTILE, links=(replace(link, name=HOSTILE), *links), joints=(joint,))
        for shown in (arm._repr_html_(), hostile._repr_html_()):
            assert "<script" not in shown
            assert "\u202e" not in shown
            assert "<script>alert(1)</script>" in html.fromstring(shown).text_content()


class TestDrawings:
    @pytest.fixture(autouse=True)
    def _matplotlib(self) -> None:
        pytest.importorskip("matplotlib")

    @pytest.mark.parametrize("count", [1, 6, 100])
    def test_arm_and_robot_are_drawn(self, count: int) -> None:
        """One drawing each, which says in words what it shows; the same arm gives the same bytes."""
        arm = chain(count)
        robot = robot_of(arm)
        for thing, frames in ((arm, "DH frames"), (robot, "link frames")):
            shown = thing._repr_html_()
            (figure,) = html.fromstring(shown).xpath(".//svg")
            assert figure.get("aria-label") == f"zero joint values, with joint axes and {frames}"
            assert shown == thing._repr_html_()

    def test_two_on_a_page_do_not_meet(self) -> None:
        """The names of a drawing's parts are its own, and those of an equal drawing are of equal parts."""
        names = [set(html.fromstring(chain(n)._repr_html_()).xpath(".//svg//@id")) for n in (3, 4)]
        assert names[0]
        assert not names[0] & names[1]

    def test_what_cannot_be_drawn_is_told(self) -> None:
        """An arm of astronomical length, of no numbers, and joints that make no tree have their table; nothing fails."""
        for field, value in (("a", 1e200), ("alpha", math.inf), ("alpha", math.nan), ("d", -math.inf)):
            row = replace_unchecked(chain(1).rows[0], **{field: value})
            shown = replace_unchecked(chain(2), rows=(row,))._repr_html_()
            assert "<svg" not in shown
            assert "joint_1" in shown
        robot = robot_of(chain(3))
        circle = replace(robot, joints=tuple(reversed(robot.joints)))
        assert "<svg" not in circle._repr_html_()
        assert "joint_3" in circle._repr_html_()

    def test_the_robot_is_drawn_where_it_is(self, reference_robot: ReferenceRobot) -> None:
        """A drawn robot ends at tool0, and a joint's axis goes through the joint in its direction."""
        from dh2urdf.kinematics.expected_poses import ExpectedPoses
        from dh2urdf.report.figures import arm_skeleton, robot_skeleton

        arm = reference_robot.manipulator
        bones, truth = robot_skeleton(robot_of(arm)), arm_skeleton(ExpectedPoses.of(arm).tips[0])
        np.testing.assert_allclose(bones.tips[-1], arm.fk(np.zeros(len(arm.moving_rows)))[:3, 3], atol=1e-9)
        for drawn, expected in zip(bones.axes, truth.axes, strict=True):
            assert (drawn.number, drawn.slides) == (expected.number, expected.slides)
            np.testing.assert_allclose(drawn.direction, expected.direction, atol=1e-9)
            beside = np.subtract(drawn.at, expected.at)
            if not drawn.slides:  # Where a slide is mounted along its direction, and beside it, does not matter.
                np.testing.assert_allclose(np.cross(beside, expected.direction), 0, atol=1e-9)
