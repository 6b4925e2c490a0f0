"""What the pages of studio and view have in common: layers, views, opacity and looks; and files that are dropped."""

from __future__ import annotations

import json
from contextlib import suppress
from html import escape
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from nicegui import run, ui

from dh2urdf_studio import dialogs, words
from dh2urdf_studio.drawing.parts import GREY
from dh2urdf_studio.drawing.scene import LAYERS
from dh2urdf_studio.editing.opening import tables_of
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.widgets import ANSWERED, QUIET, Menu, icon_button, lay_menu_item

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf_studio.drawing.parts import Colour
    from dh2urdf_studio.widgets import ArmView

USUAL_LAYERS = ("links", "axes", "frames", "parameters")
"""Layers with a box in the bar; the others are in a menu, so that the bar takes two rows beside a table."""
LEAST_OPACITY = 0.1
"""The smallest opacity of bodies: what is less could not be found again."""
WITHOUT_COLOUR = "links without a colour"


def lay_look() -> None:
    """Lay out the menu by which a person chooses how the pages look; what is chosen stays in the browser."""
    told = "light, dark, projector"

    def lay(text: str, data: str, act: str) -> None:
        item = ui.menu_item(text, auto_close=False).classes("studio-look").props(f"{data} role=menuitem")
        item.on("click", js_handler=f"() => dhLook.{act}")

    with ui.button(icon="contrast").props(f'{QUIET} aria-label="{told}"') as button:
        button.tooltip(told)
        with Menu(items=True).props(f'aria-label="{told}"') as menu:
            for scheme, text in PAGE["schemes"].items():
                lay(text, f'data-scheme="{scheme}"', f"choose('{scheme}')")
            ui.separator()
            lay("projector: larger text and lines", 'data-size="large"', "magnify()")
            lay("smooth edges", 'data-edges="smooth"', "smooth()")
        menu.on("show", js_handler="() => dhLook.mark()")


