"""What MuJoCo makes of a file, whatever file that is: its bodies, joints and shapes as its arrays hold them."""

from __future__ import annotations

import os
import re
import sys
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.measuring import Body
from dh2urdf.rotations import ZERO, RigidTransform, multiply, transpose
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.loaders.inspecting import (
    COLLISION,
    VISUAL,
    lengths,
    lengths_of,
    refused,
    told_bodies,
    told_frames,
)
from dh2urdf_plugins.loaders.measures import rotation, vector
from dh2urdf_plugins.loaders.simulators import PACKAGES, SimulatorOptions

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from dh2urdf.stages import Question


class Model:
    """What MuJoCo makes of a file.

    Raises:
        ValueError: MuJoCo refuses the file.
        mujoco.FatalError: as before.
    """

    def __init__(self, mujoco: Any, path: Path) -> None:  # noqa: ANN401 - a module without type information
        self.mujoco = mujoco
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.data = mujoco.MjData(self.model)
        self.bodies = {self.model.body(number).name: number for number in range(self.model.nbody)}
        sites = {self.model.site(number).name: number for number in range(self.model.nsite)}
        self.sites = {name: number for name, number in sites.items() if name not in self.bodies}
        self.joints = {self.model.joint(number).name: number for number in range(self.model.njnt)}

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links, sites among them, in the world, as the data has them."""
        data, frames = self.data, {}
        for name in links:
            if name in self.sites:
                site = self.sites[name]
                frames[name] = RigidTransform(rotation(data.site_xmat[site]), vector(data.site_xpos[site]))
            else:
                body = self.bodies[name]
                frames[name] = RigidTransform(rotation(data.xmat[body]), vector(data.xpos[body]))
        return frames

    def held_joint(self, number: int) -> dict[str, Any]:
        """A joint as MuJoCo has it; limits that make no sense, it has switched off."""
        model, types = self.model, self.mujoco.mjtJoint
        limited = bool(model.jnt_limited[number])
        kinds = {int(types.mjJNT_HINGE): "revolute" if limited else "continuous", int(types.mjJNT_SLIDE): "prismatic"}
        kind = int(model.jnt_type[number])
        limits = [model.jnt_actfrcrange[number][1]] if model.jnt_actfrclimited[number] else []
        moved_by = model.actuator_trnid[:, 0] == number
        limits += list(model.actuator_forcerange[moved_by & (model.actuator_forcelimited != 0), 1])
        return {
            "name": model.joint(number).name,
            "type": kinds.get(kind, types(kind).name),
            "axis": vector(model.jnt_axis[number]),
            "lower": float(model.jnt_range[number][0]) if limited else None,
            "upper": float(model.jnt_range[number][1]) if limited else None,
            "effort": float(min(limits)) if limits else None,
        }

    def held_bodies(self) -> dict[str, Body]:
        """The links as MuJoCo has them, a site without mass; inertias are turned back from their principal axes."""
        import numpy as np

        bodies = {name: Body(0.0, ZERO, (0.0,) * 9) for name in self.sites}
        for name, number in self.bodies.items():
            matrix = np.zeros(9)
            self.mujoco.mju_quat2Mat(matrix, self.model.body_iquat[number])
            axes = rotation(matrix)
            a, b, c = vector(self.model.body_inertia[number])
            tensor = multiply(multiply(axes, (a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c)), transpose(axes))
            mass = float(self.model.body_mass[number])
            # The centre of no mass is wherever MuJoCo's compiler left it.
            bodies[name] = Body(mass, vector(self.model.body_ipos[number]) if mass else ZERO, tensor)
        return bodies

    def held_mimic(self, number: int) -> tuple[str, float, float] | None:
        """Which joint a joint follows by an equality constraint: its name, the factor and the offset."""
        model = self.model
        for at in range(model.neq):
            kind, first, second = int(model.eq_type[at]), int(model.eq_obj1id[at]), int(model.eq_obj2id[at])
            if kind == int(self.mujoco.mjtEq.mjEQ_JOINT) and first == number and second >= 0:
                offset, factor = (float(each) for each in model.eq_data[at][:2])
                return model.joint(second).name, factor, offset
        return None

    def held_shapes(self) -> dict[str, dict[str, list[tuple[float, float, float]]]]:
        """The lengths of the shapes of each body; one that touches nothing is for the eye."""
        model, types = self.model, self.mujoco.mjtGeom
        found: dict[str, dict[str, list[tuple[float, float, float]]]] = {}
        for at in range(model.ngeom):
            kind, (x, y, z) = int(model.geom_type[at]), model.geom_size[at]
            if kind == int(types.mjGEOM_MESH):
                size = self._mesh(int(model.geom_dataid[at]))
            else:
                by_kind = {
                    int(types.mjGEOM_SPHERE): (2 * x, 2 * x, 2 * x),
                    int(types.mjGEOM_CAPSULE): (2 * x, 2 * x, 2 * (x + y)),
                    int(types.mjGEOM_CYLINDER): (2 * x, 2 * x, 2 * y),
                }
                size = lengths(*by_kind.get(kind, (2 * x, 2 * y, 2 * z)))
            touches = model.geom_contype[at] or model.geom_conaffinity[at]
            name = model.body(int(model.geom_bodyid[at])).name
            found.setdefault(name, {}).setdefault(COLLISION if touches else VISUAL, []).append(size)
        return found

    def _mesh(self, number: int) -> tuple[float, float, float]:
        """The lengths of a mesh along its own axes: MuJoCo has turned it to its principal axes."""
        import numpy as np

        model, turned = self.model, np.zeros(9)
        first, count = int(model.mesh_vertadr[number]), int(model.mesh_vertnum[number])
        self.mujoco.mju_quat2Mat(turned, model.mesh_quat[number])
        return lengths_of(model.mesh_vert[first : first + count] @ turned.reshape(3, 3).T)


def prepare() -> str:
    """Import MuJoCo without graphics; its version.

    Raises:
        MissingDependencyError: it is not installed.
    """
    os.environ["MUJOCO_GL"] = "disable"
    PACKAGES["mujoco"].load(SimulatorOptions())
    return version("mujoco")


def inspect(question: Question) -> HeldRobot:
    """What MuJoCo makes of a URDF or an MJCF.

    Raises:
        LoaderError: it refuses the file.
    """
    mujoco = sys.modules["mujoco"]
    mujoco.set_mju_user_warning(print_warning)
    try:
        held = Model(mujoco, question.path)
    except (ValueError, mujoco.FatalError) as error:
        raise refused(error, question) from error
    model, data = held.model, held.data
    free = int(mujoco.mjtJoint.mjJNT_FREE)
    names = [name for number in range(1, model.nbody) if (name := model.body(number).name)]

    def frames(values: Mapping[str, float]) -> dict[str, RigidTransform]:
        mujoco.mj_resetData(model, data)
        for name, value in values.items():
            if name in held.joints:
                data.qpos[int(model.jnt_qposadr[held.joints[name]])] = value
        mujoco.mj_kinematics(model, data)
        return held.placed(names)

    bodies = held.held_bodies()
    return HeldRobot(
        links=told_bodies({name: bodies[name] for name in names}),
        joints=[
            {**held.held_joint(number), "mimic": held.held_mimic(number)}
            for number in range(model.njnt)
            if int(model.jnt_type[number]) != free
        ],
        frames=told_frames(question.postures, frames),
        shapes=held.held_shapes(),
        root_is_loose=bool((model.jnt_type == free).any()),
    )


def print_warning(text: str | bytes) -> None:
    """Print a warning; without this, MuJoCo writes it into a file in the working directory too."""
    words = text.decode("utf-8", "replace") if isinstance(text, bytes) else text
    os.write(2, f"WARNING: {' '.join(words.split())}\n".encode())


_MESSAGE = re.compile(r"^(?:WARNING|ERROR): *(.+?) *$", re.MULTILINE)
_UNNAMED = "Geom with duplicate name ''"  # MuJoCo 3.3 prints this for every file with two shapes: shapes have no names


def complaints(output: str) -> list[str]:
    """MuJoCo's warnings in what was printed."""
    return [text for text in _MESSAGE.findall(output) if not text.startswith(_UNNAMED)]
