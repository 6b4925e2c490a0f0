"""What docs/coming-from.md says of the Robotics Toolbox for Python is what the toolbox does."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dh2urdf

PAGE = Path(__file__).parents[1] / "docs" / "coming-from.md"


def _turn(link: Any, q: float) -> float:
    x = link.A(q).R[:, 0]
    return float(np.arctan2(x[1], x[0]))


def _no_theta(rtb: Any) -> None:
    with pytest.raises(ValueError, match="theta"):
        rtb.DHLink(theta=0.5, sigma=0)
    assert _turn(rtb.RevoluteDH(offset=0.5), 0.2) == pytest.approx(0.7)


def _no_d(rtb: Any) -> None:
    with pytest.raises(ValueError, match="prismatic"):
        rtb.DHLink(d=0.4, sigma=1)
    assert rtb.PrismaticDH(offset=0.1).A(0.2).t == pytest.approx([0, 0, 0.3])


def _flip(rtb: Any) -> None:
    link = rtb.RevoluteDH(offset=0.5, flip=True)
    assert _turn(link, 0.2) == pytest.approx(0.3)
    (row,) = dh2urdf.from_roboticstoolbox(rtb.DHRobot([link])).rows
    assert (row.sign, row.offset) == (-1, 0.5)


def _limits(rtb: Any) -> None:
    robot = rtb.DHRobot([rtb.RevoluteDH(a=0.3, qlim=[-1, 1])])
    assert robot.fkine([2.0]).t == pytest.approx([0.3 * np.cos(2), 0.3 * np.sin(2), 0])


def _named(rtb: Any) -> None:
    link = rtb.RevoluteDH(d=0.1, a=0.3, alpha=0.5)
    assert link.A(0).t == pytest.approx([0.3, 0, 0.1])
    assert (link.d, link.a, link.alpha) == (0.1, 0.3, 0.5)


def _modified(rtb: Any) -> None:
    cos, sin = np.cos, np.sin
    tilt = np.array([[1, 0, 0, 0.3], [0, cos(0.5), -sin(0.5), 0], [0, sin(0.5), cos(0.5), 0], [0, 0, 0, 1]])
    turn = np.array([[cos(0.2), -sin(0.2), 0, 0], [sin(0.2), cos(0.2), 0, 0], [0, 0, 1, 0.1], [0, 0, 0, 1]])
    np.testing.assert_allclose(rtb.RevoluteMDH(d=0.1, a=0.3, alpha=0.5).A(0.2).A, tilt @ turn, atol=1e-12)


SENTENCES: dict[str, Callable[[Any], None]] = {
    "A revolute link has no theta": _no_theta,
    "A prismatic link has no d": _no_d,
    "With `flip`": _flip,
    "`qlim` is a note": _limits,
    "The numbers of a link are named": _named,
    "`RevoluteMDH` is the modified convention": _modified,
}
"""What tries each sentence of the list, by its beginning."""


@pytest.mark.parametrize("beginning", SENTENCES)
def test_the_toolbox_does_so(beginning: str) -> None:
    SENTENCES[beginning](pytest.importorskip("roboticstoolbox"))


def test_every_sentence_is_tried() -> None:
    text = PAGE.read_text("utf-8").partition("does with the numbers of a link:")[2].partition("The way back")[0]
    sentences = [line[2:] for line in text.splitlines() if line.startswith("- ")]
    assert len(sentences) == len(SENTENCES)
    assert all(line.startswith(tuple(SENTENCES)) for line in sentences)
