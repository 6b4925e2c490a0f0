"""Tables as Markdown, in the form of GitHub, with symbols of Unicode."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import markdown_text
from dh2urdf_plugins.emitters.table.symbols import Notation, cells_of, convention_product

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.emitters.table.options import TableOptions

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def markdown_file(arms: Sequence[Manipulator], options: TableOptions) -> bytes:
    """The tables, each below a heading of the manipulator's name."""
    blocks = ["\n".join(_block(arm, options)) for arm in arms]
    return "\n\n".join([*blocks, ""]).rstrip("\n").encode() + b"\n"


def _block(arm: Manipulator, options: TableOptions) -> Iterator[str]:
    cells = cells_of(arm, options, _NOTATION)
    length, angle = options.length_unit, options.angle_unit
    heads = ["no.", "joint", "type", f"a [{length}]", f"α [{angle}]", f"d [{length}]", f"θ [{angle}]"]
    heads += [f"{bound} [{cells.limit_units}]" for bound in ("lower", "upper") if cells.limit_units]
    yield f"## {markdown_text(arm.name)}"
    yield ""
    product = "·".join(convention_product(arm, ("Rz(θ)", "Tz(d)", "Tx(a)", "Rx(α)")))
    yield f"Denavit-Hartenberg parameters, {arm.convention} convention: A = {product}."
    yield ""
    yield _line(heads)
    yield _line(["--:", "---", "---", *["--:"] * (len(heads) - 3)])
    yield from map(_line, cells.rows)
    for name, pose in (("Base", cells.base), ("Tool", cells.tool)):
        if pose:
            yield ""
            yield f"{name}: `{pose}`"


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _number(text: str) -> str:
    return text.replace("*pi", "π").replace("pi", "π").replace("-", "−")


def _variable(letter: str, number: int) -> str:
    return {"theta": "θ", "d": "d"}[letter] + str(number).translate(_SUBSCRIPTS)


def _sum(terms: Sequence[tuple[str, str]]) -> str:
    (sign, first), *others = terms
    start = f"−{first}" if sign == "-" else first
    return " ".join([start, *(f"{'−' if sign == '-' else '+'} {term}" for sign, term in others)])


_NOTATION = Notation(text=markdown_text, number=_number, variable=_variable, sum=_sum)
