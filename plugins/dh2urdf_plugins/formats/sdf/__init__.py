"""The stage ``sdf``: models for Gazebo. What writes and reads them is imported when it is called."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.stages import Emitter, GivesNotices, ReadsBack, ReadsForeign
from dh2urdf_plugins.formats import checks, foreign_sdf, notices_of_elements, read_sdf
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from dh2urdf.robot import Robot
    from dh2urdf.source import Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class SdfOptions:
    """How the model is placed in a world."""

    fixed: bool = option("hold the arm on the world, where it is spawned; without, something else has to hold it", True)


def notices(robot: Robot, options: SdfOptions) -> list[Problem]:
    """What a person should know of the file: a base's mass that no table states, and elements that are left out."""
    from dh2urdf_plugins.base_bodies import notices_for_gazebo

    return [*notices_for_gazebo(robot, filled=True), *notices_of_elements(robot, options)]


EMITTER = Emitter(
    name="sdf",
    summary="an SDF model for Gazebo, which keeps flange and tool0 as frames",
    suffixes=(".sdf",),
    options=SdfOptions,
    emit=Late(f"{__name__}.writer:sdf_files"),
    capabilities=(
        ReadsBack(read_sdf),
        ReadsForeign(foreign_sdf),
        *checks("inspection:inspect_sdf", "files:sdfs"),
        GivesNotices(notices),
    ),
)
