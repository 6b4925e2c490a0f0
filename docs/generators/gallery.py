"""The pictures of arms for the gallery and for the README: the shapes that the transform makes, drawn as SVG."""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.kinematics.chain import link_poses
from dh2urdf.manipulator import JointType
from dh2urdf.plugin_system import load
from dh2urdf.robot import Cylinder
from dh2urdf.rotations import RigidTransform, Vec3, add, rotate
from drawing import Camera, Drawing, svg
from reference_arms import load_reference_robots

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Joint, Robot

TABLES = Path(__file__).parents[2] / "configs" / "tables"
README = Path(__file__).parents[2] / "README.md"

AZIMUTH, ELEVATION = math.radians(-58), math.radians(22)
SIZE = 220
"""Width and height of a picture of the gallery [px]."""
MARGIN = 18
"""Free space around an arm [px]."""
BEND = 0.35
"""Where a joint is drawn between its middle and its end, alternately to both sides."""
WIDEST = math.radians(100)
"""A joint without narrower limits is bent as if it had these."""


class Body(NamedTuple):
    """A cylinder in space.

    Attributes:
        frame: its centre, z along it.
        radius: its radius [m].
        length: its length [m].
        colour: red, green and blue in 0..1.
    """

    frame: RigidTransform
    radius: float
    length: float
    colour: tuple[float, float, float]


@cache
def tables() -> dict[str, Manipulator]:
    """The arms of configs/tables by name."""
    catalog = load()
    found = {}
    for path in sorted(TABLES.iterdir()):
        reader = catalog.reader_for(path)
        for manipulator in reader.read(path, reader.options()):
            found[path.name.partition(".")[0]] = manipulator
    return found  # type: ignore[return-value]  # the tables are right


def arm(manipulator: Manipulator) -> str:
    """An arm in a bent pose, as large as the picture allows."""
    sheet = Drawing(_camera(manipulator, (SIZE, SIZE)))
    draw_arm(sheet, manipulator)
    return svg([sheet], (-SIZE / 2, -SIZE / 2, SIZE, SIZE), f"The arm of the table {manipulator.name}")


def draw_arm(sheet: Drawing, manipulator: Manipulator, *, links: bool = False) -> None:
    """The bodies of an arm, the far ones first, and the frame tool0; with the frames of its links if wanted."""
    robot, poses = _posed(manipulator)
    for body in sorted(_bodies(robot, poses), key=lambda each: sheet.camera.depth(each.frame.translation)):
        sheet.solid(body.frame, body.radius, body.length, body.colour)
    for name in (*(joint.child for joint in robot.moving_joints if links), "tool0"):
        sheet.triad(poses[name], 26 / sheet.camera.scale, width=2, head=7)


def _posed(manipulator: Manipulator) -> tuple[Robot, Mapping[str, RigidTransform]]:
    stage: Any = load().get("transform", "alpha-swap")
    robot: Robot = stage.transform(manipulator, stage.options())
    return robot, link_poses(robot, bent(robot))


def _camera(manipulator: Manipulator, size: tuple[float, float]) -> Camera:
    """A camera in which an arm fills a picture of this size [px]."""
    return _fitting(_bodies(*_posed(manipulator)), size)


def bent(robot: Robot) -> Mapping[str, float]:
    """A pose in which an arm is neither stretched nor folded, by joint name [rad, m]."""
    return {joint.name: _bend(number, joint) for number, joint in enumerate(robot.moving_joints)}


def _bend(number: int, joint: Joint) -> float:
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.type is JointType.PRISMATIC:
        return 0.0 if lower is None or upper is None else lower + 0.7 * (upper - lower)
    low, high = max(-WIDEST, lower or -WIDEST), min(WIDEST, upper or WIDEST)
    if low >= high:  # the limits are beyond the widest angle
        return lower if lower is not None and lower > 0 else upper or 0.0
    side = 1 if number % 2 == 0 else -1
    return (low + high) / 2 + side * BEND * (high - low) / 2


def _bodies(robot: Robot, poses: Mapping[str, RigidTransform]) -> list[Body]:
    """The bodies of a robot; the transform makes cylinders only."""
    return [
        Body(
            poses[link.name] @ visual.origin.transform,
            visual.geometry.radius,
            visual.geometry.length,
            visual.material.rgba[:3],
        )
        for link in robot.links
        for visual in link.visuals
        if isinstance(visual.geometry, Cylinder) and visual.material
    ]


def _fitting(bodies: Sequence[Body], size: tuple[float, float]) -> Camera:
    """A camera in which some bodies fill a picture."""
    camera = Camera(AZIMUTH, ELEVATION, 1.0)
    points = [camera.project(corner) for body in bodies for corner in _corners(body)]
    low = [min(point[axis] for point in points) for axis in (0, 1)]
    high = [max(point[axis] for point in points) for axis in (0, 1)]
    scale = min((size[axis] - 2 * MARGIN) / (high[axis] - low[axis]) for axis in (0, 1))
    right, up = (low[0] + high[0]) / 2, -(low[1] + high[1]) / 2
    return camera._replace(scale=scale, centre=_in_space(right, up))


