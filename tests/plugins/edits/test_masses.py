"""The edit `masses`: the total of a data sheet, shared out among the links of tables with masses and without."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

import dh2urdf
from dh2urdf.errors import ConfigError, EditError, TableError
from dh2urdf.manipulator import Inertia
from dh2urdf.testing import reference_manipulators
from dh2urdf_plugins.edits.masses import MassesOptions, edit_table

HEAD = "# convention: standard\n# name: arm\n"
GEOMETRY = ("hip, thigh, 0.4, pi/2, 0.1", "knee, shin, 0.3, 0.2, 0", "wrist, hand, 0.05, 0, 0.2")
TENSOR = "0.01, 0, 0, 0.02, 0.03, 0.025, 0.001, 0, 0"
TABLES = {
    "neither": "\n".join(("joint, link, a, alpha, d", *GEOMETRY)),
    "density": "\n".join(("# density: 800", "joint, link, a, alpha, d", *GEOMETRY)),
    "masses": "\n".join(
        ("joint, link, a, alpha, d, mass", *(f"{row}, {m}" for row, m in zip(GEOMETRY, (7, 3, 1), strict=True)))
    ),
    "one mass": "\n".join(
        ("joint, link, a, alpha, d, mass", *(f"{row}, {m}" for row, m in zip(GEOMETRY, ("", 3, ""), strict=True)))
    ),
    "inertias": "\n".join(
        (
            "joint, link, a, alpha, d, mass, com_x, com_y, com_z, ixx, iyy, izz, ixy, ixz, iyz",
            *(f"{row}, {m}, {TENSOR}" for row, m in zip(GEOMETRY, (7, 3, 1), strict=True)),
        )
    ),
}


def bodies(text: str) -> dict[str, tuple[float, str, np.ndarray]]:
    """Mass, place and inertia of every link that weighs something, as the URDF has them."""
    found = {}
    for link in etree.fromstring(text.encode()).iter("link"):
        if (inertial := link.find("inertial")) is not None and float(inertial.find("mass").get("value")):
            moments = np.array(
                [float(inertial.find("inertia").get(f"i{ab}")) for ab in ("xx", "yy", "zz", "xy", "xz", "yz")]
            )
            place = etree.tostring(inertial.find("origin")).decode().strip()
            found[link.get("name")] = (float(inertial.find("mass").get("value")), place, moments)
    return found


def urdf(table: Any, *edits: Any, **more: Any) -> str:
    return dh2urdf.convert(table, edits=edits, **more).text


@pytest.mark.parametrize("kind", TABLES)
@pytest.mark.parametrize("shape", ["cylinder", "arm"])
def test_the_arm_weighs_what_its_data_sheet_says(kind: str, shape: str) -> None:
    """Each link keeps its share, its centre of mass and the shape of its inertia, whatever the table says of masses."""
    table, drawn = HEAD + TABLES[kind], {"shape": shape}
    before, after = bodies(urdf(table, **drawn)), bodies(urdf(table, {"masses": {"total": "20.6 kg"}}, **drawn))
    assert math.fsum(mass for mass, *_ in after.values()) == pytest.approx(20.6, rel=1e-12)
    factor = 20.6 / math.fsum(mass for mass, *_ in before.values())
    assert before.keys() == after.keys()
    for name, (mass, place, moments) in before.items():
        assert after[name][0] == pytest.approx(factor * mass, rel=1e-12)
        assert after[name][1] == place
        assert after[name][2] == pytest.approx(factor * moments, rel=1e-12, abs=1e-18)


@pytest.mark.parametrize("kind", TABLES)
def test_what_is_held_is_taken_off_first(kind: str) -> None:
    """The base and a link have the given masses; the two others share the rest as they did before."""
    edit = {"masses": {"total": 20.6, "base": 4, "links": {"shin": "2300 g"}}}
    before, after = bodies(urdf(HEAD + TABLES[kind])), bodies(urdf(HEAD + TABLES[kind], edit))
    assert (after["base_link_inertia"][0], after["shin"][0]) == (4.0, 2.3)
    assert math.fsum(mass for mass, *_ in after.values()) == pytest.approx(20.6, rel=1e-12)
    assert after["thigh"][0] / after["hand"][0] == pytest.approx(before["thigh"][0] / before["hand"][0], rel=1e-12)
    for name, (mass, _, moments) in before.items():
        assert after[name][2] == pytest.approx(moments * after[name][0] / mass, rel=1e-12, abs=1e-18)


def test_meshes_weigh_by_their_volumes(tmp_path: Path) -> None:
    """A cube and a box three times as long share 8 kg as 2 and 6; the payload is no part of the total."""
    trimesh = pytest.importorskip("trimesh")
    for name, size in (("one", (0.125, 0.125, 0.125)), ("three", (0.125, 0.125, 0.375))):
        trimesh.creation.box(extents=size).export(tmp_path / f"{name}.stl")
    (tmp_path / "arm.yaml").write_text(
        "convention: standard\npayload: {mass: 5}\njoints:\n"
        "- {name: hip, link: thigh, a: 0.4, alpha: 0, d: 0, visual: one.stl}\n"
        "- {name: knee, link: shin, a: 0.3, alpha: 0, d: 0, visual: three.stl}\n"
    )
    after = bodies(urdf(tmp_path / "arm.yaml", {"masses": {"total": 12, "base": 4}}))
    assert [after[name][0] for name in ("thigh", "shin", "payload")] == pytest.approx([2.0, 6.0, 5.0], rel=1e-9)
    long, wide = 6.0 / 12 * (0.125**2 + 0.375**2), 6.0 / 12 * (0.125**2 + 0.125**2)
    assert np.sort(after["shin"][2][:3]) == pytest.approx([wide, long, long], rel=1e-12)


def efforts(text: str) -> list[str]:
    return [limit.get("effort") for limit in etree.fromstring(text.encode()).iter("limit")]


def test_efforts_are_those_of_the_new_masses() -> None:
    """As of a table in which somebody has written these masses; efforts that the table gives stay."""
    edited = urdf(HEAD + TABLES["neither"], {"masses": {"total": 60}})
    masses = [bodies(edited)[name][0] for name in ("thigh", "shin", "hand")]
    rows = "".join(f"{row}, {mass!r}\n" for row, mass in zip(GEOMETRY, masses, strict=True))
    assert efforts(edited) == efforts(urdf(f"{HEAD}joint, link, a, alpha, d, mass\n{rows}"))
    assert efforts(edited) != efforts(urdf(HEAD + TABLES["neither"]))
    given = HEAD + "\n".join(("joint, link, a, alpha, d, effort", *(f"{row}, 42" for row in GEOMETRY)))
    assert efforts(urdf(given, {"masses": {"total": 60}})) == ["42"] * 3


def test_many_at_once_weigh_what_each_weighs_by_itself(tmp_path: Path) -> None:
    """Variants without masses: a run makes them side by side, each with its own volumes as weights."""
    (tmp_path / "arm.csv").write_text(HEAD + TABLES["one mass"])
    edits = "edits: [{stage: masses, options: {total: 20.6, base: 4}}]\n"
    run = (
        f"inputs: arm.csv\n{edits}emitters: EMITTERS\noutput: out\nreport: {{html: false}}\n"
        "variations: {of: arm, count: 40, vary: {joints: all, field: a, scale: [0.5, 1.5]}}\nsample: {first: 0}\n"
    )
    files = []
    for emitters in ("[urdf]", "[urdf, xacro]"):  # xacro is made one by one
        (tmp_path / "run.yaml").write_text(run.replace("EMITTERS", emitters))
        dh2urdf.run(tmp_path / "run.yaml")
        files.append({path.name: path.read_text() for path in (tmp_path / "out").glob("arm_*.urdf")})
    assert files[0] == files[1]
    assert len(files[0]) == 40
    shares = set()
    for text in files[0].values():
        found = bodies(text)
        assert math.fsum(mass for mass, *_ in found.values()) == pytest.approx(20.6, rel=1e-12)
        shares.add(found["thigh"][0])
    assert len(shares) == 40


def test_each_arm_of_a_cell_has_the_total(tmp_path: Path) -> None:
    """The edits of a run change every arm of its cells."""
    (tmp_path / "arm.csv").write_text(HEAD + TABLES["neither"])
    (tmp_path / "run.yaml").write_text(
        "inputs: arm.csv\nedits: [{stage: masses, options: {total: 20.6}}]\noutput: out\nreport: {html: false}\n"
        "cells: {name: pair, arms: [{name: l, of: arm}, {name: r, of: arm, xyz: [0, 1, 0]}]}\n"
    )
    dh2urdf.run(tmp_path / "run.yaml")
    pair = bodies((tmp_path / "out" / "pair.urdf").read_text())
    assert math.fsum(mass for mass, *_ in pair.values()) == pytest.approx(41.2, rel=1e-12)


WEIGHED = replace(
    reference_manipulators()[0],
    base_mass=2.0,
    rows=tuple(
        replace(row, link=f"link_{n}", mass=float(n), inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0))
        for n, row in enumerate(reference_manipulators()[0].rows, start=1)
    ),
)


@pytest.mark.parametrize(
    "options",
    [
        MassesOptions(total=4.0, base=4.0),
        MassesOptions(total=4.0, links={"link_1": 5.0}),
        MassesOptions(total=30.0, base=1.0, links={f"link_{n}": 1.0 for n in range(1, 7)}),
        MassesOptions(total=30.0, links={"link1": 1.0}),
    ],
)
def test_what_cannot_be_is_refused(options: MassesOptions) -> None:
    """Less than what is held, all held and another total, an unknown link."""
    with pytest.raises(EditError) as refused:
        edit_table(WEIGHED, options)
    assert len(refused.value.problems) == 1
    if "link1" in options.links:
        assert "link_1" in str(refused.value.problems[0].suggestion)


@pytest.mark.parametrize("wrong", [{"total": 0}, {"total": -1}, {"base": -1}, {"links": {"shin": 0}}, {"total": "2 m"}])
def test_no_mass_is_refused_before_anything_is_made(wrong: dict[str, Any]) -> None:
    with pytest.raises(ConfigError):
        urdf(HEAD + TABLES["neither"], {"masses": wrong})


def test_a_density_that_was_used_is_no_mistake() -> None:
    """It decided on the shares, and is no statement without effect after the edit."""
    assert dh2urdf.convert(HEAD + TABLES["density"], edits=[{"masses": {"total": 3}}]).notices == ()


def test_a_link_whose_mass_nobody_knows_is_refused() -> None:
    """As of a transform whose robot has no such link."""
    rows = (replace(WEIGHED.rows[0], mass=None), *WEIGHED.rows[1:])
    with pytest.raises(EditError) as refused:
        edit_table(replace(WEIGHED, rows=rows), MassesOptions(total=30.0))
    assert refused.value.problems[0].code == "masses-unknown"


def test_all_may_be_held() -> None:
    """With the total or without: then these are the masses, and inertias go with them."""
    links = {f"link_{n}": 1.0 for n in range(1, 7)}
    for total in (None, 7.0):
        edited = edit_table(WEIGHED, MassesOptions(total=total, base=1.0, links=links))
        assert [row.mass for row in edited.rows] == [1.0] * 6
        assert edited.base_mass == 1.0
        assert edited.rows[3].inertia == Inertia(ixx=0.25, iyy=0.25, izz=0.25)


def test_a_table_that_no_robot_is_made_of_is_refused_by_its_transform() -> None:
    """Whose problems are reported, such as a negative mass."""
    rows = TABLES["masses"].replace(", 7", ", -7")
    with pytest.raises(TableError):
        urdf(HEAD + rows, {"masses": {"total": 3}})


def test_what_is_not_named_keeps_its_density() -> None:
    """Without a total, a link without a mass weighs what its shape does, also after an edit of its length."""
    table, edits = HEAD + TABLES["density"], [{"masses": {"links": {"hand": 2}}}, {"values": {"hip": {"a": "*2"}}}]
    both = [bodies(urdf(table, *order)) for order in (edits, edits[::-1])]
    assert both[0]["hand"][0] == 2.0
    assert {name: body[:2] for name, body in both[0].items()} == {name: body[:2] for name, body in both[1].items()}
