"""Comments that declare something under a key: `# convention: standard`, `# tcp: {xyz: [0, 0, 0.1]}`."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from dh2urdf.documents import Node, load_yaml
from dh2urdf.errors import TableError
from dh2urdf.quantities import is_unit
from dh2urdf.source import Messages
from dh2urdf.table_text import STATEMENTS
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.comments.sentences import said_in
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.comment_lines import Comment, within
from dh2urdf_plugins.readers.words.fields import convention_of, key_of, keys_in, near

if TYPE_CHECKING:
    from dh2urdf.source import Mark

say = Messages(__file__)

EXAMPLES = {
    "name": "# name: ur5",
    "convention": "# convention: standard, or modified",
    "units": "# units: {length: mm, angle: deg}",
    "base": "# base: {xyz: [0, 0, 0.3], rpy: [0, 0, pi]}",
    "tool": "# tool: {xyz: [0, 0, 0.1]}",
    "payload": "# payload: {mass: 2.5, com: [0, 0, 0.05], inertia: {ixx: 0.01, iyy: 0.01, izz: 0.004}}",
    "defaults": "# defaults: {geometry: {shape: cylinder, radius: 0.04}, density: 2700}",
    "symbols": "# symbols: {L1: 91 mm, a2: 0.35}",
}
MAX_STATEMENT = 10_000
"""Length of a comment line that declares something."""

_ENTRY = r"\s*[-*•]?\s*([^\W\d_][\w .\-]{0,40}?)\s*(?:([:=\uff1a])\s*|(?=[\[{]))"
_BEHIND_KEYS = frozenset(":=\uff1a[{")
"""What is behind a key, one of them at least."""
_QUOTES = ("'", '"')
_OF_MAPPING = r"\{[^{}]*:|\{\s*\}"
_OF_LIST = r"\[(?!\s*[0-9]{1,3}\s*\])(?=.*[0-9]).*\]$"
"""A list with a number in it, and no citation: ``[2]``."""


def statements_in(comment: Comment) -> dict[str, Node]:
    """What a comment declares under a key: the YAML values by their keys; nothing where it is prose.

    Raises:
        TableError: the key is misspelt, or nothing is called so and the value is a mapping or a list; or the value is
            not YAML.
    """
    text = comment.text
    match = None if _BEHIND_KEYS.isdisjoint(text) else re.match(_ENTRY, text[:MAX_TEXT])
    if match is None:
        return {}
    word, value = match[1], text[match.end() :].strip()
    if key := declared_key(word):
        return {key: _value(comment, key, match)} if _is_declaration(word, key, value, comment) else {}
    meant = near(key_of(word.casefold()), STATEMENTS) if match[2] and len(text) <= MAX_TEXT else None
    is_list = match[2] != "=" and re.match(_OF_LIST, value[:MAX_TEXT])
    if meant or is_list or re.match(_OF_MAPPING, value):
        advice = f"did you mean {meant!r}?" if meant else "put a word in front if this is prose, such as `# Note: …`"
        place = within(comment.mark, match.start(1))
        raise TableError(say("no-such-key", place, found=word, keys=[*STATEMENTS], suggestion=advice))
    return {}


@cache
def declared_key(word: str) -> str | None:
    """The statement that a key declares, by its name or by one of its words: ``tool`` of ``tcp``."""
    key = key_of(word.casefold())
    named = (name for name in STATEMENTS if key == name or key in keys_in("declarations", name))
    return key if key in STATEMENTS else next(named, None)


def _is_declaration(word: str, key: str, value: str, comment: Comment) -> bool:
    """Whether what is behind a key is its value, and not a sentence that says more, or prose."""
    is_own = word.casefold() == key
    if len(comment.text) > MAX_TEXT or (is_own and key not in ("units", "convention")):
        return is_own
    if key == "name":
        in_quotes = len(value) > 1 and value[0] in _QUOTES and value.endswith(value[0])
        return in_quotes or not said_in(replace(comment, text=value))
    if key == "convention":
        return convention_of(value) is not None or (is_own and not said_in(comment))
    if key == "units":
        from dh2urdf_plugins.readers.statements.statements import unit_words

        return value.startswith("{") or all(map(is_unit, unit_words(value.strip("[]() .")))) or not said_in(comment)
    is_value = value.startswith(("{", "[")) or key_of(value.casefold()) in keys_in("values", "identity")
    return is_value and not re.fullmatch(r"\[\s*[0-9]{1,3}\s*\].*", value)


def comment_below(line: str, place: Mark) -> Comment:
    """The comment that a line or a row below the header is.

    Raises:
        TableError: it declares something, which would not hold for the rows above.
    """
    whole = Comment.of(line, place, longest=len(line))
    if not _BEHIND_KEYS.isdisjoint(whole.text[:MAX_TEXT]) and statements_in(whole):
        raise TableError(say("below-the-header", whole.whole, line=whole.line))
    return Comment.of(line, place)


def _value(comment: Comment, key: str, match: re.Match[str]) -> Node:
    """What a comment has behind a key."""
    start, about = match.end(), {"field": key, "found": comment.line}
    value = comment.text[start:].strip()
    if len(comment.line) > MAX_STATEMENT:
        length = len(comment.line)
        raise TableError(say("long-statement", comment.whole, length=length, limit=MAX_STATEMENT, key=key))
    if value[:1] in ("", "#"):  # `# base: # none`, as YAML has comments behind values
        raise TableError(say("nothing-behind", comment.mark, word=match[1], example=EXAMPLES[key], **about))
    is_bare = key == "name" and match[1].casefold() != key and value[:1] not in _QUOTES
    node = _node(comment, yaml_word(value) if is_bare else comment.text[start:], start)
    if key == "convention" and isinstance(node.value, dict | list):
        raise TableError(say("more-than-convention", node.mark, value=value, example=EXAMPLES[key], **about))
    return node


def _node(comment: Comment, text: str, start: int) -> Node:
    """The YAML value that begins in a comment, with the places of the file."""
    place = within(comment.mark, start)
    # The value is moved to its own line and column, so that its marks are those of the file.
    before = "\n" * ((place.line or 1) - 1) + " " * ((place.column or 1) - 1)
    try:
        root = load_yaml(before + text, place.file, TableError)
    except TableError as error:
        if place.place is None:
            raise
        raise TableError(replace(problem, mark=place) for problem in error.problems) from None
    waiting = [root] if place.place else []  # a cell has one place for all that is in it
    for node in waiting:
        node.line, node.column, node.place, node.key_places = place.line or 0, place.column or 0, place.place, {}
        if isinstance(node.value, dict | list):
            waiting += node.value.values() if isinstance(node.value, dict) else node.value
    return root
