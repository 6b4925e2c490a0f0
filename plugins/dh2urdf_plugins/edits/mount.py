"""The edit ``mount``: a frame that is fixed to a link, such as that of a camera, with a body or without."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.stages import Edit, EditsInColumns
from dh2urdf_plugins.edits.mount_options import MountOptions

if TYPE_CHECKING:
    from dh2urdf.robot import Robot


def edit_robot(robot: Robot, options: MountOptions) -> Robot:
    """The robot with one more link on a fixed joint, and an optical frame in it where that is asked for.

    Raises:
        EditError: there is no such parent, or a name is taken or missing.
    """
    from dh2urdf_plugins.edits.mounting import mounted

    return mounted(robot, options)


EDIT = Edit(
    name="mount",
    summary="a link on a fixed joint: the frame of a camera or of another sensor, with a box or without",
    options=MountOptions,
    edit_robot=edit_robot,
    capabilities=(EditsInColumns(),),
)
