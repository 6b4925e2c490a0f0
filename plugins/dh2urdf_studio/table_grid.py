"""The table on the page: AG Grid with a column for every field, and the readers' messages in its cells."""

from __future__ import annotations

import json
from copy import deepcopy
from typing import TYPE_CHECKING, Any

from nicegui import ui

from dh2urdf.manipulator import Convention
from dh2urdf_studio.editing.opening import first_field
from dh2urdf_studio.page_data import PAGE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.session import Session

_WIDTH = 70


class TableGrid:
    """The rows of a session's table, to edit.

    The page knows a row by its key. So what a person does to it is done to that row, though rows were added, removed or
    moved meanwhile; where it is gone, that is reported, and no other row changes. Cursor and picked row are the page's:
    the server learns of them, and moves neither. The page numbers what is done to cells and rows, and each answer has
    the number of the last act before it: what was done since stays on the screen.

    Functions of `on` are called with row, field and text of a cell (``edit`` when it was typed, ``typing`` before,
    ``paste``), rows and fields (``clear``), a key (``pick``), what `edits.rearranged` takes (``act``), a number of axes
    with keys for new rows (``axes``), or nothing (``end`` of typing). None is what there is not.
    """

    def __init__(self, session: Session, **on: Callable[..., Any]) -> None:
        self._session = session
        self._header: tuple[Any, ...] = ()
        self._columns: list[dict[str, Any]] = []
        self._acts = 0
        self._drawn: Sequence[str] = ()
        self._grid = ui.aggrid(deepcopy(PAGE["grid"]), theme="balham", auto_size_columns=False).classes("dh-table")
        grid = self._grid
        self._take("dh-edit", lambda key, field, text: on["edit"](self._number(key), field, text))
        grid.on("cellEditingStopped", lambda _: on["end"](), ["rowId"])
        ui.on("dh-focus", lambda event: on["pick"](event.args))
        for event in ("input", "focusin"):
            grid.on(event, js_handler=f"e => dhGrid.{event}(e)")
        ui.on("dh-typing", lambda event: on["typing"](self._number(event.args[0]), *event.args[1:]))
        grid.on(
            "paste",
            lambda event: on["paste"](self._first(event.args[0]), *event.args[1:]),
            js_handler=f"e => dhGrid.paste(getElement({grid.id}).api, e, emit)",
        )
        ui.on("dh-paste", lambda event: on["paste"](self._first([]), first_field(event.args), event.args))
        for event, function in {"copy": "copy", "cut": "copy", "mousedown": "clicked"}.items():
            grid.on(event, js_handler=f"e => dhGrid.{function}(getElement({grid.id}).api, e)")
        self._take("dh-clear", lambda keys, fields: on["clear"]([*map(self._number, keys)], fields))
        self._take("dh-act", on["act"])
        self._take("dh-axes", on["axes"])
        ui.on("dh-text-size", self._lay_columns)

    def _number(self, key: str) -> int:
        """The number of a row of the page, -1 where it is no longer in the table."""
        keys = self._session.history.keys
        return keys.index(key) if key in keys else -1

    def _first(self, keys: Sequence[str]) -> int:
        """The number of the first of the last rows of the page, -1 where other rows are the last ones by now."""
        now, first = self._session.history.keys, len(self._session.history.keys) - len(keys)
        return first if list(now[max(first, 0) :]) == list(keys) and (keys or not now) else -1

    def _take(self, event: str, act: Callable[..., None]) -> None:
        """What a person does to cells and rows; the page has done it already, and has numbered it."""

        def take(arguments: Sequence[Any]) -> None:
            *told, number = arguments
            self._acts = int(number)
            act(*told)

        ui.on(event, lambda event: take(event.args))

    def show(self) -> None:
        """Shows the table, and what is wrong with it."""
        session = self._session
        header = (session.columns, session.table.convention, session.table.length_unit, session.table.angle_unit)
        if header != self._header:
            self._header = header
            self._columns = [PAGE["number_column"], *(_column(field, session.table) for field in session.columns)]
            self._lay_columns()
        rows = [{"id": key, **row} for key, row in zip(session.history.keys, session.table.rows, strict=True)]
        self.run("fill", rows, self._acts)
        self.mark()

    def _lay_columns(self) -> None:
        """The columns, as wide as the text of the page is large, and as wide as the cells need."""
        self._grid.run_grid_method("setGridOption", "columnDefs", self._columns)
        self.run("widen")

    def typed(self, row: int, field: str) -> None:
        """Shows what is wrong after a cell was typed, and the cell as it was taken.

        Other cells stay as they are on the screen, where a person may have gone on typing.
        """
        session = self._session
        if session.columns != self._header[0]:
            self.show()
            return
        self.run("setCell", session.history.keys[row], field, session.table.rows[row].get(field, ""), self._acts)
        self.mark()

    def mark(self) -> None:
        """Marks the wrong cells."""
        session, found = self._session, dict[str, dict[str, dict[str, str]]]()
        for problem in session.problems:
            if problem.row is not None:
                cells = found.setdefault(session.history.keys[problem.row], {})
                told = {"severity": problem.problem.severity, "text": problem.text}
                cells.setdefault(problem.field or "number", told)
        self.run("mark", found)

    def draw(self, keys: Sequence[str]) -> None:
        """The keys of the rows of the arm that is in the scene now."""
        if keys != self._drawn:
            self._drawn = keys
            self.run("draw", keys)

    def run(self, name: str, *arguments: object) -> None:
        """Calls a function of table_grid.js; ``ask`` when what is being typed is on the screen."""
        said = ", ".join(json.dumps(argument) for argument in arguments)
        self._grid.client.run_javascript(
            f"{{const api = getElement({self._grid.id})?.api; if (api) dhGrid.{name}(api, {said});}}"
        )


def _column(field: str, table: TableText) -> dict[str, Any]:
    about = PAGE["columns"].get(field, {})
    header, index, width = about.get("header", field), about.get("index"), about.get("width", _WIDTH)
    if index == "i" or (index == "a" and table.convention):
        header += "ᵢ₋₁" if index == "a" and table.convention == Convention.MODIFIED else "ᵢ"
    unit = {"length": table.length_unit, "angle": table.angle_unit}.get(about.get("unit", ""))
    shown = {"headerName": f"{header} [{unit}]" if unit else header, "headerTooltip": about.get("told", field)}
    editor = {":cellEditor": "dhGrid.TypeEditor"} if field == "type" else {}
    return {"field": field, "colId": field, **shown, ":minWidth": f"dhGrid.wide({width})", "flex": width, **editor}
