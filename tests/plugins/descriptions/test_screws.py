"""Screw axes: the table of an arm, against an own product of exponentials."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from command_line import Cli
from numpy.typing import NDArray
from plain_frames import dh, homogeneous
from scipy.linalg import expm

import dh2urdf
from dh2urdf import Manipulator
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, JointType
from reference_arms import ReferenceRobot

Array = NDArray[np.float64]

OWN_SHARE = 5e-13
"""The tolerance of a table, as a share of the arm's size."""
SHARE = 1e-12
"""How far T(q) may be from the product of exponentials, as a share of the arm's size."""


class Screws(NamedTuple):
    """An arm as its axes, and which of them slide."""

    Slist: Array
    M: Array
    slides: list[bool]

    @property
    def size(self) -> float:
        """The longest distance among the frames [m], 1 at least."""
        points = [np.cross(w, v) for w, v in zip(self.Slist[:3].T, self.Slist[3:].T, strict=True)]
        return max(1.0, *(float(np.abs(point).max()) for point in (*points, self.M[:3, 3])))

    @property
    def joints(self) -> list[dict[str, str]]:
        return [{"type": "prismatic" if slides else "revolute"} for slides in self.slides]


def skew(vector: Array) -> Array:
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def exponential(screw: Array, q: float) -> Array:
    matrix = np.zeros((4, 4))
    matrix[:3, :3], matrix[:3, 3] = skew(screw[:3]), screw[3:]
    return np.asarray(expm(matrix * q))


def product(arm: Screws, q: Array) -> Array:
    """Eq. 4.14 of Modern Robotics."""
    pose = np.eye(4)
    for screw, value in zip(arm.Slist.T, q, strict=True):
        pose = pose @ exponential(screw, value)
    return pose @ arm.M


def body_axes(arm: Screws) -> Array:
    """The same axes in the frame of the tool: the adjoint of M⁻¹."""
    turn, shift = arm.M[:3, :3].T, -arm.M[:3, :3].T @ arm.M[:3, 3]
    adjoint = np.block([[turn, np.zeros((3, 3))], [skew(shift) @ turn, turn]])
    return np.asarray(adjoint @ arm.Slist)


def steps(arm: Screws) -> tuple[Array, Array, Array]:
    """The same arm as H, P and R, with points on the axes that are anywhere along them."""
    slides = np.array(arm.slides)
    H = np.where(slides, arm.Slist[3:], arm.Slist[:3])
    along = np.linspace(-0.3, 0.4, len(slides))
    points = [np.cross(w, v) + at * h for w, v, h, at in zip(arm.Slist[:3].T, arm.Slist[3:].T, H.T, along, strict=True)]
    places = np.array([np.zeros(3), *points, arm.M[:3, 3]])
    return H, np.diff(places, axis=0).T, arm.M[:3, :3]


def arms_of(arm: Screws, **options: Any) -> dict[str, Manipulator]:
    """The tables of all that an arm can be given as."""
    options["tolerance"] = OWN_SHARE * arm.size
    H, P, R = steps(arm)
    return {
        "Slist": dh2urdf.from_screws(arm.Slist, arm.M, **options),
        "Blist": dh2urdf.from_screws(Blist=body_axes(arm), M=arm.M, **options),
        "H": dh2urdf.from_screws(H=H, P=P, R=R, joints=arm.joints, **options),
    }


def check(arm: Screws, seed: int) -> None:
    vectors = [np.zeros(len(arm.slides)), *np.random.default_rng(seed).uniform(-2.5, 2.5, (3, len(arm.slides)))]
    poses = [product(arm, q) for q in vectors]
    for convention in ("standard", "modified"):
        for table in arms_of(arm, convention=convention).values():
            assert [row.type is JointType.PRISMATIC for row in table.moving_rows] == arm.slides
            for q, pose in zip(vectors, poses, strict=True):
                assert np.abs(table.fk(q) - pose).max() <= SHARE * arm.size


# --- Published arms ---------------------------------------------------------------------------------------------------


def screws_of(table: Manipulator) -> Screws:
    """The axes of a DH table at q = 0, by its matrices: z of the frame before the row, or of that of the row."""
    pose, screws, slides = homogeneous(table.base), [], []
    for row in table.rows:
        is_sliding = row.type is JointType.PRISMATIC
        theta, d = (row.theta, row.d + row.offset) if is_sliding else (row.theta + row.offset, row.d)
        after = pose @ dh(table.convention, theta, d, row.a, row.alpha)
        frame = pose if table.convention is Convention.STANDARD else after
        axis = row.sign * frame[:3, 2]
        moment = np.cross(frame[:3, 3], axis)
        if row.type is not JointType.FIXED:
            slides.append(is_sliding)
            screws.append(np.concatenate([np.zeros(3), axis] if is_sliding else [axis, moment]))
        pose = after
    return Screws(np.array(screws).T, pose @ homogeneous(table.tool), slides)


