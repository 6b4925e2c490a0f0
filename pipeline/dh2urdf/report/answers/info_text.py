"""What was understood of a table, for people: lines, a table for a terminal, Markdown."""

from __future__ import annotations

import math
from typing import IO, TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.report.answers.conversions import counted
from dh2urdf.report.answers.info import CELL, DEFAULT, unit_of
from dh2urdf.source import markdown_text, printable

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.results import AxesEntry, Detail, DistanceEntry, FieldEntry, InfoReport, MassEntry, Placement

HEAD = ("joint", "field", "value", "as typed", "read in", "place")
MOST_ARMS = 40
"""Manipulators of a table that are listed; the rest are counted."""
WIDTH = 100
"""Characters of a line on a terminal."""
_KINDS = {"turn_rate": "angular speed", "linear_damping": "linear damping"}
"""Kinds of quantities, as a sentence names them."""
_STATED = {"geometry": "shape of the links", "base_mass": "mass of the base", "base_geometry": "shape of the base"}
_STATED_UNITS = {"density": "kg/m³", "base_mass": "kg", "com": "m"}
_ANGULAR = ("rad", "rad/s")


def lines(report: InfoReport) -> Iterator[str]:
    """A report as plain lines: the facts, a line for each field, the notices."""
    detail = report["detail"]
    if detail is None:
        yield from _arms(report)
        return
    yield from _facts(report["source"], detail)
    yield ""
    rows = [HEAD, *_rows(detail)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEAD))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
    yield from _notices(detail)


