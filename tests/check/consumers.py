"""What the consumers themselves do with files: each in a process of its own, and each file in a fork of that.

`python consumers.py CONSUMER` reads paths, a line each, and prints a JSON line for each.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import TracebackType

SECONDS = 20
PROCESSOR_SECONDS = 5
PRINTED = 2**22
"""A consumer may take so long for one file, and print so many bytes of it; one that goes on counts as crashed."""
_OTHERS = [folder for folder in os.get_exec_path() if not (Path(folder).parent / "pyvenv.cfg").is_file()]
CHECK_URDF = shutil.which("check_urdf", path=os.pathsep.join(_OTHERS))
"""urdfdom's command as a system has it. Pinocchio brings a newer one along, urdfdom 6, which takes document types."""


@dataclass
class Behaviour:
    """What a consumer did with a file.

    Attributes:
        end: ``loads``, ``refuses`` (an exception, or an exit status), or ``crashes`` (a signal).
        printed: what it printed, on both streams.
        masses: mass of each body by its name [kg]; what a consumer merges or drops is not there.
        joints: moving joints: name to (lower, upper), None where it has none.
        finite: whether its numbers are.
        positions: how many numbers its position vector has.
        extra: what else there is to know of a consumer. `told` has its joints of one value, and of each the kind,
            `revolute` or `prismatic`, and those of lower, upper, effort and velocity that it knows.
    """

    end: str
    printed: str = ""
    masses: dict[str, float] = field(default_factory=dict)
    joints: dict[str, Any] = field(default_factory=dict)
    finite: bool = True
    positions: int = 0
    extra: dict[str, Any] = field(default_factory=dict)


