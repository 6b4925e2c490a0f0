"""`report.html`: what a run found, on one page for people, which asks nothing of any network.

A short run is shown in full, manipulator by manipulator; of a longer one there are a table of all, failures first,
what failed and why, the distributions of errors and of what was drawn, and its first manipulators. All comes from the
rows of the manifest, the tables, and robots made of these once more: the same run has the same page.

Names and messages come from strangers' files. They get into the page through jinja2's escaping alone, and the page's
own policy lets it run no script but its own.
"""

from __future__ import annotations

import math
import tarfile
from base64 import b64encode
from hashlib import sha256
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape  # noqa: TID253 - this module is imported where a page is written, and nowhere else

from dh2urdf._version import __version__
from dh2urdf.output.layouts import Form
from dh2urdf.quantities.number_text import format_number
from dh2urdf.report.figures import ARMS, FARTHEST_DRAWN, Workspace, arm_figure, bars_figure, without_warnings
from dh2urdf.report.first_manipulators import DetailedManipulator
from dh2urdf.report.overview import MOST_DRAWN, checks
from dh2urdf.report.page import PAGE
from dh2urdf.report.reproduction import plain_options
from dh2urdf.report.verdicts import covered, notice_line
from dh2urdf.source import printable

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jinja2 import Environment, PackageLoader

    from dh2urdf.conversion.one_manipulator import Recipe
    from dh2urdf.output.layouts import Layout
    from dh2urdf.output.store import Store
    from dh2urdf.report.first_manipulators import FirstManipulators
    from dh2urdf.report.manifest_writer import ManifestWriter
    from dh2urdf.report.overview import Overview

LARGEST_PICTURE = 4_000_000
"""Pictures beyond are left out of the page [B]."""
_PNG = b"\x89PNG\r\n\x1a\n"


def write_html(
    store: Store,
    manifest: ManifestWriter,
    manipulators: FirstManipulators,
    recipe: Recipe,
    layout: Layout,
    *,
    reports: Store,
) -> None:
    """Write `report.html`.

    Args:
        store: where the pictures of the simulators are.
        manifest: what was gathered from the rows of its manifest, an overview among it.
        manipulators: what the run's first manipulators are made of.
        recipe: what was done with every manipulator.
        layout: under which names the files lie.
        reports: where it goes.

    Raises:
        OutputError: it cannot be written.
    """
    with without_warnings():
        content = page(manifest, manipulators, recipe, store, layout)
    reports.write(PAGE, content)


def page(
    manifest: ManifestWriter, manipulators: FirstManipulators, recipe: Recipe, store: Store, layout: Layout
) -> bytes:
    """The page of a run, of which an overview was gathered."""
    overview = manifest.overview
    if overview is None:
        raise ValueError("no overview was gathered")

    environment, templates = _environment()
    style, script = (templates.get_source(environment, name)[0] for name in ("page.css", "page.js"))
    shown = [
        DetailedManipulator.of(number, overview.first[number - 1], what, recipe)
        for number, what in enumerate(manipulators.shown(overview.count), start=1)
    ]
    text = environment.get_template("page.html").render(
        version=__version__,
        overview=overview,
        most_drawn=MOST_DRAWN,
        coverage=manifest.verdicts.coverage(),
        covered=covered,
        simulator_notices=list(map(notice_line, manifest.verdicts.notices())),
        told=manifest.reproduction,
        shown=shown,
        shown_keys={detailed.number: detailed.key for detailed in shown},
        stages=list(_stages(recipe)),
        recipe=recipe,
        checks=checks,
        figures=_figures,
        pictures=lambda detailed: list(_pictures(detailed, store, layout)),
        distributions=_distributions(overview),
        style=Markup(style),  # noqa: S704 - the project's own
        script=Markup(script),  # noqa: S704
        script_hash=b64encode(sha256(script.encode()).digest()).decode(),
    )
    return text.encode("utf-8", "backslashreplace")  # The name of a file may hold bytes that are no UTF-8.


def _environment() -> tuple[Environment, PackageLoader]:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    templates = PackageLoader("dh2urdf.report")
    environment = Environment(
        loader=templates,
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_finalize,
    )
    environment.filters |= {
        "number": _number,
        "angle": _angle,
        "error": _error,
        "vector": _vector,
        "size": _size,
        "lines": _lines,
    }
    return environment, templates


# --- Facts as text ----------------------------------------------------------------------------------------------------


def _finalize(value: Any) -> Any:  # noqa: ANN401 - whatever a template shows
    """Text without control characters, nor those that turn the direction of what follows."""
    return printable(value) if type(value) is str else value


def _lines(text: str) -> Markup:
    """Several lines of a simulator's output, as they were."""
    return Markup("\n").join(escape(printable(line)) for line in text.splitlines())


