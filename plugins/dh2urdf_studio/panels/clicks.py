"""What a click does, however slow the network is: a menu opens and closes at once, and a file is made once."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from nicegui import ui

if TYPE_CHECKING:
    from collections.abc import Callable


class Menu(ui.menu):  # type: ignore[misc]  # ui.menu is any type to mypy
    """A menu that opens and closes at once, and not when the server has answered.

    Args:
        items: whether a click on an entry closes it.
    """

    LOOPBACK = None

    def __init__(self, *, items: bool = False) -> None:
        super().__init__()
        opens = f"mounted_app.elements[{self.id}].props['model-value'] = opens"
        self.on("update:model-value", js_handler=f"(opens) => ({opens})")
        if items:
            self.props("auto-close")


def lay_menu_item(told: str, act: Callable[[], Any]) -> None:
    """Lay out an entry of a menu; a list's, which Quasar makes of it, is none to a screen reader."""
    act_once(ui.menu_item(told, auto_close=False).props("role=menuitem"), act)


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
