"""The DH tables that dh2urdf and iDynTree make of the same descriptions, each measured against the file's own chain.

    pip install -e '.[pinocchio]' idyntree
    python benchmarks/extract_others.py

Pinocchio multiplies the file's chain, and numpy the table, at 200 random joint vectors. A line has the largest
difference at the tip, and how many of the table's lengths and angles are not 0: a table for people has few. With
`--files` other descriptions are taken, as FILE,BASE,TIP.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import sys
import tempfile
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import idyntree.bindings as idyntree
import numpy as np  # noqa: TID253 - a script
import pinocchio  # noqa: TID253 - a script

import dh2urdf

if TYPE_CHECKING:
    from dh2urdf.rotations import RigidTransform

Row = tuple[float, float, float, float, bool]
Table = tuple[Sequence[Row], np.ndarray, np.ndarray]
"""a, α, d and θ of the rows in the standard convention and whether a row moves, and the transforms at both ends."""

JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><origin xyz="{4}" rpy="{5}"/>'
    '<axis xyz="{6}"/><limit lower="-1" upper="1" effort="10" velocity="1"/></joint>'
)
SLIDE = (
    ("turn", "revolute", "base", "arm", "0 0 0.3", "0 0 0", "0 0 1"),
    ("slide", "prismatic", "arm", "tool0", "0.1 0 0.2", "0 0 0", "1 0 0"),
)
ROUNDED = (  # parallel axes that four digits of pi make nearly parallel
    ("hip", "revolute", "base", "upper", "0 0 0.1", "1.5708 0 0", "0 0 1"),
    ("knee", "revolute", "upper", "fore", "0.4 0 0", "-1.5708 1.5708 0", "1 0 0"),
    ("wrist", "revolute", "fore", "tool0", "0.3 0.1 0.2", "0.3 0 0", "0 0 1"),
)


def descriptions(folder: Path) -> Iterator[tuple[Path, str, str]]:
    """Makers' arms of example-robot-data, and two small ones: file, base and tip."""
    spec = find_spec("cmeel")
    places = (spec.submodule_search_locations or ()) if spec else ()
    for place in places:
        robots = Path(place).parent / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
        yield robots / "ur_description/urdf/ur5_robot.urdf", "base_link", "tool0"
        yield robots / "panda_description/urdf/panda.urdf", "panda_link0", "panda_link8"
        yield robots / "z1_description/urdf/z1.urdf", "link00", "link06"
    for name, joints in (("slide", SLIDE), ("rounded", ROUNDED)):
        links = dict.fromkeys(link for joint in joints for link in joint[2:4])
        text = "".join(f'<link name="{link}"/>' for link in links) + "".join(JOINT.format(*joint) for joint in joints)
        path = folder / f"{name}.urdf"
        path.write_text(f'<robot name="{name}">{text}</robot>', "utf-8")
        yield path, "base", "tool0"


def of_dh2urdf(path: Path, base: str, tip: str) -> Table:
    """Its table in the standard convention, with no tolerance but that of doubles."""
    arm = dh2urdf.extract(path, convention="standard", base_link=base, tip_link=tip, tolerance=1e-12)
    rows = [(row.a, row.alpha, row.d, row.theta, row.type != "fixed") for row in arm.rows]
    return rows, _matrix(arm.base), _matrix(arm.tool)


def _matrix(pose: RigidTransform) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = np.reshape(pose.rotation, (3, 3)), pose.translation
    return matrix


def of_idyntree(path: Path, base: str, tip: str) -> Table:
    """Its table; it prints on standard error what it cannot do."""
    loader, chain = idyntree.ModelLoader(), idyntree.DHChain()
    with quiet():
        if not loader.loadModelFromFile(str(path)):
            raise ValueError("does not load the file")
        done = idyntree.ExtractDHChainFromModel(loader.model(), base, tip, chain)
    if not done:
        raise ValueError("gives no table")
    rows = [chain(number) for number in range(chain.getNrOfDOFs())]
    ends = [np.array(end.asHomogeneousTransform().toNumPy()) for end in (chain.getH0(), chain.getHN())]
    return [(row.A, row.Alpha, row.D, row.Offset, True) for row in rows], ends[0], ends[1]


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Nothing of what a library of C++ prints."""
    kept = os.dup(2)
    with Path(os.devnull).open("wb") as nothing:
        os.dup2(nothing.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def product(table: Table, q: Sequence[float], slides: Sequence[bool]) -> np.ndarray:
    """Base, Rz(θ) Tz(d) Tx(a) Rx(α) of every row, tool."""
    rows, first, last = table
    pose = first
    moving = iter(zip(q, slides, strict=True))
    for a, alpha, d, theta, moves in rows:
        value, slide = next(moving) if moves else (0.0, False)
        turn, shift = (theta, d + value) if slide else (theta + value, d)
        ct, st, ca, sa = np.cos(turn), np.sin(turn), np.cos(alpha), np.sin(alpha)
        row = [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, shift], [0, 0, 0, 1]]
        pose = pose @ np.array(row)
    return pose @ last


def largest_difference(path: Path, base: str, tip: str, table: Table, vectors: int = 200) -> float:
    """Between the tip of the file's chain and that of a table [m, rad]."""
    model = pinocchio.buildModelFromUrdf(str(path))
    data, first, last = model.createData(), model.getFrameId(base), model.getFrameId(tip)
    joints = []
    joint = model.frames[last].parentJoint
    while joint > model.frames[first].parentJoint:
        joints.insert(0, joint)
        joint = model.parents[joint]
    if len(joints) != (moving := sum(row[-1] for row in table[0])):
        raise ValueError(f"gives a table with {moving} of {len(joints)} moving joints")
    slides = [model.joints[joint].shortname().startswith("JointModelP") for joint in joints]
    draw, worst = random.Random(1), 0.0
    for _ in range(vectors):
        q, values = pinocchio.neutral(model), [draw.uniform(-1, 1) for _ in joints]
        for joint, value in zip(joints, values, strict=True):
            q[model.joints[joint].idx_q] = value
        pinocchio.framesForwardKinematics(model, data, q)
        true = data.oMf[first].actInv(data.oMf[last]).homogeneous
        worst = max(worst, float(np.abs(product(table, values, slides) - true).max()))
    return worst


def main() -> int:
    """Print a line for each description and tool."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", nargs="*", default=[], metavar="FILE,BASE,TIP")
    asked = parser.parse_args()
    print(f"iDynTree {version('idyntree')}, Pinocchio {version('pin')}")
    tools = {"dh2urdf": of_dh2urdf, "iDynTree": of_idyntree}
    with tempfile.TemporaryDirectory() as folder:
        chosen = [(Path(one), base, tip) for one, base, tip in (item.split(",") for item in asked.files)]
        for path, base, tip in chosen or descriptions(Path(folder)):
            for name, tool in tools.items():
                try:
                    table = tool(path, base, tip)
                    far = largest_difference(path, base, tip, table)
                except (ValueError, dh2urdf.Dh2UrdfError) as error:
                    print(f"{path.stem:12} {name:9} {str(error).splitlines()[0]}")
                    continue
                full = sum(abs(number) > 1e-15 for row in table[0] for number in row[:4])
                print(f"{path.stem:12} {name:9} {len(table[0])} rows, {full:2} numbers, off by {far:.1e}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
