"""What comments and notes around a table say that the table itself does not: nothing of it may be lost in silence.

A comment begins with #; a note is a text below or beside the table. Prose is no statement, but where it contradicts
what is read, one of the two is wrong.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.patterns import late_pattern
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.readers.header.units import SI
from dh2urdf_plugins.readers.rows.names import speaks_of_slide
from dh2urdf_plugins.readers.statements.comment_phrases import prose_problems
from dh2urdf_plugins.readers.statements.csv_comments import (
    EXAMPLES,
    below_header,
    placement_of,
    statement,
    unread_values,
    words_under_key,
)
from dh2urdf_plugins.readers.statements.statements import Statements
from dh2urdf_plugins.readers.words.comment_lines import Comment, is_comment
from dh2urdf_plugins.readers.words.fields import convention_of, joint_type
from dh2urdf_plugins.readers.words.type_codes import exchanged, exchanged_codes

if TYPE_CHECKING:
    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.header.columns import Columns

_TYPE_KEYS = frozenset(
    "type types jointtype jointtypes joint joints kinematics structure configuration gelenk gelenke typ typen "  # noqa: SIM905
    "gelenktypen gelenktyp kinematik articulations tipo tipos".split()
)
_SEQUENCE = late_pattern(
    r"(?<![\w-])(?=[\w-]*P)(?:(?:[2-9]?[RP]-?){3,8}(?![\w-])|[2-9]?[RP]-?[2-9]?[RP](?=\s*(?:robot|arm|manipulator)\b|\s*$))"
)
"""The joints of an arm by their letters: ``RRP``, ``R-R-P-R``, ``RP robot``."""
_NTH = (
    r"(?:(?:joint|axis|link|gelenk|achse|axe|articulation|eje|giunto|asse|j|q)[\s_.#-]*[0-9]{1,2}"
    r"|(?:[0-9]{1,2}(?:st|nd|rd|th|\.|[eªº])|first|second|third|fourth|fifth|sixth|last)\s+"
    r"(?:joint|axis|gelenk|achse|axe|articulation|eje|giunto|asse))(?![^\W_])"
)
"""A joint by its number, as prose names it."""
_NTH_SLIDES = late_pattern(
    rf"{_NTH}[^.;,]{{0,24}}?(?<![^\W_])(?:slides?|sliding|translat\w*|prism\w*\.?|schub\w*|glissi\w*"
    r"|linear(?:achse)?(?!\s*(?:speed|veloc|accel|interpol|motion|encoder)))(?![^\W_])",
    re.IGNORECASE,
)
_SLIDE_VARIABLE = late_pattern(
    r"(?<![^\W_])d_?[0-9]{1,2}\*?\s+(?:is\s+)?(?:an?\s+|the\s+)?(?:joint\s+)?variable"
    r"|variables?\b[^.]*?(?<![^\W_])d_?[0-9]{1,2}\b"
    r"|(?<![^\W_])q\s*=\s*[\[({][^\])}]*(?<![^\W_])d_?[0-9]",
    re.IGNORECASE,
)
"""``d3`` among the variables of an arm: ``q = [θ1, θ2, d3]``."""
_UNREAD = late_pattern(
    rf"{_NTH}[^.;]{{0,24}}?(?<![^\W_])(?:fixed|locked|coupled|mimic|reversed|inverted|opposite|negative)"
    rf"|(?<![^\W_])(?:reversed|inverted|opposite|negative|positive)\s+(?:direction|sense|sign)\b[^.;]{{0,24}}{_NTH}"
    r"|(?:θ|theta|th|q)[\s_{]*[0-9]{1,2}\W{0,3}=[^=]*(?:θ|theta|th|q)[\s_{]*[0-9]"
    r"|10\s*(?:\^|\*\*|(?=[⁻⁺⁰¹²³⁴-⁹]))|[x×*]\s*10{1,6}\b"
    r"|(?:multiplied|divided|scaled) by|(?:multiples|units) of (?:pi|π)",
    re.IGNORECASE,
)
"""What prose adds to joints or to all numbers, and no comment can: ``θ2 = q2 - 90°``, ``all × 10⁻³``."""
_IN_UNREAD = (
    "= 10 multipl divided scaled units fixed locked coupled mimic reversed inverted opposite negative positive".split()  # noqa: SIM905
)
"""What such prose has at least one of: most comments have none, and need no search."""
_NUMBER = late_pattern(r"(?<![^\W])[-+−]?(?:[0-9]*\.)?[0-9]+")
_LENGTH = late_pattern(r"(?<![\w.,])[-+−]?[0-9]*[.,]?[0-9]*[1-9][0-9]*[.,]?[0-9]*\s*(?:mm|cm|m|µm|inch(?:es)?)\b")


def comment_problems(
    comment: Comment, statements: Statements, columns: Columns, *, below: bool = False
) -> list[Problem]:
    """What is wrong with a comment, or worth a notice.

    Args:
        comment: one that says nothing under a key, where it is above the header.
        statements: what the table and the options say.
        columns: its headers.
        below: whether it is below the header, where a note says nothing that could hold.

    Raises:
        TableError: it says something under a key that nothing reads.
    """
    prose, typed = prose_problems(comment, statements, columns), "type" in columns.fields
    if below and not is_comment(comment.line):
        said = statement(comment)
        if said is None:
            return prose + types_elsewhere(comment, typed=typed)
        return [] if said[0] == "name" or _holds(*said, statements, columns) else [below_header(comment)]
    problems = [below_header(comment)] if below and prose and statement(comment) else prose
    problems = problems + types_elsewhere(comment, typed=typed)
    return problems + (unread_values(comment) or _unread_prose(comment, statements))


def _holds(key: str, node: Node, statements: Statements, columns: Columns) -> bool:
    """Whether a note only repeats what holds for the rows above it."""
    if key == "convention":
        return statements.convention is not None and statements.convention[0] is convention_of(node.text or "")
    if key != "units":
        return False
    said, problems = Statements(), list[Problem]()
    said.declare_units(node, problems.append)
    declared = [*(unit for unit, _ in statements.stated.values()), *columns.units.values()]
    return not problems and all(
        unit.symbol in ({other.symbol for other in declared if other.dimension is dimension} or {SI.get(dimension, "")})
        for dimension, (unit, _) in said.stated.items()
    )


def types_elsewhere(comment: Comment, *, typed: bool) -> list[Problem]:
    """What is wrong with a comment that speaks of joints that slide, in a table without types, or exchanges 0 and 1.

    Args:
        comment: the comment, or a note.
        typed: whether the table has types.
    """
    if typed:
        codes = exchanged_codes(comment.text)
        return [exchanged(comment.line, codes, comment.whole)] if len(codes) > 1 else []
    kinds = {joint_type(word) for word in words_under_key(comment, ("sigma", "σ"))}
    kinds |= {None if word.isdigit() else joint_type(word) for word in words_under_key(comment, _TYPE_KEYS)}
    slides = JointType.PRISMATIC in kinds and None not in kinds
    patterns = (_SEQUENCE, _NTH_SLIDES, _SLIDE_VARIABLE)
    if not (slides or speaks_of_slide(comment.text) or any(pattern.search(comment.text) for pattern in patterns)):
        return []
    return [
        Problem(
            message=f"{shown(comment.line)} speaks of a prismatic joint, and the table has no types: every joint would "
            "be taken as revolute",
            mark=comment.whole,
            field="type",
            found=comment.line,
            accepted="a type of each joint, in a column or under the key type: revolute or R, prismatic or P",
        )
    ]


def _is_bare(text: str) -> bool:
    """Whether a text is a place and a number, and nothing besides."""
    return bool(placement_of(_NUMBER.sub(" ", text)) and _NUMBER.search(text))


def _unread_prose(comment: Comment, statements: Statements) -> list[Problem]:
    """A notice of prose that gives a length of the tool or of the base, or says what only columns can say."""
    placed = map(placement_of, re.findall(r"[^\W\d_]+", comment.text))
    found = {kind for kind in placed if kind}
    what = found.pop() if len(found) == 1 else None
    if what in statements.placed or not (what and (_is_bare(comment.text) or _LENGTH.search(comment.text))):
        what = None
    plain = comment.text.casefold()
    if what is None and not (any(word in plain for word in _IN_UNREAD) and _UNREAD.search(comment.text)):
        return []
    return [
        Problem(
            message=f"{shown(comment.line)} is a comment, and nothing is read from it",
            severity="notice",
            mark=comment.whole,
            field=what,
            found=comment.line,
            suggestion=f"if it is part of the arm, declare it: `{EXAMPLES[what]}`" if what else None,
        )
    ]
