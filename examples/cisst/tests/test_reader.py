from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.stages import NoOptions
from dh2urdf.testing import ReaderContract
from dh2urdf_cisst.reader import READER, TYPES, read

ARM = Path(__file__).parents[1] / "arms" / "endoscope.cisst.json"
JOINT = '{"alpha": 0, "A": 0.3, "theta": 0.0, "D": 0.1}'


class TestContract(ReaderContract):
    stage = READER
    example = ARM.read_text("utf-8")


def of_text(folder: Path, text: str) -> dh2urdf.Manipulator:
    path = folder / "arm.json"
    path.write_text(text, "utf-8")
    (arm,) = read(path, NoOptions())
    return arm


def turn(axis: int, angle: float) -> np.ndarray:
    """Rotation about x (0) or z (2), as a 4x4 matrix."""
    c, s = math.cos(angle), math.sin(angle)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    T = np.eye(4)
    T[i, i] = T[j, j] = c
    T[i, j], T[j, i] = -s, s
    return T


def move(x: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, 0.0, z
    return T


def test_the_arm_is_where_cisst_has_it() -> None:
    """T(q) is base · Rx(alpha)·Tx(A)·Rz(theta)·Tz(D) of each joint with its offset · tooltip."""
    q = [0.3, -0.4, 0.15, 0.8]
    half = math.pi / 2
    expected = np.array([[0, 1, 0, 0.1], [-1, 0, 0, 0], [0, 0, 1, 0.3], [0, 0, 0, 1]])
    expected = expected @ turn(0, half) @ turn(2, 1.5708 + q[0])
    expected = expected @ turn(0, -half) @ move(0.015, 0) @ turn(2, 0.1 - 1.5708 + q[1])
    expected = expected @ turn(0, half) @ move(0, 0.05 - 0.4 + q[2])
    expected = expected @ turn(2, q[3]) @ move(0, 0.4)
    expected = expected @ np.array([[0, -1, 0, 0], [0, 0, 1, 0.01], [-1, 0, 0, 0], [0, 0, 0, 1]])
    arm = dh2urdf.read(ARM)
    np.testing.assert_allclose(arm.fk(q), expected, atol=1e-12)
    np.testing.assert_allclose(dh2urdf.convert(arm).robot.fk(q), expected, atol=1e-12)


def test_names_limits_and_places() -> None:
    """A joint has its name, its limits, its largest effort and its line."""
    arm = dh2urdf.read(ARM)
    assert arm.name == "endoscope"
    assert [row.joint for row in arm.rows] == ["yaw", "pitch", "insertion", "roll"]
    slide = arm.rows[2]
    assert (slide.limits.lower, slide.limits.upper, slide.limits.effort) == (0.0, 0.2, 70.0)
    assert [row.mark.line for row in arm.rows if row.mark] == [7, 16, 24, 32]


@pytest.mark.parametrize(
    "form", ['{"DH": {"links": [JOINT], "convention": "standard"}}', '{"convention": "standard",\t"joints": [JOINT]}']
)
def test_older_and_shorter_forms(tmp_path: Path, form: str) -> None:
    """`links` for `joints`, the table without DH around it, tabs between words."""
    arm = of_text(tmp_path, form.replace("JOINT", JOINT))
    assert (arm.name, arm.convention, arm.rows[0].a, arm.rows[0].joint) == ("arm", "standard", 0.3, "joint_1")


def test_a_convention_with_each_joint(tmp_path: Path) -> None:
    """Older files say it there; two that differ are an error."""
    joints = [JOINT.replace("{", f'{{"convention": "{word}", ') for word in ("modified", "modified", "standard")]
    assert of_text(tmp_path, f'{{"links": [{joints[0]}, {joints[1]}]}}').convention == "modified"
    with pytest.raises(TableError, match="one convention"):
        of_text(tmp_path, f'{{"links": [{joints[0]}, {joints[2]}]}}')


def test_no_comment_in_a_string(tmp_path: Path) -> None:
    """What is in a string is no comment."""
    arm = of_text(tmp_path, f'{{"convention": "standard", "joints": [{JOINT[:-1]}, "name": "a//b /* c */"}}]}}')
    assert arm.rows[0].joint == "a//b /* c */"


@pytest.mark.parametrize("word", [*TYPES, "HINGE"])
def test_words_for_types(tmp_path: Path, word: str) -> None:
    """In whatever case."""
    arm = of_text(tmp_path, f'{{"convention": "standard", "joints": [{JOINT[:-1]}, "type": "{word}"}}]}}')
    assert arm.rows[0].type is TYPES[word.lower()]


def test_masses_are_left_with_a_notice(tmp_path: Path) -> None:
    """Nobody should wonder where they went."""
    arm = of_text(tmp_path, f'{{"convention": "standard", "joints": [{JOINT[:-1]}, "mass": 1.5, "cx": 0}}]}}')
    assert "masses of the file are not read" in str(arm.notices[0])
    assert arm.rows[0].mass is None


def test_all_that_is_wrong_is_said_at_once(tmp_path: Path) -> None:
    """Every problem has its place, its joint and its key, and says what is accepted."""
    with pytest.raises(TableError) as error:
        of_text(
            tmp_path,
            '{"DH": {"convention": "modern",\n"joints": [\n{"name": "a", "alpah": 1, "A": "x", "theta": 0, "D": 0},\n'
            '{"type": "universal", "alpha": 0, "A": 0, "theta": 0, "D": 0, "qmin": 2, "qmax": 1}]},\n'
            '"base-offset": [[1, 0], [0, 1]],\n'
            '"tooltip-offset": [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}',
        )
    text = str(error.value)
    for words in (
        "arm.json:1:23: error: field 'convention': the text 'modern' is no convention",
        "accepted: standard or modified",
        "arm.json:3:24: error: joint 'a', field 'alpah': no joint has the key 'alpah'",
        "did you mean 'alpha'?",
        "joint 'a', field 'alpha': it is missing",
        "joint 'a', field 'A': the text 'x' is no number",
        "joint 'joint_2', field 'type': cisst computes with no such joint",
        "joint 'joint_2', field 'qmin': it is larger than qmax",
        "field 'base-offset': a list of 2 is no matrix",
        "field 'tooltip-offset': the matrix is no rigid transform",
    ):
        assert words in text


@pytest.mark.parametrize("text", ["{}", "[]", "7", '{"DH": 3}', '{"DH": {"joints": []}}', '{"DH": {"joints": 1}}'])
def test_what_is_no_arm(tmp_path: Path, text: str) -> None:
    """JSON of something else is an error that says what is looked for."""
    with pytest.raises(TableError, match=r"joints|object"):
        of_text(tmp_path, text)
