from __future__ import annotations

import pickle
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.conversion.one_manipulator import (
    Call,
    Recipe,
    Sample,
    Written,
    emit_robot,
    read_items,
    write_robot,
)
from dh2urdf.conversion.robots import make_robot
from dh2urdf.errors import (
    EmitterError,
    MissingDependencyError,
    ProofError,
    RobotError,
    StageError,
)
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.robot import Inertial, Joint, Link, Origin, Robot
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import EmittedFile, Emitter, KeepsKinematics, NoOptions, Reader, ReadsBack, Rejected, Transform

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

# The stages of these tests are made here: the core is tried without any built-in plugin.

TABLE = Manipulator(
    name="arm",
    convention=Convention.STANDARD,
    rows=(DHRow(joint="turn", link="one", a=0.5, alpha=0.0, d=0.0),),
    mark=Mark(file="arm.csv", line=2),
)
BODY = Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0))


def robot(length: float = 0.5, **turn: Any) -> Robot:
    """The arm of the table as links and joints, drawn by hand."""
    limits = Limits(lower=-1.0, upper=1.0, velocity=1.0, effort=1.0)
    joints = (
        Joint(name="base", type=JointType.FIXED, parent="base_link", child="base_link_inertia"),
        replace(
            Joint(name="turn", type=JointType.REVOLUTE, parent="base_link_inertia", child="one", limits=limits), **turn
        ),
        Joint(
            name="one-tool0", type=JointType.FIXED, parent="one", child="tool0", origin=Origin(xyz=(length, 0.0, 0.0))
        ),
    )
    links = (
        Link(name="base_link"),
        Link(name="base_link_inertia", inertial=BODY),
        Link(name="one", inertial=BODY),
        Link(name="tool0", inertial=Inertial(mass=0.0)),
    )
    return Robot(name="arm", links=links, joints=joints)


@dataclass(frozen=True, kw_only=True)
class Keeping:
    keeps: bool = True


def transforming(function: Callable[..., Any], *, keeps: bool = True) -> Call[Transform[Any]]:
    stage = Transform(
        name="draw",
        summary="draws",
        transform=function,
        options=Keeping,
        capabilities=(KeepsKinematics(lambda options: options.keeps),),
    )
    return Call(stage=stage, options=Keeping(keeps=keeps))


def emitting(
    name: str = "pickle",
    emit: Callable[..., Any] | None = None,
    *,
    suffix: str = ".pickle",
    read_back: Callable[[Path], Any] | None = lambda path: pickle.loads(path.read_bytes()),  # noqa: S301 - made here
    costly: bool = False,
) -> Call[Emitter[Any]]:
    def pickled(robot: Robot, stem: str, _options: NoOptions) -> list[EmittedFile]:
        return [EmittedFile(name=f"{stem}{suffix}", content=pickle.dumps(robot))]

    stage = Emitter(
        name=name,
        summary="writes",
        emit=emit or pickled,
        options=NoOptions,
        suffixes=(suffix,),
        capabilities=(ReadsBack(read_back, is_costly=costly),) if read_back else (),
    )
    return Call(stage=stage, options=NoOptions())


def write(
    *emitters: Call[Emitter[Any]], to: Path, of: Robot | None = None, keeps: bool = True, **more: Any
) -> Sequence[Written]:
    drawing = transforming(lambda _table, _options: robot(), keeps=keeps)
    recipe = Recipe(transform=drawing, emitters=emitters, poses=4)
    return write_robot(ExpectedPoses.of(TABLE), of or robot(), recipe, directory=to, stem="arm", **more)


def fail(*_: object) -> Any:
    raise KeyError("colour")


def leave(*_: object) -> Any:
    raise SystemExit(7)


class TestReadItems:
    @staticmethod
    def read(function: Callable[..., Any]) -> list[Any]:
        reader = Reader(name="table", summary="reads", read=function, options=NoOptions)
        return list(read_items(Call(stage=reader, options=NoOptions()), Path("arm.tab")))

    def test_manipulators_and_rejected_ones_come_as_they_are(self) -> None:
        """What a reader yields arrives in its order."""
        rejected = Rejected(name="bad", problems=(Problem(message="no"),))
        assert self.read(lambda *_: iter([TABLE, rejected, TABLE])) == [TABLE, rejected, TABLE]


class TestMakeRobot:
    def test_a_good_robot_passes(self) -> None:
        """The robot of the transform arrives as it is, and the transform gets the table and its options."""
        given: list[Any] = []

        def draw(*words: Any) -> Robot:
            given.extend(words)
            return robot()

        assert make_robot(TABLE, transforming(draw)) == robot()
        assert given == [TABLE, Keeping()]

    def test_notices_of_the_check_are_added_to_the_transform_s(self) -> None:
        """What the transform and the check want a person to know both travel with the robot."""
        notice = Problem(message="π/2 was probably meant", severity="notice")
        troublesome = robot(name="two words")
        made = make_robot(TABLE, transforming(lambda *_: replace(troublesome, notices=(notice,))))
        assert made.notices[0] == notice
        assert len(made.notices) > 1
        assert {problem.severity for problem in made.notices} == {"notice"}
        assert {problem.robot for problem in made.notices[1:]} == {"arm"}

    def test_a_robot_that_breaks_a_rule_is_refused(self) -> None:
        """A robot that no reader should get is an error with the manipulator and its place in the table."""
        with pytest.raises(RobotError) as caught:
            make_robot(TABLE, transforming(lambda *_: robot(axis=(0.0, 0.0, 2.0))))
        problem = next(problem for problem in caught.value.problems if problem.severity == "error")
        assert (problem.robot, problem.mark) == ("arm", TABLE.mark)
        assert problem.joint == "turn"


