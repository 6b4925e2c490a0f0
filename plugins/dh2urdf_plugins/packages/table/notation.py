r"""Tables as people read them: Markdown in the form of GitHub, and LaTeX with the rules of the package booktabs.

A cell has a constant, or the joint variable with its number. The LaTeX file is a fragment: ``\usepackage{booktabs}`` in
the preamble, then ``\input{arm}``.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import JointType
from dh2urdf.quantities import UNITS, number_in
from dh2urdf.source import markdown_text
from dh2urdf.table_text import PARAMETERS
from dh2urdf.table_text.texts import law_text, transform_text
from dh2urdf_plugins.packages.templates import filled

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf_plugins.packages.table import TableOptions

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_ESCAPES = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\char34{}",  # also where babel has made it a command
    **{character: f"\\{character}" for character in "&%$#_{}"},
}
_UNITS = {"rad": "rad", "deg": r"$^\circ$", "m": "m", "cm": "cm", "mm": "mm"}
_PI = re.compile(r"(-?)(?:([0-9]+)\*)?pi(?:/([0-9]+))?")
_POWER = re.compile(r"(-?[0-9.]+)[eE]([+-]?[0-9]+)")


class Notation(NamedTuple):
    """How a format writes what is in a cell."""

    text: Callable[[str], str]  # a name
    number: Callable[[str], str]  # a number, such as ``-3*pi/4`` or ``1e-05``
    variable: Callable[[str, int], str]  # the joint variable of a letter and a number
    minus: str  # its minus sign
    formula: str = ""  # what is around a number or a sum


def markdown_file(arms: Sequence[Manipulator], options: TableOptions) -> bytes:
    """The tables, each below a heading of the manipulator's name."""
    length, angle = options.length_unit, options.angle_unit
    blocks = []
    for arm in arms:
        rows, units = _cells_of(arm, options, _MARKDOWN)
        heads = ["no.", "joint", "type", f"a [{length}]", f"α [{angle}]", f"d [{length}]", f"θ [{angle}]"]
        heads += [f"{bound} [{', '.join(units)}]" for bound in ("lower", "upper") if units]
        heads += ["follows"] if arm.followers else []
        rows = [heads, ["--:", "---", "---", *["--:"] * (len(heads) - 3)], *rows]
        block = filled(
            "table/templates/table.md",
            NAME=markdown_text(arm.name),
            CONVENTION=arm.convention,
            PRODUCT="·".join(_product(arm, "Rz(θ)", "Tz(d)", "Tx(a)", "Rx(α)")),
            ROWS="\n".join(f"| {' | '.join(row)} |" for row in rows),
            POSES="\n".join(f"\n{name}: `{pose}`" for name, pose in _poses(arm, options)),
        )
        blocks.append(block)
    return "\n".join(blocks).encode()


def latex_file(arms: Sequence[Manipulator], options: TableOptions) -> bytes:
    """The tables, each as a float with a caption."""
    length, angle = _UNITS[options.length_unit], _UNITS[options.angle_unit]
    blocks = []
    for arm in arms:
        rows, units = _cells_of(arm, options, _LATEX)
        own = "i" if arm.convention == "standard" else "i-1"
        heads = ["$i$", "Joint", "Type", f"$a_{{{own}}}$ [{length}]", rf"$\alpha_{{{own}}}$ [{angle}]"]
        heads += [f"$d_i$ [{length}]", rf"$\theta_i$ [{angle}]"]
        limits = ", ".join(_UNITS[unit] for unit in units)
        heads += [rf"$q_{{\{bound}}}$ [{limits}]" for bound in ("min", "max") if limits]
        heads += ["follows"] if arm.followers else []
        factors = (r"R_z(\theta_i)", r"T_z(d_i)", rf"T_x(a_{{{own}}})", rf"R_x(\alpha_{{{own}}})")
        block = filled(
            "table/templates/table.tex",
            NAME=escaped(arm.name),
            CONVENTION=arm.convention,
            PRODUCT=r" \, ".join(_product(arm, *factors)),
            COLUMNS="r" * (len(heads) - 3),
            HEADS=" & ".join(heads),
            ROWS="\n".join(rf"{' & '.join(row)} \\" for row in rows),
            POSES="\n".join("\n" + rf"  {name}: \texttt{{{escaped(pose)}}}" for name, pose in _poses(arm, options)),
        )
        blocks.append(block)
    return "".join([r"% \usepackage{booktabs}", "\n", *blocks]).encode()


