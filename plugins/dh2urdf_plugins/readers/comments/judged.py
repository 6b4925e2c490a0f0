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
from dh2urdf.patterns import late_pattern
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.readers.comments.declared import (
    EXAMPLES,
    below_header,
    placement_of,
    statements_in,
    unread_values,
    words_under_key,
)
from dh2urdf_plugins.readers.comments.prose import prose_problems
from dh2urdf_plugins.readers.header.units import SI
from dh2urdf_plugins.readers.rows.names import speaks_of_slide
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
    r"(?<![\w-])(?:(?=[\w-]*P)(?:(?:[2-9]?[RP]-?){3,8}(?![\w-])"
    r"|[2-9]?[RP]-?[2-9]?[RP](?=\s*(?:robot|arm|manipulator)\b|\s*$))"
    r"|[1-9]R\s?\+?\s?[1-9]P(?![\w-])|[1-9]P\s?\+?\s?[1-9]R(?![\w-])|[1-9]R\s?\+\s?P(?!\w)|P\s?\+\s?[1-9]R(?!\w)"
    r"|(?=[R, ]{0,16}P)[RP](?:(?:,\s?|\s)[RP]){2,8}(?![\w-]|\s[A-Z]\b))"
)
"""The joints of an arm by their letters: ``RRP``, ``R-R-P-R``, ``R R P``, ``RP robot``, ``2R1P``."""
_SLIDING_ARM = late_pattern(
    r"(?<![^\W_])(?:scara|(?:cartesian|cylindrical|gantry) (?:robot|arm|manipulator)|stanford (?:arm|manipulator)"
    r"|(?:polar|spherical) (?:robot|arm|manipulator)|gantry|telescop\w*|(?:ball|lead)[ -]?screw|moves? linearly|stroke"
    r"|linear (?:motion|actuator|drive|slide|guide|module|unit|rail)s?(?! speed| veloc| accel)"
    r"|[1-9] (?:linear ax[ei]s|translations?|traslaci[oó]n(?:es)?|traslazion[ei]|translationen|transla[cç](?:ão|ões)))"
    r"(?![^\W_])",
    re.IGNORECASE,
)
"""Words for an arm that mostly has a joint that slides."""
_STILL_ROW = late_pattern(
    r"(?<![^\W_])(?:(?:last|first|final|[0-9]{1,2}(?:st|nd|rd|th))\s+(?:row|line)|row\s*[0-9]{1,2})(?![^\W_])[^.;]{0,24}"
    r"(?<![^\W_])(?:tool|flange|end[ -]?effector|base|tcp|gripper|hand|ee|fixed)(?![^\W_])",
    re.IGNORECASE,
)
"""A row that is no joint, in prose: ``the last row is the tool``."""
_NTH = (
    r"(?:(?:joint|axis|link|gelenk|achse|axe|articulation|articulaci[oó]n|articulação|eje|giunto|asse|junta|eixo|关节|轴|関節|軸"
    r"|관절|축|przegub|eklem|сочленение|ось|j|q)[\s_.#-]*[0-9]{1,2}|第?\s?[0-9一二三四五六七](?:关节|轴|関節|軸)"
    r"|(?:[0-9]{1,2}(?:st|nd|rd|th|\.|[eªº])|first|second|third|fourth|fifth|sixth|last)\s+"
    r"(?:joint|axis|gelenk|achse|axe|articulation|eje|giunto|asse))(?![^\W_])"
)
"""A joint by its number, as prose names it."""
_NTH_SLIDES = late_pattern(
    rf"{_NTH}[^.;,]{{0,24}}?(?<![^\W_])(?:slides?|sliding|translat\w*|prism\w*\.?|schub\w*|glissi\w*"
    r"|linear(?:achse)?(?!\s*(?:speed|veloc|accel|interpol|motion|encoder)))(?![^\W_])"
    rf"|{_NTH}\s*[:=(]\s*P(?!\w)",
    re.IGNORECASE,
)
_SLIDE_VARIABLE = late_pattern(
    r"(?<![^\W_])d_?[0-9]{1,2}\*?\s+(?:is\s+)?(?:an?\s+|the\s+)?(?:joint\s+)?variable"
    r"|variables?\b[^.]*?(?<![^\W_])d_?[0-9]{1,2}\b"
    r"|(?<![^\W_])q\s*=\s*[\[({][^\])}]*(?<![^\W_])d_?[0-9]|(?<![^\W_])q_?[0-9]\s*=\s*d_?[0-9]",
    re.IGNORECASE,
)
"""``d3`` among the variables of an arm: ``q = [θ1, θ2, d3]``."""
_VARIABLE = rf"(?:{_NTH}|(?<![^\W_])(?:θ|theta|th|q|d)[\s_{{]*(?:[0-9]{{1,2}}|[₁-₉])\}}?)"
_ADDED = r"(?:[0-9]{2,}|[0-9]+(?:[.,][0-9]+|\s*(?:°|deg|rad|mm|cm))|[0-9]*\s?\*?\s?(?:pi|π))"
"""What is added to a joint variable, and no number of a joint: ``q1-6`` are six joints."""
_UNREAD = late_pattern(
    rf"{_NTH}[^.;]{{0,24}}?(?<![^\W_])(?:fixed|locked|coupled|mimic|reversed|inverted|opposite|negative|negated|welded"
    r"|frozen|blocked|clamped|passive|unused|disabled|swapped|exchanged|mirrored|flipped|dependent|follows"
    r"|(?:not|never|n['’]t)\s+(?:mov|used|actuated|driven|turn|rotat))"
    rf"|(?<![^\W_])(?:add|subtract|plus|minus)(?:ed)?\s[^.;]{{0,24}}?(?:[0-9]|pi|π)[^.;]{{0,24}}{_VARIABLE}"
    r"|(?:[0-9]|pi|π)\s*(?:°|deg\w*|rad\w*|mm|cm|m)?\s*(?:offset|shift|versatz)(?![^\W_])"
    rf"|(?<![^\W_])(?:zero|home|rest|initial|reference)\b[^.;]{{0,24}}(?:{_VARIABLE}|(?:position|pose|configuration|angle)s?)"
    rf"[^;]{{0,40}}?(?<![\w.,])[-+−]?{_ADDED}|{_VARIABLE}[^.;]{{0,24}}(?<![^\W_])(?:zero|home)\b[^.;]{{0,24}}{_ADDED}"
    r"|(?<![^\W_])signs?\s*[:=]\s*[\[(]?\s*[-+−](?!\s?[0-9])"
    r"|(?<![^\W_])in (?:(?:units|steps) of )?[01][0-9.]*(?:e[-+]?[0-9]+)?\s*(?:µm|mm|cm|m|deg|rad|°)(?![^\W_])"
    r"|(?<![^\W_])inertias?(?![^\W_])[^.;]{0,24}(?:about|around|at|relative to)\s+(?:the\s+)?"
    r"(?:joint|origin|link|frame|axis|base)"
    r"|(?<![^\W_])(?:com|cog|cent(?:re|er)s? of mass)(?![^\W_])[^.;]{0,24}"
    r"(?:(?:frame|link)\s*\(?i\s*[-−]\s*1|(?:world|base|previous)\s+(?:frame|link|coord))"
    r"|(?<![^\W_])(?:limits?|speeds?|velocit(?:y|ies)|torques?|ranges?)(?![^\W_])[^.;]{0,24}(?<![^\W_])(?:motors?|rotor|gear)"
    r"|(?<![^\W_])times\s+[0-9]{2,}|multiply by|normali[sz]ed|dimensionless"
    rf"|(?<![^\W_])(?:reversed|inverted|opposite|negative|positive)\s+(?:direction|sense|sign)\b[^.;]{{0,24}}{_NTH}"
    r"|(?:θ|theta|th|q|j)[\s_{]*[0-9]{1,2}[a-z_}]{0,8}\W{0,3}=[^=]*(?:θ|theta|th|q|j)[\s_{]*[0-9]"
    rf"|{_VARIABLE}[^.;]{{0,32}}?(?<![^\W_])(?:horizontal|vertical|absolute|offset|shifted|versatz|d[ée]calage|desfase)"
    rf"|(?<![^\W_])(?:offset|shift|versatz|d[ée]calage|desfase)(?![^\W_])[^.;]{{0,16}}{_VARIABLE}"
    r"|(?<![^\W_])offsets?(?:\s+(?:of|is))?\s*[:=]?\s*[-+−±]?\s*(?:(?![0-9]+\s+(?:rows?|lines?|columns?|cells?|pages?"
    r"|figures?|tables?|characters?|digits?)\b)[0-9.]|pi|π)"
    r"|10\s*(?:\^|\*\*|(?=[⁻⁺⁰¹²³⁴-⁹]))|[x×*]\s*10{1,6}\b"
    r"|(?:multiplied|divided|scaled) by|(?:multiples|units) of (?:pi|π)"
    r"|(?:θ|theta|th)\w{0,3}\W{0,3}=\s*[-−]?\s*q\w{0,3}\s*[-+−]\s*(?:[0-9]|pi|π)"
    r"|revers\w+ order|(?<![^\W_])(?:1|one)\s+[^\W\d]{1,12}\s*(?:=|≙|equals)\s*[0-9.]"
    r"|(?<![^\W_])(?:scale(?!\s+models?\b)|scaling|scaled|ma(?:ß|ss)stab|[ée]chelle|escala|scala)(?![^\W_])[^.;]{0,24}[0-9]",
    re.IGNORECASE,
)
"""What prose adds to joints or to all numbers, and no comment can: ``θ2 = q2 - 90°``, ``all × 10⁻³``."""
_ADDS = late_pattern(
    rf"(?<![^\W_])(?:θ|theta|th|q|phi|φ)[\s_{{]*[0-9₁-₉]?[}}'\s]{{0,3}}[-+−]\s?{_ADDED}", re.IGNORECASE
)
"""A joint variable with what is added to it: ``q2-90``."""
_IN_ADDS = ("q", "theta", "θ", "phi", "φ")
_IN_UNREAD = (
    *"= 10 multipl divided units fixed locked coupled mimic reversed inverted opposite negative positive negated "  # noqa: SIM905
    "horizontal vertical absolute offset shift versatz calage desfase revers scal ≙ equals stab chelle welded frozen "
    "blocked clamped passive unused disabled swapped exchanged mirror flipped depend follows n't never n’t added "
    "subtract plus minus zero home initial reference sign: sign= signs times normali dimensionless".split(),
    "add ",
    "in 0",
    "in 1",
    "not ",
    "rest ",
    "inertia",
    "com ",
    "cog",
    "of mass",
    "motor",
    "rotor",
    "gear",
)
"""What such prose has at least one of: most comments have none, and need no search."""
_BOUNDS = late_pattern(
    r"(?<![^\W_])(?:limit|range)s?(?![^\W_])[^.;]{0,24}(?:±|\+\s?/?\s?[-−])\s?[0-9]"
    rf"|{_VARIABLE}[^.;]{{0,32}}?(?:[∈±]|\+\s?/?\s?[-−]\s?[0-9]|[<≤>≥]=?\s?[-+−]?\s?(?:[0-9]|pi|π)|(?<![^\W_])ranges?(?![^\W_])"
    r"|[0-9]\s?(?:°|deg)?\s?(?:\.\.|…|to|bis|~|～)\s?[-+−]?[0-9])",
    re.IGNORECASE,
)
"""How far a joint moves, in prose: ``d₃ ∈ [0.2, 1]``, ``q1: -170..170``."""
_IN_BOUNDS = ("∈", "+", "limit", "<", "≤", ">", "≥", "±", "range", "..", "…", "to", "bis", "~", "～")
_TURNED = late_pattern(
    r"(?<!counter)(?<!counter-)(?<!anti)(?<!anti-)(?<![^\W_])(?:clockwise|cw(?![^\W_]))"
    r"|(?<![^\W_])mirror(?:ed|s)?(?![^\W_])|(?<!gegen den )uhrzeigersinn"
    r"|顺时针|(?<!反)時計回り|(?<!반)시계 ?방향|(?<!против )часовой"
    r"|(?<!anti)(?<!anti-)(?<![^\W_])h?or[aá](?:ire|rio)(?![^\W_])"
    r"|upside[ -]down|(?<![^\W_])(?:ceiling(?! height)|wall[ -]mounted|left[ -]handed|kopfüber|hängend|hang(?:s|ing))"
    r"(?![^\W_])"
    r"|倒装|吊装|(?<![^\W_])z_?[0₀][^.;]{0,16}(?:down|unten|abajo)(?![^\W_])",
    re.IGNORECASE,
)
"""Joints that turn the other way, and a base that is turned: ``clockwise is positive``, ``mounted upside down``."""
_IN_TURNED = (
    "clockwise cw mirror uhrzeiger 顺时针 時計 시계 horaire horario horário orario часовой upside ceiling wall handed "  # noqa: SIM905
    "kopf häng hang 装 z0 z_0 z₀".split()
)
_NUMBER = late_pattern(r"(?<![^\W])[-+−]?(?:[0-9]*\.)?[0-9]+")
_SIZE = late_pattern(
    r"(?<![A-Za-z0-9_.,])[-+−]?[0-9]*[.,]?[0-9]*[1-9][0-9]*[.,]?[0-9]*\s*"
    r"(?:(?:mm|cm|m|µm|inch(?:es)?|deg(?:rees)?|rad|grad|мм|см|м)(?![A-Za-zа-я0-9_])|°|毫米|厘米|米|ミリ|メートル)"
)


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
    problems = [below_header(comment)] if below and prose and statements_in(comment) else prose
    problems = problems + types_elsewhere(comment, typed=typed)
    return problems + (unread_values(comment) or unread_prose(comment, statements))


