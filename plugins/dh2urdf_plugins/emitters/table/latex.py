r"""Tables as LaTeX, with the rules of the package booktabs.

The file is a fragment: ``\usepackage{booktabs}`` in the preamble, then ``\input{arm}``.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf_plugins.emitters.table.symbols import Notation, cells_of, convention_product

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.emitters.table.options import TableOptions

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
_PRODUCT = r" \, "
_THETA = r"\theta"
_UNITS = {"rad": "rad", "deg": r"$^\circ$", "m": "m", "cm": "cm", "mm": "mm"}
_PI = re.compile(r"(-?)(?:([0-9]+)\*)?pi(?:/([0-9]+))?")
_POWER = re.compile(r"(-?[0-9.]+)[eE]([+-]?[0-9]+)")


def latex_file(arms: Sequence[Manipulator], options: TableOptions) -> bytes:
    """The tables, each as a float with a caption."""
    lines = [r"% \usepackage{booktabs}", *(line for arm in arms for line in ("", *_table(arm, options)))]
    return "\n".join([*lines, ""]).encode()


def _table(arm: Manipulator, options: TableOptions) -> Iterator[str]:
    cells = cells_of(arm, options, _NOTATION)
    length, angle = _UNITS[options.length_unit], _UNITS[options.angle_unit]
    own = "i" if arm.convention == "standard" else "i-1"
    heads = ["$i$", "Joint", "Type", f"$a_{{{own}}}$ [{length}]", rf"$\alpha_{{{own}}}$ [{angle}]"]
    heads += [f"$d_i$ [{length}]", rf"$\theta_i$ [{angle}]"]
    limits = ", ".join(_UNITS[unit] for unit in cells.limit_units.split(", ") if unit)
    heads += [rf"$q_{{\{bound}}}$ [{limits}]" for bound in ("min", "max") if limits]
    factors = convention_product(arm, (r"R_z(\theta_i)", r"T_z(d_i)", rf"T_x(a_{{{own}}})", rf"R_x(\alpha_{{{own}}})"))
    yield r"\begin{table}"
    yield r"  \centering"
    yield rf"  \caption{{Denavit--Hartenberg parameters of {escaped(arm.name)}, {arm.convention} convention:"
    yield rf"    $A_i = {_PRODUCT.join(factors)}$.}}"
    yield rf"  \begin{{tabular}}{{rll{'r' * (len(heads) - 3)}}}"
    yield r"    \toprule"
    yield rf"    {' & '.join(heads)} \\"
    yield r"    \midrule"
    for row in cells.rows:
        yield rf"    {' & '.join(row)} \\"
    yield r"    \bottomrule"
    yield r"  \end{tabular}"
    for name, pose in (("Base", cells.base), ("Tool", cells.tool)):
        if pose:
            yield ""
            yield rf"  {name}: \texttt{{{escaped(pose)}}}"
    yield r"\end{table}"


def escaped(text: str) -> str:
    """A text without characters that mean something to LaTeX."""
    return "".join(_ESCAPES.get(character, character) for character in " ".join(text.split()))


def _number(text: str) -> str:
    return f"${_formula(text)}$"


def _formula(text: str) -> str:
    """A number as a formula: ``-3*pi/4`` as ``-3\\pi/4``, ``1e-05`` as ``1 \\times 10^{-5}``."""
    if match := _PI.fullmatch(text):
        sign, times, part = match.groups()
        return rf"{sign}{times or ''}\pi{f'/{part}' if part else ''}"
    if match := _POWER.fullmatch(text):
        return rf"{match[1]} \times 10^{{{int(match[2])}}}"
    return text


def _variable(letter: str, number: int) -> str:
    return f"${_THETA if letter == 'theta' else letter}_{{{number}}}$"


def _sum(terms: Sequence[tuple[str, str]]) -> str:
    (sign, first), *others = terms
    parts = [f"-{first.strip('$')}" if sign == "-" else first.strip("$")]
    parts += [f"{sign} {term.strip('$')}" for sign, term in others]
    return f"${' '.join(parts)}$"


_NOTATION = Notation(text=escaped, number=_number, variable=_variable, sum=_sum)
