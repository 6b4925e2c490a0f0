"""The studio's page: the table to the left, the arm to the right, joints and numbers below it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from nicegui import ui

from dh2urdf.table_text import LENGTH_UNITS, TableText
from dh2urdf_studio import dialogs, words
from dh2urdf_studio.bars import EndFields, ProblemList, StudioHead, TableBar, lay_files, lay_scene_bar
from dh2urdf_studio.editing import edits, opening
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.panels.comparing import ComparingPanel
from dh2urdf_studio.panels.lesson import LessonPanel
from dh2urdf_studio.panels.poses import MeasuringPanel, PosesPanel
from dh2urdf_studio.panels.target import TargetPanel
from dh2urdf_studio.table_grid import TableGrid
from dh2urdf_studio.widgets import ANSWERED, ArmView, JointSliders

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from dh2urdf.manipulator import Convention
    from dh2urdf_studio.drawing.mesh_files import MeshStore
    from dh2urdf_studio.editing.reading import CellProblem
    from dh2urdf_studio.editing.session import Session


class StudioPage:
    """What a tab shows of its session."""

    def __init__(self, session: Session, meshes: MeshStore) -> None:
        """Lays the page out; `show` fills it."""
        self.session, self._meshes, self._number = session, meshes, session.history.number
        ui.on_exception(dialogs.show_fault)
        ui.on("dh-undo", lambda event: self._do(self.session.redo if event.args else self.session.undo))
        with ui.element("div").classes("studio") as page:
            self._choose_file = lay_files(page, session.catalog, self._show_opened)
            with ui.element("header").classes("studio-head"):
                acts: dict[str, Callable[..., Any]] = {
                    "name": lambda name: self._set_texts(name=name),
                    "undo": lambda: self._do(session.undo),
                    "redo": lambda: self._do(session.redo),
                    "new": lambda: self._do(lambda: session.open(TableText(name="arm"))),
                    "open": self._open,
                }
                self._head = StudioHead(session, acts, lambda: self._view)
            with ui.element("section").classes("studio-table").props('aria-label="DH table"'):
                self._lay_table()
            with ui.element("section").classes("studio-scene").props('aria-label="Scene"'):
                self._lay_scene()
            with ui.element("section").classes("studio-motion").props('aria-label="Joints"'):
                with ui.element("div").classes("studio-joints"):
                    self._sliders = JointSliders(on_values=self._moved, told="joint values")
                with ui.element("div").classes("studio-numbers"):
                    self._numbers = ui.html(sanitize=False)

    def _lay_table(self) -> None:
        session, show_pose = self.session, self._show_pose
        self._bar = TableBar(
            session,
            on_convention=self._choose_convention,
            on_units=self._choose_units,
            on_columns=self._all_columns,
        )
        acts: Mapping[str, Callable[..., Any]] = {
            "edit": self._edited,
            "typing": self._typing,
            "end": self._typing_ended,
            "pick": self._pick,
            "paste": self._paste,
            "clear": self._clear,
            "act": self._act,
            "axes": self._resize,
        }
        self._table = TableGrid(session, acts)
        self._target = TargetPanel(session, show_pose, lambda shown: self._view.run_method("showHandle", shown))
        self._panels = (
            self._target,
            PosesPanel(session, show_pose),
            MeasuringPanel(session, show_pose, self._show_cloud),
            LessonPanel(session, show_pose),
            ComparingPanel(session, self._show_arm, self._meshes, self._put),
        )
        self._problems = ProblemList(session, on_unit=self._answer_unit)
        self._ends = EndFields(session, self._set_texts)

    def _lay_scene(self) -> None:
        lay_scene_bar(
            self.session,
            self._panels,
            on_layers=self._choose_layers,
            on_variant=self._choose_variant,
            scene=lambda: self._view,
        )
        self._remark = ui.label().classes("studio-bar studio-remark")
        with ui.element("div").classes("studio-stage"):
            self._view = ArmView(on_aim=self._target.drag, on_grip=self._drag, on_undrawn=dialogs.Warnings().add)
            with ui.element("div").classes("studio-empty") as self._empty, ui.element("div"):
                ui.html(PAGE["empty"]["scene"], sanitize=False)

    # --- What is shown ------------------------------------------------------------------------------------------------

    def show(self) -> None:
        """Shows all of the session."""
        if self._view.is_deleted:  # The tab was closed during a dialog.
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
        self._head.show()
        self._bar.show()
        self._empty.set_visibility(not self.session.table.rows)
        self._keep()
        self._ends.show(wrong=self._problems.show())

    def _show_arm(self) -> None:
        session = self.session
        self._view.show(session.drawing, session.drawing.poses(session.joint_values()), session.strokes())
        self._view.run_method("highlight", session.drawn_row)
        self._table.draw(session.arm.keys if session.arm else ())
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

    # --- What is done to the table ------------------------------------------------------------------------------------

    def _do(self, act: Callable[[], None]) -> None:
        act()
        self.show()

    def _put(self, table: TableText) -> None:
        self._do(lambda: self.session.put(table))

    def _set_texts(self, **texts: str) -> None:
        self._do(lambda: self.session.set_texts(**texts))

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
            self._table.answer()

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
                dialogs.warn(words.left_out(put.left_out))
        elif isinstance(answer, tuple):
            await self._show_opened(await dialogs.choose(answer))

    def _resize(self, count: float | None, keys: Sequence[str]) -> None:
        # An emptied field takes no rows away, and Enter says a number twice.
        if count is None or count < 0 or min(int(count), edits.MOST_ROWS) == len(self.session.moving_rows):
            self.show()
            return
        if count > edits.MOST_ROWS:
            told = f"A table of the studio has at most {edits.MOST_ROWS} rows: these are the first of {int(count)}."
            dialogs.warn(told)
        self._do(lambda: self.session.resize(int(count), keys))

    def _act(self, act: str, key: str | None, other: str | None) -> None:
        """What was done to a row."""
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
        dialogs.warn(words.refused(act))
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

    async def _choose_convention(self, convention: Convention) -> None:
        session = self.session
        convert: bool | None = False
        if session.table.convention and edits.begun(session.table):
            convert = await dialogs.ask_convention(convention, possible=session.convertible is not None)
        if convert is not None:
            session.set_convention(convention, convert=convert)
        self.show()

    async def _choose_units(self, length: str, angle: str) -> None:
        session = self.session
        chosen: tuple[str, str, bool] | None = (length, angle, False)
        if edits.begun(session.table):
            chosen = await dialogs.ask_units(length, angle, possible=session.convertible is not None)
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
            self._view.run_method("fit", keep_view)

    # --- What is done to the arm --------------------------------------------------------------------------------------

    def _pick(self, key: str | None) -> None:
        self.session.picked = key
        self._view.run_method("highlight", self.session.drawn_row)
        if self.session.lesson is not None:
            self._show_pose()

    def _choose_layers(self, layers: frozenset[str]) -> None:
        self.session.layers = layers
        self._show_pose()

    def _choose_variant(self, variant: str) -> None:
        self.session.show_variant(variant)
        self._show_arm()
        self._view.run_method("fit", False)

    def _show_cloud(self, points: Any) -> None:  # noqa: ANN401 - an array of shape (n, 3)
        self._view.show_cloud(points)

    def _drag(self, node: str, by: float, *, begins: bool) -> None:
        self.session.drag(node, by, begins=begins)
        self._show_pose()

    def _moved(self, values: Mapping[str, float]) -> None:
        self.session.move(values)
        self._show_pose()

    async def start(self) -> None:
        """Shows the session for the first time."""
        is_new = not self.session.history.can_undo  # before the answer, in whose time a person may begin a table
        text, left = await ui.run_javascript("return [dhPage.kept(), dhPage.unfinished()]", timeout=ANSWERED)
        self.session.finish_typing(left, kept := edits.kept_table(text), is_new=is_new)
        self._view.set_layers(self.session.shown_layers)
        self._view.run_method("fade", self.session.opacities)
        self.show()
        self._view.run_method("fit", True)  # a person may have turned the camera already
        if (linked := await dialogs.linked_table()) is not None:
            await self._show_opened(opening.Opened(linked), keep_view=True)
            return
        if is_new and kept is not None and kept != self.session.table:
            self._keep(kept)  # The page may be loaded again before the question is answered.
            if await dialogs.ask_back(kept):
                await self._show_opened(opening.Opened(kept))
            else:
                self._keep()
