"""The studio's own widgets: the scene, the sliders, menus and buttons."""

from __future__ import annotations

import contextlib
import inspect
import json
import math
from functools import partial
from typing import TYPE_CHECKING, Any

from nicegui import ui
from nicegui.element import Element
from nicegui.elements import scene as _scene  # noqa: F401 - it makes three.js known to the page as nicegui-scene

from dh2urdf.quantities.units import QuantityError
from dh2urdf_studio import joints

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Mapping, Sequence

    from dh2urdf_studio.editing.session import OpenArm, Session
    from dh2urdf_studio.joints import Slider
    from dh2urdf_studio.tab import Tab

ANSWERED = 60.0  # how long a page may take to answer what it is asked [s], as on a slow network
QUIET = "flat dense no-caps color=white"  # how the buttons at the top of a page look
_STEPS = {"deg": 1.0, "rad": 0.01, "m": 0.001, "cm": 0.1, "mm": 1.0}  # what an arrow key moves a slider by, in its unit
_DIGITS = {"deg": 2, "rad": 4, "m": 4, "cm": 2, "mm": 1}  # digits behind the point of what a slider shows
_LEAST_STEPS = 50  # from one limit of a joint to the other; of a joint that moves by a millimetre the steps are smaller


class Menu(ui.menu):
    """A menu that opens and closes at once, and not when the server has answered; a click on an item may close it."""

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


def icon_button(icon: str, told: str, act: Callable[..., Any] | None = None) -> ui.button:
    """A small round button, with a name for those who do not see it."""
    button = ui.button(icon=icon, on_click=act).props("flat dense round size=sm").tooltip(told)
    button.props["aria-label"] = told
    return button


def small_button(text: str, act: Callable[..., Any] | None = None, icon: str | None = None) -> ui.button:
    """A small button with a text."""
    return ui.button(text, icon=icon, on_click=act).props("outline dense no-caps size=sm")


def row_of() -> ui.element:
    """A row of buttons and fields, which may break."""
    return ui.element("div").classes("studio-row")


def section(kind: str, name: str) -> ui.element:
    """A part of a page, with a name for those who do not see it."""
    return ui.element("section").classes(kind).props(f'aria-label="{name}"')


def toggle(choices: Any, told: str, act: Callable[..., Any], value: object = None) -> ui.toggle:  # noqa: ANN401 - NiceGUI's
    """Buttons of which one is pressed."""
    choices = choices if isinstance(choices, dict) else list(choices)
    return ui.toggle(choices, value=value, on_change=act).props(f'dense unelevated no-caps aria-label="{told}"')


def lay_upload(target: ui.element, wanted: Mapping[str, Any], **events: Callable[..., Any]) -> str:
    """Files that are dropped on a part of a page are taken; where to, and which ones, as `dhPage.choose` has them."""
    with target:
        upload = ui.upload(multiple="on_multi_upload" in events, **events).style("display: none")
    where = f"{json.dumps(upload.props['url'])}, {json.dumps(wanted)}"
    target.on("drop", js_handler=f"event => dhPage.drop(event, {where})")
    return where


class Panel:
    """A panel below the table, which a button of the bar opens and closes.

    Where it moves the arm, `on_move` draws that anew; `tell` calls a method of the scene.
    """

    ICON = TITLE = NAME = ""

    def __init__(self, session: Session, on_move: Callable[[], None], tell: Callable[..., None]) -> None:
        self._session, self._on_move, self._tell, self._is_open = session, on_move, tell, False
        with ui.element("aside").classes("studio-panel").props(f'aria-label="{self.NAME}"') as self._panel:
            self._lay_out()
        self.show()

    def _lay_out(self) -> None:
        """Lay out what is in the panel."""

    def switch(self) -> None:
        """Open the panel, or close it."""
        self._is_open = not self._is_open
        self.show()

    def show(self) -> None:
        """Show the session as it is now."""
        arm = self._session.arm if self._is_open else None
        self._panel.set_visibility(arm is not None)
        if arm is not None:
            self._show_arm(arm)

    def _show_arm(self, arm: OpenArm) -> None:
        """Show what the panel is for."""


