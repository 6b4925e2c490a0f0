"""YAML documents whose every value and key knows its place in the file.

A document is read as YAML 1.2 with the core schema: ``1e-3`` is a number, ``no``, ``1:30`` and ``2020-01-01`` are
strings. PyYAML only splits the text into events; what they mean is decided here, since its own loaders follow YAML
1.1 and keep the last of two equal keys. JSON is YAML, so it is read too.

A file may come from a stranger. There is no recursion, tags are refused, and `MAX_BYTES`, `MAX_DEPTH` and
`MAX_ALIASED` bound what a document can cost.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.documents.nodes import Item, Node, core_value, expect_mapping
from dh2urdf.documents.text_files import decoded, read_bytes
from dh2urdf.errors import ConfigError, InputError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["Item", "Node", "expect_mapping", "load_yaml", "read_yaml", "stream_yaml"]


def read_yaml(path: Path, error: type[InputError] = ConfigError) -> Node:
    """The document that a file holds.

    Raises:
        InputError: of the type given, where the file cannot be read or is not one YAML document.
    """
    return load_yaml(read_bytes(path, error), str(path), error)


def load_yaml(content: bytes | str, file: str, error: type[InputError] = ConfigError) -> Node:
    """The document that a text holds.

    Args:
        content: the text, or its bytes in UTF-8 or UTF-16.
        file: what marks name as the file.
        error: the type of the error raised.

    Raises:
        InputError: of the type given, where the text is not one YAML document.
    """
    if isinstance(content, str) and (word := content.strip()).isalpha() and word.isascii():
        # Most options and comment lines are one word, which needs no parser: its import costs more.
        before = content[: content.index(word)]
        return Node(core_value(word), file, before.count("\n") + 1, len(before) - before.rfind("\n"), word)
    (root,) = stream_yaml(content, file, error)
    if root.problems:
        raise error(root.problems)
    return root.node


def stream_yaml(
    content: bytes | str,
    file: str,
    error: type[InputError] = ConfigError,
    *,
    items_of: str | None = None,
    longest_list: int | None = None,
) -> Iterator[Item]:
    """The entries of a list in the outermost mapping, one by one, and last the document without them.

    The file may hold a million manipulators; only one of them is held as nodes at a time.

    Args:
        content: the text, or its bytes in UTF-8 or UTF-16.
        file: what marks name as the file.
        error: the type of the error raised.
        items_of: the key of the list, such as ``robots``.
        longest_list: entries that any other list may have; None where nothing bounds them.

    Yields:
        Each entry of the list, and then the whole document, where the list is empty.

    Raises:
        InputError: of the type given, where the text is not one YAML document; what came before has been yielded.
    """
    from dh2urdf.documents.composer import Composer

    text = decoded(content, file, error)
    return Composer(text, file, error, items_of, longest_list).run()