def _data(value: float, text: str) -> Markup:
    """A number as people read it; the element says all its digits."""
    exact = format_number(value) if math.isfinite(value) else str(value)
    return Markup('<data value="{}">{}</data>').format(exact, text)


def _nothing() -> Markup:
    return Markup('<span class="none">–</span>')


def _number(value: float | None, unit: str = "", digits: int = 6) -> Markup:
    """A quantity with so many digits."""
    if value is None:
        return _nothing()
    return _data(value, f"{value + 0.0:.{digits}g}{unit and f' {unit}'}")


def _angle(value: float | None) -> Markup:
    """An angle in rad, and in degrees below."""
    if not value:
        return _number(value)
    return _number(value) + Markup(' <small class="deg">{}°</small>').format(f"{math.degrees(value) + 0.0:.6g}")


def _error(value: float | None, unit: str = "") -> Markup:
    """An error with two digits; one that is none, with three."""
    if value is None:
        return _nothing()
    text = f"{value:.3g}" if not value or value >= _LARGE else f"{value:.1e}"
    return _data(value, f"{text}{unit and f' {unit}'}")


_LARGE = 1e-2  # [m or rad]


def _vector(values: Sequence[float], most: int = 16) -> Markup:
    """Some numbers in brackets, with four digits each."""
    shown = Markup(", ").join(_data(value, f"{value + 0.0:.4g}") for value in values[:most])
    more = f", … {len(values) - most} more" if len(values) > most else ""
    return Markup("[{}{}]").format(shown, more) if values else _nothing()


def _size(count: int) -> Markup:
    """A size in bytes as people read it."""
    power = min(max(0, (len(str(count)) - 1) // 3), 3)
    return _data(count, f"{count / 1000**power:.3g} {('B', 'kB', 'MB', 'GB')[power]}")


def _stages(recipe: Recipe) -> Iterator[tuple[str, str, str, str]]:
    """The stages of a run: kind, name, summary, options."""
    for call in recipe.calls:
        told = ", ".join(f"{name}: {_word(value)}" for name, value in plain_options(call).items())
        yield call.kind, call.stage.name, call.stage.summary, told


def _word(value: object) -> str:
    """The value of an option, as YAML has it."""
    return (
        {None: "null", True: "true", False: "false"}[value]
        if value is None or value is True or value is False
        else str(value)
    )


# --- Figures and pictures ---------------------------------------------------------------------------------------------


def _figures(detailed: DetailedManipulator) -> dict[str, Any] | None:
    """Draw a manipulator and how far its tips get; None where there is no robot, or none that can be drawn."""
    if detailed.robot is None or detailed.expected is None:
        return None
    workspace = Workspace(detailed.expected, detailed.robot)
    extents = {tip: workspace.extent(tip) for tip in workspace.points}
    if not all(0.0 <= extent["distance"] < FARTHEST_DRAWN for extent in extents.values()):
        return None
    return {
        "arm": Markup(arm_figure(detailed.expected, f"{detailed.key}-arm")),  # noqa: S704 - drawn by matplotlib
        "workspace": Markup(workspace.figure(f"{detailed.key}-reach")),  # noqa: S704
        "extents": [(tip, ARMS[n % len(ARMS)], extent) for n, (tip, extent) in enumerate(extents.items())],
        "samples": len(next(iter(workspace.points.values()))),
    }


def _distributions(overview: Overview) -> dict[str, Any]:
    several = {
        "errors": (overview.error_distributions, "how many manipulators have which position error"),
        "drawn": (overview.distributions, "how often which values were drawn"),
    }
    return {
        name: Markup(bars_figure(bars, what, name)) if bars and overview.count > 1 else None  # noqa: S704
        for name, (bars, what) in several.items()
    }


def _pictures(detailed: DetailedManipulator, store: Store, layout: Layout) -> Iterator[tuple[str, str]]:
    """The pictures that simulators took, as data URIs, with the simulators' names."""
    for load in detailed.row["loaders"].values():
        if load["picture"]:
            content = _picture(detailed.number - 1, load["picture"], store, layout)
            if content.startswith(_PNG):
                yield load["simulator"], f"data:image/png;base64,{b64encode(content).decode()}"


def _picture(index: int, name: str, store: Store, layout: Layout) -> bytes:
    """A picture of the manipulator of a number; nothing where there is none, or a large one."""
    if layout.form is Form.SHARDS:
        with store.open(layout.folder(index)) as stream, tarfile.open(fileobj=stream, mode="r|") as shard:
            for member in shard:
                if member.name == name and member.size <= LARGEST_PICTURE and (file := shard.extractfile(member)):
                    return file.read()
        return b""
    path = layout.path(index, name)
    size = store.size(path)
    return store.read(path) if size is not None and size <= LARGEST_PICTURE else b""
