"""Every installed stage keeps the contract that plugin authors hold theirs to."""

from __future__ import annotations

import json

from dh2urdf.registry import load
from dh2urdf.testing import EmitterContract, ExecutorContract, LoaderContract, ReaderContract, TransformContract

CATALOG = load()

CSV = "# convention: standard\njoint, a, alpha, d\nhip, 0.4, pi/2, 0.1\nknee, 0.3, 0, 0\n"


class TestCsv(ReaderContract):
    stage = CATALOG.get("reader", "csv")
    example = CSV

    def many(self, count: int) -> str:
        rows = "".join(f"arm_{i}, 0.{i}1, pi/2, 0.1\narm_{i}, 0.3, 0, 0\n" for i in range(count))
        return f"# convention: standard\nrobot, a, alpha, d\n{rows}"


class TestYaml(ReaderContract):
    stage = CATALOG.get("reader", "yaml")
    example = "convention: standard\njoints:\n  - {name: hip, a: 0.4, alpha: pi/2, d: 0.1}\n"
    is_document = True

    def many(self, count: int) -> str:
        joints = [{"a": 0.4, "alpha": 0.5, "d": 0.1}]
        return json.dumps(
            {"robots": [{"name": f"r{i}", "convention": "standard", "joints": joints} for i in range(count)]}
        )


class TestAlphaSwap(TransformContract):
    stage = CATALOG.get("transform", "alpha-swap")


class TestUrdf(EmitterContract):
    stage = CATALOG.get("emitter", "urdf")


class TestXacro(EmitterContract):
    stage = CATALOG.get("emitter", "xacro")


class TestSdf(EmitterContract):
    stage = CATALOG.get("emitter", "sdf")


class TestMjcf(EmitterContract):
    stage = CATALOG.get("emitter", "mjcf")


class TestPyBullet(LoaderContract):
    stage = CATALOG.get("loader", "pybullet")


class TestMujoco(LoaderContract):
    stage = CATALOG.get("loader", "mujoco")


class TestPinocchio(LoaderContract):
    stage = CATALOG.get("loader", "pinocchio")


class TestDrake(LoaderContract):
    stage = CATALOG.get("loader", "drake")


class TestGazebo(LoaderContract):
    stage = CATALOG.get("loader", "gazebo")


class TestLocal(ExecutorContract):
    stage = CATALOG.get("executor", "local")
    options = stage.options(workers=2)


class TestDask(ExecutorContract):
    stage = CATALOG.get("executor", "dask")
    options = stage.options(workers=2)
