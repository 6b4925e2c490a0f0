"""Pieces of Markdown that the generated pages share."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; a bar in a cell does not end it."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)


def code(text: object) -> str:
    """A piece of code; of an empty text nothing."""
    return f"`{text}`" if str(text) else ""


def prose(text: str) -> str:
    """A sentence of the program as Markdown: nothing in it is markup, and what is in braces is code."""
    pieces = re.split(r"(`[^`]*`|\{[^{}]*\})", text)
    return "".join(
        (piece if piece.startswith("`") else code(piece)) if number % 2 else re.sub(r"([*_<\[])", r"\\\1", piece)
        for number, piece in enumerate(pieces)
    )
