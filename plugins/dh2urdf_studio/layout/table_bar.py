"""What is around the grid: axes, convention, units and rows above it; base, tool, payload and defaults below it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nicegui import ui

from dh2urdf.manipulator import Convention
from dh2urdf.table_text import ANGLE_UNITS, LENGTH_UNITS
from dh2urdf_studio.editing.axes import moving_rows
from dh2urdf_studio.editing.edits import MOST_ROWS

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from dh2urdf_studio.editing.session import Session

_PLACED = "{xyz: [0, 0, 0.3], rpy: [0, 0, pi]}"
ROW_ACTS = {
    "add": ("add", "add a row below (Alt+Insert)"),
    "remove": ("remove", "remove the row (Alt+Delete)"),
    "up": ("arrow_upward", "move the row up (Alt+↑)"),
    "down": ("arrow_downward", "move the row down (Alt+↓)"),
    "columns": ("view_column", "show all columns, or those in use"),
}
"""What the buttons of the bar do: an icon and a tooltip for each. The page does it to the row that is picked there."""


ENDS = {
    "base": ("base_link to the first DH frame", _PLACED),
    "tool": ("last DH frame to tool0", _PLACED),
    "payload": ("what the arm carries at tool0", "{mass: 2.5, com: [0, 0, 0.05]}"),
    "defaults": (
        "shape and density of all links; the shape arm draws housings at the joints",
        "{geometry: {shape: arm}, density: 2700}",
    ),
}
"""The fields below the cells: a tooltip and an example for each."""


class TableBar:
    """The bar above the cells.

    Args:
        session: the session.
        on_convention: takes the convention that was chosen; it may ask a person.
        on_units: takes the units of lengths and angles that were chosen; it may ask a person.
        on_columns: shows all columns, or those in use.
    """

    def __init__(
        self,
        session: Session,
        *,
        on_convention: Callable[[Convention], Any],
        on_units: Callable[[str, str], Any],
        on_columns: Callable[[], None],
    ) -> None:
        self._session = session
        self._filling = False
        self._on_convention, self._on_units = on_convention, on_units
        with ui.element("div").classes("studio-row"):
            with ui.element("div").classes("studio-group"):
                ui.label("axes").classes("studio-caption")
                self._axes = ui.number(min=0, precision=0, format="%d")
                self._axes.props('dense outlined aria-label="number of axes"').classes("studio-axes")
                self._axes.props["autofocus"] = not session.table.rows  # to leave it costs the first key into a cell
                for event in ("keydown.enter", "change"):
                    self._axes.on(event, js_handler=f"() => dhGrid.resize({MOST_ROWS})")
            with ui.element("div").classes("studio-group"):
                self._convention = ui.toggle([str(kind) for kind in Convention], on_change=self._choose_convention)
                self._convention.props('dense unelevated no-caps toggle-color=primary aria-label="convention"')
                self._convention.classes("studio-convention").on("click", js_handler="() => dhGrid.begin()")
            with ui.element("div").classes("studio-group"):
                self._length = ui.toggle(list(LENGTH_UNITS), on_change=self._choose_units)
                self._length.props('dense unelevated no-caps aria-label="unit of lengths"')
                self._angle = ui.toggle(list(ANGLE_UNITS), on_change=self._choose_units)
                self._angle.props('dense unelevated no-caps aria-label="unit of angles"')
            with ui.element("div").classes("studio-group"):
                for name, (icon, told) in ROW_ACTS.items():
                    button = ui.button(icon=icon).props(f'flat dense round size=sm aria-label="{told}"').tooltip(told)
                    if name == "columns":
                        button.on_click(on_columns)
                    else:
                        button.on("click", js_handler=f"() => dhGrid.press('{name}')")

    def show(self) -> None:
        """Show the axes, the convention and the units of the table."""
        table = self._session.table
        self._filling = True
        self._axes.set_value(len(moving_rows(table, self._session.arm)) if table.rows else None)
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


class EndFields:
    """The fields below the cells, for what the table has beside its rows.

    Args:
        session: the session.
        on_text: takes the text of a field by its name.
    """

    def __init__(self, session: Session, on_text: Callable[..., None]) -> None:
        self._session = session
        self._fields: dict[str, ui.input] = {}
        with ui.element("div").classes("studio-ends"):
            for key, (told, example) in ENDS.items():
                field = ui.input(placeholder=example).props(
                    f'dense outlined prefix="{key}" aria-label="{key}" data-text="{key}"'
                )
                field.on("change", lambda key=key: on_text(**{key: self._fields[key].value or ""}))
                field.tooltip(told)
                self._fields[key] = field

    def show(self, wrong: Collection[str]) -> None:
        """Show the texts; those that are wrong stand out."""
        for key, field in self._fields.items():
            field.set_value(getattr(self._session.table, key))
            field.props(f"error={'true' if key in wrong else 'false'} no-error-icon hide-bottom-space")
