"""What was understood of a table, for people: lines, a table for a terminal, Markdown."""

from __future__ import annotations

import math
from typing import IO, TYPE_CHECKING, Any

from dh2urdf.manipulator import JointType
from dh2urdf.report.answers.conversions import counted
from dh2urdf.report.answers.info import CELL, DEFAULT, unit_of
from dh2urdf.source import markdown_text, printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.results import Detail, FieldEntry, InfoReport

HEAD = ("joint", "field", "value", "as typed", "read in", "place")
MOST_ARMS = 40
"""Manipulators of a table that are listed; the rest are counted."""
WIDTH = 100
"""Characters of a line on a terminal."""
_KINDS = {"turn_rate": "angular speed", "linear_damping": "linear damping"}
"""Kinds of quantities, as a sentence names them."""
_STATED = {"geometry": "shape of the links", "base_mass": "mass of the base", "base_geometry": "shape of the base"}
_STATED_UNITS = {"density": "kg/m³", "base_mass": "kg", "com": "m"}
_MATRIX = "T(base_link → tool0) at q = 0:"


def lines(report: InfoReport) -> Iterator[str]:
    """A report as plain lines: the facts, a line for each field, the notices."""
    detail = report["detail"]
    if detail is None:
        yield from _arms(report)
        return
    yield from (*_facts(report["source"], detail), "")
    rows = [HEAD, *(row for row, _ in _rows(detail))]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
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
    for row, is_typed in _rows(detail):
        if before and row[0] != before:
            table.add_section()
        joint = row[0] if row[0] != before else ""
        before = row[0]
        table.add_row(*map(escape, (joint, *row[1:])), style=None if is_typed else "dim")
    console.print(table)
    console.print("\n".join(_notices(detail)), markup=False)


def markdown(report: InfoReport) -> Iterator[str]:
    """A report as Markdown."""
    detail = report["detail"]
    if detail is None:
        yield from (f"# {markdown_text(report['source'])}", "")
        yield from (f"- {markdown_text(line)}" for line in _arms(report))
        return
    facts = list(_facts(report["source"], detail))
    matrix = facts.index(_MATRIX)
    yield from (f"# {markdown_text(detail['name'])}", "")
    yield from (f"- {markdown_text(line)}" for line in facts[:matrix])
    yield from ("", _MATRIX, "", "```text", *facts[matrix + 1 :], "```", "")
    yield from (f"| {' | '.join(HEAD)} |", f"|{'---|' * len(HEAD)}")
    yield from (f"| {' | '.join(map(markdown_text, row))} |" for row, _ in _rows(detail))
    if notices := [f"- {markdown_text(line)}" for line in _notices(detail) if line]:
        yield from ("", *notices)


def _arms(report: InfoReport) -> Iterator[str]:
    """Several manipulators, a line each."""
    arms = report["manipulators"]
    yield f"{printable(report['source'])}: {counted(len(arms), 'manipulator')}; --robot NAME shows one of them"
    for arm in arms[:MOST_ARMS]:
        told = f"{counted(arm['joints'] or 0, 'row')}, {arm['moving']} of them moving, {arm['convention']} convention"
        if arm["joints"] is None:
            told = f"cannot be read: {arm['errors'][0]['message']}"
        yield printable(f"{arm['name']}: {told} ({arm['place'] or ''})")
    if (more := len(arms) - MOST_ARMS) > 0:
        yield f"and {more:,} more"