def _cells_of(arm: Manipulator, options: TableOptions, notation: Notation) -> tuple[list[list[str]], list[str]]:
    """The cells of each row: number, name, type, a, α, d, θ, limits and laws, if any; the units of limits."""
    length, angle = UNITS[options.length_unit], UNITS[options.angle_unit]
    limited = [row for row in arm.moving_rows if (row.limits.lower, row.limits.upper) != (None, None)]
    units = dict.fromkeys(length if row.type is JointType.PRISMATIC else angle for row in limited)
    rows, number = [], 0
    for row in arm.rows:
        number += row.type is not JointType.FIXED
        cells = ["" if row.type is JointType.FIXED else str(number), notation.text(row.joint), str(row.type)]
        cells += [_parameter(row, name, number, options, notation) for name in PARAMETERS]
        if limited:
            unit = length if row.type is JointType.PRISMATIC else angle
            limits = (row.limits.lower, row.limits.upper)
            texts = ["" if each is None else notation.number(number_in(each, unit)) for each in limits]
            cells += [text and f"{notation.formula}{text}{notation.formula}" for text in texts]
        if arm.followers:
            unit = length if row.type is JointType.PRISMATIC else angle
            law = row.follows and law_text(row.follows, f"{number_in(row.follows.offset, unit)} {unit.symbol}")
            cells.append(notation.text(law or ""))
        rows.append(cells)
    return rows, [unit.symbol for unit in units]


def _parameter(row: DHRow, name: str, number: int, options: TableOptions, notation: Notation) -> str:
    """A cell: a number, or the joint variable with what is added to it."""
    unit = UNITS[options.length_unit if name in ("a", "d") else options.angle_unit]
    value: float = getattr(row, name)
    moved = {JointType.PRISMATIC: "d", JointType.FIXED: None}.get(row.type, "theta")
    text = notation.number(number_in(value, unit))
    if name == moved:
        text = f"{notation.minus if row.sign < 0 else ''}{notation.variable(name, number)}"
        for constant in (value, row.offset):
            if constant:
                sign = notation.minus if constant < 0 else "+"
                text += f" {sign} {notation.number(number_in(abs(constant), unit))}"
    return f"{notation.formula}{text}{notation.formula}"


def _product(arm: Manipulator, turn: str, shift: str, length: str, twist: str) -> tuple[str, ...]:
    """The factors of A in the order of a table's convention, of Rz(θ), Tz(d), Tx(a), Rx(α)."""
    return (turn, shift, length, twist) if arm.convention == "standard" else (twist, length, turn, shift)


def _poses(arm: Manipulator, options: TableOptions) -> list[tuple[str, str]]:
    """The base and the tool as YAML, where they are not the identity."""
    units = UNITS[options.length_unit], UNITS[options.angle_unit]
    texts = (("Base", transform_text(arm.base, *units)), ("Tool", transform_text(arm.tool, *units)))
    return [(name, text) for name, text in texts if text]


def escaped(text: str) -> str:
    """A text without characters that mean something to LaTeX."""
    return "".join(_ESCAPES.get(character, character) for character in " ".join(text.split()))


def _formula(text: str) -> str:
    """A number as a formula: ``-3*pi/4`` as ``-3\\pi/4``, ``1e-05`` as ``1 \\times 10^{-5}``."""
    if match := _PI.fullmatch(text):
        sign, times, part = match.groups()
        return rf"{sign}{times or ''}\pi{f'/{part}' if part else ''}"
    if match := _POWER.fullmatch(text):
        return rf"{match[1]} \times 10^{{{int(match[2])}}}"
    return text


_MARKDOWN = Notation(
    text=markdown_text,
    number=lambda text: text.replace("*pi", "π").replace("pi", "π").replace("-", "−"),
    variable=lambda letter, number: {"theta": "θ", "d": "d"}[letter] + str(number).translate(_SUBSCRIPTS),
    minus="−",
)
_LATEX = Notation(
    text=escaped,
    number=_formula,
    variable=lambda letter, number: f"{chr(92)}theta_{{{number}}}" if letter == "theta" else f"{letter}_{{{number}}}",
    minus="-",
    formula="$",
)
