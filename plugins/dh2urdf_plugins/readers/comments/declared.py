"""Comments that declare something: under a key (`# tcp: {xyz: [0, 0, 0.1]}`) or as a sentence (`lengths in mm`).

A sentence declares a convention, units, or the types of the joints where nothing else does, and a notice names it.
Everything else in a comment is prose, and is passed over in silence.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import replace
from functools import cache, lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.documents import Node, load_yaml
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention
from dh2urdf.quantities import UNITS, is_unit, unit_word
from dh2urdf.source import Messages, listed, shown
from dh2urdf.table_text import STATEMENTS
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.header.units import KEY_OF
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.comment_lines import Comment, within
from dh2urdf_plugins.readers.words.fields import (
    FIELDS,
    convention_of,
    header_fields,
    joint_type,
    key_of,
    keys_in,
    near,
    said_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from dh2urdf.quantities import Unit
    from dh2urdf.source import Mark, Problem
    from dh2urdf_plugins.readers.statements.statements import Statements

say = Messages(__file__)

MAX_STATEMENT = 10_000
"""Length of a comment line that declares something."""

_ENTRY = r"\s*[-*•]?\s*([^\W\d_][\w .\-]{0,40}?)\s*(?:([:=\uff1a])\s*|(?=[\[{]))"
_BEHIND_KEYS = frozenset(":=\uff1a[{")
"""What is behind a key, one of them at least."""
_QUOTES = ("'", '"')
_OF_MAPPING = r"\{[^{}]*:|\{\s*\}"
_OF_LIST = r"\[(?!\s*[0-9]{1,3}\s*\])(?=.*[0-9]).*\]$"
"""A list with a number in it, and no citation: ``[2]``."""

_TOKENS = r"[Dd]-[Hh]\b|°(?:/[a-z]+)?|[^\W\d_]+(?:[/·][^\W\d_]+[²2]?)*[²³]?|[0-9][0-9.,]*|\S"
_CHINESE = r"([\u3040-\u30ff\u4e00-\u9fff\uac00-\ud7a3]+)"
_TYPES = r"(?<![\w-])[RP](?:-?[RP])+(?![\w-])"
_OPENING = frozenset("[({:=：>")
_LISTING = frozenset(",;/&|-–—")
"""What is between the units of a list: ``mm, deg``."""
_ENDS = frozenset(",;/)]}&|.")
_MEASURES = ("length", "angle", "mass", "inertia", "effort", "velocity")
_DECLARING = (*Convention, *_MEASURES, "of_conventions", "beside_conventions", "before", "between")
"""Words of a sentence that does nothing but declare."""
_BEFORE_UNIT = ("before", *_MEASURES, *Convention)
"""Words before a unit that is meant."""
_FOREIGN = ("mm", "cm", "deg", "rad")
"""Units that have words of their own in `vocabulary.toml`."""
_WHOLE = frozenset(("a", "alpha", "d", "theta", "joint", "link", "index", "type", "robot", "convention"))
"""Fields that a sentence about all lengths or angles may name."""
_LENGTHS = frozenset(("a", "d"))


# --- Under a key ------------------------------------------------------------------------------------------------------


def statement_in(comment: Comment) -> tuple[str, Node] | None:
    """The key under which a comment declares something, and the YAML value; None where it is prose.

    Refused are a misspelt key, an unknown one with a mapping or a list behind it, and a value that is not YAML.
    """
    text = comment.text
    match = None if _BEHIND_KEYS.isdisjoint(text) else re.match(_ENTRY, text[:MAX_TEXT])
    if match is None:
        return None
    word, value = match[1], text[match.end() :].strip()
    if key := declared_key(word):
        return (key, _value(comment, key, match)) if _is_declaration(word, key, value, comment) else None
    meant = near(key_of(word.casefold()), STATEMENTS) if match[2] and len(text) <= MAX_TEXT else None
    is_list = match[2] != "=" and re.match(_OF_LIST, value[:MAX_TEXT])
    if meant or is_list or re.match(_OF_MAPPING, value):
        advice = f"did you mean {meant!r}?" if meant else "put a word in front if this is prose, such as `# Note: …`"
        place = within(comment.mark, match.start(1))
        raise TableError(say("no-such-key", place, found=word, keys=[*STATEMENTS], suggestion=advice))
    return None


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
    """The comment that a line or a row below the header is; it cannot declare what would not hold for rows above."""
    whole = Comment.of(line, place, longest=len(line))
    if not _BEHIND_KEYS.isdisjoint(whole.text[:MAX_TEXT]) and statement_in(whole):
        raise TableError(say("below-the-header", whole.whole, line=whole.line))
    return Comment.of(line, place)


def _value(comment: Comment, key: str, match: re.Match[str]) -> Node:
    """What a comment has behind a key."""
    start, about, length = match.end(), {"field": key, "found": comment.line}, len(comment.line)
    value = comment.text[start:].strip()
    if length > MAX_STATEMENT:
        raise TableError(say("long-statement", comment.whole, length=length, limit=MAX_STATEMENT, key=key))
    if value[:1] in ("", "#"):  # `# base: # none`, as YAML has comments behind values
        raise TableError(say("nothing-behind", comment.mark, word=match[1], example=said_of("examples", key), **about))
    is_bare = key == "name" and match[1].casefold() != key and value[:1] not in _QUOTES
    node = _node(comment, yaml_word(value) if is_bare else comment.text[start:], start)
    if key == "convention" and isinstance(node.value, dict | list):
        raise TableError(say("more-than-convention", node.mark, value=value, example=said_of("examples", key), **about))
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


# --- In a sentence ----------------------------------------------------------------------------------------------------


class Sentence(NamedTuple):
    """What a sentence declares: a convention, units by their keys, the types of all joints, a letter each.

    It is bare where it has no word besides those that declare: ``Standard DH parameters:``.
    """

    comment: Comment
    convention: Convention | None
    units: Mapping[str, str]
    types: str
    is_bare: bool


def said_in(comment: Comment) -> Sentence | None:
    """What a comment declares as a sentence; None where it is prose."""
    convention, units, types, is_bare = _read(comment.text)
    return Sentence(comment, convention, units, types, is_bare) if convention or units or types else None


@lru_cache(maxsize=1024)
def _read(text: str) -> tuple[Convention | None, Mapping[str, str], str, bool]:
    spaced = re.sub(_CHINESE, r" \1 ", unicodedata.normalize("NFC", text)) if not text.isascii() else text
    found = re.findall(_TOKENS, spaced)  # `deg/s` is one unit, `mm/deg` are two
    tokens = [part for token in found for part in ([token] if _unit(token) else re.split("(/)", token)) if part]
    letters = re.findall(_TYPES, text)
    types = letters[0].replace("-", "") if len(letters) == 1 else ""
    is_bare = all(_unit(token) or any(_is(name, token) for name in _DECLARING) for token in tokens if token.isalpha())
    return _convention(tokens), _units(tokens), types, is_bare


def _is(section: str, token: str) -> bool:
    """Whether a token is one of the words of a line, or, in a script without blanks, has one of them in it."""
    keys, key = keys_in("sentences", section), key_of(token.casefold())
    return key in keys or (
        bool(re.fullmatch(_CHINESE, token)) and any(word in token for word in keys if not word.isascii())
    )


def _convention(tokens: Sequence[str]) -> Convention | None:
    """The convention that a sentence names, and no other, beside a word that shows what it is about."""
    words = [token for token in tokens if token[:1].isalpha()]
    pairs = [pair for pair in pairwise([*words, ""]) if not _is("happened", pair[1])]  # `modified on …` names none
    named = {each for each in Convention for word, _ in pairs if _is(each.value, word)}
    about = len(words) == 1 or any(_is("of_conventions", word) for word in words)
    if len(named) != 1 or not about or any(_is("not", word) for word in words):
        return None
    return named.pop()


def _units(tokens: Sequence[str]) -> dict[str, str]:
    """The units that a sentence names of all lengths, angles and so on: one of each at most."""
    padded = ["", "", *tokens, ".", "."]
    windows = list(zip(padded, padded[1:], tokens, padded[3:], padded[4:], strict=False))
    fields = {
        field.name
        for earlier, before, token, behind, last in windows
        if (field := header_fields().get(key_of(token.casefold())))
        and not (_unit(token) and (_is("before", before) or _are_units(earlier, before) or _are_units(last, behind)))
    }  # `in m` and `m, deg` have no mass
    named = {name for name in _MEASURES if any(_is(name, token) for token in tokens)}
    if fields - _WHOLE and not named:
        return {}  # `joint limits in degrees` says nothing of other angles
    measured = {FIELDS[name].dimension for name in fields}
    found: dict[str, set[str]] = {}
    is_alone = all(_unit(token) or token in _LISTING | _OPENING | _ENDS for token in tokens)
    is_open = is_alone  # whether what is before shows that a unit is meant
    counts = {"1"} if any(_is("before", token) and _is("between", token) for token in tokens) else ()  # `unit = 1 mm`
    for earlier, before, token, behind, last in windows:
        unit = _unit(token)
        key = KEY_OF.get(unit.dimension) if unit else None
        is_for_kind = _is("for", behind) and _is(key or "", last)  # `mm for lengths`
        goes_on = _is("between", behind)
        ends = behind in _ENDS or goes_on
        is_other = token.casefold() == "in" and behind not in _ENDS
        if unit and _is("no_units", token):
            in_list = (_are_units(earlier, before) or _are_units(last, behind)) and (behind != "." or last == ".")
            shows = before in _OPENING or before == "/" or _is("before", before)
            is_named = shows and (key in named or unit.dimension in measured)  # `angles in rev`, and no `in turn`
            is_unit = ends and (is_named or in_list) and not _is("no_units", f"{before} {token}")
            is_other = not (is_unit or is_for_kind)
        if unit and key and not is_other and not _is("of", behind):
            field = FIELDS.get(earlier.casefold(), FIELDS["joint"])
            is_of_field = field.name in _WHOLE and field.dimension is unit.dimension  # `a/mm`
            is_last = ends and len(token) > 1  # `metric, mm`
            if is_open or is_for_kind or (before in _LISTING and (is_last or is_of_field)):
                found.setdefault(key, set()).add(unit.symbol)
                is_open = is_alone or behind in _LISTING or goes_on  # `kg mm` is one unit, and `kg, mm` are two
        elif token in _OPENING or any(_is(name, token) for name in _BEFORE_UNIT):
            is_open = True
        elif not (token in _LISTING or _is("between", token) or token in counts):
            is_open = False
    if len(fields & _LENGTHS) == 1 and "length" not in named:
        found.pop("length", None)  # `a in mm` says nothing of d
    return {key: units.pop() for key, units in found.items() if len(units) == 1}


def _are_units(token: str, sign: str) -> bool:
    """Whether a unit is a neighbour in a list: the ``mm`` of ``mm, deg``."""
    return sign in _LISTING and _unit(token) is not None


@lru_cache(maxsize=1024)
def _unit(token: str) -> Unit | None:
    """The unit that a word stands for, in any language."""
    plain = token.casefold()
    name = next((name for name in _FOREIGN if key_of(plain) in keys_in("sentences", name)), None)
    return UNITS[name] if name else UNITS.get(unit_word(token)) or UNITS.get(unit_word(plain))


# --- What they declare ------------------------------------------------------------------------------------------------


def declare(
    sentences: Sequence[Sentence], statements: Statements, add: Callable[[Problem], None], *, by_row: bool = False
) -> None:
    """Takes what sentences declare where nothing else does; refuses what contradicts the table.

    One notice names all sentences of which something is taken. A line that says nothing but the convention is as good
    as a key, and has none. By row, each row has its convention.
    """
    taken: dict[str, dict[str, str]] = {}
    headers = statements.columns.units.values() if statements.columns else ()
    for sentence in sentences:
        cell = Cell(sentence.comment.line, sentence.comment.whole)
        found: dict[str, str] = {}
        if sentence.convention and not by_row:
            if statements.convention is None:
                found["convention"] = sentence.convention
            statements.declare_implied_convention(sentence.convention, cell, add)
        for key, symbol in sentence.units.items():
            unit = UNITS[unit_word(symbol)]
            if symbol in {each.symbol for each in headers if each.dimension is unit.dimension}:
                continue
            read = statements.units().of(unit.dimension)
            if unit.dimension not in statements.stated and (symbol != read.symbol if read else not unit.is_si):
                found[key] = symbol
            statements.declare_unit(Cell(symbol, cell.mark), key, add, said=cell.text)
        if sentence.units.keys() & found or (found and not sentence.is_bare):
            taken.setdefault(cell.text, {}).update(found)
    if taken:
        declared = {line: ", ".join(map("{}: {}".format, said, said.values())) for line, said in taken.items()}
        says = listed([f"{shown(line)} ({said})" for line, said in declared.items()])
        place = next(each.comment.whole for each in sentences if each.comment.line in taken)
        add(say("declared-by-sentences", place, says=says, verb="declares" if len(taken) == 1 else "declare"))


def declare_types(
    sentences: Sequence[Sentence],
    rows: Sequence[tuple[dict[str, Cell] | None, Mark]],
    add: Callable[[Problem], None],
) -> None:
    """Gives the rows of a table without types those that a sentence declares, a letter each: their cells are changed.

    Where another notice names the sentence, there is none of the types.
    """
    said = [each for each in sentences if len(each.types) == len(rows)]
    if not said or any(cells is None or "type" in cells for cells, _ in rows):
        return
    first, line, place = said[0], said[0].comment.line, said[0].comment.whole
    if other := next((each.comment for each in said if each.types != first.types), None):
        add(say("types-twice", other.whole, field="type", line=other.line, other=line))
    for (cells, _), letter in zip(rows, first.types, strict=True):
        kind = joint_type(letter)
        if cells is not None and kind:
            cells["type"] = Cell(kind.value, place)
    if not (first.convention or first.units):
        add(say("types-by-a-sentence", place, field="type", line=line, types=first.types))
