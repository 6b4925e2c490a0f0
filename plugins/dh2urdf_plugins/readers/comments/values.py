"""Numbers in comments: nothing reads them, and a table may lack them, or have others in their place."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from typing import TYPE_CHECKING

from dh2urdf.quantities import Dimension, QuantityError, evaluate
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.readers.comments.declared import entry_of, is_number, plain_key
from dh2urdf_plugins.readers.comments.phrases import FILLERS, unit_called
from dh2urdf_plugins.readers.header.words import read_header

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.quantities import Unit
    from dh2urdf_plugins.readers.words.comment_lines import Comment
    from dh2urdf_plugins.readers.words.fields import Field

_ONE = r"[\[(]*[-+−±]?\s*(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)(?:[eE][-+]?[0-9]+)?\s*(?:°|[^\W\d_]{1,3})?[\])]*"
_NUMBERS = rf"\s*{_ONE}(?:(?:\s*(?:[,;|/]|\.\.+|…|\bto\b)\s*|\s+){_ONE})*\s*"
"""One number or several with nothing else: ``[0, 90] deg``, ``±170°``, ``-170 170``."""
_BY_JOINT = ("limits", "lower", "upper", "velocity", "effort", "mass", "offset", "sign", "flip")
_BY_NUMBER = r"[0-9].*[0-9]"
"""Numbers for one joint after the other: ``limits: J1 ±170, J2 ±90``."""
_SEVERAL = r"[-+−]?[0-9.]+\s*[^\W\d]{0,3}(?:[,;]?\s*[^\W\d]\w{0,11}\s*[=:]\s*[-+−]?[0-9.]+\s*[^\W\d]{0,3})+\s*\.?"
"""One key after the other: ``l1 = 0.3, l2 = 0.2``."""
_LIST = r"\s*\[\s*[-+−]?(?:[0-9.]|pi\b|π)"
_OF_THE_FILE = frozenset(
    "version rev revision release edition date year page pages figure fig table chapter section equation eq line sheet "  # noqa: SIM905
    "no nr id serial serialnumber dof dofs axes joints links rows columns degreesoffreedom numberofjoints numberofaxes "
    "anzahlachsen achsen freiheitsgrade seite abbildung tabelle datum datei jahr fecha data pagina".split()
)
"""What comments number that is no quantity of the arm."""
_CITATION = r"\[[0-9]{1,3}\][.,]?"
"""``see [2]``, whose bracket is the sign behind a key."""
_CLAUSES = r"[,;()]\s|[()]|\.\s+(?=[A-Z])"
_NUMBER = (
    r"(?<![a-zA-Z0-9_\u00c0-\u04ff.,])(?P<either>±\s?|\+/?[-−]\s?)?(?P<number>[-+−–]?\s?(?:[0-9]+(?:[.,][0-9]+)?|[.,][0-9]+))"
    r"(?:\s*(?P<unit>(?:°|[^\W\d_]+)(?:[/·*][^\W\d_]+)?))?(?!\w)"
)
_NO_UNIT = r"(?i)\s*(?:of|de|di)\s+(?:freedom|libert)"
"""Behind a number that is none of the arm's: ``6 degrees of freedom``."""
_OF_JOINTS = (Dimension.TURN_RATE, Dimension.TORQUE)
"""What nothing but joints has, in any words: ``180 deg/s``."""
_MOST_WORDS = 6
"""Words of a clause that gives a number to something; a longer one tells a story."""
_SUM = r"(?i)[-+−±(]?\s*(?:[0-9.(]|pi|π|q[0-9_]|θ|th)"
"""How an expression begins."""
_BESIDE = r"[,;|\t{}\[\]]|:\s"
_SCALES = (1.0, 100.0, 1000.0, math.degrees(1.0))
"""Units that one number may have in two places: m, cm and mm, or rad and deg."""
_ROUNDED = 6e-3
_COUNTS_UP_TO = 20
"""A bare number up to this may count something, and no angle or length."""
_PLAIN_SIGNS = str.maketrans("−–,", "--.")
_NOTHING = "nothing is read from it"


def unread_values(comment: Comment, *, place: str = "column") -> list[Problem]:
    """A notice of a comment that gives a number to something: nothing reads it; a joint has it in a column.

    Args:
        comment: one that says nothing under a key that is read.
        place: where a joint has its values: in a column, or under a key.
    """
    entry = entry_of(comment)
    is_other = entry and (plain_key(entry[1]) in _OF_THE_FILE or "scale model" in entry[1].casefold())
    if entry is None or is_other or re.fullmatch(_CITATION, entry[2].strip()):
        return []
    field = read_header(entry[1]).field
    by_joint = field is not None and field.name in _BY_JOINT and re.search(_BY_NUMBER, entry[2])
    is_value = by_joint or _are_numbers(entry[2]) or re.fullmatch(_SEVERAL, entry[2])
    return [_unread(comment, field, place)] if is_value else []


