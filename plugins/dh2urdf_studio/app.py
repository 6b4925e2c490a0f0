"""The studio as pages of a server: a session for every tab, which a reload finds again.

What a person does on a page reaches the server once, though the connection breaks; see acts.js. NiceGUI's pages send it
and wait for no answer: what is sent into a broken connection would be lost without a word.
"""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastapi import Response
from nicegui import Client, app, core, ui

from dh2urdf.errors import OutputError
from dh2urdf_studio import dialogs
from dh2urdf_studio.drawing.mesh_files import MeshStore
from dh2urdf_studio.editing.session import Session
from dh2urdf_studio.live_joints import LiveJoints, serve_joints
from dh2urdf_studio.page import StudioPage
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.view_page import ViewPage
from dh2urdf_studio.viewing import View
from dh2urdf_studio.words import MOST_LOST

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText

MOST_SESSIONS = 100  # tabs whose state is kept; the one that was not used for the longest time goes first
MOST_PAGES = 1000
"""Pages of which it is known what has arrived; of those that are gone, the one that was heard of first goes first."""
KINDS = ("event", "javascript_response")
"""The messages of NiceGUI that are acts: what was done to an element, and what the page was asked for."""
_HERE = Path(__file__).parent


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


async def _tab() -> str:
    """The tab that asks for a page, as soon as it has said which it is; the page has its style sheet and scripts."""
    ui.add_css((_HERE / "studio.css").read_text("utf-8"))
    for script in ("acts.js", "look.js", "view_cube.js", "table_grid.js", "table_widths.js", "page.js"):
        ui.add_head_html(f"<script>{(_HERE / script).read_text('utf-8')}</script>")
    ui.colors(primary="#1864ab", positive="#237032", info="#1864ab")  # white text on them can be read
    await ui.context.client.connected(timeout=30.0)
    return str(ui.context.client.tab_id)


def build_studio(catalog: Catalog, table: TableText | None, arm_edits: Sequence[str] = (), *, may_edit: bool) -> None:
    """Declares the page of the studio; its tabs begin with a table and edits of its arm, which a person may change."""
    arrivals = Arrivals()
    arrivals.serve()
    session_of = lru_cache(MOST_SESSIONS)(lambda _: Session(catalog, table, arm_edits, may_edit=may_edit))
    meshes = MeshStore({})
    app.on_shutdown(meshes.close)
    _serve(meshes)

    def tell_lost(page: str, acts: list[tuple[int, str]]) -> None:
        if lost := arrivals.lost(page, acts):
            more = f"\nand {len(lost) - MOST_LOST} more" if len(lost) > MOST_LOST else ""
            dialogs.warn(PAGE["warnings"]["lost"].format(acts="\n".join(lost[:MOST_LOST]) + more))

    @ui.page("/")
    async def studio() -> None:
        ui.on("dh-lost", lambda event: tell_lost(*event.args))
        client = ui.context.client
        try:
            await StudioPage(session_of(await _tab()), meshes).start()
        except TimeoutError:  # a page that was closed or loaded anew on the way answers no more, and nothing is lost
            if client.has_socket_connection:
                raise


def _serve(meshes: MeshStore) -> None:
    """Declares the routes of the mesh files that are open, and of the pictures that they name."""

    @app.get("/meshes/{key}")
    async def mesh(key: str) -> Response:
        """The triangles of a file that the descriptions name; nothing else can be asked for."""
        if key not in meshes:
            return Response("there is no such mesh", status_code=404)
        try:
            found = await asyncio.wrap_future(meshes.triangles(key))
        except OutputError as error:
            return Response(str(error), status_code=422)
        return Response(found.content, media_type="application/octet-stream")

    @app.get("/textures/{key}")
    async def texture(key: str) -> Response:
        """A picture on triangles that the page has got."""
        picture = meshes.picture(key)
        if picture is None:
            return Response("there is no such texture", status_code=404)
        return Response(picture.content, media_type=picture.media_type)


def build_view(first: View, meshes: MeshStore) -> None:
    """Declares the page that shows some robots."""
    Arrivals().serve()
    live = LiveJoints(first)
    view_of = lru_cache(MOST_SESSIONS)(lambda _: live.begin(View(first.figures)))
    serve_joints(live)
    _serve(meshes)

    @ui.page("/")
    async def view() -> None:
        await ViewPage(view_of(await _tab()), live).start()
