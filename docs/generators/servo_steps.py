"""How the servos of an MJCF follow a step in MuJoCo, and the picture of that: every joint of the published arms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.plugin_system import load
from drawing import FAINT, INK, X_COLOUR, Z_COLOUR, Camera, Drawing, svg
from reference_arms import load_reference_robots

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dh2urdf.robot import Robot

SECONDS = 3.0
COLUMNS, PANEL, PLOT = 3, (280.0, 104.0), (250.0, 56.0)
"""Panels in a row, and width and height of a panel and of what is plotted in it [px]."""
SHOWN = 1.5
"""Time that is drawn [s]."""
SAMPLES = 30


class Response(NamedTuple):
    """How the joints follow when the targets of all of them jump at once.

    Attributes:
        q: joint values, time steps × joints [rad or m].
        start: joint values before the step.
        target: joint values that the servos are given.
        speed: the largest speed of a joint [rad/s or m/s].
        time_step: of the simulation [s].
    """

    q: NDArray[np.float64]
    start: NDArray[np.float64]
    target: NDArray[np.float64]
    speed: float
    time_step: float

    @property
    def shares(self) -> NDArray[np.float64]:
        """The values of all joints as shares of the step that each makes."""
        return (self.q - self.start) / (self.target - self.start)

    @property
    def error(self) -> float:
        """How far a joint is from its target at the end [rad or m]."""
        return float(abs(self.q[-1] - self.target).max())

    @property
    def overshoot(self) -> float:
        """How far a joint goes beyond its target, as a share of its step."""
        return float(self.shares.max()) - 1.0


def mjcf_text(robot: Robot) -> str:
    """The MJCF of a robot, as it is written by default."""
    stage: Any = load().get("emitter", "mjcf")
    (file,) = stage.emit(robot, "arm", stage.options())
    return str(file.content.decode())


def follow(model: Any, step: float) -> Response:  # noqa: ANN401 - MuJoCo's model
    """Let all joints of a model with servos make a step from home, backwards where a limit is nearer than that.

    Args:
        model: the model, with a keyframe; nothing in it is changed.
        step: how far targets jump [rad]; those of joints that slide by a quarter of it [m].
    """
    import mujoco
    import numpy as np

    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    start = data.qpos.copy()
    steps = np.where(model.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE, step / 4, step)
    lower, upper = np.where(model.jnt_limited, model.jnt_range.T, [[-np.inf], [np.inf]])
    up, down = np.minimum(start + steps, upper), np.maximum(start - steps, lower)
    target = np.where((start + steps > upper) & (up - start < start - down), down, up)
    data.ctrl[:] = target[model.actuator_trnid[:, 0]]
    q, speed = [], 0.0
    for _ in range(round(SECONDS / model.opt.timestep)):
        mujoco.mj_step(model, data)
        q.append(data.qpos.copy())
        speed = max(speed, float(np.abs(data.qvel).max()))
    return Response(np.array(q), start, target, speed, model.opt.timestep)


def servo_steps() -> str:
    """A panel for each published arm: how far every joint has come after a step of 0.2 rad, or of 5 cm."""
    import mujoco

    transform: Any = load().get("transform", "alpha-swap")
    sheet = Drawing(Camera(0.0, 0.0, 1.0))
    arms = load_reference_robots()
    for number, published in enumerate(arms):
        robot = transform.transform(published.manipulator, transform.options())
        response = follow(mujoco.MjModel.from_xml_string(mjcf_text(robot)), 0.2)
        row, column = divmod(number, COLUMNS)
        _panel(sheet, (20 + column * PANEL[0], 34 + row * PANEL[1]), published.id, response)
    height = 20 + PANEL[1] * -(-len(arms) // COLUMNS)
    return svg([sheet], (0, 0, 20 + COLUMNS * PANEL[0], height), f"Steps of all joints of {len(arms)} arms in MuJoCo")


def _panel(sheet: Drawing, place: tuple[float, float], name: str, response: Response) -> None:
    left, top = place
    width, height = PLOT

    def at(seconds: float, share: float) -> tuple[float, float]:
        return left + width * seconds / SHOWN, top + height * (1.0 - share / 1.2)

    sheet.words((left, top - 6), name, size=12, colour=INK, anchor="start")
    sheet.path([at(0.0, 0.0), at(SHOWN, 0.0)], colour=FAINT, width=1)
    sheet.path([at(0.0, 1.0), at(SHOWN, 1.0)], colour=X_COLOUR, width=1)
    # Most of it happens early.
    rows = sorted({round(SHOWN * (k / SAMPLES) ** 2 / response.time_step) for k in range(1, SAMPLES + 1)})
    for joint in response.shares.T:
        points = [at(row * response.time_step, float(joint[row - 1])) for row in rows]
        sheet.path([at(0.0, 0.0), *points], colour=Z_COLOUR, width=1.1)
    sheet.words((left, top + height + 16), "0", size=10)
    sheet.words((left + width, top + height + 16), f"{SHOWN:g} s", size=10)