def _corners(body: Body) -> list[Vec3]:
    r, half = body.radius, body.length / 2
    corners = [(x, y, z) for x in (-r, r) for y in (-r, r) for z in (-half, half)]
    return [add(body.frame.translation, rotate(body.frame.rotation, corner)) for corner in corners]


def _in_space(right: float, up: float) -> Vec3:
    """A point of space that a camera sees so far right of the origin and above it [m]."""
    c, s = math.cos(AZIMUTH), math.sin(AZIMUTH)
    tilt = -up * math.sin(ELEVATION)
    return (-s * right + c * tilt, c * right + s * tilt, up * math.cos(ELEVATION))


# --- The first picture of the README ----------------------------------------------------------------------------------

PANELS = (390, 350, 260)
"""Widths of the table, the URDF and the arm [px]."""
HEIGHT = 275
SHOWN_JOINT = "elbow"
"""The joint of which the URDF is shown."""


def readme() -> str:
    """The table of the README beside the URDF that it becomes, beside the arm."""
    (table,) = re.findall(r"^```csv\n(.*?)^```$", README.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "arm.csv"
        path.write_text(table, "utf-8")
        catalog = load()
        reader = catalog.reader_for(path)
        (manipulator,) = reader.read(path, reader.options())
        robot, _ = _posed(manipulator)  # type: ignore[arg-type]  # the table is right
    first, second = PANELS[0], PANELS[0] + PANELS[1]
    size = (PANELS[2], HEIGHT - 40)
    camera = _camera(manipulator, size)  # type: ignore[arg-type]
    sheet = Drawing(camera, shift=(second + PANELS[2] / 2, HEIGHT / 2 + 14))
    for left, title in ((18, "arm.csv"), (first + 18, "arm.urdf"), (second + 18, "the arm")):
        sheet.words((left, 28), title, size=15, anchor="start")
    sheet.code((18, 58), table.splitlines())
    sheet.code((first + 18, 58), _excerpt(robot.to_urdf()))
    draw_arm(sheet, manipulator, links=True)  # type: ignore[arg-type]
    return svg([sheet], (0, 0, sum(PANELS), HEIGHT), "A DH table, a part of its URDF, and the arm with its frames")


def _excerpt(urdf: str) -> list[str]:
    """The lines of one joint, with long numbers cut, and the limits in two lines."""
    (joint,) = re.findall(rf'^  <joint name="{SHOWN_JOINT}".*?</joint>$', urdf, re.MULTILINE | re.DOTALL)
    lines = [
        re.sub(r"(\.\d{3})\d+", r"\1…", line[2:])
        for line in joint.replace(" effort", "\n           effort").splitlines()
    ]
    return ['<robot name="arm">', "  …", *(f"  {line}" for line in lines), "  …", "</robot>"]


# --- The page of the gallery ------------------------------------------------------------------------------------------

COLUMNS = 4


def page() -> str:
    """The tables of docs/gallery.md: the arms that `dh2urdf example` prints, then the published ones."""
    shipped = [(name, f"`{name}`", manipulator) for name, manipulator in tables().items()]
    published = [(robot.id, robot.title, robot.manipulator) for robot in load_reference_robots()]
    return f"{_grid(shipped)}\n\n## Published arms\n\n{PUBLISHED}\n\n{_grid(published)}\n"


PUBLISHED = """\
The tests compare dh2urdf with these tables. Each came with end-effector poses that its publisher's own library
computed. The file `tests/reference/robots.json` names the source of each."""


def _grid(arms: Sequence[tuple[str, str, Manipulator]]) -> str:
    """Pictures and words in rows of a table."""
    lines = ["| " * COLUMNS + "|", "|---" * COLUMNS + "|"]
    for start in range(0, len(arms), COLUMNS):
        row = arms[start : start + COLUMNS]
        empty = ["" for _ in range(COLUMNS - len(row))]
        pictures = [f"![{manipulator.name}](pictures/arm-{file}.svg)" for file, _, manipulator in row]
        words = [f"{title}: {_words(manipulator)}" for _, title, manipulator in row]
        lines += [f"| {' | '.join([*cells, *empty])} |" for cells in (pictures, words)]
    return "\n".join(lines)


def _words(manipulator: Manipulator) -> str:
    """The joints of an arm in the order of its rows, as RRP, and its convention."""
    letters = "".join({JointType.FIXED: "", JointType.PRISMATIC: "P"}.get(row.type, "R") for row in manipulator.rows)
    short = f"{len(letters)}R" if set(letters) == {"R"} else letters
    return f"{short}, {manipulator.convention}"


# --- All pictures -----------------------------------------------------------------------------------------------------


def _picture(manipulator: Manipulator) -> Callable[[], str]:
    return lambda: arm(manipulator)


def gallery() -> dict[str, Callable[[], str]]:
    """The pictures by file name: of the README, of the arms of configs/tables, and of the published ones."""
    pictures = {"readme.svg": readme}
    pictures |= {f"arm-{name}.svg": _picture(manipulator) for name, manipulator in tables().items()}
    for robot in load_reference_robots():
        pictures[f"arm-{robot.id}.svg"] = _picture(robot.manipulator)
    return pictures