class ArmView(Element, component="arm_view.js", esm={"dh2urdf-scene": "scene3d"}):  # type: ignore[call-arg]  # Element is any type to mypy
    """The arm in 3D."""

    def __init__(
        self,
        on_undrawn: Callable[[str], None],
        on_grip: Callable[..., None],
        on_aim: Callable[..., None] | None = None,
        on_pick_node: Callable[[str | None], None] | None = None,
    ) -> None:
        super().__init__()
        self._layers: list[str] = []
        self.on("undrawn", lambda event: on_undrawn(str(event.args["message"])))
        self.on("grip", lambda event: self._dragged(partial(on_grip, event.args["node"]), [event.args["by"]], event))
        if on_pick_node is not None:
            self.on("pick", lambda event: on_pick_node(event.args["node"]))
        else:
            self.on("pick", js_handler="event => dhGrid.chooseDrawn(event)")
        if on_aim is not None:
            self.on("aim", lambda event: self._dragged(on_aim, event.args["place"], event))

    def show(self, tab: Tab) -> None:
        """Another drawing."""
        self._set_layers(sorted(tab.shown_layers))
        self.run_method("show", tab.drawing.as_json(), tab.pose_as_json())

    def pose(self, tab: Tab) -> None:
        """The same drawing in another pose, and perhaps with other layers."""
        self._set_layers(sorted(tab.shown_layers))
        self.run_method("move", tab.pose_as_json())

    def _set_layers(self, layers: list[str]) -> None:
        if layers != self._layers:
            self._layers = layers
            self.run_method("setLayers", layers)

    async def drawn(self) -> None:
        """Waits until the browser has drawn what it has got; a tab that is not seen draws once a second at most."""
        with contextlib.suppress(TimeoutError):
            await self.run_method("nextPicture", timeout=1.0)

    async def turn(self, frames: int, largest: int) -> AsyncIterator[str]:
        """Frames of a turn of the camera about the arm, as data addresses of PNGs; the camera is back afterwards."""
        try:
            for number in range(frames):
                yield str(await self.run_method("turn", number / frames, largest, timeout=30.0))
        finally:
            self.run_method("turn", None)

    def _dragged(self, act: Callable[..., None], numbers: Sequence[Any], event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        """Numbers of what a person drags, the place of the handle or how far a link has come, if they are finite."""
        if all(map(math.isfinite, numbers := [*map(float, numbers)])):
            act(*numbers, begins=bool(event.args["begins"]))
        self.run_method("answered")


class JointSliders(Element, component="joint_sliders.js"):  # type: ignore[call-arg]
    """A slider and a number for every moving joint, below buttons for all of them."""

    def __init__(self, on_values: Callable[[Mapping[str, float]], None], told: str = "") -> None:
        self._sliders: tuple[Slider, ...] = ()
        self._on_values = on_values
        self._number = 0
        with row_of():
            if told:
                ui.label(told).classes("studio-caption")
            small_button("zero", lambda: on_values(joints.kept({}, self._sliders)))
            small_button("random pose", lambda: on_values(joints.anywhere(self._sliders)))
        super().__init__()
        self.on("typed", lambda event: self._typed(int(event.args["index"]), str(event.args["text"])))
        self.on("values", lambda event: self._moved(event.args["values"], int(event.args["number"])))

    def show(self, sliders: Sequence[Slider], q: Mapping[str, float]) -> None:
        """Other joints, or the same in another pose [rad or m]."""
        if tuple(sliders) == self._sliders:
            self.answer(q)
            return
        self._sliders = tuple(sliders)
        self.run_method("show", [_as_json(slider) for slider in sliders], self._shown(q))

    def answer(self, q: Mapping[str, float]) -> None:
        """The pose that holds now [rad or m]."""
        self.run_method("answer", self._shown(q), self._number)

    def _moved(self, values: Sequence[Any], number: int) -> None:
        self._number = number
        if len(values) == len(self._sliders):  # else the joints have changed meanwhile
            pairs = zip(self._sliders, values, strict=True)
            self._on_values({slider.name: slider.value(float(shown)) for slider, shown in pairs})

    def _typed(self, index: int, text: str) -> None:
        if index < len(self._sliders):
            try:
                self.run_method("take", index, self._sliders[index].read(text))
            except QuantityError as error:
                self.run_method("refuse", index, str(error))

    def _shown(self, q: Mapping[str, float]) -> list[float]:
        return [slider.shown(q.get(slider.name, 0.0)) for slider in self._sliders]


def _as_json(slider: Slider) -> dict[str, Any]:
    unit, lower, upper = slider.unit.symbol, slider.shown(slider.lower), slider.shown(slider.upper)
    step = _STEPS.get(unit, 0.01)
    if 0.0 < upper - lower < _LEAST_STEPS * step:
        step = 10.0 ** math.floor(math.log10((upper - lower) / _LEAST_STEPS))
    digits = max(_DIGITS.get(unit, 4), 1 - math.floor(math.log10(step)))
    shown = {"lower": lower, "upper": upper, "unit": "°" if slider.unit.degrees else unit}
    return {"name": slider.name, "group": slider.group, **shown, "step": step, "digits": digits}