class Reader:
    """A consumer in a process that waits for files."""

    def __init__(self, consumer: str) -> None:
        self.consumer = consumer
        self._folder = tempfile.TemporaryDirectory()  # MuJoCo writes a log into the folder where it is called
        self._process = subprocess.Popen(
            [sys.executable, str(Path(__file__).resolve()), consumer],
            cwd=self._folder.name,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def behaviour(self, path: Path) -> Behaviour:
        """What the consumer does with a file."""
        self.ask(path)
        return self.answer()

    def ask(self, path: Path) -> None:
        """Hand over a file; `answer` says what became of it."""
        assert self._process.stdin
        self._process.stdin.write(f"{path.resolve()}\n")
        self._process.stdin.flush()

    def answer(self) -> Behaviour:
        """What the consumer did with the file that was handed over."""
        assert self._process.stdout
        return Behaviour(**json.loads(self._process.stdout.readline()))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.communicate()
        self._folder.cleanup()


def require(*consumers: str) -> None:
    """Skips a test where one of the consumers that it asks is not here."""
    import pytest

    for consumer in consumers:
        name = {"ros": "check_urdf", "gazebo": "sdformat", "drake": "pydrake"}.get(consumer, consumer)
        system = {"ros": CHECK_URDF, "gazebo": SDFORMAT}
        if not (system[consumer] if consumer in system else find_spec(name)):
            pytest.skip(f"{name} is not installed")


def behaviours(consumer: str, paths: Sequence[Path]) -> list[Behaviour]:
    """What a consumer does with some files."""
    with Reader(consumer) as reader:
        return [reader.behaviour(path) for path in paths]


# --- Python packages --------------------------------------------------------------------------------------------------


def pybullet(path: str) -> Behaviour:
    import pybullet as p

    if path.endswith(".urdf"):
        robots = [p.loadURDF(path, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE)]
    else:
        robots = p.loadSDF(path) if path.endswith(".sdf") else p.loadMJCF(path)
    found = Behaviour("loads")
    found.masses |= {p.getBodyInfo(robot)[0].decode(): p.getDynamicsInfo(robot, -1)[0] for robot in robots}
    extra = found.extra
    extra |= {"inertias": {}, "axis": {}, "effort": {}, "start": {}, "moves": True, "told": {}}
    numbers: list[float] = []
    for robot, index in ((each, index) for each in robots for index in range(p.getNumJoints(each))):
        info, dynamics = p.getJointInfo(robot, index), p.getDynamicsInfo(robot, index)
        joint, link = info[1].decode(), info[12].decode()
        found.masses[link], extra["inertias"][link] = dynamics[0], dynamics[2]
        if info[2] == p.JOINT_FIXED:
            continue
        found.joints[joint] = (info[8], info[9])
        extra["axis"][joint], extra["effort"][joint] = info[13], info[10]
        kind = {p.JOINT_REVOLUTE: "revolute", p.JOINT_PRISMATIC: "prismatic"}.get(info[2], "other")
        extra["told"][joint] = {"kind": kind} | dict(
            zip(("lower", "upper", "effort", "velocity"), info[8:12], strict=True)
        )
        try:
            extra["start"][joint] = p.getJointState(robot, index)[0]
            p.resetJointState(robot, index, 0.3)
            numbers.extend(p.getLinkState(robot, index, computeForwardKinematics=True)[4])
        except p.error:
            extra["moves"] = False
    found.positions = len(found.joints)
    found.finite = all(map(math.isfinite, numbers))
    return found


def mujoco(path: str) -> Behaviour:
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    found = Behaviour("loads", positions=model.nq)
    found.masses = {model.body(i).name: float(model.body(i).mass[0]) for i in range(1, model.nbody)}
    told = found.extra["told"] = {}
    for i in range(model.njnt):
        joint = model.joint(i)
        found.joints[joint.name] = joint.range.tolist() if model.jnt_limited[i] else None
        lower, upper = found.joints[joint.name] or (None, None)
        effort = float(model.jnt_actfrcrange[i][1]) if model.jnt_actfrclimited[i] else None
        kind = {int(mujoco.mjtJoint.mjJNT_HINGE): "revolute", int(mujoco.mjtJoint.mjJNT_SLIDE): "prismatic"}
        told[joint.name] = {
            "kind": kind.get(int(model.jnt_type[i]), "other"),
            "lower": lower,
            "upper": upper,
            "effort": effort,
        }
    data = mujoco.MjData(model)
    found.extra["start"] = data.qpos.tolist()
    mujoco.mj_step(model, data)
    found.finite = bool(all(map(math.isfinite, [*data.qpos, *data.qacc])))
    found.extra["equalities"] = model.neq
    found.extra["axis"] = {model.joint(i).name: model.joint(i).axis.tolist() for i in range(model.njnt)}
    return found


def pinocchio(path: str) -> Behaviour:
    import numpy as np
    import pinocchio as pin

    model = pin.buildModelFromUrdf(path)
    # The shapes are read by a function of their own.
    found = Behaviour("loads", positions=model.nq)
    try:
        pin.buildGeomFromUrdf(model, path, pin.GeometryType.VISUAL)
    except Exception as error:  # noqa: BLE001 - whatever it raises is the answer
        found.extra["geometry"] = str(error)
    inertias, told = found.extra["inertias"], found.extra["told"] = {}, {}
    for index in range(1, model.njoints):
        joint = model.joints[index]
        found.masses[model.names[index]] = model.inertias[index].mass
        inertias[model.names[index]] = model.inertias[index].inertia.diagonal().tolist()
        found.joints[model.names[index]] = (
            (float(model.lowerPositionLimit[joint.idx_q]), float(model.upperPositionLimit[joint.idx_q]))
            if joint.nq == 1
            else None
        )
        if joint.nv == 1:
            told[model.names[index]] = {
                "kind": "prismatic" if "JointModelP" in joint.shortname() else "revolute",
                **dict(zip(("lower", "upper"), found.joints[model.names[index]] or (None, None), strict=True)),
                "effort": float(model.effortLimit[joint.idx_v]),
                "velocity": float(model.velocityLimit[joint.idx_v]),
            }
    data = model.createData()
    q = pin.neutral(model)
    pin.framesForwardKinematics(model, data, q)
    if not model.existFrame("tool0"):
        return found
    found.extra["tool0"] = data.oMf[model.getFrameId("tool0")].translation.tolist()
    pin.framesForwardKinematics(model, data, pin.integrate(model, q, np.full(model.nv, 0.3)))
    rotation = data.oMf[model.getFrameId("tool0")].rotation
    found.finite = all(map(math.isfinite, rotation.ravel()))
    found.extra["rigid"] = bool(np.allclose(rotation.T @ rotation, np.eye(3)))
    return found


def drake(path: str) -> Behaviour:
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
    from pydrake.systems.framework import DiagramBuilder

    plant, _ = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.001)
    parser = Parser(plant)
    for package in filter(None, os.environ.get("DRAKE_PACKAGES", "").split(os.pathsep)):
        parser.package_map().Add(Path(package).name, package)
    parser.AddModels(Path(path))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    found = Behaviour("loads", positions=plant.num_positions())
    from pydrake.multibody.tree import BodyIndex, JointIndex

    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    found.masses = {body.name(): body.default_mass() for body in bodies}
    told = found.extra["told"] = {}
    for index in plant.GetJointIndices():
        joint = plant.get_joint(JointIndex(index))
        if joint.num_positions() == 1:
            lower, upper = float(joint.position_lower_limits()[0]), float(joint.position_upper_limits()[0])
            found.joints[joint.name()] = (lower, upper)
            velocity = float(joint.velocity_upper_limits()[0])
            told[joint.name()] = {"kind": joint.type_name(), "lower": lower, "upper": upper, "velocity": velocity}
        elif joint.num_positions():
            found.joints[joint.name()] = None
    numbers = [x for body in bodies for x in plant.EvalBodyPoseInWorld(context, body).translation()]
    found.finite = all(map(math.isfinite, numbers))
    found.extra["actuators"] = plant.num_actuators()
    found.extra["constraints"] = plant.num_constraints()
    found.extra["inertias"] = {
        body.name(): body.default_rotational_inertia().get_moments().tolist() for body in bodies if body.default_mass()
    }
    found.extra["start"] = plant.GetPositions(context).tolist()
    return found