def spoken_values(comment: Comment, *, place: str = "column") -> list[Problem]:
    """A notice of a comment that gives a number to joints, or to the payload, in words: ``max. speed 180 deg/s``."""
    has_number = any(b.isdigit() and not (a.isascii() and a.isalnum()) for a, b in pairwise(f" {comment.text}"))
    for clause in re.split(_CLAUSES, comment.text) if has_number else ():  # ``UR5`` is none, and compiles no pattern
        for match in re.finditer(_NUMBER, clause):
            before, behind = clause[: match.start()], clause[match.end() :]
            words = [word for word in before.split() if word.strip(".:=").casefold() not in FILLERS]
            field, unit = read_header(" ".join(words)).field if words else None, _unit_of(match)
            is_value = unit and (
                (field and field.dimension) or words[-1:] == ["payload"] or unit.dimension in _OF_JOINTS
            )
            is_other = re.match(_NO_UNIT, behind) or (words and plain_key(words[-1]) in _OF_THE_FILE)
            if is_value and not is_other and len(words) + len(behind.split()) <= _MOST_WORDS:
                return [_unread(comment, field, place)]
    return []


def other_values(comment: Comment, beside: str, *, place: str = "column") -> list[Problem] | None:
    """A notice of a comment behind values that has a number which none of them is: ``0.3  # 350 mm``.

    None where it only repeats them.

    Args:
        comment: the comment.
        beside: the values that it is behind, as they are in the file.
        place: where a joint has its values: in a column, or under a key.
    """
    entry = entry_of(comment)
    numbers = list(_numbers_in(entry[2] if entry else comment.text, bare=entry is not None))
    if not numbers:
        return unread_values(comment, place=place)
    held = [number for text in re.split(_BESIDE, beside) for number, _ in _numbers_in(text, bare=True)]
    same = [any(_is_same(number, other, either=either) for other in held) for number, either in numbers]
    if entry:
        field = read_header(entry[1]).field
        repeats = all(same) and field and field.dimension
        return [] if repeats else unread_values(comment, place=place)
    if any(same) or re.fullmatch(_CITATION, comment.text.strip()):
        return None if all(same) and re.fullmatch(_NUMBERS, comment.text) else []
    message = f"{shown(comment.line)} is a comment, and {'no value beside it is this number' if held else _NOTHING}"
    return [Problem(message=message, severity="notice", mark=comment.whole, found=comment.line)]


def _unread(comment: Comment, field: Field | None, place: str) -> Problem:
    of_joints = field is not None and field.dimension is not None
    nothing = "no joint gets this value" if of_joints else _NOTHING
    return Problem(
        message=f"{shown(comment.line)} is a comment, and {nothing}",
        severity="notice",
        mark=comment.whole,
        field=field.name if field and of_joints else None,
        found=comment.line,
        suggestion=f"write a {place} {field.name} if it is meant for the joints" if field and of_joints else None,
    )


def _numbers_in(text: str, *, bare: bool) -> Iterator[tuple[float, bool]]:
    """The numbers of a text in SI units, each with whether its sign may be either.

    Args:
        text: the text.
        bare: whether one without a unit counts, however small, beside words too.
    """
    if not any(map(str.isdigit, text)) and "π" not in text and "pi" not in text:
        return
    whole = text.strip()
    may_be_sum = any(sign in whole[1:] for sign in ("+", "-", "−", "*", "/")) or "π" in whole or "pi" in whole
    for dimension in (Dimension.ANGLE, Dimension.LENGTH) if may_be_sum and re.match(_SUM, whole) else ():
        try:
            yield evaluate(whole, dimension).value, False
        except QuantityError:
            continue
        return
    is_whole = not bare and re.fullmatch(_NUMBERS, text) is not None
    for match in re.finditer(_NUMBER, text):
        unit = _unit_of(match)
        if bare or is_whole or unit:
            number = float(re.sub(r"\s", "", match["number"]).translate(_PLAIN_SIGNS))
            if bare or unit or number % 1 or abs(number) > _COUNTS_UP_TO:
                yield unit.si(number) if unit else number, bool(match["either"])


def _unit_of(match: re.Match[str]) -> Unit | None:
    """The unit behind a number; `in` before another word is none."""
    word = match["unit"]
    if not word or (word.casefold() == "in" and match.string[match.end() :].strip(" .")):
        return None
    return unit_called(word)


def _is_same(number: float, other: float, *, either: bool) -> bool:
    """Whether two numbers are one, rounded and in some unit each."""
    if either:
        number, other = abs(number), abs(other)
    if not number or not other:
        return number == other
    return any(
        abs(ratio - 1) < _ROUNDED for scale in _SCALES for ratio in (other / number * scale, other / number / scale)
    )


def _are_numbers(text: str) -> bool:
    """Whether a text is a number, or several."""
    return is_number(text) or re.match(_LIST, text) is not None or re.fullmatch(_NUMBERS, text) is not None
