"""Links whose meshes, centres of mass and inertias stay when lengths change: one notice with the gap."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from solids import STL

import dh2urdf
from dh2urdf.fields import replace_unchecked
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator, MeshFile, MeshShape
from dh2urdf.rotations import RigidTransform
from dh2urdf.variations.drawn_links import mesh_gap, other_lengths, torn_links

TORN = """\
name: torn
convention: standard
joints:
  - {name: lift, a: -0.6, alpha: 0, d: 0, mass: 8.393, com: [0.145, 0, 0.136],
     inertia: {ixx: 0.0151, iyy: 0.2269, izz: 0.2269}, visual: {xyz: [0.425, 0, 0.136], file: upperarm.stl}}
  - {name: elbow, a: -0.392, alpha: 0, d: 0}
"""
"""Two links of a UR5, the first of which was 0.425 m long."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "upperarm.stl").write_bytes(STL)
    (tmp_path / "torn.yaml").write_text(TORN)
    (tmp_path / "good.yaml").write_text(TORN.replace("a: -0.6", "a: -0.425").replace("name: torn", "name: good"))
    return tmp_path


def shape(x: float, y: float = 0.0, z: float = 0.0) -> MeshShape:
    file = MeshFile(path="/upperarm.stl", sha256="0" * 64)
    return MeshShape(file=file, pose=RigidTransform((1, 0, 0, 0, 1, 0, 0, 0, 1), (x, y, z)))


def row(name: str, **said: Any) -> DHRow:
    return DHRow(joint=name, link=f"{name}_link", **({"a": 0.0, "alpha": 0.0, "d": 0.0} | said))


def arm(*rows: DHRow, convention: str = "standard", **said: Any) -> Manipulator:
    return Manipulator(name="arm", convention=Convention(convention), rows=rows, **said)


class TestTypedLengths:
    def test_a_mesh_that_was_drawn_for_another_a(self, folder: Path) -> None:
        """The gap is that of the joint's axis from the mesh: 0.6 - 0.425 m."""
        with pytest.warns(dh2urdf.TableWarning, match="175 mm") as caught:
            made = dh2urdf.convert(folder / "torn.yaml")
        (notice,) = (notice for notice in made.robot.notices if notice.field == "a")
        assert (notice.joint, notice.mark and notice.mark.line) == ("lift", 4)
        assert sum("175 mm" in str(each.message) for each in caught) == 1

    @pytest.mark.parametrize("alpha", [0.0, math.pi / 2, -math.pi / 2, 0.3])
    def test_the_gap_is_that_from_the_axis(self, alpha: float) -> None:
        """Computed from the DH product: the distance of the mesh's origin from the axis of the joint, in any column."""
        along = 0.136
        origin = (0.425, math.sin(alpha) * along, math.cos(alpha) * along)
        lengths = [-0.45, -0.6, -0.425]
        gaps = []
        for a in lengths:
            frame = arm(row("lift", a=a, alpha=alpha, d=0.2)).fk([0.7])
            inverse = np.linalg.inv(frame)
            start, axis = inverse[:3, 3], inverse[:3, 2]
            gaps.append(np.linalg.norm(np.cross(np.array(origin) - start, axis)))
        typed = row("lift", alpha=alpha, d=0.2, a=lengths[0], visual=shape(*origin))
        assert mesh_gap(typed) == pytest.approx(gaps[0], abs=1e-12)
        column = replace_unchecked(typed, a=np.array(lengths))
        assert mesh_gap(column) == pytest.approx(gaps, abs=1e-12)

    @pytest.mark.parametrize(
        "silent",
        [
            row("lift", a=-0.6),
            row("lift", a=-0.6, visual=shape(0.0)),  # in the frame after the row
            row("lift", a=-0.6, visual=shape(0.3)),  # in the middle of the link, as that of a box
            row("lift", a=-0.6, visual=shape(-0.5)),  # beyond the frame
            row("lift", a=-0.6, visual=shape(0.5, 0.1)),  # drawn from anywhere
        ],
    )
    def test_what_says_nothing_of_lengths(self, silent: DHRow) -> None:
        """Meshes that begin at their joint, and those that were drawn from another place."""
        assert list(other_lengths(arm(silent))) == []
        assert list(other_lengths(arm(replace(silent, visual=None, collision=silent.visual)))) == []

    def test_modified_tables_do_not_tell(self) -> None:
        """There a mesh begins at the origin of its frame, whatever the row says."""
        assert list(other_lengths(arm(row("lift", a=-0.6, visual=shape(0.5)), convention="modified"))) == []


