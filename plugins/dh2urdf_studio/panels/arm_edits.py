"""The edits of the arm: a list of them, each as `dh2urdf convert --edit` takes it, and a box for one more."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf.errors import BrokenPluginError
from dh2urdf.plugin_system.calls import Call, depending_on
from dh2urdf.plugin_system.option_types import describe_options
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.widgets import Panel, icon_button, row_of, small_button

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf_studio.editing.session import Session

WORDS = PAGE["edits"]
_SHOWN = 3  # names of options in the empty box


class EditsPanel(Panel):
    """Adds edits of the arm, changes and removes them, and shows what is wrong with each; `on_edit` shows the arm."""

    ICON, TITLE, NAME = "handyman", WORDS["title"], "edits"

    def __init__(
        self, session: Session, on_edit: Callable[[Callable[[], None]], None], tell: Callable[..., None]
    ) -> None:
        self._on_edit = on_edit
        self._laid: object = None  # what the list shows
        super().__init__(session, lambda: None, tell)

    def _lay_out(self) -> None:
        self._is_open = bool(self._session.arm_edits)
        self._list = ui.element("div").classes("studio-edits")
        self._list.set_visibility(False)
        if not self._session.may_edit:
            ui.label(WORDS["not here"])
            return
        self._stages = {item.stage.name: item for item in self._session.catalog.provided("edit")}
        with row_of():
            self._stage = ui.select([*self._stages], value=next(iter(self._stages), None), on_change=self._choose)
            self._stage.props(f'dense outlined options-dense aria-label="{WORDS["stage"]}"')
            self._options = ui.input().classes("studio-edit")
            self._options.props(f'dense outlined aria-label="{WORDS["options"]}"').on("keydown.enter", self._add)
            small_button(WORDS["add"], self._add, "add")
        self._summary = ui.label().classes("studio-caption")
        self._help = ui.element("dl").classes("studio-options")
        ui.label(WORDS["folder"])
        self._choose()

    def show(self) -> None:
        """Show the edits as they are now; the panel opens where something is wrong with one of them."""
        session = self._session
        found = [(each.edit, each.problem.severity, each.text) for each in session.problems if each.edit is not None]
        self._panel.set_visibility(self._is_open or bool(found))
        remarks = [str(each) for each in session.arm.remarks] if session.arm and not found else []
        if self._laid == (now := (session.arm_edits, found, remarks)):
            return
        self._laid = now
        self._list.set_visibility(bool(session.arm_edits))
        self._list.clear()
        with self._list:
            for number, text in enumerate(session.arm_edits):
                with row_of():
                    self._lay_edit(number, text)
                for _, severity, told in (each for each in found if each[0] == number):
                    _lay_problem(severity, told)
            for told in remarks:
                _lay_problem("notice", told)

    def _lay_edit(self, number: int, text: str) -> None:
        """Lay out an edit: its text, which a person may change, and what is done to it."""
        label = f"{WORDS['edit']} {number + 1}"
        field = ui.input(value=text).classes("studio-edit").props(f'dense outlined aria-label="{label}"')
        if not self._session.may_edit:
            field.props("readonly")
            return
        field.on("change", lambda: self._replace(number, [text], [field.value or ""]))
        if number:
            before = self._session.arm_edits[number - 1]
            act = partial(self._replace, number - 1, [before, text], [text, before])
            icon_button("arrow_upward", f"{WORDS['up']} {number + 1}", act)
        icon_button("close", f"{WORDS['remove']} {number + 1}", partial(self._replace, number, [text], []))

    def _replace(self, number: int, old: Sequence[str], new: Sequence[str]) -> None:
        """Some edits take the place of others; nothing is done where the others are no longer there."""
        now, there = [*self._session.arm_edits], slice(number, number + len(old))
        if now[there] == [*old]:
            now[there] = new
            self._on_edit(partial(self._session.edit_arm, now))

    def _add(self) -> None:
        if not (stage := self._stage.value):
            return
        options = (self._options.value or "").strip()
        added = f"{stage}: {options}" if options else str(stage)
        self._options.set_value("")
        self._on_edit(partial(self._session.edit_arm, [*self._session.arm_edits, added]))

    def _choose(self) -> None:
        """Show the options of the chosen stage."""
        if (chosen := self._stages.get(self._stage.value)) is None:
            return
        self._summary.set_text(chosen.stage.summary)
        self._help.clear()
        try:
            with depending_on(Call(stage=chosen.stage, options=None, plugin=chosen.plugin), "options"):
                options = describe_options(chosen.stage.options)
        except BrokenPluginError as error:  # a default that cannot be shown
            self._summary.set_text(str(error))
            return
        self._options.props["placeholder"] = f"{{{', '.join(f'{name}: …' for name, *_ in options[:_SHOWN])}}}"
        with self._help:
            for name, takes, default, told in options:
                with ui.element("dt"):
                    ui.label(name)
                with ui.element("dd"):
                    ui.label(told).tooltip(WORDS["takes"].format(takes=takes, default=default))


def _lay_problem(severity: str, told: str) -> None:
    with ui.element("div").classes(f"studio-problem {severity}"):
        ui.label(told)
