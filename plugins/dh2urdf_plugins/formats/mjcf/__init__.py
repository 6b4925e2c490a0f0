"""The stage ``mjcf``: models for MuJoCo. What writes and reads them is imported when it is called."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from dh2urdf.stages import Emitter, GivesNotices, ReadsBack, ReadsForeign
from dh2urdf_plugins.formats import checks, foreign_mjcf, read_mjcf
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.options import option


@dataclass(frozen=True, slots=True, kw_only=True)
class MjcfOptions:
    """What moves the arm, and what of it does not touch."""

    actuators: Literal["position", "motor", "none"] = option(
        "position: servos that hold the arm; motor: torques and forces; all within the efforts", "position"
    )
    excludes: Literal["home", "neighbours", "touching"] = option(
        "links without contacts: neighbours; home: also links that touch where the arm starts; "
        "touching: also links that always touch, for which pinocchio is needed",
        "home",
    )
    followers: Literal["equality", "connect"] = option(
        "equality of joint values; connect: a joint that turns back what its leader turns is held by a bar instead, "
        "which makes a parallelogram",
        "equality",
    )


EMITTER = Emitter(
    name="mjcf",
    summary="an MJCF model for MuJoCo, with actuators, sites for flange and tool0, and no contacts of neighbours",
    suffixes=(".xml", ".mjcf"),
    options=MjcfOptions,
    emit=Late(f"{__name__}.writer:mjcf_files"),
    capabilities=(
        ReadsBack(read_mjcf),
        ReadsForeign(foreign_mjcf),
        *checks("inspection:inspect_mjcf", "files:mjcfs"),
        GivesNotices(Late(f"{__name__}.bars:mjcf_notices")),
    ),
)
