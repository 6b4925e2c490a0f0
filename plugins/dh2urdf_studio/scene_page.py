"""What the pages of studio and view have in common: the scene with its bar, looks, and files that are dropped."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from html import escape
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from nicegui import run, ui

from dh2urdf.errors import Dh2UrdfError
from dh2urdf.output.whole_files import safe_stem
from dh2urdf_studio import dialogs
from dh2urdf_studio.drawing import exports
from dh2urdf_studio.drawing.parts import GREY
from dh2urdf_studio.drawing.scene import LAYERS
from dh2urdf_studio.editing.opening import tables_of
from dh2urdf_studio.editing.save import Saved
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.widgets import ANSWERED, QUIET, Menu, icon_button, lay_menu_item, lay_upload

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Collection, Mapping

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf_studio.drawing.parts import Colour
    from dh2urdf_studio.tab import Tab
    from dh2urdf_studio.widgets import ArmView, JointSliders

USUAL_LAYERS = ("links", "axes", "frames", "parameters")
"""Layers with a box in the bar; the others are in a menu, so that the bar takes two rows beside a table."""
LEAST_OPACITY = 0.1  # the smallest opacity of bodies: what is less could not be found again
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
    """A file that is dropped on a page, or chosen by what it returns, is opened; parts may take dropped files first."""

    async def take(event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        if event.file.size() > dialogs.LARGEST_FILE:
            dialogs.warn(told["too much"])
            return
        name, size = unquote(event.file.name), event.file.size()
        told_size = f"{size / 1e6:.1f} MB" if size >= 1e5 else f"{max(size / 1e3, 0.1):.1f} kB"  # noqa: PLR2004 - [B]
        with page:
            busy = ui.notification(f"reading {name}, {told_size}", spinner=True, timeout=None)
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
    told = {
        "none": f"This is not a file that can be opened. Accepted: one of {', '.join(suffixes)}.",
        "too much": f"Open one file, of at most {dialogs.LARGEST_FILE // 2**20} MB. Descriptions with their meshes "
        "can be dropped on the panel that compares them with the table.",
        "lost": dialogs.LOST,
    }
    ui.on("dh-no-table", lambda event: dialogs.warn(told[str(event.args)]))
    wanted = {"ends": suffixes, "most": 1, "largest": dialogs.LARGEST_FILE, "refused": "dh-no-table"}
    return f"dhPage.choose({lay_upload(page, wanted, on_upload=take)}, false)"


class ScenePage:
    """What a page does with the scene and the sliders of its tab; `on_person` is called when a person moves joints."""

    _scene: ArmView
    _sliders: JointSliders

    def __init__(self, tab: Tab, on_person: Callable[[], None] = lambda: None) -> None:
        self._tab, self._on_person = tab, on_person
        ui.on_exception(dialogs.show_fault)

    def _tell(self, method: str, *arguments: object) -> None:
        self._scene.run_method(method, *arguments)

    def _show_arm(self) -> None:
        self._scene.show(self._tab)
        self._sliders.show(self._tab.sliders, self._tab.q)
        self._show_numbers()

    def _show_pose(self) -> None:
        self._scene.pose(self._tab)
        self._sliders.answer(self._tab.q)
        self._show_numbers()

    def _show_numbers(self) -> None:
        """Shows where the arm is."""

    def _drag(self, node: str, by: float, *, begins: bool) -> None:
        self._tab.drag(node, by, begins=begins)
        self._on_person()
        self._show_pose()

    def _moved(self, values: Mapping[str, float]) -> None:
        self._tab.move(values)
        self._on_person()
        self._show_pose()

    def _fade(self, robot: str, opacity: float) -> None:
        self._tab.fade(robot, opacity)
        self._tell("fade", self._tab.opacities)

    # --- The bar ------------------------------------------------------------------------------------------------------

    def _lay_layers(self, left_out: Collection[str] = ()) -> None:
        """Lay out a box for each layer, the rare ones in a menu."""
        boxes: dict[str, ui.checkbox] = {}

        def choose() -> None:
            self._tab.layers = frozenset(layer for layer, box in boxes.items() if box.value)
            self._show_pose()

        def lay(*, usual: bool) -> None:
            for layer, told in LAYERS.items():
                if layer not in left_out and (layer in USUAL_LAYERS) is usual:
                    box = ui.checkbox(told, value=layer in self._tab.layers, on_change=choose)
                    boxes[layer] = box.props("dense size=xs")

        lay(usual=True)
        with _dialog("layers", "more layers"):
            lay(usual=False)

    def _lay_tools(self, see_all: str) -> ui.element:
        """Lay out what every scene has: a button that sees all, the standard views, and the hand that drags links."""
        with ui.element("div").classes("studio-tools") as tools:
            icon_button("center_focus_strong", see_all, partial(self._tell, "fit", False))
            with icon_button("view_in_ar", "look from a side"), Menu(items=True):
                for view, told in PAGE["views"].items():
                    lay_menu_item(told, partial(self._tell, "look", view))
                ui.separator()
                follow = ui.menu_item("follow what is picked", auto_close=False).classes("studio-tick")
                follow.props("role=menuitemcheckbox aria-checked=false")
                follow.on_click(lambda: self._tell("followPicked", _switched(follow, "aria-checked")))
            hand = icon_button("pan_tool", "drag links to move their joints; with Shift you always can")

            def grasp() -> None:
                on = _switched(hand, "aria-pressed")
                hand.props(remove="flat" if on else "unelevated", add="unelevated" if on else "flat")
                self._tell("grasp", on)

            hand.props("aria-pressed=false").on_click(grasp)
        return tools

    def _lay_opacity(
        self, robots: Mapping[str, str], plain: Colour = GREY, on_paint: Callable[[Colour], None] | None = None
    ) -> None:
        """Lay out the menu with which bodies are looked through and, where `on_paint` takes a colour, painted."""
        with _dialog("opacity", "opacity, and the colour of links without one" if on_paint else "opacity"):
            for name, title in robots.items():
                ui.label(title)
                slider = ui.element("input").props(f"type=range min={LEAST_OPACITY} max=1 step=0.05")
                slider.props(f'value={self._tab.opacities.get(name, 1.0)} aria-label="opacity of {escape(title)}"')
                taken = "(event) => emit(event.target.valueAsNumber)"
                slider.on("input", lambda event, name=name: self._fade(name, float(event.args)), js_handler=taken)
            if on_paint is not None:

                def paint(event: Any) -> None:  # noqa: ANN401 - NiceGUI's
                    """A colour as a page writes it: ``#b8bdc4``."""
                    red, green, blue = bytes.fromhex(str(event.args).removeprefix("#"))
                    on_paint((red / 255, green / 255, blue / 255))

                ui.label(WITHOUT_COLOUR)
                colour = f"#{bytes(round(255 * part) for part in plain).hex()}"
                chosen = ui.element("input").props(f'type=color value="{colour}" aria-label="{WITHOUT_COLOUR}"')
                chosen.on("change", paint, js_handler="(event) => emit(event.target.value)")

    # --- Taking along: pictures, a turntable, glTF --------------------------------------------------------------------

    def _lay_scene_items(self) -> None:
        """Lay out the entries of a menu that take the scene along, as it is shown."""
        for told, transparent in (("Picture (PNG)", False), ("Picture with a transparent ground", True)):
            lay_menu_item(told, partial(self._save_picture, transparent=transparent))
        lay_menu_item("Turntable (GIF)", lambda: self._hand_over("turntable", ".gif", self._turntable()))
        lay_menu_item("Scene as glTF (GLB)", lambda: self._hand_over("scene", ".glb", self._scene_file()))

    def _save_picture(self, *, transparent: bool) -> None:
        """The scene as the browser draws it, as a PNG of twice the size; with or without the ground."""
        self._tell("savePicture", safe_stem(self._tab.name or "arm"), transparent)

    async def _hand_over(self, what: str, suffix: str, making: Awaitable[Any]) -> None:
        """Hand over what is made, which is None while the server ends; or say what keeps it from being made."""
        name = safe_stem(self._tab.name or "arm")
        try:
            if (made := await making) is not None:
                dialogs.hand_over(Saved(f"{name}{suffix}", made))
        except Dh2UrdfError as error:
            await dialogs.show_error(f"The {what} cannot be made", error)

    async def _scene_file(self) -> Any:  # noqa: ANN401 - bytes, or None
        """The robots as they are shown, in the pose on the screen."""
        tab = self._tab
        return await run.io_bound(exports.glb, tab.shown(), tab.joint_values(), tab.layers, tab.name or "arm")

    async def _turntable(self) -> Any:  # noqa: ANN401 - bytes, or None
        """A turn about the arm: the page draws the frames, and what they are made into is made here."""
        note = ui.notification("turntable", spinner=True, timeout=None)
        try:
            frames = []
            async for frame in self._scene.turn(exports.FRAMES, exports.LARGEST):
                frames.append(frame)
                note.message = f"turntable: frame {len(frames)} of {exports.FRAMES}"
            return await run.io_bound(exports.gif, frames)
        finally:
            note.dismiss()


def _dialog(icon: str, told: str) -> ui.element:
    """Lay out a button that opens a small dialog beside it."""
    with icon_button(icon, told), Menu().props(f'role=dialog aria-label="{told}"'):
        return ui.element("div").classes(f"studio-{icon}")


def _switched(element: ui.element, state: str) -> bool:
    """Switch the state that an attribute of an element has; whether it is on now."""
    on = str(element.props[state]) == "false"
    element.props(f"{state}={'true' if on else 'false'}")
    return on
