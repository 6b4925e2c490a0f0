"""Edits on their way: before and after the transform, in order, in the proof, and in what is known of a robot."""

import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from small_stages import Keeping, drawing, pickling

from dh2urdf.conversion.keys import recipe_key
from dh2urdf.conversion.one_manipulator import Recipe, write_robot
from dh2urdf.conversion.robots import make_item, make_robot
from dh2urdf.errors import ProofError, RobotError, StageError
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.plugin_system.calls import Call
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.stages import Edit, KeepsKinematics
from dh2urdf.testing import reference_manipulators

UR5 = reference_manipulators()[0]


DRAWING, PICKLING = drawing(), pickling()


def edit(
    *, table: Callable[..., Any] | None = None, robot: Callable[..., Any] | None = None, **options: Any
) -> Call[Edit[Any]]:
    """An edit of a test."""
    stage = Edit(
        name="change",
        summary="changes",
        options=Keeping,
        edit_table=table,
        edit_robot=robot,
        capabilities=(KeepsKinematics(lambda given: given.keeps),),
    )
    return Call(stage=stage, options=Keeping(**options))


def longer(table: Manipulator, _options: object) -> Manipulator:
    """An arm whose second segment is 10 cm longer."""
    first, second, *others = table.rows
    return replace(table, rows=(first, replace(second, a=second.a - 0.1), *others))


def moved(robot: Robot, _options: object) -> Robot:
    """A robot whose tool0 is 1 mm further out."""
    *joints, last = robot.joints
    x, y, z = last.origin.xyz
    return replace(robot, joints=(*joints, replace(last, origin=Origin(xyz=(x, y, z + 1e-3), rpy=last.origin.rpy))))


def written(tmp_path: Path, *edits: Call[Edit[Any]]) -> Any:
    recipe = Recipe(transform=DRAWING, emitters=(PICKLING,), edits=edits, poses=4)
    robot, expected = make_item(UR5, recipe.transform, recipe.edits)
    (result,) = write_robot(expected, robot, recipe, directory=tmp_path, stem="arm")
    return result.proof


class TestTheProof:
    def test_an_edited_table_is_the_truth(self, tmp_path: Path) -> None:
        """The robot is that of the edited table: nothing is off, and its reach is another one."""
        assert written(tmp_path, edit(table=longer)).position_error == pytest.approx(0.0, abs=1e-12)
        zero = [0.0] * 6
        edited = pickle.loads((tmp_path / "arm.pickle").read_bytes())  # noqa: S301 - written above
        assert edited.fk(zero)[0, 3] == pytest.approx(UR5.fk(zero)[0, 3] - 0.1)

    def test_an_edited_robot_has_to_be_the_arm_of_the_table(self, tmp_path: Path) -> None:
        """A tool0 that an edit has moved by a millimetre is found."""
        with pytest.raises(ProofError, match=r"0\.001 m"):
            written(tmp_path, edit(robot=moved))
        assert not list(tmp_path.iterdir())

    def test_an_edit_may_say_that_it_makes_another_arm(self, tmp_path: Path) -> None:
        """Then the proof has the difference, and the robot has no table any more."""
        call = edit(robot=moved, keeps=False)
        assert written(tmp_path, call).position_error == pytest.approx(1e-3)
        assert make_robot(UR5, DRAWING, [call]).manipulator is None


class TestTheOrder:
    def test_tables_before_and_robots_after_each_in_order(self) -> None:
        """Of two edits with both functions, the tables come first."""
        seen: list[str] = []

        def both(word: str) -> Call[Edit[Any]]:
            def of_table(table: Manipulator, _options: object) -> Manipulator:
                seen.append(f"table {word}")
                return table

            def of_robot(robot: Robot, _options: object) -> Robot:
                seen.append(f"robot {word}")
                return robot

            return edit(table=of_table, robot=of_robot)

        robot = make_robot(UR5, DRAWING, [both("one"), both("two")])
        assert seen == ["table one", "table two", "robot one", "robot two"]
        assert robot.comment.endswith("edited by change, change")


class TestFaults:
    def test_another_name_is_a_fault(self) -> None:
        """Files are named before edits are made."""
        for call in (
            edit(table=lambda table, _: replace(table, name="b")),
            edit(robot=lambda robot, _: replace(robot, name="b")),
        ):
            with pytest.raises(StageError, match=r"'change'.*'ur5'.*'b'"):
                make_robot(UR5, DRAWING, [call])

    def test_a_robot_that_an_edit_has_broken_names_the_edit(self) -> None:
        """Readers refuse a link that nothing holds."""
        call = edit(robot=lambda robot, _: replace(robot, links=(*robot.links, Link(name="loose"))))
        with pytest.raises(RobotError, match=r"'change'.*loose"):
            make_robot(UR5, DRAWING, [call])

    def test_a_joint_that_an_edit_adds_is_checked(self) -> None:
        """A second parent of tool0 is an error of the edit too."""

        def hold(robot: Robot, _options: object) -> Robot:
            joint = Joint(name="strut", type=JointType.FIXED, parent="base_link", child="tool0")
            return replace(robot, joints=(*robot.joints, joint))

        with pytest.raises(RobotError, match="'change'"):
            make_robot(UR5, DRAWING, [edit(robot=hold)])


def test_the_key_of_a_recipe_has_its_edits_and_their_files(tmp_path: Path) -> None:
    """Order, options, and what a file holds that an option names: a run with --resume makes all of these again."""
    file = tmp_path / "differences.csv"
    file.write_text("a")

    def key(*calls: Call[Edit[Any]]) -> str:
        return recipe_key(Recipe(transform=DRAWING, emitters=(PICKLING,), edits=calls))

    one, other = edit(table=longer), edit(table=longer, keeps=False)
    with_file = edit(table=longer, file=file)
    before = key(with_file)
    assert len({key(), key(one), key(one, one), key(one, other), key(other, one), before}) == 6
    assert key(with_file) == before
    file.write_text("b")
    assert key(with_file) != before
    file.unlink()
    assert key(with_file) != before