# --- Programs and libraries of C++ ---------------------------------------------------------------------------------------------------------


def check_urdf(path: str) -> Behaviour:
    with tempfile.TemporaryFile() as out:  # a pipe has no limit
        done = subprocess.run(
            [str(CHECK_URDF), path],
            stdout=out,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            check=False,
            timeout=SECONDS,
        )
        out.seek(0)
        told = out.read().decode(errors="replace")
    end = "crashes" if done.returncode < 0 else "refuses" if done.returncode else "loads"
    links = re.findall(r"^(?:root Link: (.*) has \d+ child\(ren\)| *child\(\d+\):  (.*))$", told, re.MULTILINE)
    extra = {"stdout": told, "status": done.returncode, "links": [root or child for root, child in links]}
    return Behaviour(end, printed=done.stderr, extra=extra)


SDFORMAT = next((name for v in range(15, 11, -1) if (name := ctypes.util.find_library(f"sdformat{v}"))), None)
"""The library behind the command ``gz sdf`` (of old ``ign sdf``), which calls these two functions of it."""


def said_by_sdformat(path: str) -> tuple[str, str]:
    """How sdformat takes a file, ``loads`` or ``refuses``, and what it printed of it, at the end as it understood it."""
    library, out, printed = ctypes.CDLL(SDFORMAT), Path("sdf"), ""
    for function in ("cmdCheck", "cmdPrint"):
        sys.stdout.flush()
        before, target = os.dup(1), os.open(out, os.O_CREAT | os.O_WRONLY | os.O_TRUNC)
        os.dup2(target, 1)
        status = library[function](path.encode())
        ctypes.CDLL(None).fflush(None)
        os.dup2(before, 1)
        printed = out.read_text("utf-8", errors="replace")
        if status or not printed.strip():
            return "refuses", printed
    return "loads", printed


