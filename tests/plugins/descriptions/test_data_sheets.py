"""Known arms as their descriptions place the joints: the rows that their makers or the literature publish come back."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml
from lxml import etree

import dh2urdf

ARMS: dict[str, Any] = yaml.safe_load(Path(__file__).with_name("data_sheets.yaml").read_text("utf-8"))
PI = {"pi": math.pi, "-pi": -math.pi, "pi/2": math.pi / 2, "-pi/2": -math.pi / 2}


def description(joints: list[dict[str, str]]) -> str:
    """A URDF of the joints alone."""
    robot = etree.Element("robot", name="arm")
    links = [f"link_{number}" for number in range(len(joints))] + ["tool0"]
    for name in links:
        etree.SubElement(robot, "link", name=name)
    for number, placed in enumerate(joints):
        kind = placed.get("type", "revolute")
        joint = etree.SubElement(robot, "joint", name=f"joint_{number}", type=kind)
        etree.SubElement(joint, "parent", link=links[number])
        etree.SubElement(joint, "child", link=links[number + 1])
        etree.SubElement(joint, "origin", xyz=placed["xyz"], rpy=placed.get("rpy", "0 0 0"))
        etree.SubElement(joint, "axis", xyz=placed.get("axis", "0 0 1"))
        if kind != "fixed":
            etree.SubElement(joint, "limit", lower="-1", upper="1", effort="10", velocity="1")
    return etree.tostring(robot, encoding="unicode")


@pytest.mark.parametrize(("arm", "convention"), [(arm, convention) for arm in ARMS for convention in ARMS[arm]["rows"]])
def test_the_published_rows(arm: str, convention: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(description(ARMS[arm]["joints"]), "utf-8")
    found = dh2urdf.extract(path, convention=convention)
    for row, published in zip(found.rows, ARMS[arm]["rows"][convention], strict=True):
        wanted = [PI.get(number, number) for number in published]
        assert (row.a, row.alpha, row.d, row.theta) == pytest.approx(wanted, abs=1e-10), found.rows
