"""What comments and notes around a table say that the table itself does not: nothing of it may be lost in silence.

A comment begins with #; a note is a text below or beside the table. Prose is no statement, but where it contradicts
what is read, one of the two is wrong.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.manipulator import JointType
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.readers.comments.declared import (
    EXAMPLES,
    below_header,
    placement_of,
    statements_in,
    words_under_key,
)
from dh2urdf_plugins.readers.comments.meanings import MEANINGS, MOTION, NTH
from dh2urdf_plugins.readers.comments.phrases import is_model
from dh2urdf_plugins.readers.comments.prose import prose_problems
from dh2urdf_plugins.readers.comments.values import other_values, spoken_values, unread_values
from dh2urdf_plugins.readers.header.units import SI
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
_SEQUENCE = (
    r"(?<![\w-])(?:(?=[\w-]*P)(?:(?:[2-9]?[RP]-?){3,8}(?![\w-])"
    r"|[2-9]?[RP]-?[2-9]?[RP](?=\s*(?:robot|arm|manipulator)\b|\s*$))"
    r"|[1-9]R\s?\+?\s?[1-9]P(?![\w-])|[1-9]P\s?\+?\s?[1-9]R(?![\w-])|[1-9]R\s?\+\s?P(?!\w)|P\s?\+\s?[1-9]R(?!\w)"
    r"|(?=[R, ]{0,16}P)[RP](?:(?:,\s?|\s)[RP]){2,8}(?![\w-]|\s[A-Z]\b))"
)
"""The joints of an arm by their letters: ``RRP``, ``R-R-P-R``, ``R R P``, ``RP robot``, ``2R1P``."""
_SLIDING_ARM = (
    r"(?i)(?<![^\W_])(?:scara|(?:cartesian|cylindrical|gantry) (?:robot|arm|manipulator)|stanford (?:arm|manipulator)"
    r"|(?:polar|spherical) (?:robot|arm|manipulator)|gantry|telescop\w*|(?:ball|lead)[ -]?screw"
    r"|moves? (?:linearly|up|along)|stroke|(?:7th|seventh|external|additional) axis|(?:on|with) (?:a )?(?:rail|track)"
    r"|linear (?:motion|actuator|drive|slide|guide|module|unit|rail)s?(?! speed| veloc| accel)"
    r"|[1-9] (?:linear ax[ei]s|translations?|traslaci[oó]n(?:es)?|traslazion[ei]|translationen|transla[cç](?:ão|ões)))"
    r"(?![^\W_])"
)
"""Words for an arm that mostly has a joint that slides."""
_STILL_ROW = (
    r"(?i)(?<![^\W_])(?:(?:last|first|final|[0-9]{1,2}(?:st|nd|rd|th))\s+(?:row|line)|row\s*[0-9]{1,2})(?![^\W_])[^.;]{0,24}"
    r"(?<![^\W_])(?:tool|flange|end[ -]?effector|base|tcp|gripper|hand|ee|fixed)(?![^\W_])"
)
"""A row that is no joint, in prose: ``the last row is the tool``."""
_NTH_SLIDES = (
    rf"(?i){NTH}[^.;,]{{0,24}}?(?<![^\W_])(?:slides?|sliding|translat\w*|prism\w*\.?|schub\w*|glissi\w*"
    r"|linear(?:achse)?(?!\s*(?:speed|veloc|accel|interpol|motion|encoder)))(?![^\W_])"
    rf"|{NTH}\s*[:=(]\s*P(?!\w)"
)
_SLIDE_VARIABLE = (
    r"(?i)(?<![^\W_])d_?[0-9]{1,2}\*?\s+(?:is\s+)?(?:an?\s+|the\s+)?(?:joint\s+)?variable"
    r"|(?<![^\W_])d(?:\s*_?i)?\s+is\s+(?:an?\s+|the\s+)?(?:joint\s+)?variable|(?<![^\W_])q\s*=\s*d(?![^\W])"
    r"|variables?\b[^.]*?(?<![^\W_])d_?[0-9]{1,2}\b"
    r"|(?<![^\W_])q\s*=\s*[\[({][^\])}]*(?<![^\W_])d_?[0-9]|(?<![^\W_])q_?[0-9]\s*=\s*d_?[0-9]"
)
"""``d3`` among the variables of an arm: ``q = [θ1, θ2, d3]``."""
_NUMBER = r"(?<![^\W])[-+−]?(?:[0-9]*\.)?[0-9]+"
_SIZE = (
    r"(?<![A-Za-z0-9_.,])[-+−]?[0-9]*[.,]?[0-9]*[1-9][0-9]*[.,]?[0-9]*\s*"
    r"(?:(?:mm|cm|m|µm|inch(?:es)?|deg(?:rees)?|rad|grad|мм|см|м)(?![A-Za-zа-я0-9_])|°|毫米|厘米|米|ミリ|メートル)"
)
_HEADING = (
    r"(?i)\W*(?:(?:left|right|link(?:s|er)|recht(?:s|er)|first|second|third|other|next)(?:\s+(?:arm|robot|manipulator))?"
    r"|(?:arm|robot|manipulator|roboter)\s*(?:[0-9]{1,2}|[a-d]|left|right|links|rechts))\W*"
)
_SHORT = 4
"""Blanks in a comment among rows that is about the row behind it."""
_TURNED = frozenset("reversed inverted negative negated flipped mirrored cw clockwise".split())  # noqa: SIM905
_NO_FRAMES = frozenset("none null nil nan note notes remark remarks comment comments source".split())  # noqa: SIM905


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
        said = statements_in(comment)
        if not said:
            return prose + types_elsewhere(comment, typed=typed)
        holds = all(key == "name" or _holds(key, node, statements, columns) for key, node in said.items())
        return [] if holds else [below_header(comment)]
    if below and "robot" not in columns.fields and _is_heading(comment.text):
        message = f"{shown(comment.line)} may be the title of another arm, and all rows are of one"
        meant = "a column robot tells several arms apart"
        return [Problem(message=message, severity="notice", mark=comment.whole, found=comment.line, suggestion=meant)]
    problems = [below_header(comment)] if below and prose and statements_in(comment) else prose
    problems = problems + types_elsewhere(comment, typed=typed)
    return problems + unread(comment, statements, among_rows=below)


def remark_problems(remark: Comment, number: int, statements: Statements, columns: Columns) -> list[Problem]:
    """What a cell of a column that no field knows declares about the table, as a comment would, or about its joint.

    Args:
        remark: the cell.
        number: the number of the row.
        statements: what the table and the options say.
        columns: its headers.
    """
    try:
        said = statements_in(remark)
    except TableError as error:
        return list(error.problems)
    words = [key for key, node in said.items() if key not in ("units", "convention") and isinstance(node.value, str)]
    if all(key in words or _holds(key, node, statements, columns) for key, node in said.items()):
        typed = "type" in columns.fields
        problems = prose_problems(remark, statements, columns) + types_elsewhere(remark, typed=typed)
        return (
            problems
            or unread_values(remark)
            or unread_prose(_about_joint(remark, number), statements)
            or spoken_values(remark)
        )
    return [
        Problem(
            message=f"{shown(remark.line)} is in a column that is left out, and may declare the {' and '.join(said)}",
            mark=remark.whole,
            found=remark.line,
            accepted="what holds for all rows, above the header",
        )
    ]


def behind_problems(
    comment: Comment,
    beside: str,
    number: int,
    statements: Statements,
    *,
    typed: bool,
    lead: str = "# ",
    place: str = "column",
) -> list[Problem]:
    """A notice of a comment behind a row or a value that has another number, or says something about its joint.

    Args:
        comment: the comment.
        beside: what it is behind, as YAML has it: keys and their values.
        number: the number of the row.
        statements: what the table and the options say.
        typed: whether the table has types.
        lead: what a line begins with that declares something.
        place: where a joint has its values: in a column, or under a key.
    """
    problems, word = other_values(comment, beside, place=place), comment.text.strip(" .!").casefold()
    repeats = problems is None or (word in _TURNED and re.search(r"\b(?:sign|flip)\b", beside))
    if typed and (kind := joint_type(word)):
        kinds = {joint_type(text.strip()) for text in re.split("[:;,{}]", beside)} - {None}
        if kinds and kind not in kinds:
            message = f"{shown(comment.line)} is a comment, and the type beside it is another"
            return [Problem(message=message, severity="notice", mark=comment.whole, field="type", found=comment.line)]
        repeats = True
    if repeats:
        return []
    about_joint = _about_joint(comment, number)
    return problems or unread_prose(about_joint, statements, lead=lead)


def _about_joint(comment: Comment, number: int) -> Comment:
    return replace(comment, text=f"joint {number}: {comment.text}")


def _holds(key: str, node: Node, statements: Statements, columns: Columns) -> bool:
    """Whether a note only repeats what holds for the rows above it."""
    if key == "convention" and statements.convention is None:
        return "convention" in columns.fields
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
    if not (slides or any(re.search(pattern, comment.text) for pattern in patterns)):
        mostly = len(comment.text) > len("scara") - 1 and re.search(_SLIDING_ARM, comment.text)
        still = not mostly and re.search(_STILL_ROW, comment.text)
        message = f"{shown(comment.line)} speaks of an arm that mostly has a prismatic joint, and no joint is one"
        if still:
            message = f"{shown(comment.line)} speaks of a row that may not move, and the table has no types"
        notice = Problem(message=message, severity="notice", mark=comment.whole, field="type", found=comment.line)
        return [notice] if mostly or still else []
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
    return bool(placement_of(re.sub(_NUMBER, " ", text)) and re.search(_NUMBER, text))


def unread(
    comment: Comment, statements: Statements, *, among_rows: bool = False, lead: str = "# ", place: str = "column"
) -> list[Problem]:
    """A notice of a comment on a line of its own that gives a number to something, or says what only columns can say.

    Args:
        comment: one that says nothing under a key.
        statements: what the table and the options say.
        among_rows: whether it is below the header, and may be about the row behind it.
        lead: what a line begins with that declares something.
        place: where a joint has its values: in a column, or under a key.
    """
    return (
        unread_values(comment, place=place)
        or unread_prose(comment, statements, among_rows=among_rows, lead=lead)
        or spoken_values(comment, place=place)
    )


def _is_heading(text: str) -> bool:
    """Whether a comment among rows is the title of another arm: ``right arm``, ``UR10``."""
    return re.fullmatch(_HEADING, text) is not None or (text.isascii() and text.upper() == text and is_model(text))


def unread_prose(
    comment: Comment, statements: Statements, *, among_rows: bool = False, lead: str = "# "
) -> list[Problem]:
    """A notice of prose that gives a place of the tool or of the base, or says what only columns can say.

    Args:
        comment: one that says nothing under a key.
        statements: what the table and the options say.
        among_rows: whether it is below the header, and may be about the row behind it.
        lead: what a line begins with that declares something.
    """
    placed = map(placement_of, re.findall(r"[^\W\d_]+", comment.text))
    found = {kind for kind in placed if kind}
    what = found.pop() if len(found) == 1 else None
    if what in statements.placed or not (what and (_is_bare(comment.text) or re.search(_SIZE, comment.text))):
        what = None
    plain = comment.text.casefold()
    meant = any(meaning.is_in(comment.text, plain) for meaning in MEANINGS.values())
    if among_rows and not meant and comment.text.count(" ") < _SHORT:
        meant = MEANINGS[MOTION].is_in(_about_joint(comment, 1).text, plain)
    if what is None and not meant:
        return []
    return [
        Problem(
            message=f"{shown(comment.line)} is a comment, and nothing is read from it",
            severity="notice",
            mark=comment.whole,
            field=what,
            found=comment.line,
            suggestion=f"if it is part of the arm, declare it: `{lead}{EXAMPLES[what].removeprefix('# ')}`"
            if what
            else None,
        )
    ]