def test_published_arms(reference_robot: ReferenceRobot) -> None:
    """The axes of each published table become a table again, and T(q) is that of the publisher's own library, too."""
    arm = screws_of(reference_robot.manipulator)
    check(arm, 1)
    table = dh2urdf.from_screws(arm.Slist, arm.M, tolerance=OWN_SHARE * arm.size)
    for q, pose in zip(reference_robot.q, reference_robot.poses, strict=True):
        assert np.abs(table.fk(q) - np.array(pose)).max() <= SHARE * arm.size


# --- Any arms ---------------------------------------------------------------------------------------------------------


def random_arm(seed: int) -> Screws:
    """One to eight axes: of any direction, along the frame's own axes, parallel, on one line, sliding."""
    draw = np.random.default_rng(seed)
    columns: list[Array] = []
    slides: list[bool] = []
    for _ in range(draw.integers(1, 9)):
        if draw.random() < 0.5:
            axis = draw.choice([-1.0, 1.0]) * np.eye(3)[draw.integers(3)]
        else:
            axis = draw.normal(size=3)
            axis /= np.linalg.norm(axis)
        point = np.where(draw.random(3) < 0.3, 0.0, draw.uniform(-1, 1, 3))
        slides.append(bool(draw.random() < 0.2))
        if columns and draw.random() < 0.2:
            columns.append(columns[-1])
            slides[-1] = slides[-2]
            continue
        columns.append(np.concatenate([np.zeros(3), axis] if slides[-1] else [axis, np.cross(point, axis)]))
    q, _ = np.linalg.qr(draw.normal(size=(3, 3)))
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = q * np.sign(np.linalg.det(q)), draw.uniform(-1, 1, 3)
    return Screws(np.array(columns).T, M, slides)


@pytest.mark.parametrize("seed", range(40))
def test_any_arm(seed: int) -> None:
    check(random_arm(seed), seed)


# --- Files ------------------------------------------------------------------------------------------------------------

BOOK = """\
name: ur5
units: {length: mm}
Slist:
  - [0, 0,   0,   0,   0,    0]
  - [0, 1,   1,   1,   0,    1]
  - [1, 0,   0,   0,  -1,    0]
  - [0, -89, -89, -89, -109, 6]
  - [0, 0,   0,   0,   817,  0]
  - [0, 0,   425, 817, 0,    817]
M: [[-1, 0, 0, 817], [0, 0, 1, 191], [0, 1, 0, -6], [0, 0, 0, 1]]
"""
"""Example 4.5 of Modern Robotics: W1 = 109, W2 = 82, L1 = 425, L2 = 392, H1 = 89 and H2 = 95 mm."""


@pytest.fixture
def extracted(tmp_path: Path) -> Callable[..., Manipulator]:
    """The table of a text."""

    def extracted(text: str, **options: object) -> Manipulator:
        (path := tmp_path / "arm.yaml").write_text(text)
        return dh2urdf.extract(path, reader="screws", **options)

    return extracted


def test_the_book(extracted: Callable[..., Manipulator]) -> None:
    """The UR5 of the book: T(q) that it prints, and the rows of the data sheet with the book's rounded lengths."""
    arm = extracted(BOOK)
    printed = [[0, -1, 0, 0.095], [1, 0, 0, 0.109], [0, 0, 1, 0.988], [0, 0, 0, 1]]
    assert np.abs(arm.fk([0, -np.pi / 2, 0, 0, np.pi / 2, 0]) - printed).max() < 1e-15
    assert [(row.a, row.d) for row in arm.rows] == [
        *((0, 0.089), (-0.425, 0), (-0.392, 0)),
        *((0, 0.109), (0, 0.095), (0, 0.082)),
    ]
    assert [round(row.alpha / (np.pi / 2), 15) for row in arm.rows] == [1, 0, 0, 1, -1, 0]


def test_joints_have_what_a_table_says_of_them(extracted: Callable[..., Manipulator]) -> None:
    """Names, types and limits, in the file's units; what is not said is not known."""
    joints = (
        "joints: [pan, {type: continuous, limits: {velocity: 90 deg/s, effort: 5 Nm}}, {name: elbow, link: forearm, "
        "limits: [-pi, 2], damping: 0.1 Nms/rad, friction: 0.2 Nm, armature: 0.3 kg·m²}, w1, w2, w3]\n"
    )
    pan, lift, elbow, *_, last = extracted(BOOK + joints).rows
    assert (pan.joint, pan.limits.lower, last.joint) == ("pan", None, "w3")
    assert (lift.joint, lift.type, lift.limits.velocity) == ("joint_2", JointType.CONTINUOUS, np.pi / 2)
    assert (elbow.joint, elbow.link, elbow.limits.lower, elbow.limits.upper) == ("elbow", "forearm", -np.pi, 2)
    assert (elbow.damping, elbow.friction, elbow.armature) == (0.1, 0.2, 0.3)