def _facts(source: str, detail: Detail) -> Iterator[str]:
    """A line for each fact of the whole arm."""
    convention, distance, axes, mass = detail["convention"], detail["largest_distance"], detail["axes"], detail["mass"]
    at = f" (said at {convention['place']})" if convention["place"] else ""
    facts = [f"{detail['name']}, from {source}", f"convention: {convention['value']}{at}"]
    for name, placement in (("base", detail["base"]), ("tool", detail["tool"])):
        xyz, rpy = _numbers(placement["xyz"]), _numbers(placement["rpy"])
        placed = f"xyz {xyz} m, rpy {rpy} rad ({placement['place'] or placement['from']})"
        facts.append(f"{name}: {'none (default)' if placement['from'] == DEFAULT else placed}")
    units = [(_KINDS.get(unit["of"], unit["of"]), unit["unit"], unit["place"]) for unit in detail["units"]]
    facts += [f"unit of {kind}: {unit} (said at {place})" for kind, unit, place in units]
    for key, said in detail["stated"].items():
        at = f" ({said['place']})" if said["place"] else ""
        facts.append(f"{_STATED.get(key, key)}: {_stated(key, said['value'])}{at}")
    if distance["bound"] is None:
        facts.append(f"reach: no bound, since {', '.join(distance['without_limits'])} slides without limits")
    else:
        bound = f"{_numbers([distance['bound']])} m from the origin of the first DH frame"
        facts.append(f"reach: tool0 is never further than {bound} (the sum of √(a² + d²) of all rows, and of the tool)")
    facts += [f"parallel axes: {', '.join(names)}" for names in axes["parallel"]]
    if axes["spherical_wrist"]:
        facts.append(f"spherical wrist: {', '.join(axes['spherical_wrist'])}")
    if opw := axes["opw"]:
        numbers: dict[str, Any] = {**opw}
        lengths = ", ".join(f"{name} {_numbers([numbers[name]])}" for name in ("a1", "a2", "b", "c1", "c2", "c3", "c4"))
        offsets, signs = _numbers(opw["offsets"], ", "), _numbers(opw["signs"], ", ")
        facts.append(f"OPW arm: {lengths} m, offsets {offsets} rad, signs {signs}")
    total = "no robot can be made" if mass["total"] is None else f"{_numbers([mass['total']])} kg"
    computed = f", of which computed from shapes: {', '.join(mass['computed'])}" if mass["computed"] else ""
    facts += [f"mass: {total}{computed}", _MATRIX]
    yield from map(printable, facts)
    for row in detail["pose_at_zero"]:
        yield "  " + " ".join(f"{_numbers([value]):>12}" for value in row)


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
    unit = _STATED_UNITS.get(key) or unit_of(key, JointType.REVOLUTE)
    return f"{_numbers(value if isinstance(value, list | tuple) else [value])} {unit}".rstrip()


def _rows(detail: Detail) -> Iterator[tuple[tuple[str, ...], bool]]:
    """The cells of a line for each field, and whether the table says the value."""
    for joint in detail["joints"]:
        for field in joint["fields"]:
            is_typed = field["from"] == CELL
            typed = (repr(field["typed"]) if field["typed"] is not None else "") if is_typed else field["from"]
            cells = (joint["name"], field["field"], _value(field), typed, field["read_in"] or "", field["place"] or "")
            yield tuple(map(printable, cells)), is_typed


def _value(field: FieldEntry) -> str:
    value, unit = field["value"], field["unit"]
    if isinstance(value, str):
        return value
    degrees = f" ({_numbers([math.degrees(value)])}°{unit.removeprefix('rad')})"
    return f"{value + 0.0:.9g} {unit}".rstrip() + (degrees if unit in ("rad", "rad/s") and value else "")


def _numbers(values: Iterable[Any], between: str = " ") -> str:
    return between.join(f"{value + 0.0:.6g}" for value in values)


def _notices(detail: Detail) -> Iterator[str]:
    for kind, problems in (("notice", detail["notices"]), ("error", detail["errors"])):
        for problem in problems:
            inner = (problem["place"],) if problem["place"] else (problem["line"], problem["column"])
            place = ":".join(str(part) for part in (problem["file"], *inner) if part is not None)
            about = f"joint {problem['joint']!r}: " if problem["joint"] else ""
            yield printable(f"{kind}: {place}{': ' if place else ''}{about}{problem['message']}")
