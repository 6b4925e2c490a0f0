"""Formats of robot descriptions: each has a writer, and a reader for the proof that shares no code with the writer.

The functions here are those that the records of the stages name; they are imported when they are called.
"""

from __future__ import annotations

import re
from collections import Counter
from functools import partial
from importlib.util import find_spec
from typing import TYPE_CHECKING

from dh2urdf.source import Messages, Problem
from dh2urdf.stages import Checks
from dh2urdf_plugins.late import Late

if TYPE_CHECKING:
    from collections.abc import Collection

    from dh2urdf.robot import Robot

say = Messages(__file__)

read_urdf = Late(f"{__name__}.urdf.reader:read_urdf")
read_urdfs = Late(f"{__name__}.urdf.scanner:scan_columns")
read_xacro = Late(f"{__name__}.xacro.reader:read_xacro")
read_sdf = Late(f"{__name__}.sdf.reader:read_sdf")
read_mjcf = Late(f"{__name__}.mjcf.reader:read_mjcf")
read_foreign_xacro = Late(f"{__name__}.xacro.reader:read_foreign_xacro")
foreign_urdf, foreign_xacro, foreign_sdf, foreign_mjcf = (
    partial(Late("dh2urdf_plugins.descriptions.description:foreign_robot"), form)
    for form in ("urdf", "xacro", "sdf", "mjcf")
)


def checks(check: str, descriptions: str, fix: str = "", *, finds_packages: bool = False) -> tuple[Checks, ...]:
    """The capability `Checks` of an emitter, with functions of the plugin of ``dh2urdf check`` as ``module:name``.

    There is none where the plugin is not installed.
    """
    if find_spec("dh2urdf_check") is None:
        return ()
    function = "dh2urdf_check.{}".format
    fixes = Late(function(fix)) if fix else None
    ask = Late(function("ask.findings:with_what_is_seen"))
    return (Checks(Late(function(check)), Late(function(descriptions)), fixes, finds_packages, ask),)


def notices_of_elements(robot: Robot, _options: object) -> list[Problem]:
    """A notice for each tag of the elements of attachments that are for other programs, which URDF alone keeps."""
    found = [re.match(r"<([^\s/>]+)", text) for each in robot.attachments for text in each.elements]
    counts = Counter(match[1] for match in found if match)
    materials = [each.material for link in robot.links for each in link.visuals if each.material]
    if textured := {each.name for each in materials if each.texture}:
        counts["texture"] = len(textured)
    return [say("elements-in-urdf-only", tag=tag, count=count) for tag, count in counts.items()]


def numbered_name(name: str, taken: Collection[str]) -> str:
    """A name that is not taken, with ``_2`` or a higher number behind it where it is."""
    found, number = name, 1
    while found in taken:
        number += 1
        found = f"{name}_{number}"
    return found
