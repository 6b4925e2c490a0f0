"""Random robots are bolted to random arms: every link is where both files have it, in every format and four engines.

    python fuzz/parts.py --parts 60 --seed 7

Each part is a tree of up to 12 links: joints of every type, followers of followers, shapes, frames without mass, names
that the arm has, too. The edit `attach` puts it on an arm's tool0 or base, and URDF, MJCF and SDF are given to
Pinocchio and PyBullet, MuJoCo, and Drake. Where each link has to be is computed here, by numpy, from the numbers that
were drawn; masses are compared, too. What is wrong is printed with its seed, and the exit status is 1.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
import warnings
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import cos, pi, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import dh2urdf

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "shared"))
from plain_frames import dh, rpy, shift, turn

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from plain_frames import Matrix

    Frames = Callable[[dict[str, float]], dict[str, Matrix]]

NAMES = ("base_link", "tool0", "joint_1", "link_1", "palm", "finger", "knuckle", "camera")
"""What links and joints may be called; a number follows where one is taken."""
BOUNDS = {"pinocchio": 1e-12, "mujoco": 1e-12, "drake": 1e-12, "pybullet": 3e-6}
"""What a link may be away, as a part of the robot's size; PyBullet computes in single precision."""
VECTORS = 4


def placed(numbers: tuple[float, ...]) -> Matrix:
    """A frame at x, y, z, turned by roll, pitch and yaw about fixed axes."""
    return shift(*numbers[:3]) @ rpy(*numbers[3:])


@dataclass
class Joint:
    """A joint of a part, as it was drawn."""

    name: str
    kind: str
    parent: str
    child: str
    origin: tuple[float, ...]
    axis: tuple[float, float, float]
    follows: tuple[str, float, float] | None = None  # leader, multiplier, offset

    def motion(self, q: float) -> Matrix:
        """How the joint's value moves its child."""
        return shift(*(q * np.array(self.axis))) if self.kind == "prismatic" else turn(self.axis, q)


@dataclass
class Part:
    """A part, as it was drawn."""

    links: list[str]
    masses: dict[str, float] = field(default_factory=dict)
    joints: list[Joint] = field(default_factory=list)
    text: str = ""

    def values(self, given: dict[str, float]) -> dict[str, float]:
        """The values of all moving joints."""
        by_name = {joint.name: joint for joint in self.joints}

        def value(name: str) -> float:
            law = by_name[name].follows
            return law[1] * value(law[0]) + law[2] if law else given[name]

        return {joint.name: value(joint.name) for joint in self.joints if joint.kind != "fixed"}

    def frames(self, given: dict[str, float]) -> dict[str, Matrix]:
        """T(first link → link) of every link."""
        values, found = self.values(given), {self.links[0]: np.eye(4)}
        for joint in self.joints:
            moved = joint.motion(values[joint.name]) if joint.kind != "fixed" else np.eye(4)
            found[joint.child] = found[joint.parent] @ placed(joint.origin) @ moved
        return found


def random_part(draw: random.Random) -> Part:
    """A tree of links with its URDF, whose joints are in any order."""
    taken = set[str]()

    def name() -> str:
        word = draw.choice(NAMES)
        while word in taken:
            word = f"{word.rstrip('0123456789_')}_{draw.randint(2, 99)}"
        taken.add(word)
        return word

    part = Part(links=[name() for _ in range(draw.randint(1, 12))])
    for number, child in enumerate(part.links[1:], start=1):
        kind = draw.choice(("fixed", "revolute", "revolute", "continuous", "prismatic"))
        way = np.array([draw.gauss(0, 1) for _ in range(3)])
        x, y, z = (way / np.linalg.norm(way)).tolist() if draw.random() < 0.5 else draw.choice(np.eye(3).tolist())
        origin = tuple(draw.uniform(-0.2, 0.2) for _ in range(3)) + tuple(draw.uniform(-pi, pi) for _ in range(3))
        joint = Joint(name(), kind, draw.choice(part.links[:number]), child, origin, (x, y, z))
        leaders = [each.name for each in part.joints if each.kind != "fixed"]
        if kind != "fixed" and leaders and draw.random() < 0.4:
            joint.follows = (draw.choice(leaders), round(draw.uniform(-2, 2), 3), draw.choice((0.0, 0.1)))
        part.joints.append(joint)
    moved = {joint.child for joint in part.joints if joint.kind != "fixed"}
    for link in part.links:
        if link in moved or draw.random() < 0.6:
            part.masses[link] = draw.uniform(0.05, 2.0)
    links = [_link(link, part.masses.get(link), draw) for link in part.links]
    joints = [_joint(joint) for joint in draw.sample(part.joints, len(part.joints))]
    part.text = "\n".join(["<robot name='part'>", *draw.sample(links, len(links)), *joints, "</robot>"])
    return part


