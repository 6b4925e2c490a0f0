"""A drawing as it is on the screen: without the links that are hidden, and as opaque as a person wants its robots."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from dh2urdf_studio.drawing.scene import Drawing


def faded(drawing: Drawing, opacities: Mapping[str, float], hidden: Collection[str] = ()) -> Drawing:
    """The drawing that a person sees.

    Args:
        drawing: the robots.
        opacities: how opaque their bodies are, by the names of the robots; 1 for those that are left out.
        hidden: the names of the nodes that are not shown.
    """
    nodes = []
    for node in drawing.nodes:
        share = opacities.get(node.figure, 1.0)
        parts = () if node.name in hidden else node.parts
        bodies = (replace(part, opacity=share * part.opacity) if part.layer == "links" else part for part in parts)
        nodes.append(replace(node, parts=tuple(bodies)))
    return replace(drawing, nodes=tuple(nodes))
