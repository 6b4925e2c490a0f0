"""What a person does on a page reaches the server once, though the connection breaks; see acts.js.

NiceGUI's pages send it and wait for no answer: what is sent into a broken connection would be lost without a word.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any

from nicegui import Client, core

if TYPE_CHECKING:
    from collections.abc import Iterable

MOST_PAGES = 1000
"""Pages of which it is known what has arrived; the one that was not heard of for the longest time goes first."""
KINDS = ("event", "javascript_response")
"""The messages of NiceGUI that are acts: what was done to an element, and what the page was asked for."""


class Arrivals:
    """The acts that have arrived: each page counts its own from 1."""

    def __init__(self) -> None:
        self._last: OrderedDict[str, int] = OrderedDict()

    def is_new(self, page: str, number: int) -> bool:
        """Whether an act arrives for the first time; those of a page arrive in their order."""
        is_new = number > self._last.get(page, 0)
        self._last[page] = max(number, self._last.get(page, 0))
        self._last.move_to_end(page)
        while len(self._last) > MOST_PAGES:
            self._last.popitem(last=False)
        return is_new

    def lost(self, page: str, acts: Iterable[tuple[int, str]]) -> list[str]:
        """The words of those acts of a page that have not arrived."""
        return [told for number, told in acts if number > self._last.get(page, 0)]

    def serve(self) -> None:
        """Takes acts from pages; the answer is whether an act is here and need not be sent again."""
        do = {kind: core.sio.handlers["/"][kind] for kind in KINDS}

        def take(sid: str, number: int, kind: str, message: dict[str, Any]) -> bool:
            client = Client.instances.get(message["client_id"])
            if client is None or not client.has_socket_connection:
                return False
            if self.is_new(client.id, number):
                do[kind](sid, message)
            return True

        core.sio.on("act", take)
