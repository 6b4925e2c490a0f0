"""A robot description beside the table: laid upon the arm, and how far the two are from each other."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, Any

from nicegui import run, ui

from dh2urdf.kinematics.comparison import TOLERANCE, changes
from dh2urdf.stages import Emitter
from dh2urdf.studio import words
from dh2urdf.studio.dialogs import LARGEST_FILE
from dh2urdf.studio.editing.adopting import adopted, changed_cells, own_table
from dh2urdf.studio.editing.comparing import Apart, Beside, differences
from dh2urdf.studio.editing.opening import description_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.studio.drawing.scene import Figure
    from dh2urdf.studio.editing.session import Session
    from dh2urdf.table_text import TableText

_LIKELIEST = "the likeliest"


class ComparingPanel:
    """Opens a description, lays it upon the arm of the table, and shows the differences."""

    ICON, TITLE = "compare", "compare with a robot description"

    def __init__(self, session: Session, on_arm: Callable[[], None], on_table: Callable[[TableText], None]) -> None:
        """Lay the panel out, hidden.

        Args:
            session: what it is about.
            on_arm: draws the arm anew.
            on_table: puts another table in place of the one that is there, as one step of undo.
        """
        self._session, self._on_arm, self._on_table = session, on_arm, on_table
        self._file = "", b""
        self._is_open = False
        self._figure: Figure | None = None
        suffixes = ",".join(_suffixes(session.catalog))
        with ui.element("aside").classes("studio-panel").props('aria-label="comparing"') as self._panel:
            with ui.element("div").classes("studio-row"):
                upload = ui.upload(auto_upload=True, max_file_size=LARGEST_FILE, on_upload=self._take)
                upload.props(f'accept="{suffixes}"').style("display: none")
                upload.on_rejected(lambda: self._answer(f"accepted: {suffixes}, up to {LARGEST_FILE >> 20} MB"))
                choose = ui.button("Open a description", icon="folder_open")
                choose.on_click(lambda: upload.run_method("pickFiles")).props("outline dense no-caps size=sm")
                self._ends = {
                    end: ui.select([_LIKELIEST], value=_LIKELIEST, on_change=self._choose).props(
                        f'dense outlined prefix="{end}" aria-label="{end} of the description"'
                    )
                    for end in ("base link", "tip link")
                }
                self._adopt = ui.button("Take its numbers over", on_click=self._take_over)
                self._adopt.props("outline dense no-caps size=sm")
                self._adopt.tooltip("puts the numbers that differ into the table; undo brings the old ones back")
                self._away = ui.button("Take it away", on_click=lambda: self._lay(None))
                self._away.props("flat dense no-caps size=sm")
            self._status = ui.label().classes("studio-compared").style("white-space: pre-line").props('role="status"')
            self._numbers = ui.html(sanitize=False)
        self.show()

    def switch(self) -> None:
        """Open it, or close it; the description is shown while it is open."""
        self._is_open = not self._is_open
        self._compare()

    def show(self) -> None:
        """Show the differences at the pose of the sliders."""
        session, found = self._session, self._session.beside
        self._panel.set_visibility(self._is_open)
        for element in (*self._ends.values(), self._away):
            element.set_visibility(self._figure is not None)
        agreement = found.agreement if found is not None else None
        differs = agreement is not None and agreement.difference is not None and not agreement.holds
        self._adopt.set_visibility(differs and session.reading.is_whole)
        if not self._is_open or self._figure is None:
            return
        if found is None or session.arm is None:
            self._answer("The table has no arm yet.")
            self._numbers.set_content("")
            return
        table = session.arm.manipulator
        self._answer("\n".join(_words(found, table)))
        here: tuple[Apart, ...] = ()
        if found.chain is not None:
            here = differences(found.chain, table, [session.q.get(row.joint, 0.0) for row in table.moving_rows])
        self._numbers.set_content(_as_html(found, table, here) if here else "")

    async def _take(self, event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        name, content = self._file = event.file.name, await event.file.read()
        event.sender.reset()
        found = await run.io_bound(description_of, name, content, self._session.catalog)
        if isinstance(found, str):
            self._lay(None)
            self._answer(found)
        elif found is not None:  # as it is while the server ends
            links = [_LIKELIEST, *(link.name for link in found.robot.links)]
            for select in self._ends.values():
                select.set_options(links, value=_LIKELIEST)
            self._lay(found)

    async def _take_over(self) -> None:
        session, found = self._session, self._session.beside
        if session.arm is None or found is None or found.agreement is None:
            return
        table, arm, ends = session.table, session.arm.manipulator, (found.agreement.base_link, found.agreement.tip_link)
        own = await run.io_bound(own_table, *self._file, session.catalog, arm, ends)
        taken = adopted(table, arm, found, own, session.catalog)
        if session.table is not table:  # it was edited meanwhile
            return
        if taken is None:
            ui.notify(
                "No numbers in these rows make the table this arm. Open has the description's own table.",
                type="warning",
            )
            return
        self._on_table(taken)
        ui.notify(
            f"{words.count(changed_cells(table, taken), 'cell has', 'cells have')} the description's numbers",
            type="positive",
        )

    def _answer(self, text: str) -> None:
        self._status.set_text(text)

    def _lay(self, figure: Figure | None) -> None:
        self._figure = figure
        self._answer("")
        self._numbers.set_content("")
        self._compare()

    def _choose(self) -> None:
        if self._figure is not None:
            self._compare()

    def _compare(self) -> None:
        ends = ("" if each.value == _LIKELIEST else str(each.value) for each in self._ends.values())
        self._session.lay_beside(self._figure if self._is_open else None, *ends)
        self._on_arm()
        self.show()


def _suffixes(catalog: Catalog) -> Iterator[str]:
    for item in catalog.provided("emitter"):
        stage = item.stage
        if isinstance(stage, Emitter) and stage.read_foreign:
            yield from stage.suffixes


def _words(found: Beside, table: Manipulator) -> Iterator[str]:
    """Whether the two are the same arm; where they are not, what would make them so."""
    agreement = found.agreement
    if agreement is None:
        yield found.refusal
        return
    yield f"{found.figure.title}: {agreement.base_link} to {agreement.tip_link}, {len(agreement.joints)} moving joints"
    if agreement.holds:
        yield "The description is the arm of the table."
    if agreement.first_difference:
        yield f"They are different arms: {agreement.first_difference}."
    if agreement.corrected is not None and agreement.remaining is not None:
        exactly = "the same arm" if agreement.remaining.is_none else "nearly the same arm"
        yield f"With these entries the table is {exactly}:"
        yield from changes(table, agreement.corrected)


def _as_html(found: Beside, table: Manipulator, here: tuple[Apart, ...]) -> str:
    """The differences as a table: now, and at the worst of the joint vectors that a proof takes."""
    names = [f"axis of {row.joint}" for row in table.moving_rows]
    tip = found.agreement.tip_link if found.agreement else ""
    rows = "".join(
        f"<tr><th scope='row'>{escape(name)}</th>{_cells(now)}{_cells(worst)}</tr>"
        for name, now, worst in zip((*names, f"tool0 and {tip}"), here, found.worst, strict=True)
    )
    head = "".join(f"<th scope='col'>{name}</th>" for name in ("mm now", "° now", "mm at most", "° at most"))
    return f"<table class='studio-differences'><thead><tr><td></td>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _cells(apart: Apart) -> str:
    kind = "" if max(apart) <= TOLERANCE else " class='studio-differs'"
    return f"<td{kind}>{_short(1000.0 * apart.distance)}</td><td{kind}>{_short(math.degrees(apart.angle))}</td>"


def _short(number: float) -> str:
    return f"{number:.3f}".rstrip("0").rstrip(".")
