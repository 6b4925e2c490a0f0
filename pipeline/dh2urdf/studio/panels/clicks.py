"""What a click does where it opens a dialog or makes a file: once, however slow the network is."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from nicegui import ui

if TYPE_CHECKING:
    from collections.abc import Callable


def lay_menu_item(told: str, act: Callable[[], Any]) -> None:
    """Lay out an entry of a menu; a list's, which Quasar makes of it, is none to a screen reader."""
    act_once(ui.menu_item(told).props("role=menuitem"), act)


def act_once(element: ui.button | ui.menu_item, act: Callable[[], Any]) -> None:
    """A click acts once, though more clicks follow before its answer is on the page; see page.js."""

    async def acted() -> None:
        try:
            if inspect.isawaitable(done := act()):
                await done
        finally:
            if not element.is_deleted:
                element.client.run_javascript(f"dhPage.answered('{element.html_id}')")

    element.props("data-once").on_click(acted)
