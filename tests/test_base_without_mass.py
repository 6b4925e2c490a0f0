"""An arm whose links all have masses gets no invented mass of the base: Gazebo drops such a URDF, and a notice says so."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from lxml import etree

import dh2urdf

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from conftest import Answer

    Cli = Callable[..., Answer]

HEADER = "# convention: standard\njoint,type,a,alpha,d,mass\n"
WEIGHED = HEADER + "one,R,0.3,pi/2,0,3\ntwo,P,0.2,0,0,2\n"
TABLES = {
    "weighed": WEIGHED,
    "stated": "# base: {mass: 0}\n" + HEADER + "one,R,0.3,pi/2,0,\n",
    "with base": "# base: {mass: 2}\n" + WEIGHED,
    "unweighed": HEADER + "one,R,0.3,pi/2,0,\n",
    "fixed first": HEADER + "stand,F,0,0,0.5,4\none,R,0.3,pi/2,0,3\n",
}
DROPS, FILLED = "Gazebo drops the whole arm of this URDF", "this file gives it 1 kg"
RIDER = "Gazebo drops an arm of this URDF that stands on another arm"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in TABLES.items():
        (tmp_path / f"{name}.csv").write_text(text)
    return tmp_path


def notices(folder: Path, table: str, emitter: str, options: dict[str, Any]) -> list[str]:
    """What is said of the mass of the base of a table."""
    made = dh2urdf.convert(folder / f"{table}.csv", formats=emitter, **options)
    return [notice.message for notice in made.notices if notice.field == "base.mass"]


@pytest.mark.parametrize(
    ("table", "emitter", "options", "said"),
    [
        ("weighed", "urdf", {}, DROPS),
        ("weighed", "urdf", {"profile": "ros"}, DROPS),
        ("weighed", "xacro", {}, DROPS),
        ("stated", "urdf", {}, DROPS),
        ("weighed", "urdf", {"profile": "gazebo"}, FILLED),
        ("weighed", "sdf", {}, FILLED),
        ("weighed", "urdf", {"profile": "mujoco"}, ""),
        ("weighed", "mjcf", {}, ""),
        ("with base", "urdf", {}, ""),
        ("with base", "sdf", {}, ""),
        ("unweighed", "urdf", {}, ""),
        ("fixed first", "urdf", {}, ""),
    ],
)
def test_the_notice_names_gazebo(folder: Path, table: str, emitter: str, options: dict[str, Any], said: str) -> None:
    """There is one where the file's base has no mass, or one that the table does not state; none elsewhere."""
    found = notices(folder, table, emitter, options)
    assert len(found) == bool(said)
    assert all(said in message for message in found)


@pytest.mark.parametrize("table", ["weighed", "with base", "fixed first", "unweighed"])
def test_it_is_the_finding_of_check(folder: Path, table: str) -> None:
    """`dh2urdf check`, by code of its own, declares about the written file that Gazebo drops it, in the same cases."""
    made = dh2urdf.convert(folder / f"{table}.csv", folder / "arm.urdf")
    rules = {finding.rule for finding in dh2urdf.check(folder / "arm.urdf").findings}
    assert ("weightless-root" in rules) == any(DROPS in notice.message for notice in made.notices)


def test_a_run_prints_it_once(folder: Path, cli: Cli) -> None:
    """Of many arms and formats it is printed once, and the others are counted; each row of the report has it."""
    rows = "".join(f"arm{i},one,R,0.3,pi/2,0,{1 + i}\n" for i in range(30))
    (folder / "arms.csv").write_text("# convention: standard\nrobot,joint,type,a,alpha,d,mass\n" + rows)
    inputs = "inputs: [arms.csv, weighed.csv, with base.csv]\n"
    (folder / "run.yaml").write_text(f"{inputs}emitters: [urdf, xacro]\noutput: o\n")
    answer = cli("run", "run.yaml")
    assert answer.stderr.count(DROPS) == 1
    assert "base: {mass: …}" in answer.stderr
    assert "profile: gazebo" in answer.stderr
    assert "and 30 more notices: the manifest has all of them" in answer.stderr
    report = json.loads((folder / "o" / "report.json").read_bytes())
    said = {row["name"]: [notice["message"] for notice in row["notices"]] for row in report["manipulators"]}
    assert said.pop("with base") == []
    assert len(said) == 31
    assert all(sum(DROPS in message for message in own) == 1 for own in said.values())


CELL = """inputs: [weighed.csv, unweighed.csv]
cells:
  - name: shop
    arms: [{name: one, of: weighed}, {name: two, of: unweighed, xyz: [1, 0, 0]}, {name: up, of: weighed, parent: two/tool0}]
output: o
"""


def masses(path: Path) -> dict[str, float]:
    """The mass of each link of a URDF or SDF that has one [kg]."""
    found = {}
    for link in etree.parse(path).iter("link"):
        mass = link.find("inertial/mass")
        if mass is not None:
            found[str(link.get("name"))] = float(mass.get("value") or mass.text or "0")
    return found


def test_a_cell_of_such_arms(folder: Path, cli: Cli) -> None:
    """Such arms go into a cell, and the notice is that of an arm by itself; the others of the cell change nothing."""
    (folder / "run.yaml").write_text(CELL + "emitters: [urdf]\n")
    cli("run", "run.yaml", "--quiet")
    report = json.loads((folder / "o" / "report.json").read_bytes())
    said = {row["name"]: DROPS in json.dumps(row["notices"]) for row in report["manipulators"]}
    assert said == {"weighed": True, "unweighed": False, "shop": True}
    found = masses(folder / "o" / "shop.urdf")
    assert (found["one_base_link_inertia"], found["up_base_link_inertia"]) == (0.0, 0.0)


@pytest.mark.parametrize("emitters", ["[sdf]", "[{stage: urdf, options: {profile: gazebo}}]"])
def test_what_gazebo_gets_of_a_cell(folder: Path, cli: Cli, emitters: str) -> None:
    """The base at rest without a mass gets one; no other link does, such as the base of an arm on a link that moves."""
    (folder / "run.yaml").write_text(CELL + f"emitters: {emitters}\n")
    cli("run", "run.yaml", "--quiet")
    (path,) = [path for path in (folder / "o").iterdir() if path.stem == "shop"]
    found = masses(path)
    assert found["one_base_link_inertia"] == 1.0
    assert 0 < found["two_base_link_inertia"] < 1.0
    (shop,) = (
        row for row in json.loads((folder / "o" / "report.json").read_bytes())["manipulators"] if row["name"] == "shop"
    )
    assert (RIDER in json.dumps(shop["notices"])) == ("urdf" in emitters)
    roots = ("one_base_link", "two_base_link", "up_base_link", "up_base_link_inertia")
    assert [found.get(name, 0.0) for name in roots] == [0.0] * 4