def lay_files(page: ui.element, catalog: Catalog, on_table: Callable[..., Any]) -> str:
    """A file that is dropped on a page, or chosen, is opened; parts of the page may take dropped files first.

    Returns:
        What the page calls to let a person choose a file.
    """

    async def take(event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        if event.file.size() > dialogs.LARGEST_FILE:
            dialogs.warn(told["too much"])
            return
        name = unquote(event.file.name)
        with page:
            busy = ui.notification(words.busy(name, event.file.size()), spinner=True, timeout=None)
        try:
            tables = await run.io_bound(tables_of, name, await event.file.read(), catalog, dialogs.MOST_CHOICES + 1)
        finally:
            busy.dismiss()
        if isinstance(tables, str):
            dialogs.warn(tables)
            return
        # What is being typed, and what is on its way by the socket, belongs to the table that is still there.
        with suppress(TimeoutError):
            await page.client.run_javascript("dhPage.leave()", timeout=ANSWERED)
        if not page.is_deleted:
            await on_table(await dialogs.choose(tables))

    suffixes = [suffix for item in catalog.provided("reader") for suffix in getattr(item.stage, "suffixes", ())]
    with page:
        upload = ui.upload(on_upload=take).style("display: none")
    told = {
        "none": f"This is not a file that can be opened. Accepted: one of {', '.join(suffixes)}.",
        "too much": f"Open one file, of at most {dialogs.LARGEST_FILE // 2**20} MB. Descriptions with their meshes "
        "can be dropped on the panel that compares them with the table.",
        "lost": dialogs.LOST,
    }
    ui.on("dh-no-table", lambda event: dialogs.warn(told[str(event.args)]))
    wanted = json.dumps({"ends": suffixes, "most": 1, "largest": dialogs.LARGEST_FILE, "refused": "dh-no-table"})
    where = f"{json.dumps(upload.props['url'])}, {wanted}"
    page.on("drop", js_handler=f"event => dhPage.drop(event, {where})")
    return f"dhPage.choose({where}, false)"


def lay_layers(
    shown: Collection[str], on_layers: Callable[[frozenset[str]], None], *, left_out: Collection[str] = ()
) -> None:
    """Lay out a box for each layer, the rare ones in a menu."""
    boxes: dict[str, ui.checkbox] = {}

    def choose() -> None:
        on_layers(frozenset(layer for layer, box in boxes.items() if box.value))

    def lay(*, usual: bool) -> None:
        for layer in sorted(LAYERS.keys() - left_out, key=list(LAYERS).index):
            if (layer in USUAL_LAYERS) is usual:
                boxes[layer] = ui.checkbox(LAYERS[layer], value=layer in shown, on_change=choose).props("dense size=xs")

    lay(usual=True)
    with (
        icon_button("layers", "more layers"),
        Menu().props('role=dialog aria-label="more layers"'),
        ui.element("div").classes("studio-layers"),
    ):
        lay(usual=False)


def lay_tools(scene: Callable[[], ArmView], see_all: str) -> ui.element:
    """Lay out what every scene has: a button that sees all, the standard views, and the hand that drags links."""
    with ui.element("div").classes("studio-tools") as tools:
        icon_button("center_focus_strong", see_all, lambda: scene().run_method("fit", False))
        with icon_button("view_in_ar", "look from a side"), Menu(items=True):
            for view, told in PAGE["views"].items():
                lay_menu_item(told, lambda view=view: scene().run_method("look", view))  # type: ignore[misc]  # of a default
            ui.separator()
            follow = ui.menu_item("follow what is picked", auto_close=False).classes("studio-tick")
            follow.props("role=menuitemcheckbox aria-checked=false")
            follow.on_click(lambda: scene().run_method("followPicked", _switched(follow, "aria-checked")))
        hand = icon_button("pan_tool", "drag links to move their joints; with Shift you always can")

        def grasp() -> None:
            on = _switched(hand, "aria-pressed")
            hand.props(remove="flat" if on else "unelevated", add="unelevated" if on else "flat")
            scene().run_method("grasp", on)

        hand.props("aria-pressed=false").on_click(grasp)
    return tools


def lay_opacity(
    robots: Mapping[str, str],
    opacities: Mapping[str, float],
    on_fade: Callable[[str, float], None],
    plain: Colour = GREY,
    on_paint: Callable[[Colour], None] | None = None,
) -> None:
    """Lay out the menu with which bodies are looked through and painted."""
    told = "opacity, and the colour of links without one" if on_paint else "opacity"

    def painted(text: str) -> None:
        """A colour as a page writes it: ``#b8bdc4``."""
        red, green, blue = bytes.fromhex(text.removeprefix("#"))
        if on_paint is not None:
            on_paint((red / 255, green / 255, blue / 255))

    with (
        icon_button("opacity", told),
        Menu().props(f'role=dialog aria-label="{told}"'),
        ui.element("div").classes("studio-opacity"),
    ):
        for name, title in robots.items():
            ui.label(title)
            slider = ui.element("input").props(f"type=range min={LEAST_OPACITY} max=1 step=0.05")
            slider.props(f'value={opacities.get(name, 1.0)} aria-label="opacity of {escape(title)}"')
            taken = "(event) => emit(event.target.valueAsNumber)"
            slider.on("input", lambda event, name=name: on_fade(name, float(event.args)), js_handler=taken)
        if on_paint is not None:
            ui.label(WITHOUT_COLOUR)
            colour = f"#{bytes(round(255 * part) for part in plain).hex()}"
            paint = ui.element("input").props(f'type=color value="{colour}" aria-label="{WITHOUT_COLOUR}"')
            taken = "(event) => emit(event.target.value)"
            paint.on("change", lambda event: painted(str(event.args)), js_handler=taken)


def _switched(element: ui.element, state: str) -> bool:
    """Switch the state that an attribute of an element has; whether it is on now."""
    on = str(element.props[state]) == "false"
    element.props(f"{state}={'true' if on else 'false'}")
    return on
