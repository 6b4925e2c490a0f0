import pickle
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from small_stages import drawing, one_joint, pickling, robot_of

from dh2urdf.conversion.one_manipulator import Call, Recipe, Written, emit_robot, write_robot
from dh2urdf.conversion.robots import make_robot
from dh2urdf.errors import EmitterError, ManipulatorError, ProofError, RobotError, StageError
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import EmittedFile, Emitter

TABLE = one_joint(mark=Mark(file="arm.csv", line=2))


def robot(length: float = 0.5, **turn: Any) -> Robot:
    """The arm of the table as links and joints."""
    return robot_of(one_joint(length=length), **turn)


def write(
    *emitters: Call[Emitter[Any]], to: Path, of: Robot | None = None, keeps: bool = True, **more: Any
) -> Sequence[Written]:
    recipe = Recipe(transform=drawing(keeps=keeps), emitters=emitters, poses=4)
    return write_robot(ExpectedPoses.of(TABLE), of or robot(), recipe, directory=to, stem="arm", **more)


def fail(*_: object) -> Any:
    raise KeyError("colour")


class TestMakeRobot:
    def test_notices_of_the_check_are_added_to_the_transform_s(self) -> None:
        """What the transform and the check want a person to know both travel with the robot."""
        notice = Problem(message="π/2 was probably meant", severity="notice")
        troublesome = robot(name="two words")
        made = make_robot(TABLE, drawing(lambda *_: replace(troublesome, notices=(notice,))))
        assert made.notices[0] == notice
        assert len(made.notices) > 1
        assert {problem.severity for problem in made.notices} == {"notice"}
        assert {problem.robot for problem in made.notices[1:]} == {"arm"}

    def test_a_robot_that_breaks_a_rule_is_refused(self) -> None:
        """A robot that no reader should get is an error with the manipulator and its place in the table."""
        with pytest.raises(RobotError) as caught:
            make_robot(TABLE, drawing(lambda *_: robot(axis=(0.0, 0.0, 2.0))))
        problem = next(problem for problem in caught.value.problems if problem.severity == "error")
        assert (problem.robot, problem.mark) == ("arm", TABLE.mark)
        assert problem.joint == "turn"


class TestWriteRobot:
    @pytest.mark.parametrize(
        ("asked", "proofs"),
        [
            ({}, [True, True]),
            ({"sampled": False}, [True, False]),
            ({"proved": False}, [False, False]),
            ({"proved": False, "sampled": False}, [False, False]),
        ],
        ids=["by default", "not in the sample", "not proved", "neither"],
    )
    def test_proofs_can_be_left_out(self, tmp_path: Path, asked: dict[str, bool], proofs: list[bool]) -> None:
        """A long run leaves the slow proofs to a sample, and those only; or all of them; the files are written."""
        emitters = (pickling(), pickling("slow", suffix=".slow", costly=True))
        recipe = Recipe(transform=drawing(lambda *_: robot()), emitters=emitters, poses=4)
        written = emit_robot(ExpectedPoses.of(TABLE), robot(), recipe, folder=tmp_path, stem="arm", **asked)
        assert [each.proof is not None for each in written] == proofs
        assert {path.name for path in tmp_path.iterdir()} == {"arm.pickle", "arm.slow"}


class TestWhenAnEmitterFails:
    @pytest.fixture
    def out(self, tmp_path: Path) -> Iterator[Path]:
        """An output folder with an older file, in which a failure must change nothing."""
        (tmp_path / "arm.pickle").write_bytes(b"old")
        yield tmp_path
        assert [path.name for path in tmp_path.iterdir()] == ["arm.pickle"]
        assert (tmp_path / "arm.pickle").read_bytes() == b"old"

    @pytest.mark.parametrize(
        ("how", "error"),
        [
            ({"emit": lambda *_: []}, StageError),
            # A name without the stem is every manipulator's, and the last one would overwrite all others in silence.
            ({"emit": lambda *_: [EmittedFile(name="sheet.txt", content=b"x")], "read_back": None}, StageError),
            ({"emit": lambda *_: [EmittedFile(name="ARM.pickle", content=b"x")], "read_back": None}, EmitterError),
            ({"suffix": ".bad", "read_back": fail}, StageError),
            ({"suffix": ".bad", "read_back": lambda _: "robot"}, StageError),
        ],
        ids=["no file", "no stem", "the name of another emitter's", "not read back", "read back as something else"],
    )
    def test_by_what_it_gives(self, out: Path, how: dict[str, Any], error: type[ManipulatorError]) -> None:
        """It is named, and no file of any emitter is put in place."""
        with pytest.raises(error, match="'bad'"):
            write(pickling(), pickling("bad", **how), to=out)

    def test_by_writing_another_arm(self, out: Path) -> None:
        """A file whose arm is a tenth of a micrometre longer than the table's is refused, with the numbers."""
        longer = pickle.dumps(robot(length=0.5 + 1e-7))
        with pytest.raises(ProofError) as caught:
            write(pickling("pickle", lambda *_: [EmittedFile(name="arm.pickle", content=longer)]), to=out)
        (problem,) = caught.value.problems
        assert (problem.code, problem.mark) == ("off-the-table", TABLE.mark)
        assert all(word in problem.message for word in ("'pickle'", "1e-07", "1e-09"))

    @pytest.mark.parametrize(
        ("other", "code"),
        [
            (robot(length=0.6), "off-the-table"),
            (replace(robot(), joints=robot().joints[:-1]), "no-way"),
            (
                replace(robot(), joints=tuple(replace(each, name=f"my_{each.name}") for each in robot().joints)),
                "other-joints-move",
            ),
        ],
    )
    def test_of_a_robot_that_is_another_arm(self, out: Path, other: Robot, code: str) -> None:
        """The transform made it, and the edits of robots: the emitter wrote what it was given."""
        with pytest.raises(ProofError, match="'draw'") as caught:
            write(pickling(), of=other, to=out)
        assert [problem.code for problem in caught.value.problems] == [code]


def test_a_transform_that_does_not_keep_the_kinematics_is_measured_and_passes(tmp_path: Path) -> None:
    """Where the transform does not claim the table's arm, the difference is reported and fails nothing."""
    (written,) = write(pickling(), of=robot(length=0.7), to=tmp_path, keeps=False)
    assert written.proof is not None
    assert not written.proof.holds
    assert written.proof.position_error == pytest.approx(0.2)
    assert (tmp_path / "arm.pickle").is_file()
