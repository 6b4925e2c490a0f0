"""The written files in the hands of others: readers that share no code with this project, and people who edit."""

import re
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from any_tables import SEEN_LENGTHS, manipulators
from hypothesis import given, settings

from dh2urdf.kinematics import KinematicChain
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Manipulator
from dh2urdf.robot import Robot
from dh2urdf.stages import Emitter, ReadsBack
from dh2urdf.testing.oracle import table_pose as dh_product
from dh2urdf_plugins.formats.urdf import EMITTER as URDF
from dh2urdf_plugins.formats.xacro import EMITTER as XACRO
from dh2urdf_plugins.formats.xacro.reader import expand, read_xacro
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

Table = Callable[..., Manipulator]

READ_BY_ALL = ["urdoc_ur5", "rtb_Panda", "rtb_Stanford", "kinova_gen3_std", "rkc_Brooks_PreciseFlex_400_750"]
frames = pytest.mark.parametrize("frames", ["aligned", "dh"])


def robot_of(manipulator: Manipulator, frames: str) -> Robot:
    return TRANSFORM.transform(manipulator, TRANSFORM.options(frames=frames))


def write(emitter: Emitter[Any], robot: Robot, folder: Path) -> Path:
    files = emitter.emit(robot, "arm", emitter.options())
    for file in files:
        (folder / file.name).write_bytes(file.content)
    return folder / files[0].name


def joint_vectors(manipulator: Manipulator, count: int = 3) -> list[list[float]]:
    draw = np.random.default_rng(7)
    return [list(draw.uniform(-3, 3, len(manipulator.actuated_rows))) for _ in range(count)]


def assert_same_description(xacro: bytes, urdf: bytes) -> None:
    for mine, theirs in zip(ET.fromstring(xacro).iter(), ET.fromstring(urdf).iter(), strict=True):  # noqa: S314
        assert (mine.tag, len(mine), set(mine.attrib)) == (theirs.tag, len(theirs), set(theirs.attrib))
        for key, text in theirs.attrib.items():
            if mine.attrib[key] != text:
                x, y = (np.array([float(word) for word in words.split()]) for words in (mine.attrib[key], text))
                assert (np.abs(x - y) <= 1e-15 * np.maximum(1, np.abs(y))).all(), (mine.attrib[key], text)


@frames
@given(manipulator=manipulators(lengths=SEEN_LENGTHS))
@settings(max_examples=40, deadline=None)
def test_both_files_of_any_table_are_its_arm(frames: str, manipulator: Manipulator) -> None:
    """URDF and expanded xacro are one description, and it moves tool0 as the DH product does."""
    robot = robot_of(manipulator, frames)
    with tempfile.TemporaryDirectory() as folder:
        urdf, xacro = (write(emitter, robot, Path(folder)) for emitter in (URDF, XACRO))
        assert_same_description(expand(xacro), urdf.read_bytes())
        reads = URDF.can(ReadsBack)
        chain = KinematicChain.between(reads.read_back(urdf))
    for q in joint_vectors(manipulator):
        assert np.abs(as_matrices(chain.forward_kinematics(q)) - dh_product(manipulator, q)).max() < 1e-9


@frames
@pytest.mark.parametrize("name", READ_BY_ALL)
class TestOtherReaders:
    """Readers of other people agree on the kinematics, and say nothing that is not expected."""

    def test_yourdfpy(
        self, table: Table, tmp_path: Path, caplog: pytest.LogCaptureFixture, name: str, frames: str
    ) -> None:
        """yourdfpy finds the file valid, logs no warning, and places tool0 as the DH product does."""
        yourdfpy = pytest.importorskip("yourdfpy", reason="yourdfpy is not installed")
        manipulator = table(name)
        model = yourdfpy.URDF.load(str(write(URDF, robot_of(manipulator, frames), tmp_path)))
        assert model.validate()
        for q in joint_vectors(manipulator):
            model.update_cfg(dict(zip([row.joint for row in manipulator.moving_rows], q, strict=True)))
            assert np.abs(model.get_transform("tool0", "base_link") - dh_product(manipulator, q)).max() < 1e-9
        assert [record for record in caplog.records if record.levelname not in {"DEBUG", "INFO"}] == []

    def test_urdf_parser_py(
        self, table: Table, tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, frames: str
    ) -> None:
        """urdf_parser_py finds every link and joint; it notes the tag that is MuJoCo's, and nothing else."""
        urdf = pytest.importorskip("urdf_parser_py.urdf", reason="urdf_parser_py is not installed")
        robot = robot_of(table(name), frames)
        model = urdf.URDF.from_xml_file(str(write(URDF, robot, tmp_path)))
        assert [link.name for link in model.links] == [link.name for link in robot.links]
        assert [joint.name for joint in model.joints] == [joint.name for joint in robot.joints]
        assert model.get_root() == "base_link"
        out, err = capfd.readouterr()
        assert (out, err.splitlines()) == ("", [f"Unknown tag \"mujoco\" in /robot[@name='{name}']"])


@frames
@pytest.mark.parametrize("name", ["urdoc_ur5", "rtb_Panda", "rtb_Stanford", "threelink3d_oblique", "rtb_Mico"])
def test_the_properties_are_the_arm(table: Table, tmp_path: Path, name: str, frames: str) -> None:
    """Whoever edits the properties of the macro gets the arm of the edited table: its poses and its shapes.

    A person who edits a length turns no joint axis, so angles are edited in the frames `dh` alone, where they are
    properties. Lengths of 0 stay 0: a link gets no further segment.
    """
    manipulator = table(name)
    path = write(XACRO, robot_of(manipulator, frames), tmp_path)
    macro = tmp_path / "arm_macro.xacro"
    text = macro.read_text(encoding="utf-8")
    draw = np.random.default_rng(3)
    rows = list(manipulator.rows)
    edited = []
    for parameter in re.findall(r'<xacro:property name="(\w+)"', text):
        field, _, index = parameter.rpartition("_")
        row = rows[int(index) - 1]
        value = getattr(row, field)
        if field in {"a", "d"} and not value:
            continue
        new = float(value * draw.uniform(0.9, 1.5) if field in {"a", "d"} else value + draw.uniform(-0.5, 0.5))
        rows[int(index) - 1] = replace(row, **{field: new})
        text = re.sub(rf'(name="{parameter}" value=)"[^"]*"', rf'\1"{new!r}"', text)
        edited.append(field)
    macro.write_text(text, encoding="utf-8")
    assert set(edited) == ({"a", "d"} if frames == "aligned" else {"a", "d", "alpha", "theta"})

    other = replace(manipulator, rows=tuple(rows))
    expanded, made = read_xacro(path), robot_of(other, frames)
    chain = KinematicChain.between(expanded)
    for q in joint_vectors(other):
        assert np.abs(as_matrices(chain.forward_kinematics(q)) - dh_product(other, q)).max() < 1e-9
    for mine, theirs in zip(expanded.links, made.links, strict=True):
        for shape, wanted in zip((*mine.visuals, *mine.collisions), (*theirs.visuals, *theirs.collisions), strict=True):
            assert shape.geometry.length == pytest.approx(wanted.geometry.length, abs=1e-12)
            assert np.abs(as_matrices(shape.origin.transform) - as_matrices(wanted.origin.transform)).max() < 1e-9
