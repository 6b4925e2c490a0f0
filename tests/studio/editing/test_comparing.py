"""A description laid upon the arm of a table."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import dh2urdf
import dh2urdf_studio
from dh2urdf.table_text import TableText
from dh2urdf_studio.editing.comparing import NAME, GivenFiles
from dh2urdf_studio.editing.opening import open_tables
from dh2urdf_studio.editing.session import Session

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog
    from dh2urdf_studio.drawing.scene import Figure

# Two links of 0.3 m and 0.2 m in a plane, the second joint 2 mm off and tilted by 1°, the tip 5 mm too far.
ARM = """<robot name="other"><link name="world"/><link name="one"/><link name="two"/><link name="ee"/>
  <joint name="first" type="continuous"><parent link="world"/><child link="one"/><axis xyz="0 0 1"/></joint>
  <joint name="second" type="continuous"><parent link="one"/><child link="two"/><origin xyz="0.3 {dy} 0" rpy="{roll} 0 0"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="end" type="fixed"><parent link="two"/><child link="ee"/><origin xyz="{reach} 0 0"/></joint></robot>"""
TABLE = TableText(
    name="planar",
    convention="standard",
    rows=({"joint": "q1", "a": "0.3", "alpha": "0", "d": "0"}, {"joint": "q2", "a": "0.2", "alpha": "0", "d": "0"}),
)


def described(catalog: Catalog, **numbers: float) -> Figure:
    text = ARM.format(**{"dy": 0.0, "roll": 0.0, "reach": 0.2, **numbers})
    found = GivenFiles([("other.urdf", text.encode())], catalog).figure("other.urdf")
    assert not isinstance(found, str)
    return found


def test_the_same_arm(catalog: Catalog) -> None:
    """Its joints move along with those of the table, by their order."""
    session = Session(catalog, TABLE)
    session.lay_beside(described(catalog))
    beside = session.beside
    assert beside
    assert beside.agreement
    assert beside.agreement.holds
    assert max(max(each) for each in beside.worst) < 1e-12
    session.move({"q1": 0.4, "q2": -0.7})
    names = [node.name for node in session.drawing.nodes]
    poses = session.drawing.poses(session.joint_values())
    tip, tool0 = (poses[names.index(name)].translation for name in (f"{NAME}ee", "tool0"))
    assert tip == pytest.approx(tool0)


@pytest.mark.parametrize("name", ["panda.yaml", "stanford.csv", "track.csv"])
def test_the_file_of_a_table_is_its_arm(catalog: Catalog, name: str) -> None:
    """In both conventions, with joints that slide, and with frames of links that are not those of the table."""
    path = Path(dh2urdf_studio.__file__).parent / "arms" / name
    content = dh2urdf.convert(path).text.encode()
    (opened, *_) = open_tables(path, catalog)
    session = Session(catalog, opened.table)
    figure = GivenFiles([("arm.urdf", content)], catalog).figure("arm.urdf")
    assert not isinstance(figure, str)
    session.lay_beside(figure)
    assert session.beside
    assert session.beside.worst
    assert max(max(each) for each in session.beside.worst) < 1e-9


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ({"dy": 0.002}, [(0.0, 0.0), (0.002, 0.0), (0.002, 0.0)]),
        (
            {"roll": math.radians(1)},
            [(0.0, 0.0), (0.0, math.radians(1)), (2 * 0.2 * math.sin(math.radians(0.5)), math.radians(1))],
        ),
        ({"reach": 0.205}, [(0.0, 0.0), (0.0, 0.0), (0.005, 0.0)]),
    ],
)
def test_where_they_part(catalog: Catalog, numbers: dict[str, float], expected: list[tuple[float, float]]) -> None:
    """The joint at which the difference begins, and the largest difference of the tip, known by hand."""
    session = Session(catalog, TABLE)
    session.lay_beside(described(catalog, **numbers))
    assert session.beside
    for found, (distance, angle) in zip(session.beside.worst, expected, strict=True):
        assert found.distance == pytest.approx(distance, rel=0.05, abs=1e-12)
        assert found.distance <= distance + 1e-12
        assert found.angle == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize(
    ("ends", "message"),
    [
        ({"tip_link": "one"}, "the description has 1 moving joints on this chain, the table 2"),
        ({"tip_link": "none"}, ""),
    ],
)
def test_another_chain(catalog: Catalog, ends: Any, message: str) -> None:
    """It is drawn all the same, and why there are no differences is there to be read."""
    session = Session(catalog, TABLE)
    session.lay_beside(described(catalog), **ends)
    assert session.beside
    assert session.beside.chain is None
    agreement = session.beside.agreement
    assert agreement.first_difference == message if agreement else "no link 'none'" in session.beside.refusal
    assert f"{NAME}ee" in [node.name for node in session.drawing.nodes]


def test_an_edit_is_compared_anew_and_taking_it_away(catalog: Catalog) -> None:
    session = Session(catalog, TABLE)
    session.lay_beside(described(catalog))
    session.edit(1, "a", "0.25")
    assert session.beside
    assert session.beside.worst[-1].distance == pytest.approx(0.05)
    session.lay_beside(None)
    assert session.beside is None
    assert not any(node.name.startswith(NAME) for node in session.drawing.nodes)


def test_what_is_no_description(catalog: Catalog) -> None:
    """A message names the file without its folder; a file that no emitter reads is no description."""
    files = GivenFiles([("in/a.urdf", b"<robot"), ("a.step", b"")], catalog)
    assert files.descriptions == ["in/a.urdf"]
    found = files.figure("in/a.urdf")
    assert isinstance(found, str)
    assert "not XML" in found
    assert "dh2urdf-" not in found