def test_rounded_axes_are_taken_for_what_they_are(extracted: Callable[..., Manipulator]) -> None:
    """Four digits of √½: the direction is taken, and a notice is left; an expression needs none."""
    text = (
        "{{Slist: [[{0}], [0], [{0}], [0], [0.5], [0]], M: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 1], [0, 0, 0, 1]]}}"
    )
    rounded, exact = extracted(text.format("0.7071")), extracted(text.format("sqrt(2)/2"))
    assert np.abs(rounded.fk([1.0]) - exact.fk([1.0])).max() < 2e-5
    assert any("another length than 1" in notice.message for notice in rounded.notices)
    assert not any("another length than 1" in notice.message for notice in exact.notices)


def test_in_a_run_and_in_commands(cli: Cli, tmp_path: Path) -> None:
    """The reader goes by its name, which the reader of tables gives; JSON is YAML."""
    (path := tmp_path / "ur5.yaml").write_text(BOOK)
    assert "`--from screws` reads it" in cli("convert", path, "-o", tmp_path / "ur5.urdf", status=2).stderr
    cli("convert", path, "--from", "screws", "-o", tmp_path / "ur5.urdf")
    assert cli("extract", path, "--from", "screws", "--tips").stdout == "tool0: 6 moving joints\n"
    content = {"H": np.eye(3).tolist(), "P": np.ones((3, 4)).tolist()}
    (tmp_path / "three.json").write_text(json.dumps(content))
    (tmp_path / "run.yaml").write_text(
        "inputs: [{path: ur5.yaml, stage: screws}, {path: three.json, stage: screws}]\nemitters: [urdf]\n"
        "output: {directory: out}\n"
    )
    cli("run", tmp_path / "run.yaml")
    assert sorted(each.name for each in (tmp_path / "out").glob("*.urdf")) == ["three.urdf", "ur5.urdf"]


SLIST = [[0.0], [0.0], [1.0], [0.0], [0.0], [0.0]]
UNIT = np.eye(4).tolist()
THREE = np.zeros((3, 4)).tolist()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "there are no axes in it"),
        ({"Slist": SLIST}, "there is no key M"),
        ({"Slist": SLIST, "Blist": SLIST, "M": UNIT}, "it has Slist and Blist"),
        ({"Slist": SLIST, "M": UNIT, "P": THREE}, "'P' is no key of a file of Slist"),
        ({"Slist": np.array(SLIST).T, "M": UNIT}, "exchange rows and columns: 6 rows of 1 numbers"),
        ({"Slist": [[0, 0], [0]], "M": UNIT}, "Slist is no matrix"),
        ({"Slist": [[0], [0], [2], [0], [0], [0]], "M": UNIT}, "column 1 of Slist has an axis of the length 2"),
        ({"Slist": [[0]] * 6, "M": UNIT}, "column 1 of Slist is 0: nothing moves"),
        ({"Slist": [[0], [0], [1], [0], [0], [0.1]], "M": UNIT}, "it moves 0.1 m along it for each rad"),
        ({"Slist": [[0], [0], ["one"], [0], [0], [0]], "M": UNIT}, "'one'"),
        ({"Slist": SLIST, "M": np.diag([1, 1, -1, 1])}, "the matrix of M is no rotation"),
        ({"Slist": SLIST, "M": UNIT, "joints": ["a", "b"]}, "joints is a list of 2, and there are 1 axes"),
        ({"Slist": SLIST, "M": UNIT, "joints": [{"alpha": 1}]}, "'alpha' is no key of a joint of screw axes"),
        ({"Slist": SLIST, "M": UNIT, "joints": [{"type": "prismatic"}]}, "its axis is that of a joint that turns"),
        ({"H": np.eye(3), "P": np.eye(3)}, "P has 3 columns, and H has 3"),
        ({"H": 2 * np.eye(3), "P": THREE}, "column 1 of H has an axis of the length 2"),
        ({"H": np.eye(3), "P": THREE, "R": [1, 2, 3]}, "R is a list of 3"),
        ({"H": np.eye(3), "P": THREE, "joints": ["a", "b", {"type": "fixed"}]}, "'joint_3' is fixed"),
    ],
)
def test_what_is_no_arm(given: dict[str, object], message: str) -> None:
    """What was found, and what is accepted."""
    with pytest.raises(TableError) as caught:
        dh2urdf.from_screws(**given)  # type: ignore[arg-type]  # what is wrong
    assert message in str(caught.value)
    assert any(problem.accepted for problem in caught.value.problems)