BODY: dict[str, Any] = {"mass": 1.0, "com": (0.1, 0.0, 0.0)}


class TestChangedLengths:
    @pytest.mark.parametrize("convention", ["standard", "modified"])
    def test_the_gap_is_that_of_the_frames(self, convention: str) -> None:
        """By how far the joint moves in the frame of what is drawn; that frame is before the row in the modified one."""
        before = arm(row("one", a=0.3, d=0.1, **BODY), row("two", a=0.2, d=0.1, **BODY), convention=convention)
        after = replace(before, rows=(before.rows[0], replace(before.rows[1], a=0.25, d=0.22)))
        (notice,) = torn_links(before, after, "the edits change")
        step = [
            np.linalg.inv(table.fk_all([0, 0])["one_link"]) @ table.fk_all([0, 0])["two_link"]
            for table in (before, after)
        ]
        gap = np.linalg.norm((step[1] - step[0])[:3, 3])
        assert f"{1e3 * gap:.4g} mm" in notice.message
        assert f"'{'two_link' if convention == 'standard' else 'one_link'}'" in notice.message
        assert (notice.code, notice.joint, notice.field) == ("mesh-off-drawn-link", "two", "d")

    def test_of_a_base(self) -> None:
        """In the modified convention its mesh ends at the first joint."""
        before = arm(row("one", a=0.3), convention="modified", base_visual=shape(0.0))
        (notice,) = torn_links(before, replace(before, rows=(row("one", a=0.4),)), "the edits change")
        assert all(word in notice.message for word in ("'base_link_inertia'", "100 mm"))

    @pytest.mark.parametrize(
        ("old", "new"),
        [
            (row("one", a=0.3), row("one", a=0.4)),  # nothing is drawn
            (row("one", a=0.3, **BODY), row("one", a=0.3009, **BODY)),  # calibrated
            (row("one", a=0.3, **BODY), row("one", a=0.3, theta=1.0, offset=2.0, **BODY)),  # turned about its joint
            (row("one", d=0.3, type=JointType.PRISMATIC, **BODY), row("one", d=0.5, type=JointType.PRISMATIC, **BODY)),
        ],
    )
    def test_what_does_not_tear(self, old: DHRow, new: DHRow) -> None:
        """Rows without anything drawn, small changes, other zeros of a joint."""
        assert list(torn_links(arm(old), arm(new), "the edits change")) == []

    def test_an_edit(self, folder: Path) -> None:
        """Of a calibration that makes the link longer: once, with the gap, and not again as a typed length."""
        (folder / "calibration.csv").write_text(
            "# convention: standard\njoint, a, alpha, d, theta\nlift, -0.175, 0, 0, 0\n"
        )
        edit = {"calibrate": {"file": str(folder / "calibration.csv")}}
        notices = dh2urdf.convert(folder / "good.yaml", edits=[edit]).robot.notices
        (notice,) = (notice for notice in notices if notice.field == "a")
        assert notice.code == "mesh-off-drawn-link"
        assert all(word in notice.message for word in ("'link_1'", "175 mm"))

    def test_a_variation_says_it_once(self, folder: Path, cli: Cli) -> None:
        """Of 300 variants the first, with the farthest that the law draws; a variation of other fields says nothing."""
        (folder / "run.yaml").write_text(
            "inputs: good.yaml\noutput: out\n"
            "variations:\n"
            "  - {of: good, count: 300, vary: [{joints: [1], field: a, scale: [0.8, 1.1]}]}\n"
            "  - {name: other, of: good, count: 9, vary: [{joints: [1], field: mass, scale: [0.8, 1.1]}]}\n"
        )
        printed = cli("run", "run.yaml").stderr
        assert printed.count(" 85 mm") == printed.count("run.yaml:4:") == 1
        report = json.loads((folder / "out" / "report.json").read_bytes())
        told = [(row["name"], each["code"]) for row in report["manipulators"] for each in row["notices"]]
        assert ("good_001", "mesh-off-drawn-link") in told
        assert [code for _, code in told].count("mesh-off-drawn-link") == 1
