"""The head of the studio: the name of the arm, undo and redo, opening, saving and generating."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf_studio import dialogs
from dh2urdf_studio.layout.look import lay_look
from dh2urdf_studio.panels import sharing
from dh2urdf_studio.panels.clicks import Menu, act_once, lay_menu_item

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from dh2urdf_studio.editing.session import Session
    from dh2urdf_studio.widgets import ArmView

_QUIET = "flat dense no-caps color=white"


class StudioHead:
    """The bar at the top of the page.

    Args:
        session: the session.
        on_name: takes the name of the arm when a person has changed it.
        on_undo: undoes an edit.
        on_redo: does an undone edit again.
        on_new: begins an empty table.
        on_open: opens a table.
        on_generate: makes the URDF.
    """

    def __init__(
        self,
        session: Session,
        *,
        on_name: Callable[[str], None],
        on_undo: Callable[[], None],
        on_redo: Callable[[], None],
        on_new: Callable[[], None],
        on_open: Callable[[], Awaitable[None]],
        on_generate: Callable[[], Awaitable[None]],
    ) -> None:
        self._session = session
        ui.html("<b>dh2urdf</b> studio", sanitize=False, tag="h1").classes("studio-title")
        self._name = ui.input(on_change=None).props('dense dark standout aria-label="name of the arm" data-text=name')
        self._name.classes("studio-name").on("change", lambda: on_name(self._name.value or ""))
        self._undo = ui.button(icon="undo", on_click=on_undo).props(f'{_QUIET} aria-label="undo"')
        self._undo.tooltip("undo (Ctrl+Z)")
        self._redo = ui.button(icon="redo", on_click=on_redo).props(f'{_QUIET} aria-label="redo"')
        self._redo.tooltip("redo (Ctrl+Shift+Z)")
        ui.element("div").classes("studio-space")
        ui.button("New", on_click=on_new).props(_QUIET)
        act_once(ui.button("Open", icon="folder_open").props(_QUIET), on_open)
        with ui.button("Save", icon="save").props(_QUIET), Menu(items=True):
            for kind, name, told in dialogs.savings(session.catalog):
                lay_menu_item(told, partial(dialogs.save, session, kind, name))
            self._menu = ui.element("div")
        lay_look()
        generate = ui.button("Generate", icon="precision_manufacturing")
        generate.props("unelevated dense no-caps").classes("studio-generate").tooltip("the URDF (Ctrl+Enter)")
        act_once(generate, on_generate)

    def share(self, view: ArmView) -> None:
        """Add to the menu what is made of the scene."""
        with self._menu:
            sharing.lay_items(self._session, view)

    def show(self) -> None:
        """Show the name, and whether an edit can be undone or done again."""
        self._name.set_value(self._session.table.name)
        self._undo.set_enabled(self._session.history.can_undo)
        self._redo.set_enabled(self._session.history.can_redo)