class TestWriteRobot:
    def test_the_files_are_in_place_with_their_facts(self, tmp_path: Path) -> None:
        """Every file is written, and known with its emitter and its content; the folder holds nothing else."""
        text = EmittedFile(name="arm.txt", content=b"turn\n")
        by_hand = emitting("text", lambda *_: [text, EmittedFile(name="arm.more", content=b"")], read_back=None)
        first, second = write(emitting(), by_hand, to=tmp_path / "out")
        assert (first.stage, second.stage) == ("pickle", "text")
        assert [file.name for file in second.files] == ["arm.txt", "arm.more"]
        for file in (*first.files, *second.files):
            content = (tmp_path / "out" / file.name).read_bytes()
            assert file.content == content
        assert {path.name for path in (tmp_path / "out").iterdir()} == {"arm.pickle", "arm.txt", "arm.more"}

    def test_what_is_written_is_proved(self, tmp_path: Path) -> None:
        """The proof is of the file as it was written, at zero, both ends and the vectors of the recipe."""
        (written,) = write(emitting(), to=tmp_path)
        assert written.proof is not None
        assert written.proof.holds
        assert written.proof.poses == 3 + 4

    def test_a_format_that_cannot_be_read_back_has_no_proof(self, tmp_path: Path) -> None:
        """Without a way to read a file back nothing is claimed of it."""
        (written,) = write(emitting(read_back=None), to=tmp_path)
        assert written.proof is None

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
        emitters = (emitting(), emitting("slow", suffix=".slow", costly=True))
        recipe = Recipe(transform=transforming(lambda *_: robot()), emitters=emitters, poses=4)
        written = emit_robot(ExpectedPoses.of(TABLE), robot(), recipe, folder=tmp_path, stem="arm", **asked)
        assert [each.proof is not None for each in written] == proofs
        assert {path.name for path in tmp_path.iterdir()} == {"arm.pickle", "arm.slow"}

    def test_a_file_that_is_not_proved_may_be_another_arm(self, tmp_path: Path) -> None:
        """Nobody looks: what a run does not prove it does not claim either."""
        recipe = Recipe(transform=transforming(lambda *_: robot()), emitters=(emitting(),), poses=4)
        longer = robot(length=0.6)
        (written,) = emit_robot(ExpectedPoses.of(TABLE), longer, recipe, folder=tmp_path, stem="arm", proved=False)
        assert written.proof is None
        with pytest.raises(ProofError):
            emit_robot(ExpectedPoses.of(TABLE), longer, recipe, folder=tmp_path, stem="arm")

    def test_the_first_main_file_can_be_named(self, tmp_path: Path) -> None:
        """A person may name the main file; the files beside it keep their names."""
        pair = emitting(
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
            write(emitting(), emitting("bad", lambda *_: []), to=out)

    def test_with_the_name_of_another_emitter_s_file(self, out: Path) -> None:
        """Two emitters that write one name are an error that names both, also where only the case differs."""
        loud = emitting("loud", lambda *_: [EmittedFile(name="ARM.pickle", content=b"x")], read_back=None)
        with pytest.raises(
            EmitterError, match=r"(?s)the emitters 'pickle' and 'loud' both write 'ARM\.pickle'.*leave out"
        ):
            write(emitting(), loud, to=out)

    def test_with_a_name_that_other_manipulators_have_too(self, out: Path) -> None:
        """A name without the stem is every manipulator's, and the last one would overwrite all others in silence."""
        fixed = emitting("bad", lambda *_: [EmittedFile(name="sheet.txt", content=b"x")], read_back=None)
        with pytest.raises(StageError, match=r"'sheet\.txt' does not begin with the stem 'arm' that it was given"):
            write(emitting(), fixed, to=out)

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
            write(emitting(), emitting("bad", suffix=".bad", read_back=read_back), to=out)
        assert reason in str(caught.value)

    def test_for_want_of_a_package(self, out: Path) -> None:
        """A package that is not installed is not the manipulator's fault, and says what to type."""

        def lacking(*_: object) -> Any:
            raise MissingDependencyError("emitter 'bad'", "sdformat", "lab[sdf]")

        with pytest.raises(MissingDependencyError, match="pip install"):
            write(emitting("bad", lacking), to=out)

    def test_by_writing_another_arm(self, out: Path) -> None:
        """A file whose arm is a tenth of a micrometre longer than the table's is refused, with the numbers."""
        longer = pickle.dumps(robot(length=0.5 + 1e-7))
        with pytest.raises(ProofError) as caught:
            write(emitting("pickle", lambda *_: [EmittedFile(name="arm.pickle", content=longer)]), to=out)
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
            write(emitting(), of=other, to=out)


def test_a_transform_that_does_not_keep_the_kinematics_is_measured_and_passes(tmp_path: Path) -> None:
    """Where the transform does not claim the table's arm, the difference is reported and fails nothing."""
    (written,) = write(emitting(), of=robot(length=0.7), to=tmp_path, keeps=False)
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
