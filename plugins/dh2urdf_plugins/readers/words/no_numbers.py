"""What people write where a joint has no such number: a dash, ``n/a``, ``none``; or no bound: ``∞``, ``unlimited``."""

from __future__ import annotations

import re

from dh2urdf.table_text import REQUIRED

_NONE = r"(?i)[-–—−]+|[/?.…]|n\.?/?a\.?|none|null|nil|nan|tbd|k\.?\s?a\.?"
_ENDLESS = (
    r"(?i)[+-]?\s*(?:±|\+/-)?\s*(?:inf(?:init[ey]|inity)?|∞)|unlimited|endless|continuous|unbegrenzt|endlos|illimité|ilimitado"
    r"|illimitato|no limits?"
)
_SYMBOL = (
    r"\s*[-+−–]?\s*(?:[^\W\d]_?\{?[0-9]{1,2}\}?|(?:[^\W\d]|[0Oo])[₀-₉]{1,2}|[0Oo]\s+[0-9]{1,2})"
    r"(?:\s*[-+−–](?!.*[^\W\d]_?\{?[0-9₀-₉]).*|\s*)"
)
"""A letter with a number: in theta it is the joint variable; its letter was another one, or a zero: ``0₁``, ``0 1``.
One more of them behind it is no offset."""
_BOUNDS = ("limits", "lower", "upper")
_GEOMETRY = (*REQUIRED, "theta")


def advice_for(name: str, text: str) -> str | None:
    """What to do about a cell that says that there is no number, or more than one; None for any other cell.

    Args:
        name: the field of the cell.
        text: the cell.
    """
    if name == "sign":
        return "write 1, or -1 where the positive direction is the other one"
    if "#" in text or "//" in text:
        return "put the comment on a line of its own, above the row"
    if name in _BOUNDS and re.fullmatch(_ENDLESS, text.strip()):
        return "if the joint turns without end, give it the type continuous, and leave its bounds empty"
    if name == "theta" and re.fullmatch(_SYMBOL, text):
        return "write the joint variable as q1, and what is added to it behind: q1 + pi/2"
    if name not in _GEOMETRY and re.fullmatch(_NONE, text.strip()):
        return "leave the cell empty if there is none"
    return None
