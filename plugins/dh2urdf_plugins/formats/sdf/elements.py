"""What a reader of SDF asks of its elements: words, numbers and poses.

Models of older versions of SDF in the words of version 1.7, as sdformat converts them. From the specifications of these
versions (http://sdformat.org/spec): before 1.7 the attribute of a pose for the frame that it is in was ``frame``. The
axis of a joint was in the frame of its model with ``use_parent_model_frame``, and before 1.5 always; sdformat keeps
that to models that are in no other, since these versions had no models in models.
"""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

from dh2urdf.robot import Origin
from dh2urdf.rotations import RigidTransform
from dh2urdf_plugins.formats.xml_files import D, FileElements

if TYPE_CHECKING:
    from collections.abc import Sequence

    from lxml import etree


MODEL = "__model__"
"""The frame of the model that an element is in."""
IN_MODEL = "use_parent_model_frame"
"""The element of an axis that said whether the axis is in the frame of the model."""
_OWN_AXES_SINCE = (1, 5)
FRAMES_SINCE = (1, 7)
LONGEST_VERSION = 20
"""Characters of the text of a version that are looked at."""


class SdfElements(FileElements):
    """Reads the elements of one file."""

    def name(self, element: etree._Element) -> str:
        """The name of an element."""
        return self.text(element, "name")

    def word(self, element: etree._Element, tag: str) -> str:
        """The text of a child."""
        return (self.child(element, tag).text or "").strip()

    def pose(self, element: etree._Element) -> RigidTransform:
        """The pose of an element in the frame that it names."""
        return self.origin(element).transform

    def origin(self, element: etree._Element) -> Origin:
        """The pose of an element as it is written."""
        pose = element.find("pose")
        if pose is None or not (text := pose.text) or text.isspace():  # It is where the frame is that it names.
            return Origin()
        if pose.get("rotation_format") == "quat_xyzw":
            x, y, z, *quaternion = self.read(element, "pose", text, 7)
            return Origin.of(RigidTransform(self.quaternion(element, quaternion), (x, y, z)))
        x, y, z, roll, pitch, yaw = self.read(element, "pose", text, 6)
        if is_true(pose.get("degrees")):
            roll, pitch, yaw = radians(roll), radians(pitch), radians(yaw)
        return Origin(xyz=(x, y, z), rpy=(roll, pitch, yaw))

    def number(self, element: etree._Element, path: str, default: D) -> float | D:
        """A number below an element; the default where there is none."""
        return default if element.find(path) is None else self.numbers(element, path, 1)[0]

    def numbers(
        self, element: etree._Element, path: str, count: int, default: Sequence[float] | None = None
    ) -> Sequence[float]:
        """As many numbers below an element as the count; the default where there are none."""
        found = element.find(path)
        if found is None and default is not None:
            return default
        text = (found.text if found is not None else None) or ""
        if "limit/" in path and text.strip().lstrip("+-").lower() in ("inf", "infinity"):
            return [float(text)]  # There is no limit.
        return self.read(element, path, text, count)


def is_true(word: str | None) -> bool:
    """Whether a word is that of SDF for true."""
    return (word or "").strip().lower() in {"1", "true"}


def modernise(root: etree._Element) -> None:
    """Writes the poses and axes of a file as version 1.7 has them; the elements are changed."""
    words = (root.get("version") or "")[:LONGEST_VERSION].split(".")
    version = tuple(int(word) for word in words if word.isdecimal())
    if not version or version >= FRAMES_SINCE:
        return
    for pose in root.iter("pose"):
        if frame := pose.get("frame"):
            pose.set("relative_to", frame)
    for axis in root.iter("axis"):
        xyz, word = axis.find("xyz"), axis.find(IN_MODEL)
        is_nested = len(list(axis.iterancestors("model"))) > 1
        is_old = version < _OWN_AXES_SINCE and not is_nested
        if xyz is not None and (is_old if word is None else is_true(word.text)):
            xyz.set("expressed_in", MODEL)
        if word is not None:
            axis.remove(word)
