"""Every installed stage keeps the contract that the authors of plugins hold theirs to."""

import io
import json
import random
from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from two_fingers import HAND

from dh2urdf.manipulator import Convention
from dh2urdf.plugin_system import KINDS, load
from dh2urdf.testing import (
    EditContract,
    EmitterContract,
    ExecutorContract,
    LoaderContract,
    ReaderContract,
    TransformContract,
    reference_manipulators,
)
from dh2urdf_plugins.edits.attach import AttachOptions
from dh2urdf_plugins.edits.calibrate import CalibrateOptions
from dh2urdf_plugins.edits.limits import LimitsOptions
from dh2urdf_plugins.edits.masses import MassesOptions
from dh2urdf_plugins.edits.mount import MountOptions
from dh2urdf_plugins.edits.payload import PayloadOptions
from dh2urdf_plugins.edits.rename import RenameOptions
from dh2urdf_plugins.edits.values import ValuesOptions
from dh2urdf_plugins.executors.dask import DaskOptions
from dh2urdf_plugins.executors.local import LocalOptions
from dh2urdf_plugins.loaders.simulators import CoppeliaSimOptions
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions

CATALOG = load()


def held(contract: type[Any], name: str, **more: Any) -> type[Any]:
    """The contract of a built-in stage that has nothing of its own but options."""
    return type(contract.__name__, (contract,), {"stage": CATALOG.get(contract.kind, name), **more})


CSV = "# convention: standard\njoint, a, alpha, d\nhip, 0.4, pi/2, 0.1\nknee, 0.3, 0, 0\n"


class TestCsv(ReaderContract):
    stage = CATALOG.get("reader", "csv")
    example = CSV

    def many(self, count: int) -> str:
        rows = "".join(f"arm_{i}, 0.{i}1, pi/2, 0.1\narm_{i}, 0.3, 0, 0\n" for i in range(count))
        return f"# convention: standard\nrobot, a, alpha, d\n{rows}"


def parquet(count: int) -> bytes:
    """A Parquet file with so many arms of two rows: not packed, as a file of many has to be a large one."""
    if not find_spec("pyarrow"):
        return b""
    import pyarrow as pa
    from pyarrow.parquet import write_table

    file = io.BytesIO()
    columns = {
        "robot": [f"arm_{i // 2}" for i in range(2 * count)],
        "a": [0.001 * i for i in range(2 * count)],
        "alpha": [0.0, 0.5] * count,
        "d": [0.1, 0.0] * count,
        "convention": ["standard"] * (2 * count),
    }
    write_table(pa.table(columns), file, row_group_size=2_000, compression="none", use_dictionary=False)
    return file.getvalue()


URDF = """<?xml version="1.0"?>
<robot name="arm">
  <link name="foot"/>
  <link name="upper"/>
  <link name="fore"/>
  <joint name="hip" type="revolute">
    <parent link="foot"/> <child link="upper"/>
    <origin xyz="0 0 0.1"/> <axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="80" velocity="1.5"/>
  </joint>
  <joint name="knee" type="revolute">
    <parent link="upper"/> <child link="fore"/>
    <origin xyz="0.4 0 0" rpy="1.5707963267948966 0 0"/> <axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="40" velocity="3"/>
  </joint>
</robot>
"""


TestUrdfDescription = held(ReaderContract, "urdf", example=URDF)


@pytest.mark.skipif(not find_spec("xacro"), reason="xacro is not installed")
@pytest.mark.long
class TestXacroDescription(ReaderContract):
    stage = CATALOG.get("reader", "xacro")
    example = URDF.replace('name="arm"', 'name="arm" xmlns:xacro="http://ros.org/wiki/xacro"')

    def _broken(self) -> dict[str, bytes]:
        """A sample: each file is expanded in a process of its own."""
        return dict([*super()._broken().items()][::6])

    def test_does_nothing_else(self, tmp_path: Path) -> None:
        """The file is as it was, and nothing is beside it: it is expanded in a process behind a fence."""
        path = tmp_path / "arm.urdf.xacro"
        path.write_text(self.example)
        assert len(list(self.stage.read(path, self.stage.options()))) == 1
        assert [each.name for each in tmp_path.iterdir()] == [path.name]
        assert path.read_text() == self.example


