"""Comment lines of a CSV table: what columns cannot say is in them, and prose is in them too."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.documents import Node, load_yaml
from dh2urdf.errors import TableError
from dh2urdf.quantities import Dimension, QuantityError, evaluate
from dh2urdf.source import Problem, shown
from dh2urdf.table_text import STATEMENTS
from dh2urdf_plugins.readers.header.words import one_slip, read_header
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.comment_lines import Comment, within
from dh2urdf_plugins.readers.words.fields import convention_of
from dh2urdf_plugins.readers.words.word_keys import without_separators

if TYPE_CHECKING:
    from collections.abc import Collection
    from typing import NoReturn

    from dh2urdf.source import Mark

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
"""Length of a comment line that says something."""

_STATEMENT = r"(?i)\s*[-*•]?\s*(?:dh[\s_-]+)?([^\W\d]+)\s*(?:[:=\uff1a]\s*|(?=[\[{]))"
_ENTRY = r"(?s)\s*[-*•]?\s*([^\W\d_][\w .\-]{0,40}?)\s*(?:[:=\uff1a]\s*|(?=[\[{]))(.*)"
_BEHIND_KEYS = frozenset(":=\uff1a[{")
"""What is behind a key, one of them at least."""
_BULLET = r"^\s*[-*•]\s+"
_BULLETS = ("-", "*", "•")
_QUOTED = r'"(?:[^"\\]|\\.)*"|\'(?:[^\']|\'\')*\''
_STRUCTURED = r"(?s)\{.*:.*|\[\s*(?:\[|[+-]?[0-9.])"
_WORD = r"[^\W_]+"
_CONVENTION_KEYS = frozenset(
    "dh dhparameters dhparameter dhnotation notation dhtype dhvariant dhtable dhform conventions konvention "  # noqa: SIM905
    "dhkonvention convencion convenzione parameterisation parameterization".split()
)
_MEANT = {
    "tool": "tcp tcpoffset tcptransform tcpframe tool0 tooltransform toolframe tooloffset toolcenterpoint "
    "toolcentrepoint ttool htool ee eef eeframe eetransform eeoffset endeffector endeffectortransform flange "
    "flangetransform flangeoffset gripper hand werkzeug flansch endeffektor greifer outil effecteur herramienta "
    "efector utensile",
    "base": "basetransform baseframe baseoffset baselink basepose tbase hbase world worldtransform worldframe "
    "worldtobase basis origin mounting mount root",
    "payload": "payload load payloads nutzlast chargeutile",
    "defaults": "default geometry density shape material radius",
    "units": "unitsystem measurementunits",
    "name": "robot manipulator model arm robotname manipulatorname modelname armname",
}
MEANT_BY = {word: key for key, words in _MEANT.items() for word in words.split()}
"""Keys that say what a statement says under another name, without case and separators."""
_PLACED = {
    "tool": "tool tools tcp ee eef flange gripper hand effector endeffector werkzeug flansch greifer endeffektor outil "
    "effecteur herramienta efector utensile",
    "base": "base basis pedestal mounting mount sockel socle основание основания podstawa podstawy taban 베이스",
}
_PLACED_BY = {word: key for key, words in _PLACED.items() for word in words.split()}
_OF_PLACES = frozenset(
    "is length height offset distance z d l h t end transform frame pose position link plate to from of the länge höhe "  # noqa: SIM905
    "abstand versatz longueur hauteur longitud altura lunghezza altezza высота длина wysokość długość yüksekliği "
    "uzunluğu 높이 길이".split()
)
"""Words beside those in a key that gives the place of the tool or of the base: ``tool length``, ``d_tool``."""
_COMPOUND = (
    r"(?:(?P<base>基座|底座|基台|台座|ベース|basis|sockel)"
    r"|(?P<tool>法兰到工具|工具|末端执行器|末端|法兰|夹爪|ツール|フランジ|手先|werkzeug|greifer|flansch))(?:的|の|安装)?"
    r"(?:高度|高さ|高|长度|長さ|长|偏移|オフセット|距离|距離|höhe|hoehe|länge|laenge|versatz|abstand|offset)?[为為是は]?"
)
"""Both in one word: ``基座高度``, ``Sockelhöhe``."""
_ASCII_COMPOUNDS = ("basis", "sockel", "werkzeug", "greifer", "flansch")
"""How those of ASCII alone begin."""


_MAPPING = r"\s*\{[^,]*:"
"""The beginning of units as YAML, whose places are those of the file; words are put into such a form first."""


def statements_in(comment: Comment) -> dict[str, Node]:
    """What a comment says, the YAML values by their keys; nothing where it is only a comment.

    Raises:
        TableError: it is a misspelt key, a key of something that nothing reads, or the value is not YAML.
    """
    text = comment.text
    match = None if _BEHIND_KEYS.isdisjoint(text) else re.match(_STATEMENT, text[:MAX_TEXT])
    key = match[1].casefold() if match else ""
    if len(text) > MAX_TEXT:
        return {key: _value(comment, key, match.end())} if match and key in STATEMENTS else {}
    if (not match or key not in STATEMENTS or key == "name") and (name := name_said(comment)):
        from dh2urdf.table_text.texts import yaml_word

        return {"name": _node(comment, yaml_word(name))}
    is_statement = match and key in STATEMENTS
    if match and is_statement and not _may_be_phrase(key, text[match.end() :]):
        return {key: _value(comment, key, match.end())}
    found = _phrase(comment)
    if match and is_statement and key not in found:
        return {key: _value(comment, key, match.end())}
    if match and not found and (near := next((word for word in STATEMENTS if one_slip(key, word)), None)):
        _refuse(comment, match[1], match.start(1), ", ".join(STATEMENTS), f"did you mean {near!r}?")
    if not found:
        _refuse_unread(comment)
    return found


def _may_be_phrase(key: str, value: str) -> bool:
    """Whether a statement may be in words, and may say more than its key: ``convention: standard, units: mm``."""
    return (key == "units" and not re.match(_MAPPING, value)) or (key == "convention" and not convention_of(value))


def is_statement_key(key: str) -> bool:
    """Whether a key is what a column of names, or of conventions, may be called."""
    return _field_name(key) in ("robot", "convention")


def _field_name(key: str) -> str | None:
    field = read_header(key).field
    return field.name if field else None


def entry_of(comment: Comment) -> re.Match[str] | None:
    """The key of a comment and what is behind it, or None."""
    return None if _BEHIND_KEYS.isdisjoint(comment.text) else re.fullmatch(_ENTRY, comment.text)


def name_said(comment: Comment) -> str | None:
    """The name that a comment says under a key such as `Robot`, `manipulator` or `model`, with nothing besides."""
    entry = entry_of(comment)
    if entry is None or _field_name(entry[1]) != "robot" or re.match(_STRUCTURED, entry[2].strip()):
        return None
    from dh2urdf_plugins.readers.comments.prose import convention_in_prose, mentioned_units

    value = entry[2].strip()
    # In quotes it may have letters as escapes: `g\u00df` has no grams in it. In `"x,g<n"` g is a letter.
    is_quoted = re.fullmatch(_QUOTED, value) is not None
    name = str(_node(comment, value, entry.start(2)).value) if is_quoted else value.strip("\"'")
    units = [unit for unit in mentioned_units(name) if not is_quoted or len(unit.symbol) > 1]
    return None if units or convention_in_prose(name) else name or None


def comment_below(line: str, place: Mark) -> Comment:
    """The comment that a line or a row below the header is.

    Raises:
        TableError: it says something under a key, which would not hold for the rows above.
    """
    whole = Comment.of(line, place, longest=len(line))
    match = re.match(_STATEMENT, whole.text[:MAX_TEXT])
    if match and match[1].casefold() in STATEMENTS and statements_in(whole):
        raise TableError(below_header(whole))
    return Comment.of(line, place)


def below_header(comment: Comment) -> Problem:
    """What is wrong with a comment below the header that says something."""
    return Problem(
        message=f"{shown(comment.line)} is below the header, and would not hold for the rows above",
        mark=comment.whole,
        accepted="such lines above the header",
    )


def _phrase(comment: Comment) -> dict[str, Node]:
    """The units and the convention that a comment says in words."""
    from dh2urdf_plugins.readers.comments.phrases import declared, unit_of_measure, without_model

    entry = entry_of(comment)
    text = re.sub(_BULLET, "", comment.text) if comment.text.lstrip()[:1] in _BULLETS else comment.text
    found = declared(text)
    if not found and (rest := without_model(text)) and "convention" in (said := declared(rest)):
        found = said
    if not found and entry and (unit := unit_of_measure(entry[1], entry[2])):
        found = {"units": unit}
    if not found and entry and _is_convention_key(entry[1]) and (convention := convention_of(entry[2])):
        found = {"convention": str(convention)}
    return {key: _node(comment, value) for key, value in found.items()}


def _is_convention_key(key: str) -> bool:
    return plain_key(key) in _CONVENTION_KEYS or _field_name(key) == "convention"


def _value(comment: Comment, key: str, start: int) -> Node:
    if len(comment.line) > MAX_STATEMENT:
        message = f"the comment line has {len(comment.line)} characters"
        accepted = f"at most {MAX_STATEMENT} where it says {key}"
        raise TableError(Problem(message=message, mark=comment.whole, accepted=accepted))
    if comment.text[start:].lstrip()[:1] in ("", "#"):  # `# base: # none`, as YAML has comments behind values
        word = comment.text[:start].strip().rstrip(":=\uff1a").strip()
        raise TableError(
            Problem(
                message=f"the comment line says nothing behind {shown(word)}",
                mark=comment.mark,
                field=key,
                found=comment.line,
                accepted=EXAMPLES[key],
            )
        )
    node = _node(comment, comment.text[start:], start)
    if key == "convention" and isinstance(node.value, dict | list):
        raise TableError(
            Problem(
                message=f"the comment line says more than the convention: {shown(comment.text[start:].strip())}",
                mark=node.mark,
                field=key,
                found=comment.line,
                accepted=EXAMPLES[key],
                suggestion="write each key on a line of its own",
            )
        )
    return node


def _node(comment: Comment, text: str, start: int = 0) -> Node:
    """The YAML value that begins in a comment, with the places of the file."""
    place = within(comment.mark, start)
    if place.place is None:
        # The value is moved to its own line and column, so that its marks are those of the file.
        before = "\n" * ((place.line or 1) - 1) + " " * ((place.column or 1) - 1)
        return load_yaml(before + text, place.file, TableError)
    try:
        root = load_yaml(text, place.file, TableError)
    except TableError as error:
        raise TableError(replace(problem, mark=place) for problem in error.problems) from None
    waiting = [root]
    for node in waiting:
        node.line, node.column, node.place = place.line or 0, place.column or 0, place.place
        node.key_places = {}
        if isinstance(node.value, dict):
            waiting.extend(node.value.values())
        elif isinstance(node.value, list):
            waiting.extend(node.value)
    return root


# --- What nothing reads -----------------------------------------------------------------------------------------------


def _refuse_unread(comment: Comment) -> None:
    """Refuses a comment that says something under a key that nothing reads, where a program was meant to read it."""
    entry = entry_of(comment)
    if entry is None:
        return
    key, value = plain_key(entry[1]), entry[2].strip()
    is_structured = re.match(_STRUCTURED, value) is not None
    meant = MEANT_BY.get(key) or (key if key in STATEMENTS else placement_of(entry[1]))
    if meant and (is_structured or is_number(value) or meant in ("units", "name")):
        advice = EXAMPLES.get(meant)
        _refuse(
            comment, entry[1], entry.start(1), advice or ", ".join(STATEMENTS), advice and f"did you mean {meant!r}?"
        )
    if is_structured and value.startswith("{"):
        _refuse(comment, entry[1], entry.start(1), ", ".join(STATEMENTS))


def _refuse(comment: Comment, word: str, position: int, accepted: str, suggestion: str | None = None) -> NoReturn:
    raise TableError(
        Problem(
            message=f"the comment line says {shown(word)}, which nothing is called",
            mark=within(comment.mark, position),
            found=word,
            accepted=accepted,
            suggestion=suggestion or "put a word in front if this is prose, such as `# Note: …`",
        )
    )


def placement_of(key: str) -> str | None:
    """Whether a key gives the place of the tool or of the base: ``tool length``, ``base height``, ``d_tool``."""
    words = re.findall(_WORD, key.casefold())
    named = {word: _PLACED_BY.get(word) or _compound(word) for word in words}
    placed = set(filter(None, named.values()))
    others = {word for word in words if not named[word]}
    return placed.pop() if len(placed) == 1 and others <= _OF_PLACES else None


def _compound(word: str) -> str | None:
    may_be = word.startswith(_ASCII_COMPOUNDS) or not word.isascii()
    return match.lastgroup if may_be and (match := re.fullmatch(_COMPOUND, word)) else None


def words_under_key(comment: Comment, keys: Collection[str]) -> list[str]:
    """The words that a comment says under one of some keys, and nothing besides; none where it has another key."""
    entry = entry_of(comment)
    return re.findall(_WORD, entry[2]) if entry and plain_key(entry[1]) in keys else []


def plain_key(key: str) -> str:
    """A key without case, accents and separators."""
    letters = "".join(c for c in unicodedata.normalize("NFKD", key) if not unicodedata.combining(c))
    return without_separators(letters).casefold()


def is_number(text: str) -> bool:
    """Whether a text is a number or a quantity of some kind."""
    for dimension in Dimension:
        try:
            quantity = evaluate(text.strip(), dimension)
        except QuantityError:
            continue
        return quantity.variable is None
    return False
