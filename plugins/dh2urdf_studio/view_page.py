"""The page of `dh2urdf view`: robots in one scene, a slider for every joint, and a tree of what they consist of."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, Any

from nicegui import ui
from nicegui.element import Element

from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf.source import listed
from dh2urdf_studio import dialogs, words
from dh2urdf_studio.drawing.scene import from_root
from dh2urdf_studio.live_joints import PageFollower
from dh2urdf_studio.scene_page import ScenePage, lay_look
from dh2urdf_studio.widgets import QUIET, ArmView, JointSliders, Menu, section, toggle

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

    from dh2urdf.robot import Geometry, Joint, Link, Origin
    from dh2urdf_studio.drawing.parts import Colour
    from dh2urdf_studio.drawing.scene import Figure
    from dh2urdf_studio.live_joints import LiveJoints
    from dh2urdf_studio.viewing import View

MOST_TIPS = 12  # ends of arms whose poses are shown
_POWERS = ("", "²", "³", "⁴")


class ViewPage(ScenePage):
    """What a tab shows of its view."""

    def __init__(self, view: View, live: LiveJoints) -> None:
        super().__init__(view, on_person=lambda: live.note(view))
        self.view, self._live = view, live
        with ui.element("div").classes("studio view"):
            with ui.element("header").classes("studio-head"):
                ui.html("<b>dh2urdf</b> view", sanitize=False, tag="h1").classes("studio-title")
                ui.label(view.told)
                ui.element("div").classes("studio-space")
                with ui.button("Save", icon="save").props(QUIET), Menu(items=True):
                    self._lay_scene_items()
                lay_look()
            with section("studio-motion", "Joints"):
                self._sliders = JointSliders(on_values=self._moved)
                with _fold("links"):
                    self._tree = RobotTree(on_pick=self._pick, on_hide=self._hide)
                with _fold("ends of the arms"):
                    self._numbers = ui.html(sanitize=False).classes("studio-numbers")
            with section("studio-scene", "Scene"):
                self._lay_scene()

    def _lay_scene(self) -> None:
        view = self.view
        with ui.element("div").classes("studio-bar"):
            tables = any(figure.manipulator for figure in view.figures)
            self._lay_layers(left_out=() if tables else ("parameters",))
            if len(view.figures) > 1:
                places = {True: "side by side", False: "at one place"}
                toggle(places, "place", lambda event: self._place(apart=bool(event.value)), view.apart)
            if view.turns:
                ways = {True: "meshes as in ROS", False: "as their files say"}
                up = toggle(ways, "meshes", lambda event: self._place(as_in_ros=bool(event.value)), view.as_in_ros)
                up.tooltip("COLLADA files name the axis that points up. RViz and MoveIt take z, whatever they name.")
            with self._lay_tools("see all"):
                titles = {figure.name: figure.title or figure.robot.name for figure in view.figures}
                self._lay_opacity(titles, view.plain, lambda colour: self._place(plain=colour))
        unseen, left_out = view.drawing.unseen, [each.message for figure in view.figures for each in figure.notices]
        for text, lines in ((words.unseen(unseen), unseen), (listed(left_out, words.MOST_LOST), left_out)):
            if lines:
                ui.label(text).classes("studio-bar studio-remark").tooltip("\n".join(lines[:50]))
        self._scene = ArmView(dialogs.Warnings().add, self._drag, on_pick_node=self._picked_in_scene)

    def _picked_in_scene(self, node: str | None) -> None:
        self._pick(node)
        self._tree.run_method("choose", node)

    def _pick(self, node: str | None) -> None:
        self._tell("highlight", None, node)

    def _hide(self, nodes: frozenset[str]) -> None:
        self.view.hidden = nodes
        self._tell("hide", sorted(nodes))

    async def start(self) -> None:
        """Shows the view for the first time."""
        view = self.view
        self._tree.show(view.figures, view.hidden)
        self._tell("hide", sorted(view.hidden))
        self._tell("fade", view.opacities)
        self._show_arm()
        self._tell("fit", False)
        PageFollower(self._live, self._scene, self._show_pose)

    def _show_numbers(self) -> None:
        lines = []
        for name, pose in list(self.view.tips())[:MOST_TIPS]:
            xyz = ", ".join(f"{x + 0.0:.4f}" for x in pose.translation)
            rpy = ", ".join(f"{math.degrees(x) + 0.0:.2f}" for x in pose.rpy)
            lines.append(f"<div><b>{escape(name)}</b><br>xyz {xyz} m<br>rpy {rpy} °</div>")
        self._numbers.set_content("".join(lines))

    def _place(self, *, apart: bool | None = None, as_in_ros: bool | None = None, plain: Colour | None = None) -> None:
        self.view.place(apart=apart, as_in_ros=as_in_ros, plain=plain)
        self._show_arm()
        if apart is not None:
            self._tell("fit", False)


def _fold(told: str) -> ui.element:
    """Lay out a part of the page that can be folded."""
    with ui.element("details").classes("studio-fold").props("open") as fold, ui.element("summary"):
        ui.label(told)
    return fold


class RobotTree(Element, component="robot_tree.js"):  # type: ignore[call-arg]  # Element is any type to mypy
    """A tree that folds; a link can be picked, and hidden in the scene."""

    def __init__(self, on_pick: Callable[[str | None], None], on_hide: Callable[[frozenset[str]], None]) -> None:
        super().__init__()
        self._nodes: frozenset[str] = frozenset()
        self.on("pick", lambda event: on_pick(next(iter(self._nodes & {event.args["node"]}), None)))
        self.on("hide", lambda event: on_hide(self._nodes.intersection(map(str, event.args["nodes"]))))

    def show(self, figures: Sequence[Figure], hidden: Collection[str]) -> None:
        """Show the robots, and which links are hidden, by the names of their nodes."""
        robots = [contents(figure) for figure in figures]
        self._nodes = frozenset(link["node"] for robot in robots for link in robot["links"])
        self.run_method("show", robots, sorted(hidden))


def contents(figure: Figure) -> dict[str, Any]:
    """A robot as `robot_tree.js` takes it: its links, each with its joint, its shapes, its mass and its frame."""
    above, links = {joint.child: joint for joint in reversed(figure.robot.joints)}, []
    for link, _ in from_root(figure.robot):
        items = [{"kind": kind, "text": text} for kind, text in _items(figure, link, above.get(link.name))]
        links.append({"node": figure.name + link.name, "name": link.name, "items": items})
    return {"name": figure.title or figure.robot.name or "robot", "links": links}


def _items(figure: Figure, link: Link, joint: Joint | None) -> Iterator[tuple[str, str]]:
    if joint is not None:
        yield "joint", _joint(joint, figure)
        yield "frame", f"{_place(joint.origin)} in {joint.parent}"
    else:
        yield "frame", "the root"
    for visual in link.visuals:
        colour = visual.material.name if visual.material else ""
        yield "visual", _geometry(visual.geometry) + (f", {colour}" if colour else "") + _off(visual.origin)
    for collision in link.collisions:
        yield "collision", _geometry(collision.geometry) + _off(collision.origin)
    if link.inertial is not None:
        mass, i = link.inertial.mass, link.inertial.inertia
        told = f"{mass:.4g} kg at ({_numbers(link.inertial.com)}) m; ixx, iyy, izz ({_numbers((i.ixx, i.iyy, i.izz))})"
        products = (i.ixy, i.ixz, i.iyz)
        yield "mass", f"{told} kg·m²" + (f"; ixy, ixz, iyz ({_numbers(products)})" if any(products) else "")


def _joint(joint: Joint, figure: Figure) -> str:
    kind = figure.loose.get(joint.name)
    if kind is not None or joint.type is JointType.FIXED:
        return f"{joint.name}: {f'{kind}, drawn as ' if kind else ''}fixed"
    slides = joint.type is JointType.PRISMATIC
    words = [f"{joint.name}: {joint.type.value} {'along' if slides else 'about'} ({_numbers(joint.axis)})"]
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.type is not JointType.CONTINUOUS and lower is not None and upper is not None:
        words.append(" to ".join(f"{end:.4g} m" if slides else f"{math.degrees(end):.4g}°" for end in (lower, upper)))
    if (follower := figure.robot.followers.get(joint.name)) is not None:
        told = f"follows {follower.multiplier:.4g} · {follower.leader}"
        for factor, power in zip((follower.offset, *follower.higher), _POWERS, strict=False):
            if factor:
                leader = f" · {follower.leader}{power}" if power else ""
                told += f" {'+' if factor > 0 else '−'} {abs(factor):.4g}{leader}"
        words.append(told if follower.leader else f"kept at {follower.offset:.4g}")
    return ", ".join(words)


def _geometry(geometry: Geometry) -> str:
    match geometry:
        case Box(size=size):
            return f"box {' × '.join(f'{side:.4g}' for side in size)} m"
        case Cylinder(radius=radius, length=length):
            return f"cylinder, radius {radius:.4g} m, length {length:.4g} m"
        case Sphere(radius=radius):
            return f"sphere, radius {radius:.4g} m"
        case Mesh(filename=filename, scale=scale):
            factors = "" if scale == (1.0, 1.0, 1.0) else f" × ({_numbers(scale)})"
            return f"mesh {filename.replace(chr(92), '/').rpartition('/')[2]}{factors}"


def _off(origin: Origin) -> str:
    return f", {_place(origin)}" if any((*origin.xyz, *origin.rpy)) else ""


def _place(origin: Origin) -> str:
    turned = f", rpy ({_numbers(map(math.degrees, origin.rpy))})°" if any(origin.rpy) else ""
    return f"xyz ({_numbers(origin.xyz)}) m{turned}"


def _numbers(numbers: Iterable[float]) -> str:
    return ", ".join(f"{number + 0.0:.4g}" for number in numbers)
