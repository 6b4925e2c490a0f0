"""The routes by which programs read and set joint values, and the pace at which a page follows them.

The guard of the server lets programs of this machine in, and the page itself; pages from elsewhere it does not. A
request has to be declared as JSON besides: a page from elsewhere cannot send that without asking first (a preflight),
and nothing answers that question.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import Request  # noqa: TC002 - FastAPI reads the annotation
from fastapi.responses import JSONResponse
from nicegui import app, background_tasks, ui

from dh2urdf.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from dh2urdf_studio.driving.live_joints import LiveJoints
    from dh2urdf_studio.viewing import View
    from dh2urdf_studio.widgets import ArmView

LARGEST_REQUEST = 2**20
"""Size of a request [B]."""
GET, SET = "/get_joint_positions", "/set_joint_positions"
"""The routes, called as in urdf-viz."""


def serve_joints(live: LiveJoints, views: Callable[[], Iterable[View]]) -> None:
    """Declares the routes.

    Args:
        live: the joint values.
        views: gives the views of the tabs.
    """

    async def get_positions() -> JSONResponse:
        return JSONResponse(live.as_json())

    async def set_positions(request: Request) -> JSONResponse:
        if request.headers.get("content-type", "").partition(";")[0].strip().lower() != "application/json":
            return _refusal("the header Content-Type has to be application/json", 415)
        if int(request.headers.get("content-length", "0")) > LARGEST_REQUEST:
            return _refusal(f"the request has more than {LARGEST_REQUEST // 2**20} MB", 413)
        try:
            limited = live.take(await request.body(), views())
        except InputError as error:
            return _refusal(str(error), 400)
        return JSONResponse({"is_ok": True, "reason": "", "limited": limited})

    app.add_api_route(GET, get_positions, methods=["GET"])
    app.add_api_route(SET, set_positions, methods=["POST"])


def _refusal(reason: str, status: int) -> JSONResponse:
    return JSONResponse({"is_ok": False, "reason": reason}, status_code=status)


class PageFollower:
    """Shows on a page what programs give, as often as the browser draws: what comes meanwhile is passed over.

    Args:
        live: the joint values.
        scene: the scene of the page.
        show: shows the joint values of its view.
    """

    def __init__(self, live: LiveJoints, scene: ArmView, show: Callable[[], None]) -> None:
        self._scene, self._show = scene, show
        self._behind = self._follows = False
        live.pages.add(self)
        ui.context.client.on_delete(lambda: live.pages.discard(self))

    def follow(self) -> None:
        """The joints of the view have moved."""
        self._behind = True
        if not self._follows:
            self._follows = True
            background_tasks.create(self._catch_up())

    async def _catch_up(self) -> None:
        try:
            while self._behind:
                self._behind = False
                self._show()
                await self._scene.drawn()
        finally:
            self._follows = False
