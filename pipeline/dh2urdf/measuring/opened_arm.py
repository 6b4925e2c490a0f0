"""Measures the arm that a loader has opened in its simulator."""

from __future__ import annotations

from functools import partial, update_wrapper
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import tensor
from dh2urdf.measuring.comparison import Body, Comparison, Precision
from dh2urdf.rotations import RigidTransform
from dh2urdf.stages.load_records import LoadReport, SimulatedArm

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from dh2urdf.stages import Loader
    from dh2urdf.stages.load_records import LoadRequest

_ROWS = 4


def load_function(loader: Loader[Any]) -> Callable[[LoadRequest, Any], LoadReport]:
    """The function that opens a file with a loader, and measures the arm where the loader does not."""
    return update_wrapper(partial(load_opened, loader.open), loader.open)


def load_opened(
    open_arm: Callable[[LoadRequest, Any], SimulatedArm | LoadReport],
    request: LoadRequest,
    options: Any,  # noqa: ANN401 - the options of any loader
) -> LoadReport:
    """Open a file in a simulator, and compare joints, masses and poses with the robot that was written.

    Raises:
        LoaderError: the simulator refuses the file, or has another arm.
        TypeError: `open_arm` gives something else than a `SimulatedArm` or a `LoadReport`.
        ValueError: a pose is no matrix of four rows of four numbers.
    """
    arm = open_arm(request, options)
    if isinstance(arm, LoadReport):
        return arm
    if not isinstance(arm, SimulatedArm):
        raise TypeError(f"open returned {type(arm).__name__}, neither a SimulatedArm nor a LoadReport")
    try:
        return _measured(arm, request)
    finally:
        if arm.close is not None:
            arm.close()


def _measured(arm: SimulatedArm, request: LoadRequest) -> LoadReport:
    allowed = arm.tolerance
    precision = Precision(
        number=allowed, axis=allowed, inertia=allowed, position=allowed, angle=allowed, name=arm.simulator
    )
    comparison = Comparison(arm.simulator, request, precision)
    joints = tuple(map(_plain, arm.joints))
    problems = comparison.joints(joints)
    masses: dict[str, Any] = {}
    if arm.bodies is not None:
        bodies = {name: Body(each.mass, each.com, tensor(each.inertia)) for name, each in arm.bodies.items()}
        masses, others = comparison.masses(bodies)
        problems += others
    if problems:
        raise LoaderError(problems)

    def frames(q: Sequence[float], links: Sequence[str]) -> Mapping[str, RigidTransform]:
        return {link: _transform(arm.pose(link, q), link) for link in links}

    poses = comparison.poses(frames)
    return LoadReport(
        simulator=arm.simulator, version=arm.version, joints=joints, findings=arm.findings, **masses, **poses
    )


def _plain(joint: Mapping[str, Any]) -> dict[str, Any]:
    """A joint with plain numbers, which a report can keep; what nobody compares is left as it is."""
    found = dict(joint)
    for name, value in joint.items():
        if name == "axis":
            found[name] = tuple(float(number) + 0.0 for number in value)
        elif name in ("lower", "upper", "velocity", "effort") and value is not None:
            found[name] = float(value)
    return found


def _transform(matrix: Any, link: str) -> RigidTransform:  # noqa: ANN401 - an array, or lists
    """A pose as a rigid transform.

    Raises:
        ValueError: it is no matrix of four rows of four numbers.
    """
    if isinstance(matrix, RigidTransform):
        return matrix
    rows = [[float(number) for number in row] for row in matrix]
    if (found := [len(row) for row in rows]) != [_ROWS] * _ROWS:
        raise ValueError(f"the pose of {link!r} has rows of {found} numbers; accepted: four rows of four")
    (a, b, c, x), (d, e, f, y), (g, h, i, z), _ = rows
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))
