"""A robot description beside the table: laid upon the arm, and how far the two are from each other."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from nicegui import run, ui

from dh2urdf.errors import InputError
from dh2urdf.kinematics.comparison import TOLERANCE, changes
from dh2urdf.quantities.units import UNITS
from dh2urdf_studio import dialogs, words
from dh2urdf_studio.drawing.mesh_files import LARGEST
from dh2urdf_studio.drawing.scene import Drawing
from dh2urdf_studio.editing import comparing
from dh2urdf_studio.widgets import Panel, lay_upload, row_of, small_button

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.table_text import TableText
    from dh2urdf_studio.drawing.mesh_files import MeshStore
    from dh2urdf_studio.drawing.scene import Figure
    from dh2urdf_studio.editing.comparing import Apart, Beside
    from dh2urdf_studio.editing.session import Session

_LIKELIEST = "the likeliest"
_DIGITS = 3
_MM = UNITS["mm"]


class ComparingPanel(Panel):
    """Opens a description, lays it upon the arm, and shows the differences; `on_move` draws the arm anew."""

    ICON, TITLE, NAME = "compare", "compare with a robot description", "comparing"

    def __init__(
        self,
        session: Session,
        on_move: Callable[[], None],
        tell: Callable[..., None],
        meshes: MeshStore,
        on_table: Callable[[TableText], None],
    ) -> None:
        self._meshes, self._on_table = meshes, on_table
        self._files: comparing.GivenFiles | None = None
        self._figure: Figure | None = None
        self._served: tuple[str, ...] = ()
        ui.context.client.on_delete(self._forget)
        if session.beside is not None:  # of a page that was loaded anew, whose files are gone
            session.lay_beside(None)
        super().__init__(session, on_move, tell)

    def _lay_out(self) -> None:
        catalog = self._session.catalog
        nothing = f"No description was found. Accepted: {', '.join(comparing.description_suffixes(catalog))}"
        answers = {"none": f"{nothing}, with mesh files, or a ZIP of them.", "too much": str(comparing.too_much())}
        ends = [*comparing.wanted_suffixes(catalog), ".zip"]
        wanted = {"ends": ends, "most": comparing.MOST_FILES, "largest": LARGEST, "refused": "dh-no-files"}
        where = lay_upload(self._panel, wanted, on_multi_upload=self._take)
        self._panel.on("dragover", js_handler="event => event.preventDefault()")
        with row_of():
            for told, icon, folder in (
                ("Open a description", "folder_open", "false"),
                ("Open a folder", "drive_folder_upload", "true"),
            ):
                choose = small_button(told, icon=icon)
                choose.on("click", js_handler=f"() => dhPage.choose({where}, {folder})")
            self._which = ui.select([], on_change=self._choose_description)
            self._which.props('dense outlined prefix="file" aria-label="description"').set_visibility(False)
            self._ends = [
                ui.select([_LIKELIEST], value=_LIKELIEST, on_change=self._compare).props(
                    f'dense outlined prefix="{end}" aria-label="{end} of the description"'
                )
                for end in ("base link", "tip link")
            ]
            self._adopt = small_button("Take its numbers over", self._take_over)
            self._adopt.tooltip("puts the numbers that differ into the table; undo brings the old ones back")
            self._away = ui.button("Take it away", on_click=self._close).props("flat dense no-caps size=sm")
        self._status = ui.label().classes("studio-compared").style("white-space: pre-line").props('role="status"')
        self._numbers = ui.html(sanitize=False)
        ui.on("dh-no-files", lambda event: self._status.set_text(answers.get(str(event.args), dialogs.LOST)))

    def switch(self) -> None:
        """Open it, or close it; the description is shown while it is open."""
        super().switch()
        self._compare()

    def show(self) -> None:
        """Show the differences at the pose of the sliders."""
        session, found = self._session, self._session.beside
        self._panel.set_visibility(self._is_open)
        for element in (*self._ends, self._away):
            element.set_visibility(self._figure is not None)
        agreement = found.agreement if found is not None else None
        differs = agreement is not None and agreement.difference is not None and not agreement.holds
        # The numbers of the table after its edits are not those in the cells.
        self._adopt.set_visibility(differs and session.reading.is_whole and not session.arm_edits)
        if not self._is_open or self._figure is None:
            return
        self._numbers.set_content("")
        if found is None or session.arm is None:
            self._status.set_text("The table has no arm yet.")
            return
        table = session.arm.manipulator
        self._status.set_text("\n".join(_words(found, table)))
        if found.chain is not None:
            here = comparing.differences(found.chain, table, session.vector)
            self._numbers.set_content(_as_html(found, table, here, 1 + words.decimals(_MM, session.reach)))

    async def _take(self, event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        self._close()
        if len(event.files) > comparing.MOST_FILES or sum(file.size() for file in event.files) > LARGEST:
            self._status.set_text(str(comparing.too_much()))  # before any of it is in memory
            return
        files = comparing.GivenFiles((), self._session.catalog)
        try:
            for file in event.files:
                await run.io_bound(files.add, unquote(file.name), await file.read())
        except InputError as error:
            files.close()
            self._status.set_text(str(error))
            return
        self._files, names = files, list(files.descriptions)
        if not names:
            self._status.set_text("There is no robot description among these files.")
            return
        self._which.set_options(names, value=names[0])  # which opens it
        self._which.set_visibility(len(names) > 1)

    async def _choose_description(self) -> None:
        files, name = self._files, self._which.value
        if files is None or name not in files.descriptions:
            return
        found = await run.io_bound(files.figure, name)
        if isinstance(found, str):
            self._lay(None)
            self._status.set_text(found)
        elif found is not None:  # as it is while the server ends
            links = [_LIKELIEST, *(link.name for link in found.robot.links)]
            for select in self._ends:
                select.set_options(links, value=_LIKELIEST)
            self._lay(found)

    def _close(self) -> None:
        """Takes the description away, and removes its files."""
        self._lay(None)
        self._which.set_options([], value=None)
        self._which.set_visibility(False)
        self._forget()

    def _forget(self) -> None:
        """Serves the mesh files no longer, and removes them."""
        self._meshes.forget(self._served)
        if self._files is not None:
            self._files.close()
            self._files = None

    async def _take_over(self) -> None:
        session, found = self._session, self._session.beside
        if session.arm is None or found is None or found.agreement is None or self._files is None:
            return
        table, arm, ends = session.table, session.arm.manipulator, (found.agreement.base_link, found.agreement.tip_link)
        own = await run.io_bound(
            comparing.own_table, self._files.path(str(self._which.value)), session.catalog, arm, ends
        )
        taken = comparing.adopted(table, arm, found, own, session.catalog)
        if session.table is not table:  # it was edited meanwhile
            return
        if taken is None:
            told = "No numbers in these rows make the table this arm. Open has the description's own table."
            ui.notify(told, type="warning")
            return
        self._on_table(taken)
        told = words.count(comparing.changed_cells(table, taken), "cell has", "cells have")
        ui.notify(f"{told} the description's numbers", type="positive")

    def _lay(self, figure: Figure | None) -> None:
        self._figure = figure
        self._status.set_text("")
        self._numbers.set_content("")
        self._compare()

    def _compare(self) -> None:
        ends = ("" if each.value == _LIKELIEST else str(each.value) for each in self._ends)
        self._session.lay_beside(self._figure if self._is_open else None, *ends)
        self._meshes.forget(self._served)
        drawn = Drawing.of([self._session.beside.figure]) if self._session.beside is not None else Drawing()
        self._meshes.add(drawn.meshes)
        self._served = tuple(drawn.meshes)
        self._on_move()
        self.show()


def _words(found: Beside, table: Manipulator) -> Iterator[str]:
    """Whether the two are the same arm; where they are not, what would make them so."""
    agreement = found.agreement
    if agreement is None:
        yield found.refusal
        return
    if unseen := Drawing.of([found.figure]).unseen:
        yield f"{words.unseen(unseen, ', and the links are drawn as sticks')}. Open them together, or the folder."
    yield from (f"{notice.message[:1].upper()}{notice.message[1:]}." for notice in found.figure.notices)
    yield f"{found.figure.title}: {agreement.base_link} to {agreement.tip_link}, {len(agreement.joints)} moving joints"
    if agreement.holds:
        yield "The description is the arm of the table."
    if agreement.first_difference:
        yield f"They are different arms: {agreement.first_difference}."
    if agreement.corrected is not None and agreement.remaining is not None:
        exactly = "the same arm" if agreement.remaining.is_none else "nearly the same arm"
        yield f"With these entries the table is {exactly}:"
        yield from changes(table, agreement.corrected)


def _as_html(found: Beside, table: Manipulator, here: Sequence[Apart], digits: int) -> str:
    """The differences as a table: now, and at the worst of the joint vectors that a proof takes."""
    names = [f"axis of {row.joint}" for row in table.moving_rows]
    tip = found.agreement.tip_link if found.agreement else ""
    rows = ""
    for name, *both in zip((*names, f"tool0 and {tip}"), here, found.worst, strict=True):
        rows += f"<tr><th scope='row'>{escape(name)}</th>"
        for apart in both:
            kind = "" if max(apart) <= TOLERANCE else " class='studio-differs'"
            distance = words.short(_MM.number(apart.distance), digits)
            rows += f"<td{kind}>{distance}</td><td{kind}>{words.short(math.degrees(apart.angle), _DIGITS)}</td>"
        rows += "</tr>"
    head = "".join(f"<th scope='col'>{name}</th>" for name in ("mm now", "° now", "mm at most", "° at most"))
    return f"<table class='studio-differences'><thead><tr><td></td>{head}</tr></thead><tbody>{rows}</tbody></table>"
