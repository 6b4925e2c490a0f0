"""The studio's page: the table to the left, the arm to the right, joints and numbers below it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from nicegui import ui

from dh2urdf.manipulator import Convention
from dh2urdf.studio import dialogs, joints, words
from dh2urdf.studio.drawing.scene import LAYERS
from dh2urdf.studio.editing import edits, pasting
from dh2urdf.studio.editing.conversions import ANGLE_UNITS, LENGTH_UNITS
from dh2urdf.studio.editing.keeping import kept_table, kept_text
from dh2urdf.studio.editing.session import BOTH
from dh2urdf.studio.panels import sharing
from dh2urdf.studio.panels.lesson import LessonPanel
from dh2urdf.studio.panels.measuring import MeasuringPanel
from dh2urdf.studio.panels.poses import PosesPanel
from dh2urdf.studio.panels.target import TargetPanel
from dh2urdf.studio.problem_list import ProblemList
from dh2urdf.studio.table_grid import TableGrid
from dh2urdf.studio.widgets import ArmView, JointSliders, lay_views

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from dh2urdf.studio.editing.reading import CellProblem
    from dh2urdf.studio.editing.session import Session
    from dh2urdf.table_text import TableText

_QUIET = "flat dense no-caps"


class StudioPage:
    """What a tab shows of its session.

    Attributes:
        session: the session.
    """

    def __init__(self, session: Session) -> None:
        """Lays the page out; `show` fills it."""
        self.session = session
        self._filling = False
        ui.on_exception(dialogs.show_fault)
        ui.on("dh-undo", lambda event: self._do(self.session.redo if event.args else self.session.undo))
        ui.on("dh-generate", self._generate)
        with ui.element("div").classes("studio"):
            with ui.element("header").classes("studio-head"):
                self._lay_head()
            with ui.element("section").classes("studio-table").props('aria-label="DH table"'):
                self._lay_table()
            with ui.element("section").classes("studio-scene").props('aria-label="Scene"'):
                self._lay_scene()
            with ui.element("section").classes("studio-motion").props('aria-label="Joints"'):
                self._lay_motion()

    # --- Layout -------------------------------------------------------------------------------------------------------

    def _lay_head(self) -> None:
        ui.html("<b>dh2urdf</b> studio", sanitize=False, tag="h1").classes("studio-title")
        self._name = ui.input(on_change=None).props('dense dark standout aria-label="name of the arm"')
        self._name.classes("studio-name").on("change", lambda: self._say(name=self._name.value or ""))
        self._undo = ui.button(icon="undo", on_click=lambda: self._do(self.session.undo))
        self._undo.props(f'{_QUIET} color=white aria-label="undo"')
        self._undo.tooltip("undo (Ctrl+Z)")
        self._redo = ui.button(icon="redo", on_click=lambda: self._do(self.session.redo))
        self._redo.props(f'{_QUIET} color=white aria-label="redo"')
        self._redo.tooltip("redo (Ctrl+Shift+Z)")
        ui.element("div").classes("studio-space")
        ui.button("New", on_click=self._new).props(f"{_QUIET} color=white")
        ui.button("Open", icon="folder_open", on_click=self._open).props(f"{_QUIET} color=white")
        with ui.button("Save", icon="save").props(f"{_QUIET} color=white"), ui.menu():
            for kind, name, told in dialogs.savings(self.session.catalog):
                ui.menu_item(told, on_click=lambda kind=kind, name=name: dialogs.save(self.session, kind, name))
            self._menu = ui.element("div")
        generate = ui.button("Generate", icon="precision_manufacturing", on_click=self._generate)
        generate.props("unelevated dense no-caps").classes("studio-generate").tooltip("the URDF (Ctrl+Enter)")

    def _lay_table(self) -> None:
        with ui.element("div").classes("studio-row"):
            with ui.element("div").classes("studio-group"):
                ui.label("axes").classes("studio-caption")
                self._axes = ui.number(min=0, precision=0, format="%d")
                self._axes.props('dense outlined autofocus aria-label="number of axes"').classes("studio-axes")
                self._axes.on("keydown.enter", self._resize).on("change", self._resize)
            with ui.element("div").classes("studio-group"):
                self._convention = ui.toggle([str(kind) for kind in Convention], on_change=self._choose_convention)
                self._convention.props('dense unelevated no-caps toggle-color=primary aria-label="convention"')
            with ui.element("div").classes("studio-group"):
                self._length = ui.toggle(list(LENGTH_UNITS), on_change=self._choose_units)
                self._length.props('dense unelevated no-caps aria-label="unit of lengths"')
                self._angle = ui.toggle(list(ANGLE_UNITS), on_change=self._choose_units)
                self._angle.props('dense unelevated no-caps aria-label="unit of angles"')
            with ui.element("div").classes("studio-group"):
                for icon, told, act in (
                    ("add", "add a row below (Alt+Insert)", self._add_row),
                    ("remove", "remove the row (Alt+Delete)", self._remove_row),
                    ("arrow_upward", "move the row up (Alt+↑)", lambda: self._move_row(-1)),
                    ("arrow_downward", "move the row down (Alt+↓)", lambda: self._move_row(1)),
                    ("view_column", "show all columns, or those in use", self._all_columns),
                ):
                    button = ui.button(icon=icon, on_click=act).props(f'flat dense round size=sm aria-label="{told}"')
                    button.tooltip(told)
        self._table = TableGrid(
            on_edit=self._edited,
            on_typing=self._typing,
            on_end=self._typing_ended,
            on_pick=self._pick,
            on_paste=self._paste,
            on_clear=lambda *cells: self._put(edits.cleared(self.session.table, *cells), all_cells=True),
            on_act=self._act,
            on_move=lambda one, other: self._put(edits.moved(self.session.table, one, other), all_cells=True),
        )
        self._target = TargetPanel(self.session, self._show_pose, self._show_handle)
        self._panels = (
            self._target,
            PosesPanel(self.session, self._show_pose),
            MeasuringPanel(self.session, self._show_pose, self._show_cloud),
            LessonPanel(self.session, self._show_pose),
        )
        self._problems = ProblemList(on_click=self._go_to)
        with ui.element("div").classes("studio-ends"):
            self._ends: dict[str, ui.input] = {}
            placed, carried = "{xyz: [0, 0, 0.3], rpy: [0, 0, pi]}", "{mass: 2.5, com: [0, 0, 0.05]}"
            for key, told, example in (
                ("base", "base_link to the first DH frame", placed),
                ("tool", "last DH frame to tool0", placed),
                ("payload", "what the arm carries at tool0", carried),
            ):
                field = ui.input(placeholder=example)
                field.props(f'dense outlined prefix="{key}" aria-label="{key}"')
                field.on("change", lambda key=key: self._say(**{key: self._ends[key].value or ""}))
                field.tooltip(told)
                self._ends[key] = field

    def _lay_scene(self) -> None:
        with ui.element("div").classes("studio-bar"):
            self._layers = {
                layer: ui.checkbox(told, on_change=self._choose_layers).props("dense size=xs")
                for layer, told in LAYERS.items()
            }
            names = self.session.variants
            both = {BOTH: "side by side"} if len(names) > 1 else {}
            self._variant = ui.toggle({name: name for name in names} | both, on_change=self._choose_variant)
            self._variant.props('dense unelevated no-caps aria-label="variant"').set_visibility(bool(both))
            fit = ui.button(icon="center_focus_strong", on_click=self._see_all)
            fit.props('flat dense round size=sm aria-label="see all of the arm"').tooltip("see all of the arm")
            lay_views(lambda: self._view)
            for panel in self._panels:
                switch = ui.button(icon=panel.ICON, on_click=panel.switch)
                switch.props(f'flat dense round size=sm aria-label="{panel.TITLE}"').tooltip(panel.TITLE)
        self._remark = ui.label().classes("studio-bar studio-remark")
        self._view = ArmView(on_pick=self._picked_in_scene, on_aim=self._target.drag)
        with self._menu:
            sharing.lay_items(self.session, self._view)
        with ui.element("div").classes("studio-empty") as self._empty, ui.element("div"):
            ui.html(
                "<b>An empty table.</b><br>Choose the number of axes and the convention, then enter a, α and d of "
                "every row: <code>pi/2</code>, <code>90°</code> and <code>-425 mm</code> are fine. "
                "The arm appears as you type. Or open a table of yours, or one of the gallery.",
                sanitize=False,
            )

    def _lay_motion(self) -> None:
        with ui.element("div").classes("studio-joints"):
            with ui.element("div").classes("studio-row"):
                ui.label("joint values").classes("studio-caption")
                ui.button("zero", on_click=lambda: self._move_to(joints.zero)).props("outline dense no-caps size=sm")
                ui.button("random pose", on_click=lambda: self._move_to(joints.anywhere)).props(
                    "outline dense no-caps size=sm"
                )
            self._sliders = JointSliders(on_values=self._moved)
        with ui.element("div").classes("studio-numbers"):
            self._numbers = ui.html(sanitize=False)

    # --- What is shown ------------------------------------------------------------------------------------------------

    def show(self, *, all_cells: bool = False) -> None:
        """Shows all of the session.

        Args:
            all_cells: whether the cells on the screen may be others than those of the table.
        """
        if all_cells:
            self._table.refresh(self.session)
        else:
            self._table.show(self.session)
        self._show_words()
        self._show_arm()

    def _keep(self) -> None:
        """The browser keeps the table, for when the studio is away."""
        ui.run_javascript(f"dhPage.keep({json.dumps(kept_text(self.session.table))})")

    def _show_words(self) -> None:
        """Everything but cells and arm."""
        session, table = self.session, self.session.table
        self._filling = True
        self._name.set_value(table.name)
        self._axes.set_value(len(table.rows) or None)
        self._convention.set_value(table.convention or None)
        self._length.set_value(table.length_unit)
        self._angle.set_value(table.angle_unit)
        for key, field in self._ends.items():
            field.set_value(getattr(table, key))
        for layer, box in self._layers.items():
            box.set_value(layer in session.layers)
        self._variant.set_value(session.variant)
        self._filling = False
        self._undo.set_enabled(session.history.can_undo)
        self._redo.set_enabled(session.history.can_redo)
        self._empty.set_visibility(not table.rows)
        self._keep()
        wrong = self._problems.show(session)
        for key, field in self._ends.items():
            field.props(f"error={'true' if key in wrong else 'false'} no-error-icon hide-bottom-space")

    def _show_arm(self) -> None:
        session = self.session
        q = session.joint_values()
        self._view.show(session.drawing, session.drawing.poses(q), session.strokes())
        self._sliders.show(session.sliders, session.q)
        self._show_numbers()

    def _show_pose(self) -> None:
        session = self.session
        self._view.set_layers(session.shown_layers)
        self._view.pose(session.drawing.poses(session.joint_values()), session.strokes())
        self._sliders.answer(session.q)
        self._show_numbers()

    def _show_numbers(self) -> None:
        session = self.session
        pose = session.pose
        self._numbers.set_content(words.numbers(pose, session.table, session.reach) if pose else "")
        remark = words.remark(session)
        self._remark.set_text(remark)
        self._remark.set_visibility(bool(remark))
        for panel in self._panels:
            panel.show()

    # --- What is done -------------------------------------------------------------------------------------------------

    def _do(self, act: Callable[[], None]) -> None:
        act()
        self.show(all_cells=True)

    def _put(self, table: TableText, *, all_cells: bool = False) -> None:
        self.session.put(table)
        self.show(all_cells=all_cells)

    def _say(self, **texts: str) -> None:
        self.session.say(**texts)
        self.show()

    def _edited(self, row: int, field: str, text: str) -> None:
        try:
            self.session.edit(row, field, text)
        except LookupError:  # The row went away meanwhile.
            self.show(all_cells=True)
            return
        self._show_arm()
        self._table.typed(self.session, row, field)
        self._show_words()

    def _typing(self, row: int, field: str, text: str) -> None:
        try:
            if self.session.preview(row, field, text):
                self._show_arm()
        finally:
            self._table.answer()

    def _typing_ended(self) -> None:
        if self.session.previews:
            self.session.look()
            self._show_arm()

    async def _paste(self, row: int, field: str, text: str) -> None:
        session = self.session
        if field not in session.columns:
            return
        found = pasting.whole_tables(text, session.catalog)
        answer = await dialogs.ask_paste(found) if found else "cells"
        if answer == "cells":
            put = pasting.pasted(session.table, row, field, text, session.columns)
            self._put(put.table, all_cells=True)
            if put.left_out:
                dialogs.warn(words.left_out(put.left_out))
        elif answer == "table" and not isinstance(found, str):
            await self._show_opened(await dialogs.choose(found))

    def _resize(self) -> None:
        count = self._axes.value
        if count is None or count < 0:  # an emptied field is no answer, and takes no rows away
            self._show_words()
            return
        if int(count) == len(self.session.table.rows) or self._filling:
            return
        if count > edits.MOST_ROWS:
            dialogs.warn(
                f"A table of the studio has at most {edits.MOST_ROWS} rows: these are the first of {int(count)}."
            )
        self._put(edits.resized(self.session.table, int(count)))
        self._invite()

    def _invite(self) -> None:
        """Puts the cursor where the table begins, once there are rows and a convention and nothing else."""
        table = self.session.table
        if table.rows and table.convention and self.session.reading.waiting == len(table.rows):
            self._table.focus(0, "a")

    def _act(self, act: str, row: int) -> None:
        """What was done to a row by key."""
        self.session.row = row
        match act:
            case "add":
                self._add_row()
            case "remove":
                self._remove_row()
            case _:
                self._move_row(-1 if act == "up" else 1)

    def _add_row(self) -> None:
        at = len(self.session.table.rows) if self.session.row is None else self.session.row + 1
        self.session.row = at
        self._put(edits.inserted(self.session.table, at), all_cells=True)
        self._table.focus(at, "a")

    def _remove_row(self) -> None:
        rows = len(self.session.table.rows)
        if rows:
            at = rows - 1 if self.session.row is None else self.session.row
            self._put(edits.removed(self.session.table, at), all_cells=True)
            self._table.focus(min(at, rows - 2), None)

    def _move_row(self, by: int) -> None:
        if (row := self.session.row) is None:
            ui.notify("pick a row first: click into it", type="info")
            return
        if 0 <= row + by < len(self.session.table.rows):
            self.session.row = row + by
            self._put(edits.moved(self.session.table, row, row + by), all_cells=True)
            self._table.focus(row + by, None)

    def _all_columns(self) -> None:
        self.session.all_columns = not self.session.all_columns
        self.show()

    def _pick(self, row: int | None) -> None:
        if row != self.session.row:
            self.session.row = row
            self._view.highlight(row)
            self._table.pick(row)
            if self.session.lesson is not None:
                self._show_pose()

    def _picked_in_scene(self, row: int | None) -> None:
        self._pick(row)
        if row is not None:
            self._table.focus(row, "a")

    def _go_to(self, found: CellProblem) -> None:
        if found.row is not None:
            self._table.focus(found.row, found.field if found.field in self.session.columns else "a", edit=True)

    async def _choose_convention(self, event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        session = self.session
        if self._filling or not event.value or event.value == session.table.convention:
            return
        convention = Convention(event.value)
        convert: bool | None = False
        if session.table.convention and edits.begun(session.table):
            convert = await dialogs.ask_convention(convention, possible=session.convertible is not None)
        if convert is not None:
            session.set_convention(convention, convert=convert)
        self.show(all_cells=True)
        self._invite()

    async def _choose_units(self) -> None:
        session = self.session
        units = self._length.value, self._angle.value
        if self._filling or units == (session.table.length_unit, session.table.angle_unit):
            return
        convert: bool | None = False
        if edits.begun(session.table):
            convert = await dialogs.ask_units(*units, possible=session.convertible is not None)
        if convert is not None:
            session.set_units(*units, convert=convert)
        self.show(all_cells=True)

    def _choose_layers(self) -> None:
        if self._filling:
            return
        self.session.layers = frozenset(layer for layer, box in self._layers.items() if box.value)
        self._show_pose()

    def _choose_variant(self, event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        if not self._filling:
            self.session.show_variant(event.value)
            self._show_arm()
            self._see_all()

    def _show_handle(self, *, shown: bool) -> None:
        self._view.show_handle(shown=shown)

    def _show_cloud(self, points: Any) -> None:  # noqa: ANN401 - an array of shape (n, 3)
        self._view.show_cloud(points)

    def _see_all(self) -> None:
        self._view.fit()

    def _move_to(self, poses: Callable[[Any], Mapping[str, float]]) -> None:
        self.session.move(poses(self.session.sliders))
        self._show_pose()

    def _moved(self, values: Mapping[str, float]) -> None:
        self.session.move(values)
        self._show_pose()

    async def _open(self) -> None:
        await self._show_opened(await dialogs.ask_table(self.session.catalog))

    async def _show_opened(self, table: TableText | None) -> None:
        if table is not None:
            self.session.open(table)
            self.show(all_cells=True)
            self._see_all()

    def _new(self) -> None:
        self.session.open(type(self.session.table)(name="arm"))
        self.show(all_cells=True)

    async def _generate(self) -> None:
        await dialogs.generate(self.session)

    async def start(self) -> None:
        """Shows the session for the first time."""
        kept = kept_table(await ui.run_javascript("return dhPage.kept()", timeout=10.0))
        self._view.set_layers(self.session.shown_layers)
        self.show()
        self._view.highlight(self.session.row)
        self._view.fit()
        if (linked := await sharing.linked_table()) is not None:
            await self._show_opened(linked)
            return
        is_new = not self.session.history.can_undo
        if is_new and kept is not None and kept != self.session.table and await dialogs.ask_back(kept):
            await self._show_opened(kept)
