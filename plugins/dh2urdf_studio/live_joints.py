"""The joint values that other programs give to the robots of `dh2urdf view`, and ask for.

A request has names and positions, as urdf-viz has it: ``{"names": ["elbow"], "positions": [0.5]}``. Everything in it is
checked before a joint moves. The guard of the server lets programs of this machine in, and the page itself. A request
has to be declared as JSON besides: a page from elsewhere cannot send that without asking first (a preflight), and
nothing answers that question.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from weakref import WeakSet

from fastapi import Request  # noqa: TC002 - FastAPI reads the annotation
from fastapi.responses import JSONResponse
from nicegui import app, background_tasks, ui
from pydantic import BaseModel, FiniteFloat, ValidationError

from dh2urdf.errors import InputError
from dh2urdf.source import Messages, did_you_mean, listed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from dh2urdf_studio.viewing import View
    from dh2urdf_studio.widgets import ArmView

say = Messages(__file__)

LARGEST_REQUEST = 2**20  # size of a request [B]
GET, SET = "/get_joint_positions", "/set_joint_positions"  # the routes, called as in urdf-viz


class _Request(BaseModel, strict=True):
    """What a program asks for."""

    names: list[str]
    positions: list[FiniteFloat]


class LiveJoints:
    """The joint values that programs give and ask for."""

    def __init__(self, first: View) -> None:
        self.pages: set[PageFollower] = set()  # that are open
        self._first = first
        self._given: dict[str, float] = {}
        self._views = WeakSet([first])  # of all tabs

    @property
    def q(self) -> Mapping[str, float]:
        """The values that any tab or program has set last, by name [rad or m]."""
        return self._first.q

    def note(self, view: View) -> None:
        """A person has moved the joints of a tab."""
        self._first.q = view.q

    def begin(self, view: View) -> View:
        """A new view, with the values that programs have given."""
        view.move(self._given)
        self._views.add(view)
        return view

    def take(self, text: bytes) -> list[str]:
        """Moves the joints of the views of all tabs as a program asks for, or none: an `InputError` says what is wrong.

        Joints whose values were outside their limits are at the nearest limit; it returns them.
        """
        try:
            asked = _Request.model_validate_json(text)
        except ValidationError as error:
            first = error.errors()[0]
            where = "".join(f", {each}" for each in first["loc"])
            raise InputError(say("request-wrong", reason=f"{first['msg']}{where}")) from error
        names = asked.names
        if len(names) != len(asked.positions):
            raise InputError(say("names-not-positions", names=len(names), positions=len(asked.positions)))
        for name in names:
            if name not in self.q:
                known = listed(list(self.q), 20) if self.q else "no joint moves"
                raise InputError(say("joint-unknown", name=name, known=known, suggestion=did_you_mean(name, self.q)))
        values = dict(zip(names, asked.positions, strict=True))
        if len(values) < len(names):
            raise InputError(say("joint-twice", name=next(each for each in values if names.count(each) > 1)))
        for view in self._views:
            view.move(values)
        self._given |= {name: self.q[name] for name in values}
        for page in self.pages:
            page.follow()
        sliders = {slider.name: slider for slider in self._first.sliders}
        return [name for name, value in values.items() if name in sliders and not sliders[name].holds(value)]


def serve_joints(live: LiveJoints) -> None:
    """Declares the routes by which programs read and set the joint values of all tabs."""

    async def get_positions() -> JSONResponse:
        return JSONResponse({"names": list(live.q), "positions": list(live.q.values())})

    async def set_positions(request: Request) -> JSONResponse:
        if request.headers.get("content-type", "").partition(";")[0].strip().lower() != "application/json":
            return _refusal("the header Content-Type has to be application/json", 415)
        if int(request.headers.get("content-length", "0")) > LARGEST_REQUEST:
            return _refusal(f"the request has more than {LARGEST_REQUEST // 2**20} MB", 413)
        try:
            limited = live.take(await request.body())
        except InputError as error:
            return _refusal(str(error), 400)
        return JSONResponse({"is_ok": True, "reason": "", "limited": limited})

    app.add_api_route(GET, get_positions, methods=["GET"])
    app.add_api_route(SET, set_positions, methods=["POST"])


def _refusal(reason: str, status: int) -> JSONResponse:
    return JSONResponse({"is_ok": False, "reason": reason}, status_code=status)


class PageFollower:
    """Shows on a page what programs give, as often as the browser draws: what comes meanwhile is passed over."""

    def __init__(self, live: LiveJoints, scene: ArmView, show: Callable[[], Any]) -> None:
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
