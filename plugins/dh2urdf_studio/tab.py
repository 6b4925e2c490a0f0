"""What every tab shows of its robots: a drawing, the joints that move it, and what of it is seen.

It knows no browser. Whatever a person does is a method; the page shows what the attributes say afterwards.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf_studio import joints
from dh2urdf_studio.drawing.scene import DECIMALS, Drawing, numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf_studio.drawing.strokes import Stroke
    from dh2urdf_studio.joints import Slider


class Tab:
    """What a tab shows."""

    def __init__(self, *layers: str) -> None:
        self.drawing = Drawing()
        self.sliders: tuple[Slider, ...] = ()  # the joints that a person moves
        self.q: dict[str, float] = {}  # their values by name [rad or m]
        self.layers = frozenset(layers)  # that were chosen
        self.opacities: dict[str, float] = {}  # of the bodies of robots, by their names, where a person has changed it
        self.hidden: frozenset[str] = frozenset()  # the names of the nodes of links that are not shown
        self._grasped = 0.0  # the value of the joint when a person took hold of a link

    @property
    def name(self) -> str:
        """What files of it are called."""
        return ""

    @property
    def shown_layers(self) -> frozenset[str]:
        """What is shown."""
        return self.layers

    def shown(self) -> Drawing:
        """The drawing as a person sees it: without what is hidden, its robots as opaque as they are wanted."""
        nodes = []
        for node in self.drawing.nodes:
            share = self.opacities.get(node.figure, 1.0)
            parts = () if node.name in self.hidden else node.parts
            bodies = (replace(part, opacity=share * part.opacity) if part.layer == "links" else part for part in parts)
            nodes.append(replace(node, parts=tuple(bodies)))
        return replace(self.drawing, nodes=tuple(nodes))

    def joint_values(self) -> dict[str, float]:
        """The pose on the screen by the names of all joints in the drawing [rad or m]."""
        return self.q

    def strokes(self) -> tuple[Stroke, ...]:
        """The DH parameters and common normals that are shown, at the pose on the screen."""
        parameters = self.drawing.strokes(self.q) if "parameters" in self.layers else ()
        return (*parameters, *(self.drawing.normals(self.joint_values()) if "normals" in self.layers else ()))

    def pose_as_json(self) -> dict[str, Any]:
        """Poses and strokes as a browser takes them: twelve numbers a pose, all in one list."""
        strokes = [
            {
                "row": stroke.row,
                "field": stroke.field,
                "label": stroke.label,
                "points": [[round(x, DECIMALS) for x in point] for point in stroke.points],
            }
            for stroke in self.strokes()
        ]
        poses = self.drawing.poses(self.joint_values())
        return {"poses": [number for pose in poses for number in numbers(pose)], "strokes": strokes}

    def fade(self, robot: str, opacity: float) -> None:
        """The bodies of a robot are looked through."""
        self.opacities[robot] = opacity

    def move(self, values: Mapping[str, float]) -> None:
        """Joint values by name [rad or m]; they are kept inside the limits."""
        self.q = joints.kept({**self.q, **values}, self.sliders)

    def drag(self, node: str, by: float, *, begins: bool) -> None:
        """A link has been dragged so far since it was taken [rad or m]: its joint moves, inside the limits."""
        grip = self.drawing.grips.get(node)
        if grip is not None and (name := self._moving(grip.joint)) is not None:
            self._grasped = self.q[name] if begins else self._grasped
            self.move({name: grip.value(self._grasped, by)})

    def _moving(self, joint: str) -> str | None:
        """The name in `q` of the joint that moves one of the drawing."""
        return joint
