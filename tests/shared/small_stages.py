"""Stages of tests, by which the core is tried without any built-in plugin: robots are pickled, and read back so."""

import pickle
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from dh2urdf.manipulator import Convention, DHRow, Limits, Manipulator
from dh2urdf.plugin_system.calls import Call
from dh2urdf.robot import Robot
from dh2urdf.stages import EmittedFile, Emitter, KeepsKinematics, NoOptions, ReadsBack, Transform
from dh2urdf.testing import plain_robot


@dataclass(frozen=True, kw_only=True)
class Keeping:
    keeps: bool = True
    file: Path | None = field(default=None)


def one_joint(name: str = "arm", length: float = 0.5, **more: Any) -> Manipulator:
    """A table of one joint."""
    limits = Limits(lower=-1.0, upper=1.0, velocity=1.0, effort=1.0)
    row = DHRow(joint="turn", link="one", a=length, alpha=0.0, d=0.0, limits=limits)
    return Manipulator(name=name, convention=Convention.STANDARD, rows=(row,), **more)


def robot_of(table: Manipulator, **turn: Any) -> Robot:
    """The robot of a table, whose joint `turn` is another."""
    made = plain_robot(table)
    joints = [replace(joint, **turn) if joint.name == "turn" else joint for joint in made.joints]
    return replace(made, joints=tuple(joints))


def drawing(
    draw: Callable[..., Any] = lambda table, _: plain_robot(table), *, keeps: bool = True
) -> Call[Transform[Any]]:
    capabilities = (KeepsKinematics(lambda options: options.keeps),)
    stage = Transform(name="draw", summary="draws", transform=draw, options=Keeping, capabilities=capabilities)
    return Call(stage=stage, options=Keeping(keeps=keeps))


def unpickled(path: Path) -> Any:
    return pickle.loads(path.read_bytes())  # noqa: S301 - made here


def pickling(
    name: str = "pickle",
    emit: Callable[..., Any] | None = None,
    *,
    suffix: str = ".pickle",
    read_back: Callable[[Path], Any] | None = unpickled,
    costly: bool = False,
) -> Call[Emitter[Any]]:
    def pickled(robot: Robot, stem: str, _options: NoOptions) -> list[EmittedFile]:
        return [EmittedFile(name=f"{stem}{suffix}", content=pickle.dumps(replace(robot, notices=())))]

    stage = Emitter(
        name=name,
        summary="writes",
        emit=emit or pickled,
        options=NoOptions,
        suffixes=(suffix,),
        capabilities=(ReadsBack(read_back, is_costly=costly),) if read_back else (),
    )
    return Call(stage=stage, options=NoOptions())