class TestSdfDescription(ReaderContract):
    stage = CATALOG.get("reader", "sdf")
    example = """<sdf version="1.7"><model name="arm">
  <link name="upper"/>
  <joint name="hip" type="revolute"><parent>world</parent><child>upper</child><axis><xyz>0 0 1</xyz></axis></joint>
</model></sdf>
"""


class TestMjcfDescription(ReaderContract):
    stage = CATALOG.get("reader", "mjcf")
    example = """<mujoco model="arm"><worldbody>
  <body name="upper" pos="0 0 0.1"><joint name="hip" axis="0 0 1"/><geom size="0.1"/></body>
</worldbody></mujoco>
"""


class TestUrKinematics(ReaderContract):
    stage = CATALOG.get("reader", "ur-kinematics")
    example = "kinematics:\n" + "".join(
        f"  {name}: {{x: 0, y: {y}, z: 0.1, roll: {roll}, pitch: 0, yaw: 0}}\n"
        for name, y, roll in (
            ("shoulder", 0, 0),
            ("upper_arm", 0, 1.57),
            ("forearm", 0.4, 0),
            ("wrist_1", 0.4, 0),
            ("wrist_2", 0, 1.57),
            ("wrist_3", 0, -1.57),
        )
    )


class TestFrankaKinematics(ReaderContract):
    stage = CATALOG.get("reader", "franka-kinematics")
    example = "".join(
        f"joint{number}: {{kinematic: {{x: 0, y: {y}, z: 0.1, roll: {roll}, pitch: 0, yaw: 0}}}}\n"
        for number, (y, roll) in enumerate(
            [(0, 0), (0, -1.57), (-0.3, 1.57), (0, 1.57), (0.3, -1.57), (0, 1.57), (0, 1.57), (0, 0)], start=1
        )
    )


SCREWS = "Slist: [[0, 0], [0, 1], [1, 0], [0, -0.3], [0, 0], [0, 0]]\nM: {xyz: [0.5, 0, 0.3]}\n"
TestScrews = held(ReaderContract, "screws", example=SCREWS)


@pytest.mark.skipif(not find_spec("pyarrow"), reason="pyarrow is not installed")
class TestParquet(ReaderContract):
    stage = CATALOG.get("reader", "parquet")
    example = parquet(3)

    def many(self, count: int) -> bytes:
        return parquet(count)


def workbook(count: int) -> bytes:
    """A workbook with so many arms of two rows, whose lengths and names can hardly be packed."""
    if not find_spec("openpyxl"):
        return b""
    from openpyxl import Workbook

    book = Workbook(write_only=True)
    sheet = book.create_sheet()
    sheet.append(["robot", "a", "alpha", "d", "convention"])
    draw = random.Random(0)  # noqa: S311 - any lengths will do
    for arm in range(count):
        name = f"arm_{arm}_{draw.randbytes(60).hex()}"
        sheet.append([name, draw.random(), 0.0, draw.random(), "standard"])
        sheet.append([name, draw.random(), 0.5, draw.random(), "standard"])
    file = io.BytesIO()
    book.save(file)
    return file.getvalue()


@pytest.mark.skipif(not find_spec("openpyxl"), reason="openpyxl is not installed")
class TestXlsx(ReaderContract):
    stage = CATALOG.get("reader", "xlsx")
    example = workbook(3)

    def many(self, count: int) -> bytes:
        return workbook(count)


class TestYaml(ReaderContract):
    stage = CATALOG.get("reader", "yaml")
    example = "convention: standard\njoints:\n  - {name: hip, a: 0.4, alpha: pi/2, d: 0.1}\n"
    is_document = True

    def many(self, count: int) -> str:
        joints = [{"a": 0.4, "alpha": 0.5, "d": 0.1}]
        arms = [{"name": f"arm_{i}", "convention": "standard", "joints": joints} for i in range(count)]
        return json.dumps({"robots": arms})


TestAlphaSwap = held(TransformContract, "alpha-swap")
TestAlphaSwapWithFramesOfTheTable = held(
    TransformContract, "alpha-swap", options=AlphaSwapOptions(frames="dh", shape="box")
)


