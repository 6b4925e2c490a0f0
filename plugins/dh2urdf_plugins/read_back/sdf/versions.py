"""Models of older versions of SDF in the words of version 1.7, as sdformat converts them.

From the specifications of these versions (http://sdformat.org/spec): before 1.7 the attribute of a pose for the frame
that it is in was ``frame``. The axis of a joint was in the frame of its model with ``use_parent_model_frame``, and
before 1.5 always; sdformat keeps that to models that are in no other, since these versions had no models in models.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf_plugins.read_back.sdf.elements import is_true

if TYPE_CHECKING:
    from lxml import etree

MODEL = "__model__"
"""The frame of the model that an element is in."""
IN_MODEL = "use_parent_model_frame"
"""The element of an axis that said whether the axis is in the frame of the model."""
_OWN_AXES_SINCE = (1, 5)
FRAMES_SINCE = (1, 7)
LONGEST_VERSION = 20
"""Characters of the text of a version that are looked at."""


def modernise(root: etree._Element) -> None:
    """Writes the poses and axes of a file as version 1.7 has them.

    Args:
        root: the outermost element; it is changed.
    """
    words = (root.get("version") or "")[:LONGEST_VERSION].split(".")
    version = tuple(int(word) for word in words if word.isdecimal())
    if not version or version >= FRAMES_SINCE:
        return
    for pose in root.iter("pose"):
        if frame := pose.get("frame"):
            pose.set("relative_to", frame)
    for axis in root.iter("axis"):
        xyz, word = axis.find("xyz"), axis.find(IN_MODEL)
        is_old = version < _OWN_AXES_SINCE and not _is_nested(axis)
        if xyz is not None and (is_old if word is None else is_true(word.text)):
            xyz.set("expressed_in", MODEL)
        if word is not None:
            axis.remove(word)


def _is_nested(axis: etree._Element) -> bool:
    return sum(1 for _ in axis.iterancestors("model")) > 1
