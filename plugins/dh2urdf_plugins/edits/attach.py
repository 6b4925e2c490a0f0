"""The edit ``attach``: a robot from a URDF or a xacro that is bolted to a link, such as a gripper on tool0.

The arm stays what its table says: tool0 keeps its place, and the proof compares it as before. The links of the gripper
are compared with its own file.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.rotations import ZERO, Vec3
from dh2urdf.source import Messages
from dh2urdf.stages import DependsOn, Edit, EditsInColumns
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from dh2urdf.cells.attachments import AttachmentCall
    from dh2urdf.robot import Attachment, Robot
    from dh2urdf.source import Problem

say = Messages(__file__)

FORMS = {".urdf": "urdf", ".xacro": "xacro"}
"""The formats of files that can be attached, by their suffixes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Keep:
    """What is kept of a file as it is."""

    elements: Literal["all", "none"] = option("elements for other programs, such as ros2_control and gazebo", "all")
    inertia: Literal["keep", "repair"] = option("repair: the nearest inertia that a body can have", "keep")
    missing_meshes: bool = option("whether meshes that are not there stay as addresses", False)


@dataclass(frozen=True, kw_only=True)
class AttachOptions:
    """What is attached, and where."""

    file: Path | None = option("URDF or xacro of what is attached. Required", None)
    name: str = option("what it is called; the joint that holds it is NAME_joint. Required", "")
    prefix: str | None = option("text before each of its names; NAME_ by default", None)
    parent: str = option("link that holds it", "tool0")
    xyz: Vec3 = option("where its first link is in the link that holds it [m]", ZERO, measures="length")
    rpy: Vec3 = option("roll, pitch, yaw of its first link there [rad]", ZERO, measures="angle")
    root: str | None = option("its link that is held; by default the one that nothing holds in its file", None)
    tip: str | None = option("its link that takes the place of tool0 as the tool; nothing moves", None)
    srdf: Path | None = option("its SRDF, which goes into the SRDF of the whole robot", None)
    args: dict[str, Any] | None = option("arguments of a xacro: a mapping of names to values", None)
    packages: dict[str, Path] | None = option("folders of ROS packages, by the names in package:// addresses", None)
    keep: Keep | Literal["none"] | None = option(
        "none: nothing beside links and joints; or a mapping of elements, inertia and missing_meshes", None
    )
    mesh_links: bool = option("whether symbolic links to meshes may lead out of the folders that name them", False)

    def __post_init__(self) -> None:
        if self.file is not None and self.file.suffix.lower() not in FORMS:
            raise ValueError(f"file: {self.file.name} is no URDF and no xacro; SDF and MJCF cannot be attached")

    @property
    def call(self) -> AttachmentCall:
        """What is asked of the file."""
        from dh2urdf.cells.attachments import AttachmentCall
        from dh2urdf.robot import Origin

        keep = Keep(elements="none") if self.keep == "none" else self.keep or Keep()
        return AttachmentCall(
            name=self.name,
            prefix=self.prefix,
            parent=self.parent,
            placement=Origin(xyz=self.xyz, rpy=self.rpy),
            root=self.root,
            tip=self.tip,
            srdf=self.srdf,
            elements=keep.elements == "all",
            repairs=keep.inertia == "repair",
            missing_meshes=keep.missing_meshes,
            packages=self.packages or {},
            mesh_links=self.mesh_links,
        )

    @cached_property
    def attachment(self) -> tuple[Attachment, tuple[Problem, ...]]:
        """What is attached, which is read once for all arms of a process, and notices about it."""
        from dh2urdf.cells.attachments import attachment_of
        from dh2urdf.stages import Expansion, arguments_of
        from dh2urdf_plugins.descriptions.description import foreign_robot

        path = self.file or Path()
        expansion = Expansion(arguments=arguments_of(self.args), package_paths=tuple((self.packages or {}).values()))
        found = foreign_robot(FORMS[path.suffix.lower()], path, expansion)
        return attachment_of(found, path, self.call)


def edit_robot(robot: Robot, options: AttachOptions) -> Robot:
    """The robot with what is attached to it."""
    from dataclasses import replace

    from dh2urdf.cells.attachments import attached
    from dh2urdf.errors import EditError, ManipulatorError, TableError

    if options.file is None or not options.name:
        raise EditError(say("attach-without-file", robot=robot.name, field="edits"))
    try:
        attachment, notices = options.attachment
        whole = attached(robot, attachment)
    except (ManipulatorError, TableError) as error:
        raise EditError(problem.about(robot=robot.name) for problem in error.problems) from error
    return replace(whole, notices=(*whole.notices, *notices))


EDIT = Edit(
    name="attach",
    summary="a gripper, a tool or a camera from its URDF or xacro, on a link of the arm",
    options=AttachOptions,
    edit_robot=edit_robot,
    capabilities=(EditsInColumns(), DependsOn(lambda options: options.attachment[0])),
)
