"""The words of a statement of units, such as ``mm, deg``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.quantities import UNITS, Dimension, is_unit, unit_word
from dh2urdf_plugins.readers.words.cells import Cell

if TYPE_CHECKING:
    from dh2urdf.documents import Node

_BETWEEN = r"\s*[/&]\s*|\s+(?:and|und|et|y|e)\s+|\s+"
MEANT_KEYS = {
    **dict.fromkeys(("torque", "force", "friction"), "did you mean 'effort'?"),
    **dict.fromkeys(("speed", "rate"), "did you mean 'velocity'?"),
    **dict.fromkeys(("lengths", "distance"), "did you mean 'length'?"),
    **dict.fromkeys(("angles", "rotation"), "did you mean 'angle'?"),
    **dict.fromkeys(("masses", "weight"), "did you mean 'mass'?"),
    **dict.fromkeys(
        ("a", "d", "r", "alpha", "theta"), "write the unit of a column in its header, as `a [mm]`, or in its cells"
    ),
}
"""What people call the keys of `units`, which one of their letters does not show."""


def words_of_units(node: Node) -> list[Cell]:
    """The units that a text or a list names: at its commas, or at spaces and such where that makes units of all."""
    if isinstance(node.value, list):
        return [word for item in node.value for word in words_of_units(item)]
    parts = [part.strip() for part in re.split("[,;]", node.text or "") if part.strip()] if node.value else []
    return [Cell(word, node.mark) for part in parts for word in _words(part)]


def _words(part: str) -> list[str]:
    """The units of a part: one, or several with spaces, with a slash as in ``mm/deg`` or with a word between them."""
    if is_unit(part):
        return [part]
    several = re.split(_BETWEEN, part)
    units = [UNITS.get(unit_word(word)) for word in several]
    are_measures = all(unit and unit.dimension in (Dimension.LENGTH, Dimension.ANGLE) for unit in units)
    return several if are_measures else part.split()
