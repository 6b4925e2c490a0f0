"""The studio as pages of a server: a session for every tab, which a reload finds again."""

from __future__ import annotations

from collections import OrderedDict
from pathlib import Path
from typing import TYPE_CHECKING

from nicegui import app, ui

from dh2urdf.studio.page import StudioPage
from dh2urdf.studio.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.registry import Catalog
    from dh2urdf.table_text import TableText

MOST_SESSIONS = 100
"""Tabs whose state is kept [1]; the one that was not used for the longest time goes first."""
_HERE = Path(__file__).parent
_OWNER = "dh2urdf_tab"


class Sessions:
    """The sessions by tab.

    Args:
        new: makes the session of a new tab.
    """

    def __init__(self, new: Callable[[], Session]) -> None:
        self._new = new
        self._of: OrderedDict[str, Session] = OrderedDict()

    def of(self, tab: str, before: str | None = None) -> Session:
        """The session of a tab.

        Args:
            tab: the tab.
            before: the tab of which it is a copy, where a person has duplicated one.
        """
        if tab not in self._of:
            original = self._of.get(before or "")
            self._of[tab] = original.copy() if original else self._new()
        self._of.move_to_end(tab)
        while len(self._of) > MOST_SESSIONS:
            self._of.popitem(last=False)
        return self._of[tab]


def build_studio(catalog: Catalog, table: TableText | None) -> None:
    """Declares the page of the studio.

    Args:
        catalog: the installed stages.
        table: what a new tab begins with; None for an empty table.
    """
    sessions = Sessions(lambda: Session(catalog, table))

    @ui.page("/")
    async def studio() -> None:
        dress()
        await ui.context.client.connected(timeout=30.0)
        tab = str(ui.context.client.tab_id)
        stored = app.storage.tab
        session = sessions.of(tab, stored.get(_OWNER))
        stored[_OWNER] = tab
        await StudioPage(session).start()


def dress() -> None:
    """The style sheet and the scripts of a page."""
    ui.add_css((_HERE / "studio.css").read_text("utf-8"))
    ui.add_head_html(f"<script>{(_HERE / 'table_grid.js').read_text('utf-8')}</script>")
    ui.colors(primary="#1864ab")
