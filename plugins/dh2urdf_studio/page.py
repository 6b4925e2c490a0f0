"""The studio's page: the table to the left, the arm to the right, joints and numbers below it."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING, Any

from nicegui import ui

from dh2urdf.manipulator import Convention
from dh2urdf.table_text import ANGLE_UNITS, LENGTH_UNITS, TableText
from dh2urdf_studio import dialogs, words
from dh2urdf_studio.editing import edits, opening
from dh2urdf_studio.editing.save import savings
from dh2urdf_studio.editing.session import BOTH
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.panels.arm_edits import EditsPanel
from dh2urdf_studio.panels.comparing import ComparingPanel
from dh2urdf_studio.panels.lesson import LessonPanel
from dh2urdf_studio.panels.poses import MeasuringPanel, PosesPanel
from dh2urdf_studio.panels.target import TargetPanel
from dh2urdf_studio.scene_page import ScenePage, lay_files, lay_look
from dh2urdf_studio.table_grid import TableGrid
from dh2urdf_studio.widgets import (
    ANSWERED,
    QUIET,
    ArmView,
    JointSliders,
    Menu,
    act_once,
    icon_button,
    lay_menu_item,
    row_of,
    section,
    toggle,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf_studio.drawing.mesh_files import MeshStore
    from dh2urdf_studio.editing.reading import CellProblem
    from dh2urdf_studio.editing.session import Session

MOST_PROBLEMS = 30  # problems that are spelled out; all wrong cells are marked


class StudioPage(ScenePage):
    """What a tab shows of its session."""

    def __init__(self, session: Session, meshes: MeshStore) -> None:
        super().__init__(session)
        self.session, self._number, self._meshes = session, session.history.number, meshes
        self._filling = False  # while the bar is filled in, nobody chooses anything there
        ui.on("dh-undo", lambda event: self._do(session.redo if event.args else session.undo))
        with ui.element("div").classes("studio") as page:
            self._choose_file = lay_files(page, session.catalog, self._show_opened)
            with ui.element("header").classes("studio-head"):
                self._lay_head()
            with section("studio-table", "DH table"):
                with row_of():
                    self._lay_bar()
                self._table = TableGrid(
                    session,
                    edit=self._edited,
                    typing=self._typing,
                    end=self._typing_ended,
                    pick=self._pick,
                    paste=self._paste,
                    clear=self._clear,
                    act=self._act,
                    axes=self._resize,
                )
                mine = session, self._show_pose, self._tell
                self._target = TargetPanel(*mine)
                comparing = ComparingPanel(session, self._show_arm, self._tell, meshes, self._put)
                others = PosesPanel(*mine), MeasuringPanel(*mine), LessonPanel(*mine), comparing
                self._panels = self._target, *others, EditsPanel(session, self._do, self._tell)
                self._lay_below()
            with section("studio-scene", "Scene"):
                self._lay_scene()
            with section("studio-motion", "Joints"):
                with ui.element("div").classes("studio-joints"):
                    self._sliders = JointSliders(on_values=self._moved, told="joint values")
                with ui.element("div").classes("studio-numbers"):
                    self._numbers = ui.html(sanitize=False)

    def _lay_head(self) -> None:
        """The bar at the top: the name of the arm, undo and redo, opening, saving and generating."""
        session = self.session
        ui.html("<b>dh2urdf</b> studio", sanitize=False, tag="h1").classes("studio-title")
        self._name = ui.input(on_change=None).props('dense dark standout aria-label="name of the arm" data-text=name')
        self._name.classes("studio-name").on("change", lambda: self._set_texts(name=self._name.value or ""))
        self._undo, self._redo = (
            ui.button(icon=name, on_click=partial(self._do, act)).props(f'{QUIET} aria-label="{name}"').tooltip(told)
            for name, told, act in (
                ("undo", "undo (Ctrl+Z)", session.undo),
                ("redo", "redo (Ctrl+Shift+Z)", session.redo),
            )
        )
        ui.element("div").classes("studio-space")
        new = partial(self._do, lambda: session.open(TableText(name="arm")))
        ui.button("New", on_click=new).props(QUIET)
        act_once(ui.button("Open", icon="folder_open").props(QUIET), self._open)
        with ui.button("Save", icon="save").props(QUIET), Menu(items=True):
            for kind, name, told in savings(session.catalog):
                lay_menu_item(told, partial(dialogs.make, session, kind, name))
            self._lay_scene_items()
            lay_menu_item("Link with this table", lambda: dialogs.show_link(session.table))
        lay_look()
        generate = ui.button("Generate", icon="precision_manufacturing")
        generate.props("unelevated dense no-caps").classes("studio-generate").tooltip("the URDF (Ctrl+Enter)")
        usual, failed = session.catalog.usual("emitter").name, "The URDF cannot be generated yet"
        act_once(generate, partial(dialogs.make, session, "robot", usual, failed))

    def _lay_bar(self) -> None:
        """The bar above the cells: axes, convention, units and rows."""
        group = partial(ui.element, "div")
        with group().classes("studio-group"):
            ui.label("axes").classes("studio-caption")
            self._axes = ui.number(min=0, precision=0, format="%d")
            self._axes.props('dense outlined aria-label="number of axes"').classes("studio-axes")
            self._axes.props["autofocus"] = not self.session.table.rows  # to leave it costs the first key into a cell
            for event in ("keydown.enter", "change"):
                self._axes.on(event, js_handler=f"() => dhGrid.resize({edits.MOST_ROWS})")
        with group().classes("studio-group"):
            self._convention = toggle([*map(str, Convention)], "convention", self._choose_convention)
            self._convention.props("toggle-color=primary").classes("studio-convention")
            self._convention.on("click", js_handler="() => dhGrid.begin()")
        with group().classes("studio-group"):
            self._length = toggle(LENGTH_UNITS, "unit of lengths", self._choose_units)
            self._angle = toggle(ANGLE_UNITS, "unit of angles", self._choose_units)
        with group().classes("studio-group"):
            for name, (icon, told) in PAGE["row_acts"].items():
                icon_button(icon, told).on("click", js_handler=f"() => dhGrid.press('{name}')")
            icon_button("view_column", "show all columns, or those in use", self._all_columns)

    def _lay_below(self) -> None:
        """How the table is, what is wrong with it, and the fields for what it has beside its rows."""
        with ui.element("div").classes("studio-told").props('role="status" aria-live="polite"'):
            self._status = ui.label().classes("studio-status")
            self._told = ui.element("div").style("display: contents")
        self._ends: dict[str, ui.input] = {}
        with ui.element("div").classes("studio-ends"):
            for key, (told, example) in PAGE["ends"].items():
                field = self._ends[key] = ui.input(placeholder=example).tooltip(told)
                field.props(f'dense outlined prefix="{key}" aria-label="{key}" data-text="{key}"')
                field.on("change", lambda key=key: self._set_texts(**{key: self._ends[key].value or ""}))

    def _lay_scene(self) -> None:
        """What is shown, which variant of the arm, from where, the buttons of the panels, and the arm."""
        session, names = self.session, self.session.variants
        with ui.element("div").classes("studio-bar"):
            self._lay_layers()
            if len(names) > 1:
                variants = {name: name for name in names} | {BOTH: "side by side"}
                toggle(variants, "variant", self._choose_variant, session.variant)
            with self._lay_tools("see all of the arm"):
                self._lay_opacity({"": "the arm"})
                for panel in self._panels:
                    icon_button(panel.ICON, panel.TITLE, panel.switch)
        self._remark = ui.label().classes("studio-bar studio-remark")
        with ui.element("div").classes("studio-stage"):
            self._scene = ArmView(dialogs.Warnings().add, self._drag, on_aim=self._target.drag)
            with ui.element("div").classes("studio-empty") as self._empty, ui.element("div"):
                ui.html(PAGE["empty"]["scene"], sanitize=False)

    # --- What is shown ------------------------------------------------------------------------------------------------

    def show(self) -> None:
        """Shows all of the session."""
        if self._scene.is_deleted:  # The tab was closed during a dialog.
            return
        if self._number != (number := self.session.history.number):
            self._number = number
            dialogs.forget_warnings()
        self._table.show()
        self._show_words()
        self._show_arm()

    def _keep(self, table: TableText | None = None) -> None:
        """The browser keeps a table, or else the session's, for when the studio is away."""
        kept, keys = edits.kept_text(table or self.session.table), self.session.history.keys
        ui.run_javascript(f"dhPage.keep({json.dumps(kept)}, {json.dumps(keys)})")

    def _show_words(self) -> None:
        """Everything but cells and arm."""
        session, table = self.session, self.session.table
        self._name.set_value(table.name)
        self._undo.set_enabled(session.history.can_undo)
        self._redo.set_enabled(session.history.can_redo)
        self._filling = True
        self._axes.set_value(len(session.moving_rows) if table.rows else None)
        self._convention.set_value(table.convention or None)
        self._length.set_value(table.length_unit)
        self._angle.set_value(table.angle_unit)
        self._filling = False
        self._empty.set_visibility(not table.rows)
        self._keep()
        errors = [found for found in session.problems if found.problem.severity == "error"]
        self._show_problems(len(errors))
        wrong = {found.field for found in errors if found.row is None}
        for key, field in self._ends.items():
            field.set_value(getattr(table, key))
            field.props(f"error={'true' if key in wrong else 'false'} no-error-icon hide-bottom-space")

    def _show_problems(self, errors: int) -> None:
        """How the table is, and what is wrong: a problem leads to its cell or field, and may ask for a unit."""
        session = self.session
        text, kind = words.status(session, errors)
        self._status.set_text(text)
        self._status.classes(replace=f"studio-status {kind}")
        self._told.clear()
        with self._told:
            for found in [each for each in session.problems if each.edit is None][:MOST_PROBLEMS]:
                leads = found.row is not None or found.field in self._ends
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
                            act = partial(self._answer_unit, found, unit)
                            ui.button(unit, on_click=act).props('unelevated dense no-caps padding="2px 10px"')

    def _show_arm(self) -> None:
        drawn = self.session.drawing.meshes
        self._meshes.add({key: mesh for key, mesh in drawn.items() if key not in self._meshes})
        super()._show_arm()
        self._tell("highlight", self.session.drawn_row)
        self._table.draw(self.session.arm.keys if self.session.arm else ())

    def _show_numbers(self) -> None:
        session = self.session
        pose = session.pose
        self._numbers.set_content(words.numbers(pose, session.table, session.reach) if pose else "")
        remark = words.remark(session)
        self._remark.set_text(remark)
        self._remark.set_visibility(bool(remark))
        for panel in self._panels:
            panel.show()

    # --- What is done to the table ------------------------------------------------------------------------------------

    def _do(self, act: Callable[[], None]) -> None:
        act()
        self.show()

    def _put(self, table: TableText) -> None:
        self._do(lambda: self.session.put(table))

    def _set_texts(self, **texts: str) -> None:
        self._put(edits.with_texts(self.session.table, **texts))

    def _edited(self, row: int, field: str, text: str) -> None:
        try:
            self.session.edit(row, field, text)
        except LookupError:
            self._refuse(f"{field}: {text or 'empty'}")
            return
        self._show_arm()
        self._table.typed(row, field)
        self._show_words()

    def _typing(self, row: int, field: str, text: str) -> None:
        try:
            if self.session.preview(row, field, text):
                self._show_arm()
        finally:
            self._table.run("ask")

    def _typing_ended(self) -> None:
        if self.session.previews:
            self.session.look()
            self._show_arm()

    async def _paste(self, row: int, field: str, text: str | None) -> None:
        session = self.session
        if field not in session.columns:
            return
        if text is None:  # a picture, for one
            ui.notify("the clipboard holds no text", type="info")
            return
        table, catalog = session.table, session.catalog
        found = opening.whole_tables(text, catalog, table.convention, (table.length_unit, table.angle_unit))
        answer: Any = found or "cells"
        if found and (table.rows or isinstance(found, str)):  # a whole table takes the place of an empty one
            answer = await dialogs.ask_paste(found, opening.whole_tables(text, catalog, table.convention))
        columns: Sequence[str] | None = session.columns
        if answer == "cells" and not table.rows and (choices := opening.orders(text)):  # no header is on the page
            columns = await dialogs.ask_columns(choices, opening.cells_of(text)[0])
            field = columns[0] if columns else field
        if answer == "cells" and row < 0:
            self._refuse("paste")
        elif answer == "cells" and columns is not None:
            put = opening.pasted(session.table, row, field, text, columns)
            self._put(put.table)
            if put.left_out:
                cells = words.count(put.left_out, "cell finds", "cells find")
                dialogs.warn(PAGE["warnings"]["left_out"].format(cells=cells))
        elif isinstance(answer, tuple):
            await self._show_opened(await dialogs.choose(answer))

    def _resize(self, count: float | None, keys: Sequence[str]) -> None:
        # An emptied field takes no rows away, and Enter says a number twice.
        if count is None or count < 0 or min(int(count), edits.MOST_ROWS) == len(self.session.moving_rows):
            self.show()
            return
        if count > edits.MOST_ROWS:
            dialogs.warn(PAGE["warnings"]["rows"].format(most=edits.MOST_ROWS, count=int(count)))
        self._do(lambda: self.session.resize(int(count), keys))

    def _act(self, act: str, key: str | None, other: str | None) -> None:
        try:
            self.session.arrange(act, key, other)
        except LookupError:
            self._refuse(act)
            return
        self.show()

    def _clear(self, rows: Sequence[int], fields: Sequence[str]) -> None:
        # Of a row that is gone, nothing is left to empty.
        cells = {(row, field): "" for row in rows for field in fields if row >= 0}
        self._put(edits.with_cells(self.session.table, cells))

    def _refuse(self, act: str) -> None:
        """The page showed other rows than those of the table when something was done to them."""
        dialogs.warn(PAGE["warnings"]["refused"].format(act=act))
        self.show()

    def _all_columns(self) -> None:
        self.session.all_columns = not self.session.all_columns
        self.show()

    def _answer_unit(self, found: CellProblem, unit: str) -> None:
        table = self.session.table
        if unit in (table.length_unit, table.angle_unit):
            self.session.confirmed |= {found.problem.message}
        else:
            units = (unit, table.angle_unit) if unit in LENGTH_UNITS else (table.length_unit, unit)
            self.session.set_units(*units, convert=False)
        self.show()

    async def _choose_convention(self, event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        session = self.session
        if self._filling or event.value in (None, session.table.convention):
            return
        convention, about = Convention(event.value), PAGE["conventions"][event.value]
        chosen: tuple[bool, ...] | None = (False,)
        if session.table.convention and edits.begun(session.table):
            title, possible = f"To the convention {about['told']}", session.convertible is not None
            chosen = await dialogs.ask_conversion(title, about["asked"], possible=possible)
        if chosen is not None:
            session.set_convention(convention, convert=chosen[0])
        self.show()

    async def _choose_units(self) -> None:
        session = self.session
        units = self._length.value, self._angle.value
        if self._filling or units == (session.table.length_unit, session.table.angle_unit):
            return
        chosen: tuple[Any, ...] | None = (*units, False)
        if edits.begun(session.table):
            possible = session.convertible is not None
            chosen = await dialogs.ask_conversion("To other units", PAGE["units"]["asked"], units, possible=possible)
        if chosen is not None:
            session.set_units(*chosen[:2], convert=chosen[2])
        self.show()

    async def _open(self) -> None:
        await self._show_opened(await dialogs.ask_table(self.session.catalog, self._choose_file))

    async def _show_opened(self, opened: opening.Opened | None, *, keep_view: bool = False) -> None:
        if opened is not None:
            self.session.open(opened.table)
            self.show()
            if remarks := words.remarks(opened):
                dialogs.warn("\n".join(remarks))
            self._tell("fit", keep_view)

    # --- What is done to the arm --------------------------------------------------------------------------------------

    def _pick(self, key: str | None) -> None:
        self.session.picked = key
        self._tell("highlight", self.session.drawn_row)
        if self.session.lesson is not None:
            self._show_pose()

    def _choose_variant(self, event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        self.session.show_variant(event.value)
        self._show_arm()
        self._tell("fit", False)

    async def start(self) -> None:
        """Shows the session for the first time."""
        is_new = not self.session.history.can_undo  # before the answer, in whose time a person may begin a table
        text, left = await ui.run_javascript("return [dhPage.kept(), dhPage.unfinished()]", timeout=ANSWERED)
        self.session.finish_typing(left, kept := edits.kept_table(text), is_new=is_new)
        self._tell("fade", self.session.opacities)
        self.show()
        self._tell("fit", True)  # a person may have turned the camera already
        if (linked := await dialogs.linked_table()) is not None:
            await self._show_opened(opening.Opened(linked), keep_view=True)
            return
        if is_new and kept is not None and kept != self.session.table:
            self._keep(kept)  # The page may be loaded again before the question is answered.
            if await dialogs.ask_back(kept):
                await self._show_opened(opening.Opened(kept))
            else:
                self._keep()
