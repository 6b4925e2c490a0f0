"""What a person does on a page reaches the server once, though the connection breaks; see acts.js.

NiceGUI's pages send it and wait for no answer: what is sent into a broken connection would be lost without a word.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any

from nicegui import Client, core

if TYPE_CHECKING:
    from collections.abc import Iterable

ANSWERED = 60.0
"""How long a page may take to answer what it is asked [s], as on a slow network."""
MOST_PAGES = 1000
"""Pages of which it is known what has arrived; of those that are gone, the one that was heard of first goes first."""
KINDS = ("event", "javascript_response")
"""The messages of NiceGUI that are acts: what was done to an element, and what the page was asked for."""


class Arrivals:
    """The acts that have arrived: each page counts its own from 1."""

    def __init__(self) -> None:
        self._last: OrderedDict[str, int] = OrderedDict()

    def take(self, page: str, number: int) -> bool | None:
        """Whether an act of a page arrives for the first time; None where one before it is missing.

        What was lost with a connection is sent again as soon as the page is known to the server, and what a person does
        meanwhile may overtake it.
        """
        last = self._last.get(page, 0)
        if number > last + 1:
            return None
        self._last[page] = max(number, last)
        self._last.move_to_end(page)
        if len(self._last) > MOST_PAGES:
            del self._last[next((each for each in self._last if each not in Client.instances), page)]
        return number > last

    def lost(self, page: str, acts: Iterable[tuple[int, str]]) -> list[str]:
        """The words of those acts of a page that have not arrived."""
        return [told for number, told in acts if number > self._last.get(page, 0)]

    def serve(self) -> None:
        """Takes acts from pages; the answer is whether an act is here and need not be sent again."""
        do = {kind: core.sio.handlers["/"][kind] for kind in KINDS}

        def answer(sid: str, number: int, kind: str, message: dict[str, Any]) -> bool:
            client = Client.instances.get(message["client_id"])
            if client is None or not client.has_socket_connection:
                return False
            is_new = self.take(client.id, number)
            if is_new:
                do[kind](sid, message)
            return is_new is not None

        core.sio.on("act", answer)
