"""The page of `dh2urdf view`: robots in one scene, with a slider for every joint."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf_studio import dialogs, joints, viewing, words
from dh2urdf_studio.bars import LayerBoxes, lay_look, lay_opacity, lay_tools
from dh2urdf_studio.drawing.scene import faded
from dh2urdf_studio.live_joints import PageFollower
from dh2urdf_studio.panels import sharing
from dh2urdf_studio.robot_tree import RobotTree
from dh2urdf_studio.widgets import ArmView, JointSliders, Menu, row_of, small_button

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf_studio.drawing.parts import Colour
    from dh2urdf_studio.drawing.strokes import Stroke
    from dh2urdf_studio.live_joints import LiveJoints
    from dh2urdf_studio.viewing import View
    from dh2urdf_studio.widgets import ShownScene

MOST_TIPS = 12
"""Ends of arms whose poses are shown."""


class ViewPage:
    """What a tab shows of its view."""

    def __init__(self, view: View, live: LiveJoints) -> None:
        """Lays the page out; `start` fills it."""
        self.view, self._live = view, live
        ui.on_exception(dialogs.show_fault)
        with ui.element("div").classes("studio view"):
            with ui.element("header").classes("studio-head"):
                ui.html("<b>dh2urdf</b> view", sanitize=False, tag="h1").classes("studio-title")
                ui.label(viewing.told(view.figures))
                ui.element("div").classes("studio-space")
                with ui.button("Save", icon="save").props("flat dense no-caps color=white"):
                    menu = Menu(items=True)
                lay_look()
            with ui.element("section").classes("studio-motion").props('aria-label="Joints"'):
                with row_of():
                    small_button("zero", lambda: self._moved(joints.zero(view.sliders)))
                    small_button("random pose", lambda: self._moved(joints.anywhere(view.sliders)))
                self._sliders = JointSliders(on_values=self._moved)
                with _fold("links"):
                    self._tree = RobotTree(on_pick=self._pick, on_hide=self._hide)
                with _fold("ends of the arms"):
                    self._numbers = ui.html(sanitize=False).classes("studio-numbers")
            with ui.element("section").classes("studio-scene").props('aria-label="Scene"'):
                self._lay_scene()
            with menu:
                sharing.lay_scene_items(self._scene, self._shown)

    def _shown(self) -> ShownScene:
        """What is on the screen now."""
        view = self.view
        name = viewing.told(view.figures).replace(", ", "-")
        return name, faded(view.drawing, view.opacities, view.hidden), view.q, view.layers

    def _lay_scene(self) -> None:
        view = self.view
        with ui.element("div").classes("studio-bar"):
            tables = any(figure.manipulator for figure in view.figures)
            LayerBoxes(view.layers, self._choose_layers, left_out=() if tables else ("parameters",))
            if len(view.figures) > 1:
                choice = ui.toggle({True: "side by side", False: "at one place"}, value=view.apart)
                choice.props("dense unelevated no-caps")
                choice.on_value_change(lambda event: self._place(apart=bool(event.value)))
            if view.turns:
                up = ui.toggle({True: "meshes as in ROS", False: "as their files say"}, value=view.as_in_ros)
                up.props("dense unelevated no-caps")
                up.on_value_change(lambda event: self._place(as_in_ros=bool(event.value)))
                up.tooltip("COLLADA files name the axis that points up. RViz and MoveIt take z, whatever they name.")
            with lay_tools(lambda: self._scene, "see all"):
                titles = {figure.name: figure.title or figure.robot.name for figure in view.figures}
                lay_opacity(titles, view.opacities, self._fade, view.plain, lambda colour: self._place(plain=colour))
        if unseen := view.drawing.unseen:
            told = words.count(len(unseen), "mesh file was not found", "mesh files were not found")
            _remark(f"{told}: {words.some_of(unseen)}", unseen)
        if left_out := [notice.message for figure in view.figures for notice in figure.notices]:
            _remark(words.some_of(left_out), left_out)
        self._scene = ArmView(on_undrawn=dialogs.Warnings().add, on_pick_node=self._picked_in_scene, on_grip=self._drag)

    def _picked_in_scene(self, node: str | None) -> None:
        self._pick(node)
        self._tree.pick(node)

    def _pick(self, node: str | None) -> None:
        self._scene.run_method("highlight", None, node)

    def _hide(self, nodes: frozenset[str]) -> None:
        self.view.hidden = nodes
        self._scene.run_method("hide", sorted(nodes))

    def _fade(self, robot: str, opacity: float) -> None:
        self.view.opacities[robot] = opacity
        self._scene.run_method("fade", self.view.opacities)

    async def start(self) -> None:
        """Shows the view for the first time."""
        view = self.view
        self._scene.set_layers(view.layers)
        self._tree.show(view.figures, view.hidden)
        self._scene.run_method("hide", sorted(view.hidden))
        self._scene.run_method("fade", view.opacities)
        self._show()
        self._scene.run_method("fit", False)
        PageFollower(self._live, self._scene, self._show_pose)

    def _show(self) -> None:
        view = self.view
        self._scene.show(view.drawing, view.drawing.poses(view.q), self._strokes())
        self._sliders.show(view.sliders, view.q)
        self._show_numbers()

    def _show_pose(self) -> None:
        self._scene.pose(self.view.drawing.poses(self.view.q), self._strokes())
        self._sliders.answer(self.view.q)
        self._show_numbers()

    def _strokes(self) -> Sequence[Stroke]:
        drawing, q, layers = self.view.drawing, self.view.q, self.view.layers
        parameters = drawing.strokes(q) if "parameters" in layers else ()
        return (*parameters, *(drawing.normals(q) if "normals" in layers else ()))

    def _show_numbers(self) -> None:
        lines = []
        for name, pose in list(self.view.tips())[:MOST_TIPS]:
            xyz = ", ".join(f"{x + 0.0:.4f}" for x in pose.translation)
            rpy = ", ".join(f"{math.degrees(x) + 0.0:.2f}" for x in pose.rpy)
            lines.append(f"<div><b>{escape(name)}</b><br>xyz {xyz} m<br>rpy {rpy} °</div>")
        self._numbers.set_content("".join(lines))

    def _choose_layers(self, layers: frozenset[str]) -> None:
        self.view.layers = layers
        self._scene.set_layers(layers)
        self._show_pose()

    def _place(self, *, apart: bool | None = None, as_in_ros: bool | None = None, plain: Colour | None = None) -> None:
        self.view.place(apart=apart, as_in_ros=as_in_ros, plain=plain)
        self._show()
        if apart is not None:
            self._scene.run_method("fit", False)

    def _drag(self, node: str, by: float, *, begins: bool) -> None:
        self.view.drag(node, by, begins=begins)
        self._live.note(self.view)
        self._show_pose()

    def _moved(self, values: Mapping[str, float]) -> None:
        self.view.move(values)
        self._live.note(self.view)
        self._show_pose()


def _fold(told: str) -> ui.element:
    """Lay out a part of the page that can be folded."""
    with ui.element("details").classes("studio-fold").props("open") as fold, ui.element("summary"):
        ui.label(told)
    return fold


def _remark(text: str, lines: Sequence[str]) -> None:
    """A text below the bar, and the lines that it is the short form of."""
    ui.label(text).classes("studio-bar studio-remark").tooltip("\n".join(lines[:50]))
