"""Problems of statements: a sentence of `messages.toml`, with the place and the text of a cell or of a YAML node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.source import Messages

if TYPE_CHECKING:
    from dh2urdf.documents import Node
    from dh2urdf.source import Mark, Problem
    from dh2urdf_plugins.readers.words.cells import Cell

_MESSAGES = Messages(__file__)


def say(code: str, at: Cell | Node, field: str, *, mark: Mark | None = None, **words: Any) -> Problem:  # noqa: ANN401
    """A problem of a statement.

    Args:
        code: the entry of `messages.toml`.
        at: what is wrong.
        field: the field, as messages name it.
        mark: its place, where that is another one than of the whole.
        words: what the sentence names besides; `found`, where that is not the text.
    """
    return _MESSAGES(code, mark or at.mark, **{"field": field, "found": at.text, **words})
