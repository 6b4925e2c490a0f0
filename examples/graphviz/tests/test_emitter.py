from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

import dh2urdf
from dh2urdf.testing import EmitterContract, plain_robot, reference_manipulators
from dh2urdf_graphviz.emitter import EMITTER, DotOptions, emit

ARM = Path(__file__).parents[1] / "scara.csv"


class TestContract(EmitterContract):
    stage = EMITTER


class TestRadians(EmitterContract):
    stage = EMITTER
    options = DotOptions(direction="right", angles="rad")


@pytest.fixture
def robot() -> dh2urdf.Robot:
    return dh2urdf.convert(ARM).robot


def text_of(robot: dh2urdf.Robot, options: DotOptions | None = None) -> str:
    (file,) = emit(robot, "arm", options or DotOptions())
    assert file.name == "arm.dot"
    return file.content.decode()


def test_every_link_and_joint_is_there(robot: dh2urdf.Robot) -> None:
    """A node for each link, an edge for each joint."""
    lines = text_of(robot).splitlines()
    assert sum(" -> " in line for line in lines) == len(robot.joints)
    assert sum(line.startswith("  link_") and " -> " not in line for line in lines) == len(robot.links)


def test_joints_say_how_they_move(robot: dh2urdf.Robot) -> None:
    """Type, axis and limits with their unit; what turns without end has none."""
    text = text_of(robot)
    assert '"shoulder\\nrevolute about 0 0 1\\n-130.1° … 130.1°"' in text
    assert '"quill\\nprismatic along 0 0 -1\\n0 … 0.21 m"' in text
    assert '"wrist\\ncontinuous about 0 0 -1"' in text
    assert "-2.27 … 2.27 rad" in text_of(robot, DotOptions(angles="rad"))


def test_the_tree_grows_where_it_is_asked_to(robot: dh2urdf.Robot) -> None:
    """Down, or to the right."""
    assert "rankdir=TB" in text_of(robot)
    assert "rankdir=LR" in text_of(robot, DotOptions(direction="right"))


class TestDot:
    """What Graphviz itself reads."""

    @pytest.fixture(autouse=True)
    def _dot(self) -> None:
        if shutil.which("dot") is None:
            pytest.skip("Graphviz's command dot is not installed")

    @staticmethod
    def read(text: str) -> dict[str, Any]:
        drawn = subprocess.run(["dot", "-Tjson"], input=text, capture_output=True, text=True, check=True)
        assert drawn.stderr == ""
        return dict(json.loads(drawn.stdout))

    @pytest.mark.parametrize("number", range(4))
    def test_the_tree_is_that_of_the_robot(self, number: int) -> None:
        """Parents, children and names, as dot has them."""
        robot = plain_robot(reference_manipulators()[number])
        graph = self.read(text_of(robot))
        names = [node["label"].partition("\\n")[0] for node in graph["objects"]]
        assert names == [link.name for link in robot.links]
        edges = {(names[e["tail"]], names[e["head"]], e["label"].partition("\\n")[0]) for e in graph["edges"]}
        assert edges == {(joint.parent, joint.child, joint.name) for joint in robot.joints}

    @pytest.mark.parametrize("name", ['a"b', "a\\b", "a\\", "\\N", "<b>", "a&lt;b", "{x|y}", "名前", "a//b", "0x1", ""])
    def test_a_name_is_drawn_as_it_is(self, robot: dh2urdf.Robot, name: str) -> None:
        """Whatever DOT would act on."""
        first, *others = robot.joints
        shown = replace(robot, name=name, joints=(replace(first, name=name or "x"), *others))
        drawing = subprocess.run(["dot", "-Tsvg"], input=text_of(shown), capture_output=True, text=True, check=True)
        picture = ET.fromstring(drawing.stdout)  # noqa: S314 - what dot has written
        words = [text.text or "" for text in picture.iter("{http://www.w3.org/2000/svg}text")]
        assert (name or "x") in words
        assert f"{name}: 4 moving joints" in " ".join(words)