def _numbers(numbers: Any) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def _link(name: str, mass: float | None, draw: random.Random) -> str:
    inside = []
    if mass is not None:
        x, y, z = (draw.uniform(0.01, 0.2) for _ in range(3))  # half axes of an ellipsoid, which a body can be
        i, com = [0.2 * mass * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y))], [draw.uniform(-0.1, 0.1)] * 3
        inside.append(
            f"<inertial><origin xyz='{_numbers(com)}' rpy='0.1 -0.2 0.3'/><mass value='{mass!r}'/>"
            f"<inertia ixx='{i[0]!r}' iyy='{i[1]!r}' izz='{i[2]!r}' ixy='0' ixz='0' iyz='0'/></inertial>"
        )
    for tag in draw.sample(("visual", "collision"), draw.randint(0, 2)):
        shape = draw.choice(
            ("<box size='0.1 0.02 0.03'/>", "<cylinder radius='0.02' length='0.1'/>", "<sphere radius='0.03'/>")
        )
        inside.append(f"<{tag}><origin xyz='0.01 0.02 0.03' rpy='0.3 0.2 0.1'/><geometry>{shape}</geometry></{tag}>")
    return f"<link name='{name}'>{''.join(inside)}</link>"


def _joint(joint: Joint) -> str:
    limits = "" if joint.kind == "continuous" else "lower='-1.5' upper='1.5' "
    follows = "<mimic joint='{}' multiplier='{!r}' offset='{!r}'/>".format(*joint.follows) if joint.follows else ""
    return (
        f"<joint name='{joint.name}' type='{joint.kind}'><parent link='{joint.parent}'/><child link='{joint.child}'/>"
        f"<origin xyz='{_numbers(joint.origin[:3])}' rpy='{_numbers(joint.origin[3:])}'/>"
        f"<axis xyz='{_numbers(joint.axis)}'/><limit {limits}effort='10' velocity='1'/>{follows}</joint>"
    )


def random_arm(draw: random.Random) -> list[tuple[float, float, float, float]]:
    """Rows of θ, d, a, α in the standard convention, whose joints all turn."""
    return [
        (
            round(draw.uniform(-pi, pi), 3),
            draw.uniform(-0.4, 0.4),
            draw.uniform(-0.5, 0.5),
            draw.choice((0, pi / 2, -pi / 2, 0.7)),
        )
        for _ in range(draw.randint(1, 6))
    ]


def arm_pose(rows: list[tuple[float, float, float, float]], q: list[float]) -> Matrix:
    """T(base_link → tool0): Rz(θ) Tz(d) Tx(a) Rx(α) of each row (Denavit and Hartenberg, 1955)."""
    whole = np.eye(4)
    for (theta, *others), value in zip(rows, q, strict=True):
        whole = whole @ dh("standard", theta + value, *others)
    return whole


# --- Engines: where each has the links, and the mass of all ----------------------------------------------------------


def pinocchio_frames(path: Path) -> tuple[Frames, float]:
    """Of a URDF; its joints that follow are free for it."""
    import pinocchio

    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()

    def frames(values: dict[str, float]) -> dict[str, Matrix]:
        q = pinocchio.neutral(model)
        for name, value in values.items():
            joint = model.joints[model.getJointId(name)]
            q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (cos(value), sin(value))
        pinocchio.framesForwardKinematics(model, data, q)
        bodies = [each for each in enumerate(model.frames) if each[1].type == pinocchio.FrameType.BODY]
        return {frame.name: data.oMf[number].homogeneous.copy() for number, frame in bodies}

    fixed = sum(model.inertias[0:1], pinocchio.Inertia.Zero()).mass  # of what does not move
    return frames, float(pinocchio.computeTotalMass(model) + fixed)


@contextmanager
def silent() -> Iterator[None]:
    """What the process prints meanwhile goes nowhere."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def pybullet_frames(path: Path) -> tuple[Frames, float]:
    """Of a URDF; PyBullet ties no joint to another, and takes a link without inertial for 1 kg."""
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    with silent():  # It prints a warning for each link without a mass.
        robot = pybullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client)
    joints = range(pybullet.getNumJoints(robot, physicsClientId=client))
    about = [pybullet.getJointInfo(robot, index, physicsClientId=client) for index in joints]
    names = {info[1].decode(): info[0] for info in about}

    def frames(values: dict[str, float]) -> dict[str, Matrix]:
        for name, value in values.items():
            pybullet.resetJointState(robot, names[name], value, physicsClientId=client)
        found = {}
        for info in about:
            state = pybullet.getLinkState(robot, info[0], computeForwardKinematics=True, physicsClientId=client)
            matrix = shift(*state[4])
            matrix[:3, :3] = np.reshape(pybullet.getMatrixFromQuaternion(state[5]), (3, 3))
            found[info[12].decode()] = matrix
        return found

    return frames, float("nan")


def mujoco_frames(path: Path) -> tuple[Frames, float]:
    """Of an MJCF; it has no link where the values that the joints got are not those of its equalities."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)

    def frames(values: dict[str, float]) -> dict[str, Matrix]:
        for name, value in values.items():
            data.joint(name).qpos[0] = value
        mujoco.mj_forward(model, data)
        laws = data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]
        if len(laws) < model.neq or not (np.abs(laws) <= 1e-12).all():
            return {}
        found = {}
        places = [(model.body(number).name, data.body(number)) for number in range(1, model.nbody)]
        places += [(model.site(number).name, data.site(number)) for number in range(model.nsite)]
        for name, place in places:
            found[name] = shift(*place.xpos)
            found[name][:3, :3] = place.xmat.reshape(3, 3)
        return found

    return frames, float(model.body_mass.sum())


