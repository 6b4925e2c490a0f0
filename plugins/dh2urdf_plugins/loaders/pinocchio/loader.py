"""The loader `pinocchio`: loads the written URDF into Pinocchio, measures the arm, and reads what its parser prints.

Pinocchio is a library of rigid-body algorithms and simulates nothing: whether the arm can hold its weight is asked of
its recursive Newton-Euler algorithm. It keeps moving bodies only, and adds to each what fixed joints hold to it; links
are frames. https://gepettoweb.laas.fr/doc/stack-of-tasks/pinocchio has its documentation.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.manipulator import JointType
from dh2urdf.measuring import Body
from dh2urdf.source import Messages
from dh2urdf_plugins.loaders.measures import Comparison, hold_start, lumped_bodies, printed, rotation, share_of, vector
from dh2urdf_plugins.loaders.pinocchio.model import MESSAGE, UNIVERSE, Model
from dh2urdf_plugins.loaders.simulators import PACKAGES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.robot import Joint
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Problem
    from dh2urdf.stages import LoadReport, LoadRequest
    from dh2urdf_plugins.loaders.simulators import SimulatorOptions

say = Messages(__file__)

MEASURED_JOINTS = 250
"""Largest number of joints of an arm that is put into a pose: Pinocchio's working memory holds four arrays of the cube
of their number, here half a gigabyte."""


class _Load(NamedTuple):
    """What gravity asks of a joint: a share of its effort, the force or torque [N or N·m], and where."""

    share: float
    force: float
    joint: Joint
    q: tuple[float, ...]


class Arm(Model):
    """The arm as Pinocchio holds it, beside the robot that was written.

    Raises:
        LoaderError: Pinocchio cannot load the file, or has lost a joint or a link of it.
    """

    def __init__(self, pinocchio: Any, request: LoadRequest) -> None:  # noqa: ANN401 - a module without type information
        self.request, self.robot = request, request.robot
        self.comparison = Comparison("Pinocchio", request)
        try:
            super().__init__(pinocchio, request.path.resolve())
        except ValueError as error:  # The reason stands only in what the parser prints.
            raise LoaderError(self.comparison.placed(say("cannot-load", simulator="Pinocchio"))) from error

    def report(self) -> LoadReport:
        """Measure everything.

        Raises:
            LoaderError: Pinocchio holds another arm.
        """
        lost = [
            self.comparison.placed(say("simulator-lost-link", simulator="Pinocchio", link=link.name))
            for link in self.robot.links
            if link.name not in self.numbers
        ]
        joints = [*map(self.held_joint, self.joints.values())]
        bodies, written = self._held_bodies(), lumped_bodies(self.robot)
        report = self.comparison.loaded(version("pin"), joints, bodies, written, lost)
        if len(joints) > MEASURED_JOINTS:
            found, accepted = f"{len(joints)} moving joints", f"at most {MEASURED_JOINTS} moving joints"
            return replace(report, findings=self.comparison.too_large("pinocchio-arm-too-large", found, accepted))
        data = self.model.createData()
        report = replace(report, **self.comparison.poses(partial(self._frames, data)))
        if not joints:
            return report
        hold, findings = self._hold(data)
        return replace(report, hold=hold, findings=findings)

    # What was loaded

    def _held_bodies(self) -> dict[str, Body]:
        """The moving bodies, by the names of the links that carry them, and the body that is in the world."""
        carriers = {joint.child: self.joints.get(joint.name) for joint in self.robot.moving_joints}
        carriers[self.robot.root] = UNIVERSE
        inertias = {name: self.model.inertias[number] for name, number in carriers.items() if number is not None}
        return {
            name: Body(float(inertia.mass), vector(inertia.lever), rotation(inertia.inertia))
            for name, inertia in inertias.items()
        }

    # Poses

    def _coordinates(self, q: Sequence[float]) -> Any:  # noqa: ANN401 - an array of Pinocchio's coordinates
        """A joint vector in Pinocchio's coordinates: cosine and sine of a joint that turns without end."""
        names = (joint.name for joint in self.robot.moving_joints)
        return self.coordinates(dict(zip(names, q, strict=True)))

    def _frames(self, data: Any, q: Sequence[float], links: Sequence[str]) -> Mapping[str, RigidTransform]:  # noqa: ANN401 - Pinocchio's working memory
        """The frames of some links in the root at a joint vector."""
        self.pinocchio.framesForwardKinematics(self.model, data, self._coordinates(q))
        return self.placed(data, links)

    # The hold test

    def _hold(self, data: Any) -> tuple[dict[str, Any], tuple[Problem, ...]]:  # noqa: ANN401 - Pinocchio's working memory
        """Whether the efforts that Pinocchio read hold the arm at its start and at every pose that was measured."""
        start = hold_start(self.robot)
        worst = max(
            (load for q in (start, *self.request.poses) for load in self._loads(data, q)), key=lambda load: load.share
        )
        hold = {
            "start": start,
            "poses": 1 + len(self.request.poses),
            "largest_load": worst.share if math.isfinite(worst.share) else None,
            "joint": worst.joint.name,
            "q": worst.q,
            "threshold": 1.0,
            "stayed": worst.share <= 1.0,
        }
        if hold["stayed"]:
            return hold, ()
        unit = "N" if worst.joint.type is JointType.PRISMATIC else "N·m"
        about = {"q": worst.q, "force": worst.force, "unit": unit}
        return hold, (self.comparison.weak(worst.joint, "arm-too-heavy", **about),)

    def _loads(self, data: Any, q: Sequence[float]) -> Iterator[_Load]:  # noqa: ANN401 - Pinocchio's working memory
        """What gravity asks of every joint at a joint vector, at rest."""
        import numpy as np

        model = self.model
        model.gravity.linear = np.array((0.0, 0.0, -GRAVITY))
        rest = np.zeros(model.nv)
        forces = self.pinocchio.rnea(model, data, self._coordinates(q), rest, rest)
        for joint in self.robot.moving_joints:
            at = model.joints[self.joints[joint.name]].idx_v
            force, effort = abs(float(forces[at])), float(model.effortLimit[at])
            yield _Load(share_of(effort, force), force, joint, tuple(q))


def load(request: LoadRequest, options: SimulatorOptions) -> LoadReport:
    """Load a URDF into Pinocchio and measure it.

    Raises:
        LoaderError: Pinocchio cannot load the file, or holds another arm than the one that was written.
        MissingDependencyError: Pinocchio is not installed.
    """
    return Arm(PACKAGES["pinocchio"].load(options), request).report()


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """The warnings and errors that Pinocchio's parser printed."""
    return printed("Pinocchio", request, MESSAGE.findall(output))
