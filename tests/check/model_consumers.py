"""What the consumers of SDF and MJCF do with files: each file in a fork of a process that has the consumer loaded.

`python model_consumers.py CONSUMER FILE…` prints a JSON line for each file.
"""

from __future__ import annotations

import ctypes
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from consumers import SDFORMAT, said_by_sdformat

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

SECONDS = 240


def outcomes(consumer: str, paths: Sequence[Path]) -> list[dict[str, Any]]:
    """Of each file, how loading it ends, what was printed or raised, and what was read."""
    with tempfile.TemporaryDirectory() as folder:  # MuJoCo writes a log into the folder where it is called
        done = subprocess.run(
            [sys.executable, str(Path(__file__).resolve()), consumer, *(str(path.resolve()) for path in paths)],
            cwd=folder,
            capture_output=True,
            text=True,
            check=True,
            timeout=SECONDS,
        )
    return [json.loads(line) for line in done.stdout.splitlines()]


def pybullet(path: str) -> dict[str, Any]:
    import pybullet as p

    p.connect(p.DIRECT)
    found: dict[str, Any] = {"masses": {}, "joints": {}}
    for robot in p.loadSDF(path) if path.endswith(".sdf") else p.loadMJCF(path):
        found["masses"][p.getBodyInfo(robot)[0].decode()] = p.getDynamicsInfo(robot, -1)[0]
        for index in range(p.getNumJoints(robot)):
            info = p.getJointInfo(robot, index)
            found["masses"][info[12].decode()] = p.getDynamicsInfo(robot, index)[0]
            if info[2] != p.JOINT_FIXED:
                found["joints"][info[1].decode()] = [info[8], info[9], *info[13]]
    return found


def mujoco(path: str) -> dict[str, Any]:
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    return {
        "masses": {model.body(i).name: float(model.body(i).mass[0]) for i in range(1, model.nbody)},
        "joints": {
            model.joint(i).name: [
                *(model.joint(i).range.tolist() if model.jnt_limited[i] else ()),
                *model.jnt_axis[i].tolist(),
            ]
            for i in range(model.njnt)
        },
        "finite": bool(all(map(math.isfinite, [*data.qpos, *data.qacc]))),
    }


def drake(path: str) -> dict[str, Any]:
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
    from pydrake.multibody.tree import BodyIndex, JointIndex
    from pydrake.systems.framework import DiagramBuilder

    plant, _ = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.001)
    Parser(plant).AddModels(Path(path))
    plant.Finalize()
    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    joints = [plant.get_joint(JointIndex(index)) for index in range(plant.num_joints())]
    return {
        "masses": {body.name(): body.default_mass() for body in bodies},
        "joints": {
            joint.name(): [float(joint.position_lower_limits()[0]), float(joint.position_upper_limits()[0])]
            for joint in joints
            if joint.num_positions() == 1
        },
        "positions": plant.num_positions(),
    }


def sdformat(path: str) -> dict[str, Any]:
    end, text = said_by_sdformat(path)
    return {
        "end": end,
        "masses": dict(re.findall(r"<link name='([^']*)'>.*?<mass>(.*?)</mass>.*?</link>", text, re.DOTALL)),
        "joints": {
            name: [*re.findall(r"<(?:lower|upper)>(.*?)<", joint), *re.findall(r"<xyz[^>]*>(.*?)<", joint)]
            for name, joint in re.findall(r"<joint name='([^']*)'(.*?)</joint>", text, re.DOTALL)
        },
    }


READERS: dict[str, Callable[[str], dict[str, Any]]] = {
    "pybullet": pybullet,
    "mujoco": mujoco,
    "drake": drake,
    "gazebo": sdformat,
}


def _each_in_a_fork(consumer: str, paths: list[str]) -> None:
    if consumer == "gazebo":
        ctypes.CDLL(SDFORMAT)
    else:
        __import__({"drake": "pydrake.multibody.plant"}.get(consumer, consumer))
    for path in paths:
        with tempfile.TemporaryDirectory() as folder:
            printed, answer = Path(folder, "printed"), Path(folder, "answer")
            child = os.fork()
            if child == 0:
                target = os.open(printed, os.O_CREAT | os.O_WRONLY)
                os.dup2(target, 1)
                os.dup2(target, 2)
                try:
                    found = {"end": "loads", **READERS[consumer](path)}
                except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever it raises is the answer
                    end = "crashes" if isinstance(error, SystemExit) else "refuses"
                    found = {"end": end, "raised": f"{type(error).__name__}: {error}"}
                sys.stdout.flush()
                ctypes.CDLL(None).fflush(None)  # what a library of C has printed, and `_exit` would drop
                answer.write_text(json.dumps(found))
                os._exit(0)
            _, status = os.waitpid(child, 0)
            found = json.loads(answer.read_text()) if answer.exists() else {"end": "crashes", "status": status}
            found["printed"] = re.sub(r"\x1b\[[0-9;]*m", "", printed.read_text(errors="replace"))
        print(json.dumps(found), flush=True)  # noqa: T201 - this is a program


if __name__ == "__main__":
    _each_in_a_fork(sys.argv[1], sys.argv[2:])
