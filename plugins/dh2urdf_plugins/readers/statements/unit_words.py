"""The words of a statement of units, such as ``mm, deg``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.quantities import is_unit
from dh2urdf_plugins.readers.words.cells import Cell

if TYPE_CHECKING:
    from dh2urdf.documents import Node

MEANT_KEYS = {
    **dict.fromkeys(("torque", "force", "friction"), "did you mean 'effort'?"),
    **dict.fromkeys(("speed", "rate"), "did you mean 'velocity'?"),
    **dict.fromkeys(("lengths", "distance"), "did you mean 'length'?"),
    **dict.fromkeys(("angles", "rotation"), "did you mean 'angle'?"),
    **dict.fromkeys(("masses", "weight"), "did you mean 'mass'?"),
}
"""What people call the keys of `units`, which one of their letters does not show."""


def words_of_units(node: Node) -> list[Cell]:
    """The units that a text or a list names: at its commas, or at its spaces where that makes units of all."""
    if isinstance(node.value, list):
        return [word for item in node.value for word in words_of_units(item)]
    parts = [part.strip() for part in re.split("[,;]", node.text or "") if part.strip()] if node.value else []
    words = [word for part in parts for word in ([part] if is_unit(part) else part.split())]
    return [Cell(word, node.mark) for word in words]
