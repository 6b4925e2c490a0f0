"""The emitter `datasheet`: the joints of a robot as a Markdown table, for people."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from dh2urdf.manipulator import JointType
from dh2urdf.stages import EmittedFile, Emitter

if TYPE_CHECKING:
    from dh2urdf.robot import Joint, Robot

HEADER = "| joint | type | lower | upper | unit |\n|---|---|--:|--:|---|\n"


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasheetOptions:
    """How the numbers are written."""

    angles: Literal["deg", "rad"] = field(default="deg", metadata={"help": "unit of angles"})
    digits: int = field(default=4, metadata={"help": "significant digits"})

    def __post_init__(self) -> None:
        if self.digits < 1:
            raise ValueError("digits is a number from 1 on")


def emit(robot: Robot, stem: str, options: DatasheetOptions) -> list[EmittedFile]:
    """The data sheet of a robot, as ``<stem>.datasheet.md``."""
    rows = "".join(f"| {' | '.join(_cells(joint, options))} |\n" for joint in robot.moving_joints)
    mass = f"{robot.mass:.{options.digits}g}"
    text = f"# {_escaped(robot.name)}\n\n{HEADER}{rows}\nMass of all links: {mass} kg\n"
    return [EmittedFile(name=f"{stem}.datasheet.md", content=text.encode())]


def _cells(joint: Joint, options: DatasheetOptions) -> tuple[str, ...]:
    in_degrees = options.angles == "deg" and joint.type is not JointType.PRISMATIC
    unit = "m" if joint.type is JointType.PRISMATIC else options.angles
    limits = (joint.limits.lower, joint.limits.upper)
    numbers = [math.degrees(limit) if limit is not None and in_degrees else limit for limit in limits]
    lower, upper = ("–" if number is None else f"{number:.{options.digits}g}" for number in numbers)
    return (_escaped(joint.name), joint.type, lower, upper, unit)


def _escaped(text: str) -> str:
    """A name from a table, with nothing in it that Markdown or HTML would act on."""
    return "".join(c if c.isalnum() or c in " -." else f"&#{ord(c)};" for c in text)


EMITTER = Emitter(
    name="datasheet",
    summary="a data sheet in Markdown: the joints and their limits",
    emit=emit,
    options=DatasheetOptions,
    suffixes=(".datasheet.md",),
)