def remark_problems(remark: Comment, number: int, statements: Statements, columns: Columns) -> list[Problem]:
    """What a cell of a column that no field knows declares about the table, as a comment would, or about its joint.

    What a comment behind the cells of a row declares is looked at elsewhere.

    Args:
        remark: the cell.
        number: the number of the row.
        statements: what the table and the options say.
        columns: its headers.
    """
    about_joint = replace(remark, text=f"joint {number}: {remark.text}")
    if is_comment(remark.line):
        return unread_values(remark) or unread_prose(about_joint, statements)
    try:
        said = statements_in(remark)
    except TableError as error:
        return list(error.problems)
    words = [key for key, node in said.items() if key not in ("units", "convention") and isinstance(node.value, str)]
    if all(key in words or _holds(key, node, statements, columns) for key, node in said.items()):
        problems = prose_problems(remark, statements, columns) + types_elsewhere(remark, typed="type" in columns.fields)
        return problems or unread_values(remark) or unread_prose(about_joint, statements)
    return [
        Problem(
            message=f"{shown(remark.line)} is in a column that is left out, and may declare the {' and '.join(said)}",
            mark=remark.whole,
            found=remark.line,
            accepted="what holds for all rows, above the header",
        )
    ]


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
    if not (slides or speaks_of_slide(comment.text) or any(pattern.search(comment.text) for pattern in patterns)):
        mostly = len(comment.text) > len("scara") - 1 and _SLIDING_ARM.search(comment.text)
        still = not mostly and _STILL_ROW.search(comment.text)
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
    return bool(placement_of(_NUMBER.sub(" ", text)) and _NUMBER.search(text))


def unread_prose(comment: Comment, statements: Statements, *, lead: str = "# ") -> list[Problem]:
    """A notice of prose that gives a place of the tool or of the base, or says what only columns can say.

    Args:
        comment: one that says nothing under a key.
        statements: what the table and the options say.
        lead: what a line begins with that declares something.
    """
    placed = map(placement_of, re.findall(r"[^\W\d_]+", comment.text))
    found = {kind for kind in placed if kind}
    what = found.pop() if len(found) == 1 else None
    if what in statements.placed or not (what and (_is_bare(comment.text) or _SIZE.search(comment.text))):
        what = None
    plain = comment.text.casefold()
    searches = ((_IN_UNREAD, _UNREAD), (_IN_ADDS, _ADDS), (_IN_BOUNDS, _BOUNDS), (_IN_TURNED, _TURNED))
    if what is None and not any(
        any(word in plain for word in words) and pattern.search(comment.text) for words, pattern in searches
    ):
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
