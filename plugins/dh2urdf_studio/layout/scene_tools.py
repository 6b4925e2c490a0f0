"""What is above every scene: which layers it shows, from which side, what drags links, and how opaque robots are."""

from __future__ import annotations

from functools import partial
from html import escape
from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf_studio.drawing.colours import GREY
from dh2urdf_studio.drawing.scene import LAYERS
from dh2urdf_studio.panels.clicks import Menu, lay_menu_item

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from dh2urdf_studio.drawing.colours import Colour
    from dh2urdf_studio.widgets import ArmView

LEAST_OPACITY = 0.1
"""Of bodies: what is less could not be found again."""
VIEWS = {
    "front": "front (1)",
    "back": "back",
    "right": "right (3)",
    "left": "left",
    "top": "top (7)",
    "bottom": "bottom",
    "corner": "corner (9)",
}
"""The standard views, with the keys that choose them where the scene has the focus."""
WITHOUT_COLOUR = "links without a colour"
USUAL_LAYERS = ("links", "axes", "frames", "parameters")
"""Layers with a box in the bar; the others are in a menu, so that the bar takes two rows beside a table."""


class LayerBoxes:
    """A box for each layer, the rare ones in a menu; laid out where the page is being laid out.

    Args:
        shown: the layers that are shown at first.
        on_layers: takes the layers that are to be shown, whenever a person changes them.
        left_out: layers that this scene never has.
    """

    def __init__(
        self, shown: Iterable[str], on_layers: Callable[[frozenset[str]], None], *, left_out: Iterable[str] = ()
    ) -> None:
        self._on_layers = on_layers
        self._filling = False
        self._boxes: dict[str, ui.checkbox] = {}
        shown, there = frozenset(shown), [layer for layer in LAYERS if layer not in left_out]
        for layer in (layer for layer in there if layer in USUAL_LAYERS):
            self._lay(layer, shown)
        with ui.button(icon="layers").props('flat dense round size=sm aria-label="more layers"') as button:
            button.tooltip("more layers")
            with (
                Menu().props('role=dialog aria-label="more layers"'),
                ui.element("div").classes("studio-layers"),
            ):
                for layer in (layer for layer in there if layer not in USUAL_LAYERS):
                    self._lay(layer, shown)

    def show(self, shown: frozenset[str]) -> None:
        """Tick the boxes of the layers that are shown."""
        self._filling = True
        for layer, box in self._boxes.items():
            box.set_value(layer in shown)
        self._filling = False

    def _lay(self, layer: str, shown: frozenset[str]) -> None:
        box = ui.checkbox(LAYERS[layer], value=layer in shown, on_change=self._choose)
        self._boxes[layer] = box.props("dense size=xs")

    def _choose(self) -> None:
        if not self._filling:
            self._on_layers(frozenset(layer for layer, box in self._boxes.items() if box.value))


def lay_views(scene: Callable[[], ArmView]) -> None:
    """Lay out the menu of standard views, where the page is being laid out."""
    with ui.button(icon="view_in_ar").props('flat dense round size=sm aria-label="look from a side"') as button:
        button.tooltip("look from a side")
        with Menu(items=True):
            for view, told in VIEWS.items():
                lay_menu_item(told, partial(_look, scene, view))
            ui.separator()
            follow = ui.menu_item("follow what is picked", auto_close=False).classes("studio-tick")
            follow.props("role=menuitemcheckbox aria-checked=false")
            follow.on_click(lambda: scene().follow_picked(on=_switched(follow, "aria-checked")))


def lay_grasp(scene: Callable[[], ArmView]) -> None:
    """Lay out the button with which links are dragged, where the page is being laid out."""
    told = "drag links to move their joints; with Shift you always can"
    button = ui.button(icon="pan_tool").props(f'flat dense round size=sm aria-pressed=false aria-label="{told}"')
    button.tooltip(told)

    def switch() -> None:
        on = _switched(button, "aria-pressed")
        button.props(remove="flat" if on else "unelevated", add="unelevated" if on else "flat")
        scene().grasp(on=on)

    button.on_click(switch)


def lay_opacity(
    robots: Mapping[str, str],
    opacities: Mapping[str, float],
    on_fade: Callable[[str, float], None],
    plain: Colour = GREY,
    on_paint: Callable[[Colour], None] | None = None,
) -> None:
    """Lay out the menu with which bodies are looked through and painted, where the page is being laid out.

    Args:
        robots: what robots are called, by their names in the scene.
        opacities: how opaque they are, by the same names; 1 for those that are left out.
        on_fade: takes a robot's name and how opaque it is to be.
        plain: the colour of links that have none.
        on_paint: takes another colour for them, where there may be such links.
    """
    told = "opacity, and the colour of links without one" if on_paint else "opacity"
    with ui.button(icon="opacity").props(f'flat dense round size=sm aria-label="{told}"') as button:
        button.tooltip(told)
        with (
            Menu().props(f'role=dialog aria-label="{told}"'),
            ui.element("div").classes("studio-opacity"),
        ):
            for name, told in robots.items():
                ui.label(told)
                slider = ui.element("input").props(f"type=range min={LEAST_OPACITY} max=1 step=0.05")
                slider.props(f'value={opacities.get(name, 1.0)} aria-label="opacity of {escape(told)}"')
                taken = "(event) => emit(event.target.valueAsNumber)"
                slider.on("input", lambda event, name=name: on_fade(name, float(event.args)), js_handler=taken)
            if on_paint is not None:
                ui.label(WITHOUT_COLOUR)
                paint = ui.element("input").props(
                    f'type=color value="{_hexadecimal(plain)}" aria-label="{WITHOUT_COLOUR}"'
                )
                taken = "(event) => emit(event.target.value)"
                paint.on("change", lambda event: on_paint(_colour(str(event.args))), js_handler=taken)


def _hexadecimal(colour: Colour) -> str:
    """A colour as a page writes it: ``#b8bdc4``."""
    return f"#{bytes(round(255 * part) for part in colour).hex()}"


def _colour(text: str) -> Colour:
    """A colour that a page has written."""
    red, green, blue = bytes.fromhex(text.removeprefix("#"))
    return red / 255, green / 255, blue / 255


def _switched(element: ui.element, state: str) -> bool:
    """Switch the state that an attribute of an element has; whether it is on now."""
    on = str(element.props[state]) == "false"
    element.props(f"{state}={'true' if on else 'false'}")
    return on


def _look(scene: Callable[[], ArmView], view: str) -> None:
    scene().look(view)
