"""`report.html`: what a run found, on one page for people, which asks nothing of any network.

A short run is shown in full, manipulator by manipulator; of a longer one there are a table of all, failures first,
what failed and why, the distributions of errors and of what was drawn, and its first manipulators. All comes from the
rows of the manifest, the tables, and robots made of these once more: the same run has the same page, also where it was
resumed and made none of them itself.

Names and messages come from strangers' files. They get into the page through jinja2's escaping alone, and the page's
own policy lets it run no script but its own.
"""

from __future__ import annotations

import json
import math
import tarfile
from base64 import b64encode
from contextlib import suppress
from hashlib import sha256
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape  # noqa: TID253 - this module is imported where a page is written, and nowhere else

from dh2urdf._version import __version__
from dh2urdf.cells.cell import Cell
from dh2urdf.conversion.robots import make_item
from dh2urdf.errors import ManipulatorError
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.layouts import Form
from dh2urdf.plugin_system.options import plain
from dh2urdf.quantities.number_text import format_number
from dh2urdf.report.figures import ARMS, FARTHEST_DRAWN, Workspace, arm_skeleton, bars_figure, skeleton_figure
from dh2urdf.report.manifest import tables_of
from dh2urdf.report.overview import MOST_DRAWN, checks
from dh2urdf.report.verdicts import covered, notice_line
from dh2urdf.source import printable

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.conversion.one_manipulator import Recipe
    from dh2urdf.output.layouts import Layout
    from dh2urdf.output.store import Store
    from dh2urdf.report.manifest import ManifestWriter
    from dh2urdf.report.overview import Overview
    from dh2urdf.results import ManipulatorEntry
    from dh2urdf.run_file.plan import Plan

LARGEST_PICTURE = 4_000_000  # pictures beyond are left out of the page [B]
_LARGE = 1e-2  # errors from here on have three digits [m or rad]


