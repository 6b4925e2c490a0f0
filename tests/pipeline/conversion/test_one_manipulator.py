from __future__ import annotations

import pickle
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from small_stages import drawing, one_joint, pickling, robot_of

from dh2urdf.conversion.one_manipulator import (
    Call,
    Recipe,
    Sample,
    Written,
    emit_robot,
    write_robot,
)
from dh2urdf.conversion.robots import make_robot
from dh2urdf.errors import (
    EmitterError,
    ProofError,
    RobotError,
    StageError,
)
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import EmittedFile, Emitter

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.robot import Robot

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
    def test_the_files_are_in_place_with_their_facts(self, tmp_path: Path) -> None:
        """Every file is written, and known with its emitter and its content; the folder holds nothing else."""
        text = EmittedFile(name="arm.txt", content=b"turn\n")
        by_hand = pickling("text", lambda *_: [text, EmittedFile(name="arm.more", content=b"")], read_back=None)
        first, second = write(pickling(), by_hand, to=tmp_path / "out")
        assert (first.stage, second.stage) == ("pickle", "text")
        assert [file.name for file in second.files] == ["arm.txt", "arm.more"]
        for file in (*first.files, *second.files):
            content = (tmp_path / "out" / file.name).read_bytes()
            assert file.content == content
        assert {path.name for path in (tmp_path / "out").iterdir()} == {"arm.pickle", "arm.txt", "arm.more"}

    def test_what_is_written_is_proved(self, tmp_path: Path) -> None:
        """The proof is of the file as it was written, at zero, both ends and the vectors of the recipe."""
        (written,) = write(pickling(), to=tmp_path)
        assert written.proof is not None
        assert written.proof.holds
        assert written.proof.poses == 3 + 4

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

    def test_the_first_main_file_can_be_named(self, tmp_path: Path) -> None:
        """A person may name the main file; the files beside it keep their names."""
        pair = pickling(
            "pair",
            lambda *_: [EmittedFile(name="arm.top", content=b"1"), EmittedFile(name="arm_macro.top", content=b"2")],
            read_back=None,
        )
        (written,) = write(pair, to=tmp_path, main_file="Mein Arm.top")
        assert [file.name for file in written.files] == ["Mein Arm.top", "arm_macro.top"]
        assert (tmp_path / "Mein Arm.top").read_bytes() == b"1"


class TestWhenAnEmitterFails:
    @pytest.fixture
    def out(self, tmp_path: Path) -> Iterator[Path]:
        """An output folder with an older file, in which a failure must change nothing."""
        (tmp_path / "arm.pickle").write_bytes(b"old")
        yield tmp_path
        assert [path.name for path in tmp_path.iterdir()] == ["arm.pickle"]
        assert (tmp_path / "arm.pickle").read_bytes() == b"old"

    def test_without_a_file(self, out: Path) -> None:
        """An emitter that gives no file is a failure, not a success of nothing."""
        with pytest.raises(StageError, match="emitter 'bad' failed: ValueError: it gave no file"):
            write(pickling(), pickling("bad", lambda *_: []), to=out)

    def test_with_the_name_of_another_emitter_s_file(self, out: Path) -> None:
        """Two emitters that write one name are an error that names both, also where only the case differs."""
        loud = pickling("loud", lambda *_: [EmittedFile(name="ARM.pickle", content=b"x")], read_back=None)
        with pytest.raises(
            EmitterError, match=r"(?s)the emitters 'pickle' and 'loud' both write 'ARM\.pickle'.*leave out"
        ):
            write(pickling(), loud, to=out)

    def test_with_a_name_that_other_manipulators_have_too(self, out: Path) -> None:
        """A name without the stem is every manipulator's, and the last one would overwrite all others in silence."""
        fixed = pickling("bad", lambda *_: [EmittedFile(name="sheet.txt", content=b"x")], read_back=None)
        with pytest.raises(StageError, match=r"'sheet\.txt' does not begin with the stem 'arm' that it was given"):
            write(pickling(), fixed, to=out)

    @pytest.mark.parametrize(
        ("read_back", "reason"),
        [
            (fail, "emitter 'bad' failed: KeyError: 'colour'"),
            (lambda _: "robot", "emitter 'bad' failed: TypeError: it gave str, not dh2urdf.robot.Robot"),
        ],
        ids=["raises", "gives something else"],
    )
    def test_while_its_file_is_read_back(self, out: Path, read_back: Callable[[Path], Any], reason: str) -> None:
        """A file that cannot be read back is not put in place."""
        with pytest.raises(StageError) as caught:
            write(pickling(), pickling("bad", suffix=".bad", read_back=read_back), to=out)
        assert reason in str(caught.value)

    def test_by_writing_another_arm(self, out: Path) -> None:
        """A file whose arm is a tenth of a micrometre longer than the table's is refused, with the numbers."""
        longer = pickle.dumps(robot(length=0.5 + 1e-7))
        with pytest.raises(ProofError) as caught:
            write(pickling("pickle", lambda *_: [EmittedFile(name="arm.pickle", content=longer)]), to=out)
        message = str(caught.value)
        assert "what the emitter 'pickle' wrote is not the arm of the table" in message
        assert "tool0 is off by 1e-07 m and " in message
        assert "allowed are 1e-09 m and 1e-09 rad" in message
        assert caught.value.problems[0].mark == TABLE.mark

    @pytest.mark.parametrize(
        ("other", "how"),
        [
            (robot(length=0.6), r"tool0 is off by 0\.1 m and "),
            (
                replace(robot(), joints=robot().joints[:-1]),
                "robot 'arm' has no chain from link 'base_link' to link 'tool0'",
            ),
            (
                replace(robot(), joints=tuple(replace(each, name=f"my_{each.name}") for each in robot().joints)),
                "the written chain moves the joints my_turn, the table turn",
            ),
        ],
    )
    def test_of_a_robot_that_is_another_arm(self, out: Path, other: Robot, how: str) -> None:
        """The transform made it, and the edits of robots: the emitter wrote what it was given."""
        with pytest.raises(
            ProofError, match=rf"error: [^:]*: what the transform 'draw' made is not the arm of the table: {how}"
        ):
            write(pickling(), of=other, to=out)


def test_a_transform_that_does_not_keep_the_kinematics_is_measured_and_passes(tmp_path: Path) -> None:
    """Where the transform does not claim the table's arm, the difference is reported and fails nothing."""
    (written,) = write(pickling(), of=robot(length=0.7), to=tmp_path, keeps=False)
    assert written.proof is not None
    assert not written.proof.holds
    assert written.proof.position_error == pytest.approx(0.2)
    assert (tmp_path / "arm.pickle").is_file()


@pytest.mark.parametrize(
    ("sample", "members"),
    [
        (Sample(), range(20)),
        (Sample(first=3, every=5), [0, 1, 2, 5, 10, 15]),
        (Sample(every=7), [0, 7, 14]),
        (Sample(first=20, every=1000), range(20)),
    ],
)
def test_a_sample_is_the_first_ones_and_every_so_many_th(sample: Sample, members: Sequence[int]) -> None:
    """By the numbers in the run, whatever the batches: a resumed run looks at the same ones."""
    assert [index for index in range(20) if index in sample] == list(members)
