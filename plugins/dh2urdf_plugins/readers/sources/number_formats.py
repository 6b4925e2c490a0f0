"""Number formats of a spreadsheet: what a cell shows beside its number, which may be the number's unit."""

from __future__ import annotations

import re
from functools import lru_cache

from dh2urdf.quantities import is_unit

_TOKENS = re.compile(
    r'"(?P<quoted>[^"]*)"|\\(?P<escaped>.)|_.|\*.|\[\$(?P<currency>[^\]-]*)[^\]]*\]|\[[^\]]*\]'
    r"|(?P<code>General|E[+-]|[0#?.,/%@])|(?P<bare>.)",
    re.IGNORECASE | re.DOTALL,
)
"""The parts of a section of a number format (ECMA-376-1, 18.8.31)."""
_CONDITION = re.compile(r"\s*(?:\[[^\]<>=]*\]\s*)*\[[<>=]")
"""What a section begins with that holds for some numbers only: ``[<1]0.0" mm"``."""
_NEUTRAL = "()+-− \u00a0\u202f"
"""Characters beside a number that do not change what it means; between digits, apostrophes do not, either."""


class ShownOtherwiseError(ValueError):
    """A number format shows another number than the cell holds, or text that is no unit."""


@lru_cache(maxsize=1024)
def shown_unit(number_format: str, *, negative: bool = False, zero: bool = False) -> str:
    """The unit that a number format shows behind its number; empty where it shows none.

    ``0.00" mm"`` shows mm and ``0.0°`` shows °; ``0.00`` shows nothing.

    Args:
        number_format: the format, as spreadsheets write it.
        negative: whether the number is negative: a format may have a section of its own for it.
        zero: whether it is 0.

    Raises:
        ShownOtherwiseError: the format shows a percentage, a multiple, another sign, nothing, or text that is no unit.
    """
    sections = _sections(number_format)
    if any(map(_CONDITION.match, sections)):  # the cell's number is not known here
        (unit, *others) = dict.fromkeys(_unit_of(section) for section in sections[:3])
        if others:
            raise ShownOtherwiseError("one unit for some numbers and another for others")
        return unit
    index = 1 if negative and len(sections) > 1 else 2 if zero and len(sections) > 2 else 0  # noqa: PLR2004 - positive; negative; zero; text
    if not zero and not sections[index].strip():
        raise ShownOtherwiseError("nothing")
    return _unit_of(sections[index], minus=None if zero else index == 1)


def _unit_of(section: str, *, minus: bool | None = None) -> str:
    """The unit that a section of a format shows.

    Args:
        section: the section.
        minus: whether it is that of negative numbers alone, which shows their sign or a colour for it; None where the
            sign does not matter.
    """
    before, between, behind, codes = "", "", "", ""
    for match in _TOKENS.finditer(section):
        if match["code"]:
            codes += match["code"]
            between, behind = between + behind, ""
            continue
        text = match["quoted"] or match["escaped"] or match["currency"] or match["bare"] or ""
        if codes:
            behind += text
        else:
            before += text
    if "%" in codes:
        raise ShownOtherwiseError("a percentage")
    if codes.rstrip("eE+-").endswith(","):
        raise ShownOtherwiseError("a multiple of a thousand")
    signed = "-" in before or "−" in before or "(" in before
    if (minus is False and signed) or (minus and not (signed or "-" in behind or "[" in section)):
        raise ShownOtherwiseError("another sign")
    unit = behind.strip(_NEUTRAL)
    if before.strip(_NEUTRAL) or between.strip(f"{_NEUTRAL}'") or (unit and not is_unit(unit)):
        raise ShownOtherwiseError(f"the text '{(before + between + behind).strip()}'")
    return unit


def _sections(number_format: str) -> list[str]:
    """The sections of a format, which semicolons outside quotes separate."""
    sections = [""]
    for part in re.findall(r'"[^"]*"|\\.|\[[^\]]*\]|;|[^;"\\\[]+|.', number_format, re.DOTALL):
        if part == ";":
            sections.append("")
        else:
            sections[-1] += part
    return sections
