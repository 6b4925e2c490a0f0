"""`check` names every file that a description includes and that it does not look into."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from dh2urdf.stages import Finding
from dh2urdf_check.inspection import inspect_mjcf, inspect_sdf, inspect_urdf, inspect_xacro

SPACES = 'xmlns:xi="http://www.w3.org/2001/XInclude" xmlns:xacro="http://ros.org/wiki/xacro"'
URDF = f"""<?xml version="1.0"?>
<robot name="r" {SPACES}>
<xi:include href="a.xml"/>
<include filename="b.urdf"/>
<xacro:include filename="c.xacro"/>
<link name="a"/>
</robot>
"""
SDF = """<?xml version="1.0"?>
<sdf version="1.7"><world name="w">
<include><uri>model://nowhere</uri></include>
<include><uri>https://fuel.gazebosim.org/1.0/openrobotics/models/Sun</uri></include><include><uri>package://p/m</uri></include>
<model name="arm"><link name="a"/>
<include><uri>beside</uri></include></model>
</world></sdf>
"""
MJCF = """<mujoco model="m">
<include file="part.xml"/><include file="nowhere.xml"/>
<asset>
<model name="x" file="sub.xml"/></asset>
<worldbody><body name="b"><geom size="0.1"/></body></worldbody></mujoco>
"""


def unread(findings: Sequence[Finding]) -> list[tuple[int | None, str]]:
    """Lines and messages of the notes about includes."""
    found = [each for each in findings if each.rule == "unread-include"]
    assert all(each.severity == "note" and each.fix for each in found)
    return [(each.mark.line if each.mark else None, each.message.partition("'")[2].partition("'")[0]) for each in found]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.urdf").write_text(URDF)
    (tmp_path / "arm.sdf").write_text(SDF)
    (tmp_path / "arm.xml").write_text(MJCF)
    (tmp_path / "part.xml").write_text(
        "<mujoco><worldbody><body name='c'><geom size='0.1'/></body></worldbody></mujoco>"
    )
    (tmp_path / "beside").mkdir()
    (tmp_path / "beside" / "model.sdf").write_text('<sdf version="1.7"><model name="s"><link name="a"/></model></sdf>')
    return tmp_path


def test_urdf(folder: Path) -> None:
    """A URDF has no includes: those of XInclude, of xacro and of nobody are named all the same."""
    assert unread(inspect_urdf(folder / "arm.urdf").findings) == [(3, "a.xml"), (4, "b.urdf"), (5, "c.xacro")]


def test_xacro(folder: Path) -> None:
    """What xacro includes is in the text that is checked; what is left is named where it is written."""
    pytest.importorskip("xacro")
    (folder / "c.xacro").write_text(f'<robot {SPACES}><link name="b"/>\n<include filename="d.urdf"/></robot>')
    (folder / "arm.xacro").write_text(URDF)
    findings = inspect_xacro(folder / "arm.xacro").findings
    assert unread(findings) == [(3, "a.xml"), (4, "b.urdf"), (2, "d.urdf")]


def test_sdf(folder: Path) -> None:
    """A model of the web, of a package or beside the file; one that is not there is an error of its own."""
    findings = inspect_sdf(folder / "arm.sdf").findings
    sun = "https://fuel.gazebosim.org/1.0/openrobotics/models/Sun"
    included = [
        (each.mark.line, each.message.split("'")[1]) for each in findings if each.rule == "sdf-include" and each.mark
    ]
    assert included == [(4, sun), (4, "package://p/m"), (6, "beside")]
    assert [each.message for each in findings if each.rule == "sdf-missing-include"] == [
        "'model://nowhere' is not beside the file"
    ]


def test_mjcf(folder: Path) -> None:
    """Files that an MJCF includes are looked into; models that it attaches are named."""
    findings = inspect_mjcf(folder / "arm.xml").findings
    assert unread(findings) == [(4, "sub.xml")]
    assert len([each for each in findings if each.rule == "mjcf-missing-include"]) == 1