def drake_frames(path: Path) -> tuple[Frames, float]:
    """Of an SDF."""
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.0)
    (model,) = Parser(plant).AddModels(str(path))
    plant.Finalize()
    context = plant.CreateDefaultContext()

    def frames(values: dict[str, float]) -> dict[str, Matrix]:
        q = plant.GetPositions(context)
        for name, value in values.items():
            q[plant.GetJointByName(name, model).position_start()] = value
        plant.SetPositions(context, q)
        all_frames = [plant.get_frame(index) for index in plant.GetFrameIndices(model)]
        return {frame.name(): frame.CalcPoseInWorld(context).GetAsMatrix4() for frame in all_frames}

    return frames, float(plant.CalcTotalMass(context))


ENGINES: dict[str, tuple[str, Callable[[Path], tuple[Frames, float]]]] = {
    "pinocchio": (".urdf", pinocchio_frames),
    "pybullet": (".urdf", pybullet_frames),
    "mujoco": (".xml", mujoco_frames),
    "drake": (".sdf", drake_frames),
}


# --- One arm with one part -------------------------------------------------------------------------------------------


def faults(seed: str, folder: Path) -> list[str]:
    """What is wrong with the arm and the part of a seed."""
    draw = random.Random(seed)
    rows, part = random_arm(draw), random_part(draw)
    place = tuple(draw.uniform(-0.1, 0.1) for _ in range(3)) + tuple(draw.uniform(-pi, pi) for _ in range(3))
    parent = draw.choice(("tool0", "tool0", "base_link"))
    lines = [f"{theta!r}, {d!r}, {a!r}, {alpha!r}, 1.5" for theta, d, a, alpha in rows]
    table = "\n".join(["# convention: standard", "# name: arm", "theta, d, a, alpha, mass", *lines])
    (folder / "part.urdf").write_text(part.text, "utf-8")
    edit = {"file": str(folder / "part.urdf"), "name": "x", "parent": parent, "xyz": place[:3], "rpy": place[3:]}
    wrong: list[str] = []
    mass = dh2urdf.convert(table).robot.mass + sum(part.masses.values())
    leaders = [joint.name for joint in part.joints if joint.kind != "fixed" and not joint.follows]
    for engine, (suffix, load) in ENGINES.items():
        path = folder / f"arm{suffix}"
        robot = dh2urdf.convert(table, path, edits=[{"attach": edit}]).robot
        frames, found_mass = load(path)
        if not np.isnan(found_mass) and not abs(found_mass - mass) <= 1e-9 * mass:
            wrong.append(f"{engine}: {found_mass} kg, not {mass}")
        for _ in range(VECTORS):
            q = [draw.uniform(-1, 1) for _ in rows]
            given = {name: draw.uniform(-0.7, 0.7) for name in leaders}
            names = [joint.name for joint in robot.moving_joints][: len(rows)]
            values = dict(zip(names, q, strict=True)) | {f"x_{name}": v for name, v in part.values(given).items()}
            found = frames(values)
            start = (arm_pose(rows, q) if parent == "tool0" else np.eye(4)) @ placed(place)
            for link, pose in part.frames(given).items():
                wanted = start @ pose
                size = max(1.0, float(np.abs(wanted[:3, 3]).max()))
                error = float(np.abs(found[f"x_{link}"] - wanted).max()) if f"x_{link}" in found else np.inf
                if not error <= BOUNDS[engine] * size:
                    wrong.append(f"{engine}: link {link} is {error:.2g} away")
    return wrong


def main() -> int:
    """Make the arms and print what is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parts", type=int, default=60, help="how many parts are made")
    parser.add_argument("--seed", default="0", help="the first word of each part's seed")
    asked = parser.parse_args()
    warnings.simplefilter("ignore", dh2urdf.TableWarning)
    bad = 0
    for number in range(asked.parts):
        seed = f"{asked.seed}.{number}"
        with tempfile.TemporaryDirectory() as folder:
            if found := faults(seed, Path(folder)):
                bad += 1
                print(f"part {seed}: {'; '.join(found[:3])}")
    print(f"{asked.parts} parts on arms, in URDF, MJCF and SDF: {bad} wrong in {', '.join(ENGINES)}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
