"""URDF 1.2, where it is asked for: limits of acceleration and jerk, and capsules, as other programs read them."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from pinocchio_frames import pinocchio_frames

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.manipulator import JointType, LinkGeometry, Manipulator
from dh2urdf.robot import Cylinder, Sphere
from dh2urdf_plugins.formats import read_urdf

TABLES = Path(__file__).parents[3] / "configs" / "tables"
RADIUS = 0.03


def with_limits(arm: Manipulator, *, is_fast: bool = True) -> Manipulator:
    """An arm drawn as capsules; every second joint has an acceleration and every third a jerk, where it `is_fast`."""
    rows = [
        replace(row, limits=replace(row.limits, acceleration=acceleration, jerk=jerk))
        for number, row in enumerate(arm.rows)
        for moves in [is_fast and row.type is not JointType.FIXED]
        for acceleration in [7.25 + number if moves and number % 2 == 0 else None]
        for jerk in [130.5 * (number + 1) if moves and number % 3 == 0 else None]
    ]
    return replace(arm, rows=tuple(rows), geometry=LinkGeometry(shape="capsule", radius=RADIUS))


@pytest.fixture(params=["ur5.csv", "panda.yaml", "scara.csv"])
def arm(request: pytest.FixtureRequest) -> Manipulator:
    return with_limits(dh2urdf.read(TABLES / request.param))


@pytest.fixture
def files(arm: Manipulator, tmp_path: Path) -> tuple[Path, Path]:
    """The URDF of an arm as it is by default, and that of version 1.2."""
    for name, version in (("old", "1.0"), ("new", "1.2")):
        dh2urdf.convert(arm, tmp_path / f"{name}.urdf", version=version)
    return tmp_path / "old.urdf", tmp_path / "new.urdf"


def shapes(path: Path) -> list[tuple[float, ...]]:
    """The round shapes that are seen in a file: radius, length and place; what is there twice is there once."""
    seen = {
        (number, geometry.radius, getattr(geometry, "length", 0.0), *np.round(visual.origin.xyz, 12) + 0.0)
        for number, link in enumerate(read_urdf(path).links)
        for visual in link.visuals
        for geometry in [visual.geometry]
        if isinstance(geometry, Cylinder | Sphere)
    }
    return sorted(seen)


class TestTheFile:
    def test_nothing_is_in_a_file_that_does_not_ask_for_it(self, arm: Manipulator) -> None:
        """It is that of a table without accelerations, byte for byte, and no notice tells of them."""
        fast, plain = dh2urdf.convert(arm), dh2urdf.convert(with_limits(arm, is_fast=False))
        assert fast.text == plain.text
        assert fast.notices == plain.notices

    def test_what_is_in_a_file_of_version_1_2(self, arm: Manipulator, files: tuple[Path, Path]) -> None:
        """The numbers of the table are attributes, to the last bit; the rest is what the other file has."""
        old, new = (ET.parse(file).getroot() for file in files)  # noqa: S314
        assert (old.get("version"), new.get("version")) == (None, "1.2")
        written = {joint.get("name"): joint.find("limit") for joint in new.iter("joint")}
        for row in arm.moving_rows:
            for name in ("acceleration", "jerk"):
                text = written[row.joint].attrib.pop(name, None)
                assert (text and float(text)) == getattr(row.limits, name)
        assert [joint.attrib for joint in new.iter("limit")] == [joint.attrib for joint in old.iter("limit")]
        assert len(list(new.iter("capsule"))) >= 2
        assert {sphere.get("radius") for sphere in new.iter("sphere")} <= {f"{RADIUS}"}  # of joints without segments
        assert shapes(files[0]) == shapes(files[1])

    def test_an_expanded_xacro_has_the_same(self, arm: Manipulator, files: tuple[Path, Path], tmp_path: Path) -> None:
        xacro = pytest.importorskip("xacro")
        dh2urdf.convert(arm, tmp_path / "arm.urdf.xacro", version="1.2")
        root = ET.fromstring(xacro.process_file(str(tmp_path / "arm.urdf.xacro")).toxml())  # noqa: S314
        direct = ET.parse(files[1]).getroot()  # noqa: S314
        assert root.get("version") == "1.2"
        for tag in ("limit", "capsule", "sphere", "cylinder"):
            expanded, written = ([each.attrib for each in tree.iter(tag)] for tree in (root, direct))
            assert [sorted(each) for each in expanded] == [sorted(each) for each in written]
            for one, other in zip(expanded, written, strict=True):
                assert {name: float(text) for name, text in one.items()} == pytest.approx(
                    {name: float(text) for name, text in other.items()}, rel=1e-15, abs=0.0
                )

    def test_it_becomes_the_table_again(self, arm: Manipulator, files: tuple[Path, Path]) -> None:
        """`extract` finds both, and tells of nothing that is left out."""
        back = dh2urdf.extract(files[1])
        for row, again in zip(arm.moving_rows, back.moving_rows, strict=True):
            assert again.limits.acceleration == row.limits.acceleration
            assert again.limits.jerk == row.limits.jerk
        assert not any("of a limit" in notice.message for notice in back.notices)


class TestReaders:
    def test_pinocchio(self, files: tuple[Path, Path]) -> None:
        """Pinocchio finds the poses and limits of the other file, and capsules in place of their parts."""
        pin = pytest.importorskip("pinocchio")
        old, new = (pin.buildModelFromUrdf(str(file)) for file in files)
        for name in ("lowerPositionLimit", "upperPositionLimit", "velocityLimit", "effortLimit"):
            assert np.array_equal(getattr(old, name), getattr(new, name))
        before, after = (pinocchio_frames(file) for file in files)
        for q in np.random.default_rng(12).uniform(-1.0, 1.0, (20, old.nv)):
            values = dict(zip([*old.names][1:], q, strict=True))
            assert np.array_equal(before(values, "tool0"), after(values, "tool0"))
        seen = pin.buildGeomFromUrdf(new, str(files[1]), pin.GeometryType.VISUAL)
        drawn = [each.geometry for each in seen.geometryObjects if type(each.geometry).__name__ == "Capsule"]
        written = [each.attrib for each in ET.parse(files[1]).getroot().iter("capsule")]  # noqa: S314
        assert [(each.radius, 2.0 * each.halfLength) for each in drawn] == [
            (float(each["radius"]), float(each["length"])) for each in written
        ]

    def test_mujoco(self, files: tuple[Path, Path]) -> None:
        """MuJoCo takes the file, with as many capsules, which are as long."""
        mujoco = pytest.importorskip("mujoco")
        model = mujoco.MjModel.from_xml_path(str(files[1]))
        capsules = model.geom_type == mujoco.mjtGeom.mjGEOM_CAPSULE
        lengths = [float(each.get("length", 0)) for each in ET.parse(files[1]).getroot().iter("capsule")]  # noqa: S314
        assert sorted(2.0 * model.geom_size[capsules, 1]) == pytest.approx(sorted(lengths), abs=1e-12)

    def test_check_knows_it(self, files: tuple[Path, Path], cli: Callable[..., Any]) -> None:
        """It foretells nothing for readers that take the file, and that urdfdom of ROS 2 refuses its version."""
        found = {}
        for name in ("pinocchio", "mujoco", "ros"):
            status = int(name == "ros")
            report = json.loads(
                cli("check", str(files[1]), "--no-ask", "--for", name, "--format", "json", status=status).stdout
            )
            found[name] = {finding["rule"] for finding in report["findings"] if finding["severity"] != "note"}
        assert found == {"pinocchio": set(), "mujoco": set(), "ros": {"unknown-version", "capsule"}}


@pytest.mark.parametrize(
    ("header", "cell", "field", "number"),
    [
        ("max acceleration [deg/s²]", "90", "acceleration", math.pi / 2),
        ("acc (rad/s^2)", "3", "acceleration", 3.0),
        ("qdd_max", "3", "acceleration", 3.0),
        ("max. Winkelbeschleunigung", "360 °/s²", "acceleration", 2 * math.pi),
        ("最大加速度", "2.5", "acceleration", 2.5),
        ("max [deg/s/s]", "180", "acceleration", math.pi),
        ("jerk", "900 deg/s³", "jerk", 5 * math.pi),
        ("max. jerk [rad/s^3]", "40", "jerk", 40.0),
    ],
)
@pytest.mark.parametrize("kind", ["R", "P"])
def test_columns(header: str, cell: str, field: str, number: float, kind: str) -> None:
    """Words and units of makers; of a joint that slides metres stand for radians, and millimetres for degrees."""
    if kind == "P":
        for angle, length in (("rad", "m"), ("deg", "mm"), ("°", "mm")):
            header, cell = header.replace(f"{angle}/s", f"{length}/s"), cell.replace(f"{angle}/s", f"{length}/s")
        if "mm" in header + cell:
            number = float(cell.split()[0]) / 1000
    arm = dh2urdf.read(f"# convention: standard\ntype,a,alpha,d,{header}\n{kind},0.3,0,0.1,{cell}\n", reader="csv")
    assert getattr(arm.rows[0].limits, field) == pytest.approx(number, rel=1e-15)


def test_a_table_in_degrees_has_them_in_degrees() -> None:
    """As it has speeds; what only a cell beside it says is asked for."""
    table = "convention: standard\nunits: {angle: deg, length: mm}\njoints:\n"
    row = "  - {{type: {kind}, a: 300, alpha: 0, d: 0, limits: {{acceleration: 720, jerk: 9000}}}}\n"
    turns, slides = dh2urdf.read(table + row.format(kind="R") + row.format(kind="P"), reader="yaml").rows
    assert (turns.limits.acceleration, turns.limits.jerk) == pytest.approx((4 * math.pi, 50 * math.pi), rel=1e-15)
    assert (slides.limits.acceleration, slides.limits.jerk) == (0.72, 9.0)
    unsure = "# convention: standard\na,alpha,d,lower,upper,acceleration\n0.3,0,0,-90°,90°,720\n"
    with pytest.raises(TableError, match="write '720 deg/s²' or '720 rad/s²'"):
        dh2urdf.read(unsure, reader="csv")
