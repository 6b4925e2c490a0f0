"""What a table consists of, whatever its format: texts with their places."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from dh2urdf.source import Mark

LINE_END = "\n"
"""What a cell in quotes may hold, and no plain one does."""
SPACES = " \t\u00a0\u2007\u2009\u202f"
"""White space around a cell."""


Value: TypeAlias = str | float
"""What a cell holds as it comes from its file: a text, or a number that was one already."""


def text_of(value: Value) -> str:
    """What a cell holds as a text, which reads back to the same double if it was a number."""
    return value if isinstance(value, str) else repr(value).removesuffix(".0")


class Cell(NamedTuple):
    """A text of a table and its place."""

    text: str
    mark: Mark
    of_theta: bool = False  # whether its header says that it bounds theta, which is not q where the row has an offset
    typed: str | None = None  # what was in the file, where the text is another, such as the name of joint 1