TestAttach = held(EditContract, "attach", options=AttachOptions(file=HAND, name="hand", xyz=(0.0, 0.02, 0.011)))


class TestCalibrate(EditContract):
    stage = CATALOG.get("edit", "calibrate")
    options = CalibrateOptions(file=Path(__file__).parent / "plugins" / "edits" / "six_joints.conf")
    manipulators = tuple(
        arm for arm in reference_manipulators() if len(arm.moving_rows) == 6 and arm.convention is Convention.STANDARD
    )


MOUNT = MountOptions(name="camera", xyz=(0.0, 0.05, 0.1), size=(0.02, 0.09, 0.02), mass=0.1, optical=True)
TestLimits = held(EditContract, "limits", options=LimitsOptions(range=0.9, velocity=0.5, effort=0.8))
TestMasses = held(EditContract, "masses", options=MassesOptions(total=20.6, base=4.0))
TestMount = held(EditContract, "mount", options=MOUNT)
TestPayload = held(EditContract, "payload", options=PayloadOptions(mass=2.5, com=(0, 0.01, 0.1), size=(0.1, 0.2, 0.3)))
TestRename = held(EditContract, "rename", options=RenameOptions(prefix="left_", pattern="_joint$"))


class TestValues(EditContract):
    stage = CATALOG.get("edit", "values")
    options = ValuesOptions(joints={"joint_1": {"a": "*1.4", "d": "+20 mm", "alpha": "-90 deg", "mass": "2 kg"}})
    manipulators = tuple(arm for arm in reference_manipulators() if arm.rows[0].joint == "joint_1")


TestUrdf = held(EmitterContract, "urdf")
TestXacro = held(EmitterContract, "xacro")
TestSdf = held(EmitterContract, "sdf")
TestMjcf = held(EmitterContract, "mjcf")
TestRos2 = held(EmitterContract, "ros2", stem="arm_7")
TestSrdf = held(EmitterContract, "srdf", options=replace(CATALOG.get("emitter", "srdf").options(), trials=100))
TestTable = held(EmitterContract, "table")

TestPyBullet = pytest.mark.long(held(LoaderContract, "pybullet"))
TestMujoco = pytest.mark.long(held(LoaderContract, "mujoco"))
TestPinocchio = held(LoaderContract, "pinocchio")
TestDrake = pytest.mark.long(held(LoaderContract, "drake"))
TestGazebo = pytest.mark.long(held(LoaderContract, "gazebo"))


@pytest.mark.usefixtures("simulator")
class TestCoppeliaSim(LoaderContract):
    """Against the small CoppeliaSim of the loader's own tests."""

    stage = CATALOG.get("loader", "coppeliasim")

    @pytest.fixture
    def simulator(self, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
        pytest.importorskip("coppeliasim_zmqremoteapi_client")
        pytest.importorskip("zmq")
        monkeypatch.syspath_prepend(Path(__file__).parent / "plugins" / "loaders")
        from coppeliasim_peer import Peer

        with Peer() as running:
            monkeypatch.setattr(type(self), "options", CoppeliaSimOptions(host="127.0.0.1", port=running.port))
            yield running


TestLocal = held(ExecutorContract, "local", options=LocalOptions(workers=2))
TestLocalInThisProcess = held(ExecutorContract, "local", options=LocalOptions(workers=1))
TestDask = pytest.mark.long(held(ExecutorContract, "dask", options=DaskOptions(workers=2)))


def test_no_installed_stage_is_left_out() -> None:
    """Each built-in stage has a class of this module: a new one has to be added here."""
    contracts = [each for each in globals().values() if isinstance(each, type) and hasattr(each, "stage")]
    held = {(contract.kind, contract.stage.name) for contract in contracts}
    installed = {(kind, item.stage.name) for kind in KINDS for item in CATALOG.provided(kind) if is_ours(item.plugin)}
    assert held == installed


def is_ours(plugin: Any) -> bool:
    """Whether it is the built-in plugin: others may be installed on a developer's machine."""
    return bool(plugin.module.__name__ == "dh2urdf_plugins")
