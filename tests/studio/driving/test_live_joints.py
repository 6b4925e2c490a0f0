"""Requests of programs that move the joints of a view."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.errors import InputError
from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.live_joints import LiveJoints
from dh2urdf_studio.viewing import View, load_figures

GRIPPER = """<robot name="gripper"><link name="palm"/><link name="left"/><link name="right"/><link name="wheel"/>
<joint name="l" type="prismatic"><parent link="palm"/><child link="left"/><axis xyz="0 1 0"/>
  <limit lower="0" upper="0.08" effort="1" velocity="1"/></joint>
<joint name="r" type="prismatic"><parent link="palm"/><child link="right"/><axis xyz="0 1 0"/>
  <limit lower="-0.08" upper="0" effort="1" velocity="1"/><mimic joint="l" multiplier="-1"/></joint>
<joint name="w" type="continuous"><parent link="palm"/><child link="wheel"/><axis xyz="0 0 1"/></joint></robot>"""


@pytest.fixture
def view(catalog: Catalog, tmp_path: Path) -> View:
    (tmp_path / "gripper.urdf").write_text(GRIPPER)
    return View(load_figures([tmp_path / "gripper.urdf"], catalog))


def asked(names: Any, positions: Any) -> bytes:
    return json.dumps({"names": names, "positions": positions}).encode()


def test_joints_move_inside_their_limits(view: View) -> None:
    """As sliders have it: the nearest limit holds, a wheel goes round, and a joint that follows another one follows."""
    live = LiveJoints(View(view.figures))
    tab = live.begin(view)
    assert live.take(asked(["l", "w"], [0.05, 4])) == []
    assert tab.q == live.q == {"l": 0.05, "r": -0.05, "w": 4 - math.tau}
    assert live.take(asked(["r", "l"], [9, 0.5])) == ["l"]
    assert live.q == {"l": 0.08, "w": 4 - math.tau, "r": -0.08}
    assert live.take(asked([], [])) == []

    # A tab that is opened later has what programs gave; what a person moves, programs read.
    later = live.begin(View(view.figures))
    assert later.q == tab.q
    later.move({"l": 0.01})
    live.note(later)
    assert (live.q["l"], tab.q["l"]) == (0.01, 0.08)


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"\xff{}",
        b"[" * 100_000,
        b"[]",
        b'{"names": "l", "positions": [0.0]}',
        b'{"names": ["l"]}',
        b'{"names": ["w", "l"], "positions": [1, NaN]}',
        b'{"names": ["l"], "positions": [-Infinity]}',
        *(b'{"names": ["l"], "positions": [1' + b"0" * digits + b"]}" for digits in (400, 5000)),
        *(asked(["l"], [position]) for position in (None, True, "0.05")),
        asked([["l"]], [0.0]),
    ],
)
def test_what_cannot_be_read_moves_nothing(view: View, text: bytes) -> None:
    refused(view, text, "request-wrong")


@pytest.mark.parametrize(
    ("names", "positions", "code"),
    [
        (["l", "w"], [0.0], "names-not-positions"),
        (["l", "ll"], [0.01, 0.0], "joint-unknown"),
        (["l", "w", "w"], [0.01, 0, 1], "joint-twice"),
    ],
)
def test_what_is_wrong_moves_nothing(view: View, names: list[str], positions: list[float], code: str) -> None:
    """Of a request that is partly right no part counts; the joints that there are, are named."""
    told = refused(view, asked(names, positions), code)
    assert code != "joint-unknown" or "l, w, r" in told


def refused(view: View, text: bytes, code: str) -> str:
    live = LiveJoints(View(view.figures))
    live.begin(view)
    with pytest.raises(InputError) as error:
        live.take(text)
    assert error.value.problems[0].code == code
    assert set(view.q.values()) == set(live.q.values()) == {0.0}
    return str(error.value)