def sdformat(path: str) -> Behaviour:
    end, printed = said_by_sdformat(path)
    found = Behaviour(end, extra={"said": printed[:300]})
    if found.end == "loads":
        for link in re.finditer(r"<link name='([^\n]*?)'>.*?</link>", printed, re.DOTALL):
            mass = re.search(r"<mass>(.*?)</mass>", link[0])
            found.masses[link[1]] = float(mass[1].split()[0]) if mass else math.nan
        told = found.extra["told"] = {}
        for joint in re.finditer(r"<joint name='([^\n]*?)' type='(\w*)'>.*?</joint>", printed, re.DOTALL):
            texts = {w: re.search(rf"<{w}>(.*?)</{w}>", joint[0]) for w in ("lower", "upper", "effort", "velocity")}
            numbers = {word: float(text[1]) if text else None for word, text in texts.items()}
            found.joints[joint[1]] = [numbers["lower"], numbers["upper"]]
            told[joint[1]] = {"kind": "revolute" if joint[2] == "continuous" else joint[2], **numbers}
        found.finite = "nan" not in printed
    return found


READERS: dict[str, Callable[[str], Behaviour]] = {
    "pybullet": pybullet,
    "mujoco": mujoco,
    "pinocchio": pinocchio,
    "drake": drake,
    "ros": check_urdf,
    "gazebo": sdformat,
}
MODULES = {
    "pybullet": ["pybullet"],
    "mujoco": ["mujoco"],
    "pinocchio": ["pinocchio"],
    "drake": ["pydrake.multibody.plant", "pydrake.multibody.parsing", "pydrake.multibody.tree"],
}
"""What a consumer imports, once for all files."""


def _serve(consumer: str) -> None:
    """Everything that it prints goes to a file, through C too; the answer to standard output."""
    for module in MODULES.get(consumer, ()):
        __import__(module)
    if consumer == "pybullet":
        sys.modules["pybullet"].connect(sys.modules["pybullet"].DIRECT)
    if consumer == "gazebo":
        ctypes.CDLL(SDFORMAT)
    printed, answer = Path("printed"), Path("answer")
    for line in sys.stdin:
        answer.unlink(missing_ok=True)
        child = os.fork()
        if child == 0:
            signal.alarm(SECONDS)
            resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS))
            resource.setrlimit(resource.RLIMIT_FSIZE, (PRINTED, resource.RLIM_INFINITY))
            target = os.open(printed, os.O_CREAT | os.O_WRONLY | os.O_TRUNC)
            os.dup2(target, 1)
            os.dup2(target, 2)
            try:
                found = READERS[consumer](line.rstrip("\n"))
            except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever it raises is the answer
                end = "crashes" if isinstance(error, SystemExit) else "refuses"
                found = Behaviour(end, extra={"raised": f"{type(error).__name__}: {error}"})
            sys.stdout.flush()
            ctypes.CDLL(None).fflush(None)  # what a library of C has printed, and `_exit` would drop
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
            answer.write_text(json.dumps(found.__dict__))
            os._exit(0)
        _, status = os.waitpid(child, 0)
        if os.WIFSIGNALED(status):
            found = Behaviour("crashes", extra={"signal": os.WTERMSIG(status)})
        elif answer.exists():
            found = Behaviour(**json.loads(answer.read_text()))
        else:
            found = Behaviour("refuses", extra={"status": os.WEXITSTATUS(status)})
        found.printed += re.sub(r"\x1b\[[0-9;]*m", "", printed.read_text("utf-8", errors="replace"))
        print(json.dumps(found.__dict__), flush=True)  # noqa: T201 - this is a program


if __name__ == "__main__":
    _serve(sys.argv[1])
