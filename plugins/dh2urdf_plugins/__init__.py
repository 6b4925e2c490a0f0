"""The built-in stages, through the same interface as any third party's.

A stage's module is imported inside its hook, when somebody looks so far: the usual ones come first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.hookspecs import hookimpl

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.stages import Edit, Emitter, Executor, Loader, Reader, Transform


@hookimpl
def dh2urdf_readers() -> Iterator[Reader[Any]]:
    """Tables as CSV, as YAML, as workbooks and as Parquet, and the chains of robot descriptions."""
    from dh2urdf_plugins.readers import stages

    yield from (stages.CSV, stages.YAML, stages.XLSX, stages.PARQUET)
    from dh2urdf_plugins.descriptions import readers as descriptions

    yield from (descriptions.URDF, descriptions.XACRO, descriptions.SDF, descriptions.MJCF)
    yield from (descriptions.UR_KINEMATICS, descriptions.FRANKA_KINEMATICS, descriptions.SCREWS)


@hookimpl
def dh2urdf_transforms() -> Iterable[Transform[Any]]:
    """The α-swap, exact and as the paper has it."""
    from dh2urdf_plugins.transforms import alpha_swap

    return (alpha_swap.TRANSFORM,)


@hookimpl
def dh2urdf_edits() -> Iterable[Edit[Any]]:
    """Changes of the table: calibrations, limits, masses, payloads, names, values; and what is bolted to the robot."""
    from dh2urdf_plugins.edits import attach, calibrate, limits, masses, mount, payload, rename, values

    edits = (attach, calibrate, limits, masses, mount, payload, rename, values)
    return tuple(each.EDIT for each in edits)


@hookimpl
def dh2urdf_emitters() -> Iterator[Emitter[Any]]:
    """URDF and xacro macros, SDF for Gazebo, MJCF for MuJoCo, packages for ROS 2, SRDF for MoveIt, and tables."""
    from dh2urdf_plugins.formats import urdf

    yield urdf.EMITTER
    from dh2urdf_plugins.formats import xacro

    yield xacro.EMITTER
    from dh2urdf_plugins.formats import mjcf, sdf

    yield from (sdf.EMITTER, mjcf.EMITTER)
    from dh2urdf_plugins.packages import ros2, srdf, table

    yield from (ros2.EMITTER, srdf.EMITTER, table.EMITTER)


@hookimpl
def dh2urdf_loaders() -> Iterable[Loader[Any]]:
    """The simulators."""
    from dh2urdf_plugins.loaders.simulators import LOADERS

    return LOADERS


@hookimpl
def dh2urdf_executors() -> Iterable[Executor[Any]]:
    """Processes of this machine, and a Dask cluster."""
    from dh2urdf_plugins.executors import dask, local

    return (local.EXECUTOR, dask.EXECUTOR)
