"""What a table states besides its rows: base, tool, payload and shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.source import Messages

if TYPE_CHECKING:
    from dh2urdf.documents import Node
    from dh2urdf.source import Mark, Problem
    from dh2urdf_plugins.readers.words.cells import Cell

_MESSAGES = Messages(__file__)


def say(code: str, at: Cell | Node, field: str, *, mark: Mark | None = None, **words: Any) -> Problem:  # noqa: ANN401
    """A problem of a statement, at the place and with the text of a cell or a node unless others are given."""
    return _MESSAGES(code, mark or at.mark, **{"field": field, "found": at.text, **words})
