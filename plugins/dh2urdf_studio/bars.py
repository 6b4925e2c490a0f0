"""What is around table and scene: the head, the bars, the problems, the fields below the cells, and dropped files."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import partial
from html import escape
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from nicegui import run, ui

from dh2urdf.manipulator import Convention
from dh2urdf.table_text import ANGLE_UNITS, LENGTH_UNITS
from dh2urdf_studio import dialogs, words
from dh2urdf_studio.drawing.parts import GREY
from dh2urdf_studio.drawing.scene import LAYERS, faded
from dh2urdf_studio.editing.edits import MOST_ROWS
from dh2urdf_studio.editing.opening import tables_of
from dh2urdf_studio.editing.save import savings
from dh2urdf_studio.editing.session import BOTH
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.widgets import ANSWERED, Menu, act_once, icon_button, lay_menu_item, row_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf_studio.drawing.parts import Colour
    from dh2urdf_studio.editing.reading import CellProblem
    from dh2urdf_studio.editing.session import Session
    from dh2urdf_studio.widgets import ArmView, Panel, ShownScene

ENDS: dict[str, tuple[str, str]] = PAGE["ends"]
"""The fields below the cells: a tooltip and an example for each."""
USUAL_LAYERS = ("links", "axes", "frames", "parameters")
"""Layers with a box in the bar; the others are in a menu, so that the bar takes two rows beside a table."""
LEAST_OPACITY = 0.1
"""The smallest opacity of bodies: what is less could not be found again."""
WITHOUT_COLOUR = "links without a colour"
MOST_PROBLEMS = 30
"""Problems that are spelled out; all wrong cells are marked."""
_QUIET = "flat dense no-caps color=white"


# --- The head ---------------------------------------------------------------------------------------------------------


class StudioHead:
    """The bar at the top of the studio: the name of the arm, undo and redo, opening, saving and generating."""

    def __init__(self, session: Session, on: Mapping[str, Callable[..., Any]], scene: Callable[[], ArmView]) -> None:
        self._session = session
        ui.html("<b>dh2urdf</b> studio", sanitize=False, tag="h1").classes("studio-title")
        self._name = ui.input(on_change=None).props('dense dark standout aria-label="name of the arm" data-text=name')
        self._name.classes("studio-name").on("change", lambda: on["name"](self._name.value or ""))
        self._undo, self._redo = (
            ui.button(icon=each, on_click=on[each]).props(f'{_QUIET} aria-label="{each}"').tooltip(f"{each} ({key})")
            for each, key in (("undo", "Ctrl+Z"), ("redo", "Ctrl+Shift+Z"))
        )
        ui.element("div").classes("studio-space")
        ui.button("New", on_click=on["new"]).props(_QUIET)
        act_once(ui.button("Open", icon="folder_open").props(_QUIET), on["open"])
        with ui.button("Save", icon="save").props(_QUIET), Menu(items=True):
            for kind, name, told in savings(session.catalog):
                lay_menu_item(told, partial(dialogs.make, session, kind, name))
            dialogs.lay_scene_items(scene, self._shown)
            lay_menu_item("Link with this table", lambda: dialogs.show_link(session.table))
        lay_look()
        generate = ui.button("Generate", icon="precision_manufacturing")
        generate.props("unelevated dense no-caps").classes("studio-generate").tooltip("the URDF (Ctrl+Enter)")
        usual, failed = session.catalog.usual("emitter").name, "The URDF cannot be generated yet"
        act_once(generate, lambda: dialogs.make(session, "robot", usual, failed))

    def _shown(self) -> ShownScene:
        """What is on the screen now."""
        session = self._session
        return session.table.name, faded(session.drawing, session.opacities), session.joint_values(), session.layers

    def show(self) -> None:
        """Show the name, and whether an edit can be undone or done again."""
        self._name.set_value(self._session.table.name)
        self._undo.set_enabled(self._session.history.can_undo)
        self._redo.set_enabled(self._session.history.can_redo)


def lay_look() -> None:
    """Lay out the menu by which a person chooses how the pages look; what is chosen stays in the browser."""
    told = "light, dark, projector"

    def lay(text: str, data: str, act: str) -> None:
        item = ui.menu_item(text, auto_close=False).classes("studio-look").props(f"{data} role=menuitem")
        item.on("click", js_handler=f"() => dhLook.{act}")

    with ui.button(icon="contrast").props(f'flat dense no-caps color=white aria-label="{told}"') as button:
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


# --- Around the cells -------------------------------------------------------------------------------------------------


class TableBar:
    """The bar above the cells: axes, convention, units and rows."""

    def __init__(
        self,
        session: Session,
        *,
        on_convention: Callable[[Convention], Any],
        on_units: Callable[[str, str], Any],
        on_columns: Callable[[], None],
    ) -> None:
        self._session, self._filling = session, False
        self._on_convention, self._on_units = on_convention, on_units
        group = partial(ui.element, "div")
        with row_of():
            with group().classes("studio-group"):
                ui.label("axes").classes("studio-caption")
                self._axes = ui.number(min=0, precision=0, format="%d")
                self._axes.props('dense outlined aria-label="number of axes"').classes("studio-axes")
                self._axes.props["autofocus"] = not session.table.rows  # to leave it costs the first key into a cell
                for event in ("keydown.enter", "change"):
                    self._axes.on(event, js_handler=f"() => dhGrid.resize({MOST_ROWS})")
            with group().classes("studio-group"):
                self._convention = _toggle([*map(str, Convention)], "convention", self._choose_convention)
                self._convention.props("toggle-color=primary").classes("studio-convention")
                self._convention.on("click", js_handler="() => dhGrid.begin()")
            with group().classes("studio-group"):
                self._length = _toggle(LENGTH_UNITS, "unit of lengths", self._choose_units)
                self._angle = _toggle(ANGLE_UNITS, "unit of angles", self._choose_units)
            with group().classes("studio-group"):
                for name, (icon, told) in PAGE["row_acts"].items():
                    icon_button(icon, told).on("click", js_handler=f"() => dhGrid.press('{name}')")
                icon_button("view_column", "show all columns, or those in use", on_columns)

    def show(self) -> None:
        """Show the axes, the convention and the units of the table."""
        table = self._session.table
        self._filling = True
        self._axes.set_value(len(self._session.moving_rows) if table.rows else None)
        self._convention.set_value(table.convention or None)
        self._length.set_value(table.length_unit)
        self._angle.set_value(table.angle_unit)
        self._filling = False

    async def _choose_convention(self, event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        if not self._filling and event.value and event.value != self._session.table.convention:
            await self._on_convention(Convention(event.value))

    async def _choose_units(self) -> None:
        table, units = self._session.table, (self._length.value, self._angle.value)
        if not self._filling and units != (table.length_unit, table.angle_unit):
            await self._on_units(*units)


def _toggle(choices: Iterable[str], told: str, act: Callable[..., Any]) -> ui.toggle:
    """Buttons of which one is pressed."""
    return ui.toggle(list(choices), on_change=act).props(f'dense unelevated no-caps aria-label="{told}"')


class EndFields:
    """The fields below the cells, for what the table has beside its rows; `on_text` takes a text by its name."""

    def __init__(self, session: Session, on_text: Callable[..., None]) -> None:
        self._session = session
        self._fields: dict[str, ui.input] = {}
        with ui.element("div").classes("studio-ends"):
            for key, (told, example) in ENDS.items():
                field = self._fields[key] = ui.input(placeholder=example).tooltip(told)
                field.props(f'dense outlined prefix="{key}" aria-label="{key}" data-text="{key}"')
                field.on("change", lambda key=key: on_text(**{key: self._fields[key].value or ""}))

    def show(self, wrong: Collection[str]) -> None:
        """Show the texts; those that are wrong stand out."""
        for key, field in self._fields.items():
            field.set_value(getattr(self._session.table, key))
            field.props(f"error={'true' if key in wrong else 'false'} no-error-icon hide-bottom-space")


class ProblemList:
    """The line that says how the table is, and below it what is wrong, problem by problem.

    Each that is about a cell or a field leads there. Of one that asks for a unit, `on_unit` takes the pressed unit.
    """

    def __init__(self, session: Session, on_unit: Callable[[CellProblem, str], None]) -> None:
        self._session, self._on_unit = session, on_unit
        with ui.element("div").classes("studio-told").props('role="status" aria-live="polite"'):
            self._status = ui.label().classes("studio-status")
            self._told = ui.element("div").style("display: contents")

    def show(self) -> set[str]:
        """Show the problems of the table, and return which of its texts are wrong: base, tool, payload."""
        session = self._session
        problems = session.problems
        errors = [found for found in problems if found.problem.severity == "error"]
        text, kind = words.status(session, len(errors))
        self._status.set_text(text)
        self._status.classes(replace=f"studio-status {kind}")
        self._told.clear()
        with self._told:
            for found in [*errors, *(found for found in problems if found not in errors)][:MOST_PROBLEMS]:
                leads = found.row is not None or found.field in ENDS
                box = ui.element("button" if leads else "div").classes(f"studio-problem {found.problem.severity}")
                if leads:
                    key = None if found.row is None else session.history.keys[found.row]
                    field = found.field if key is None or found.field in session.columns else "a"
                    box.props("type=button").on("click", js_handler=f"() => dhGrid.goTo(...{json.dumps([key, field])})")
                with box:
                    ui.label(f"{words.place(found, session.table)}{found.text}")
                if units := found.units(session.table):
                    with ui.element("div").classes(f"studio-problem studio-asked {found.problem.severity}"):
                        for unit in units:
                            act = partial(self._on_unit, found, unit)
                            ui.button(unit, on_click=act).props('unelevated dense no-caps padding="2px 10px"')
        return {found.field for found in errors if found.row is None and found.field}


# --- Above the scene --------------------------------------------------------------------------------------------------


def lay_scene_bar(
    session: Session,
    panels: Iterable[Panel],
    *,
    on_layers: Callable[[frozenset[str]], None],
    on_variant: Callable[[str], None],
    scene: Callable[[], ArmView],
) -> None:
    """Lay out the bar above the scene: what is shown, which variant of the arm, from where, and the panels."""
    names = session.variants

    def fade(_: str, opacity: float) -> None:
        """Both variants are the arm; a description that is compared with it is not."""
        session.opacities = {"": opacity, f"{names[-1]}/": opacity}
        scene().run_method("fade", session.opacities)

    with ui.element("div").classes("studio-bar"):
        lay_layers(session.layers, on_layers)
        if len(names) > 1:
            choices = {name: name for name in names} | {BOTH: "side by side"}
            variant = ui.toggle(choices, value=session.variant, on_change=lambda event: on_variant(event.value))
            variant.props('dense unelevated no-caps aria-label="variant"')
        with lay_tools(scene, "see all of the arm"):
            lay_opacity({"": "the arm"}, session.opacities, fade)
            for panel in panels:
                icon_button(panel.ICON, panel.TITLE, panel.switch)


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
