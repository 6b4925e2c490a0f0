"""The loader `yourdfpy`: the arm as the URDF library yourdfpy has it."""

from __future__ import annotations

from importlib.metadata import version
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError, MissingDependencyError
from dh2urdf.source import Problem
from dh2urdf.stages import Loader, LoadRequest, NoOptions, Requires, SimulatedArm

if TYPE_CHECKING:
    from collections.abc import Sequence


def open_arm(request: LoadRequest, _options: NoOptions) -> SimulatedArm:
    """What yourdfpy has of a URDF: joints with their limits, and where a link is.

    Raises:
        LoaderError: yourdfpy refuses the file.
    """
    import yourdfpy  # type: ignore[import-untyped]

    try:
        urdf = yourdfpy.URDF.load(str(request.path), load_meshes=False, load_collision_meshes=False)
    except Exception as error:
        raise LoaderError(Problem(message=f"yourdfpy cannot load the file: {error}")) from error
    names = [joint.name for joint in request.robot.moving_joints]

    def pose(link: str, q: Sequence[float]) -> Any:
        urdf.update_cfg(dict(zip(names, q, strict=True)))
        return urdf.get_transform(link, urdf.base_link)

    held = [_held(joint) for joint in urdf.robot.joints if joint.type != "fixed"]
    return SimulatedArm(simulator="yourdfpy", version=version("yourdfpy"), pose=pose, joints=held, tolerance=1e-12)


def _held(joint: Any) -> dict[str, Any]:
    limits = {name: getattr(joint.limit, name) for name in ("lower", "upper", "velocity", "effort")}
    return {"name": joint.name, "type": joint.type, "axis": joint.axis, **limits}


def require(_options: NoOptions) -> None:
    """Ask whether yourdfpy is installed, without importing it."""
    if find_spec("yourdfpy") is None:
        raise MissingDependencyError("loader 'yourdfpy'", "yourdfpy", "dh2urdf-short")


LOADER = Loader(
    name="yourdfpy",
    summary="loads a URDF into yourdfpy",
    open=open_arm,
    options=NoOptions,
    capabilities=(Requires(require),),
)