def print_on_terminal(report: InfoReport, file: IO[str]) -> None:
    """Print a report with a table that fits a terminal."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console(file=file, highlight=False)
    console.width = min(console.width, WIDTH)
    detail = report["detail"]
    if detail is None:
        console.print("\n".join(_arms(report)), markup=False)
        return
    console.print("\n".join(_facts(report["source"], detail)), markup=False)
    table = Table(box=None, pad_edge=False)
    for name in HEAD:
        table.add_column(name, overflow="fold")
    before = ""
    for row, field in zip(_rows(detail), _every_field(detail), strict=True):
        style = None if field["from"] == CELL else "dim"
        shown = row if row[0] != before else ("", *row[1:])
        if before and row[0] != before:
            table.add_section()
        before = row[0]
        table.add_row(*map(escape, shown), style=style)
    console.print(table)
    console.print("\n".join(_notices(detail)), markup=False)


def markdown(report: InfoReport) -> Iterator[str]:
    """A report as Markdown."""
    detail = report["detail"]
    if detail is None:
        yield f"# {markdown_text(report['source'])}"
        yield ""
        for line in _arms(report):
            yield f"- {markdown_text(line)}"
        return
    facts = list(_facts(report["source"], detail))
    yield f"# {markdown_text(detail['name'])}"
    yield ""
    matrix = facts.index("T(base_link → tool0) at q = 0:")
    for line in facts[:matrix]:
        yield f"- {markdown_text(line)}"
    yield ""
    yield "T(base_link → tool0) at q = 0:"
    yield ""
    yield "```text"
    yield from facts[matrix + 1 :]
    yield "```"
    yield ""
    yield f"| {' | '.join(HEAD)} |"
    yield f"|{'---|' * len(HEAD)}"
    for row in _rows(detail):
        yield f"| {' | '.join(map(markdown_text, row))} |"
    if notices := list(_notices(detail)):
        yield ""
        for line in filter(None, notices):
            yield f"- {markdown_text(line)}"


# --- Facts ------------------------------------------------------------------------------------------------------------


def _arms(report: InfoReport) -> Iterator[str]:
    """Several manipulators, a line each."""
    arms = report["manipulators"]
    yield f"{printable(report['source'])}: {counted(len(arms), 'manipulator')}; --robot NAME shows one of them"
    for arm in arms[:MOST_ARMS]:
        name = printable(arm["name"])
        if arm["joints"] is None:
            yield f"{name}: cannot be read: {printable(arm['errors'][0]['message'])} ({printable(arm['place'] or '')})"
        else:
            yield (
                f"{name}: {counted(arm['joints'], 'row')}, {arm['moving']} of them moving, {arm['convention']} "
                f"convention ({printable(arm['place'] or '')})"
            )
    if (more := len(arms) - MOST_ARMS) > 0:
        yield f"and {more:,} more"


def _facts(source: str, detail: Detail) -> Iterator[str]:
    convention = detail["convention"]
    at = f" (said at {convention['place']})" if convention["place"] else ""
    yield printable(f"{detail['name']}, from {source}")
    yield printable(f"convention: {convention['value']}{at}")
    for name in ("base", "tool"):
        yield printable(f"{name}: {_placed(detail[name])}")
    for unit in detail["units"]:
        yield printable(f"unit of {_KINDS.get(unit['of'], unit['of'])}: {unit['unit']} (said at {unit['place']})")
    for key, said in detail["stated"].items():
        at = f" ({said['place']})" if said["place"] else ""
        yield printable(f"{_STATED.get(key, key)}: {_stated(key, said['value'])}{at}")
    yield _distance(detail["largest_distance"])
    yield from _axes(detail["axes"])
    yield _weight(detail["mass"])
    yield "T(base_link → tool0) at q = 0:"
    for row in detail["pose_at_zero"]:
        yield "  " + " ".join(f"{_number(value):>12}" for value in row)


def _placed(placement: Placement) -> str:
    if placement["from"] == DEFAULT:
        return "none (default)"
    xyz, rpy = ([_number(value) for value in placement[key]] for key in ("xyz", "rpy"))
    return f"xyz {' '.join(xyz)} m, rpy {' '.join(rpy)} rad ({placement['place'] or placement['from']})"


def _stated(key: str, value: object) -> str:
    """A value that holds for the whole arm, in SI units; the parts of one that has several."""
    if isinstance(value, dict):
        return ", ".join(
            f"{'' if isinstance(part, dict) else f'{name} '}{_stated(name, part)}" for name, part in value.items()
        )
    if isinstance(value, bool):
        return "all" if value else "none"
    if isinstance(value, str):
        return value
    numbers = value if isinstance(value, list | tuple) else [value]
    unit = _STATED_UNITS.get(key) or unit_of(key, JointType.REVOLUTE)
    return f"{' '.join(map(_number, numbers))} {unit}".rstrip()


def _distance(distance: DistanceEntry) -> str:
    if distance["bound"] is None:
        return f"reach: no bound, since {', '.join(map(printable, distance['without_limits']))} slides without limits"
    return (
        f"reach: tool0 is never further than {_number(distance['bound'])} m from the origin of the first DH frame "
        "(the sum of √(a² + d²) of all rows, and of the tool)"
    )


def _axes(axes: AxesEntry) -> Iterator[str]:
    """What the axes of the arm say."""
    for names in axes["parallel"]:
        yield f"parallel axes: {', '.join(map(printable, names))}"
    if axes["spherical_wrist"]:
        yield f"spherical wrist: {', '.join(map(printable, axes['spherical_wrist']))}"
    if (opw := axes["opw"]) is not None:
        lengths = {name: opw[name] for name in ("a1", "a2", "b", "c1", "c2", "c3", "c4")}
        shown = ", ".join(f"{name} {_number(length)}" for name, length in lengths.items())
        offsets, signs = (", ".join(map(_number, opw[name])) for name in ("offsets", "signs"))
        yield f"OPW arm: {shown} m, offsets {offsets} rad, signs {signs}"


def _weight(mass: MassEntry) -> str:
    if mass["total"] is None:
        return "mass: no robot can be made"
    computed = ", ".join(map(printable, mass["computed"]))
    return f"mass: {_number(mass['total'])} kg" + (f", of which computed from shapes: {computed}" if computed else "")


# --- Fields -----------------------------------------------------------------------------------------------------------


def _every_field(detail: Detail) -> Sequence[FieldEntry]:
    return [field for joint in detail["joints"] for field in joint["fields"]]


def _rows(detail: Detail) -> list[tuple[str, ...]]:
    rows = []
    for joint in detail["joints"]:
        for field in joint["fields"]:
            typed = {CELL: repr(field["typed"]) if field["typed"] is not None else ""}
            cells = (
                joint["name"],
                field["field"],
                _value(field),
                typed.get(field["from"], field["from"]),
                field["read_in"] or "",
                field["place"] or "",
            )
            rows.append(tuple(map(printable, cells)))
    return rows


def _value(field: FieldEntry) -> str:
    value, unit = field["value"], field["unit"]
    if isinstance(value, str):
        return value
    text = f"{value + 0.0:.9g} {unit}".rstrip()
    if unit in _ANGULAR and value:
        text += f" ({_number(math.degrees(value))}°{unit.removeprefix('rad')})"
    return text


def _number(value: float) -> str:
    return f"{value + 0.0:.6g}"


def _notices(detail: Detail) -> Iterator[str]:
    for kind, problems in (("notices", detail["notices"]), ("errors", detail["errors"])):
        for problem in problems:
            inner = (problem["place"],) if problem["place"] else (problem["line"], problem["column"])
            place = ":".join(str(part) for part in (problem["file"], *inner) if part is not None)
            about = f"joint {problem['joint']!r}: " if problem["joint"] else ""
            yield printable(f"{kind.removesuffix('s')}: {place}{': ' if place else ''}{about}{problem['message']}")