def page(manifest: ManifestWriter, overview: Overview, plan: Plan) -> bytes:
    """The page of a run."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    recipe = plan.recipe
    templates = PackageLoader("dh2urdf.report")
    environment = Environment(
        loader=templates,
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        # Text without control characters, nor those that turn the direction of what follows.
        finalize=lambda value: printable(value) if type(value) is str else value,
    )
    environment.filters |= {
        "number": _number,
        "angle": _angle,
        "error": _error,
        "vector": _vector,
        "size": _size,
        "lines": lambda text: Markup("\n").join(escape(printable(line)) for line in text.splitlines()),
    }
    style, script = (templates.get_source(environment, name)[0] for name in ("page.css", "page.js"))
    shown = [
        _detailed(number, overview.first[number - 1], what, recipe)
        for number, what in enumerate(manifest.shown(overview.count), start=1)
    ]
    distributions = {
        "errors": (overview.error_distributions, "how many manipulators have which position error"),
        "drawn": (overview.distributions, "how often which values were drawn"),
    }
    text = environment.get_template("page.html").render(
        version=__version__,
        overview=overview,
        failures_by_kind=manifest.index.as_json()["failures"],
        most_drawn=MOST_DRAWN,
        coverage=manifest.verdicts.coverage,
        covered=covered,
        simulator_notices=list(map(notice_line, manifest.verdicts.notices())),
        told=manifest.reproduction,
        shown=shown,
        stages=[(call.kind, call.stage.name, call.stage.summary, _options(call.options)) for call in recipe.calls],
        recipe=recipe,
        checks=checks,
        figures=_figures,
        pictures=lambda detailed: list(_pictures(detailed, plan.store, plan.layout)),
        distributions={
            name: Markup(bars_figure(bars, what, name)) if bars and overview.count > 1 else None  # noqa: S704
            for name, (bars, what) in distributions.items()
        },
        style=Markup(style),  # noqa: S704 - the project's own
        script=Markup(script),  # noqa: S704
        script_hash=b64encode(sha256(script.encode()).digest()).decode(),
    )
    return text.encode("utf-8", "backslashreplace")  # The name of a file may hold bytes that are no UTF-8.


# --- Facts as text ----------------------------------------------------------------------------------------------------


def _data(value: float | None, text: str) -> Markup:
    """A number as people read it; the element says all its digits."""
    if value is None:
        return Markup('<span class="none">–</span>')
    return Markup('<data value="{}">{}</data>').format(
        format_number(value) if math.isfinite(value) else value, text.strip()
    )


def _number(value: float | None, unit: str = "", digits: int = 6) -> Markup:
    """A quantity with so many digits."""
    return _data(value, f"{(value or 0.0) + 0.0:.{digits}g} {unit}")


def _angle(value: float | None) -> Markup:
    degrees = Markup(' <small class="deg">{}°</small>').format(f"{math.degrees(value) + 0.0:.6g}") if value else ""
    return _number(value) + degrees


def _error(value: float | None, unit: str = "") -> Markup:
    """An error with two digits; one that is none, with three."""
    return _data(value, f"{value or 0.0:{'.1e' if value and value < _LARGE else '.3g'}} {unit}")


def _vector(values: Sequence[float], most: int = 16) -> Markup:
    """Some numbers in brackets, with four digits each."""
    shown = Markup(", ").join(_number(value, digits=4) for value in values[:most])
    more = f", … {len(values) - most} more" if len(values) > most else ""
    return Markup("[{}{}]").format(shown, more) if values else _data(None, "")


def _size(count: int) -> Markup:
    """A size in bytes as people read it."""
    power = min(max(0, (len(str(count)) - 1) // 3), 3)
    return _data(count, f"{count / 1000**power:.3g} {('B', 'kB', 'MB', 'GB')[power]}")


def _options(options: object) -> str:
    """The options of a stage, as YAML has them."""
    values = {name: value if isinstance(value, str) else json.dumps(value) for name, value in plain(options).items()}
    return ", ".join(f"{name}: {value}" for name, value in values.items())


# --- What is shown in full --------------------------------------------------------------------------------------------


def _detailed(number: int, row: ManipulatorEntry, what: object, recipe: Recipe) -> dict[str, Any]:
    """What is shown in full of a manipulator or cell: its tables, its robot, masses, limits that were computed."""
    robot = expected = None
    if row["files"] and isinstance(what, Manipulator | Cell):  # What ended a worker without files would end the run.
        with suppress(ManipulatorError):  # A transform with changing results is reported already.
            robot, expected = make_item(what, recipe.transform, recipe.edits)
    # The table of the robot is the edited one.
    arms = [("", robot.manipulator if robot and robot.manipulator else what)] if isinstance(what, Manipulator) else []
    if isinstance(what, Cell):
        arms = [(arm.prefix, what.manipulators[arm.of]) for arm in what.call.arms if arm.part is None]
    # The rows of its tables, with their numbers from 1, by the names of the links in its robot.
    rows = {prefix + each.link: (n, each) for prefix, arm in arms for n, each in enumerate(arm.rows, start=1)}
    masses: list[dict[str, Any]] = []
    computed: dict[str, list[str]] = {}
    for link in robot.links if robot else ():
        if link.inertial and link.inertial.mass:
            n, given = rows.get(link.name, (0, None))
            parts = [part for part in ("mass", "com", "inertia") if given and getattr(given, part) is not None]
            masses.append({"link": link, "given": parts, "drawn": f"mass_{n}" in row["drawn"]})
    for joint in robot.moving_joints if robot else ():
        given, limits = rows.get(joint.child, (0, None))[1], ("lower", "upper", "velocity", "effort")
        has = [name for name in limits if getattr(joint.limits, name) is not None]
        computed[joint.name] = [name for name in has if given is None or getattr(given.limits, name) is None]
    massive = {mass["link"].name for mass in masses}
    return {
        "number": number,
        "key": f"m{number}",
        "row": row,
        "call": what.call if isinstance(what, Cell) else None,
        "tables": tables_of(what),
        "robot": robot,
        "expected": expected,
        "masses": masses,
        "frames": [link.name for link in robot.links if link.name not in massive] if robot else [],
        "computed": computed,
    }


def _figures(detailed: dict[str, Any]) -> dict[str, Any] | None:
    """Draw a manipulator and how far its tips get; None where there is no robot, or none that can be drawn."""
    if detailed["robot"] is None or detailed["expected"] is None:
        return None
    workspace = Workspace(detailed["expected"], detailed["robot"])
    extents = {tip: workspace.extent(tip) for tip in workspace.points}
    if not all(0.0 <= extent["distance"] < FARTHEST_DRAWN for extent in extents.values()):
        return None
    what = "the arm at zero joint values, with its joint axes and DH frames"
    arm = skeleton_figure([arm_skeleton(tip) for tip in detailed["expected"].tips], what, f"{detailed['key']}-arm")
    return {
        "arm": Markup(arm),  # noqa: S704 - drawn by matplotlib
        "workspace": Markup(workspace.figure(f"{detailed['key']}-reach")),  # noqa: S704
        "extents": [(tip, ARMS[n % len(ARMS)], extent) for n, (tip, extent) in enumerate(extents.items())],
        "samples": len(next(iter(workspace.points.values()))),
    }


def _pictures(detailed: dict[str, Any], store: Store, layout: Layout) -> Iterator[tuple[str, str]]:
    """The pictures that simulators took, as data URIs, with the simulators' names; large ones are left out."""
    for load in detailed["row"]["loaders"].values():
        content, index, name = b"", detailed["number"] - 1, load["picture"]
        if name and layout.form is Form.SHARDS:
            with store.open(layout.folder(index)) as stream, tarfile.open(fileobj=stream, mode="r|") as shard:
                for member in shard:
                    if member.name == name and member.size <= LARGEST_PICTURE and (file := shard.extractfile(member)):
                        content = file.read()
        elif name and (store.size(path := layout.path(index, name)) or math.inf) <= LARGEST_PICTURE:
            content = store.read(path)
        if content.startswith(b"\x89PNG\r\n\x1a\n"):
            yield load["simulator"], f"data:image/png;base64,{b64encode(content).decode()}"
