"""Names of rows that hardly are joints that turn: totals, bases, flanges and tools, notes, and joints that slide.

A word counts only where the whole name consists of such words: `tool_joint` and `EE frame` do, `wrist_flange_rotation`
and `base_yaw` do not.
"""

from __future__ import annotations

import re
import unicodedata
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

from dh2urdf.manipulator import JointType
from dh2urdf.patterns import late_pattern
from dh2urdf_plugins.readers.words.fields import joint_type
from dh2urdf_plugins.readers.words.word_keys import NOT_LETTERS

if TYPE_CHECKING:
    from collections.abc import Collection

RowKind = Literal["total", "frame", "slide"]


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_TOTALS = _words("""
    total totals totale totali gesamt gesamtsumme sum sums summe summen somme sommes suma somma subtotal zwischensumme
    mean means average avg mittelwert mittel durchschnitt moyenne media promedio median mediana max maximum maximo
    massimo min minimum minimo std stddev stdev deviation variance varianz rms count anzahl range spannweite σ
""")
_OF_TOTALS = _words("""
    length lengths laenge lange reach reichweite longueur portee longitud alcance lunghezza arm robot value values wert
    werte mass weight height of all joints links rows mm cm m deg rad kg
""")
_BASES = _words("""
    base basis ground world root origin pedestal foundation mounting mount sockel fundament gestell boden welt socle
    bati monde suelo tierra mundo raiz terra mondo basamento fixed
""")
_FRAMES = _BASES | _words("""
    flange toolflange tool tools ee eef tcp gripper hand tip end effector flansch werkzeug effektor endeffektor greifer
    spitze outil effecteur terminal pince bride herramienta pinza brida efector final utensile flangia organe organo
    terminale punta adapter
    fix fixe fest fijo fisso starr static rigid dummy virtual none null nan nil note notes remark remarks comment
    comments source quelle hinweis anmerkung unit units einheit einheiten unite unites unidad unidades unita
""")
_OF_FRAMES = _words("""
    joint jnt frame offset link point center centre transform plate position interface row gelenk rahmen repere from to
""")
_SLIDES = _words("""
    prismatic prismatical prism prismatisch prismatique prismatico linear linearly lineal lineaire lineare sliding slide
    slider translation translational translatory translatorisch traslacional traslacion traslazione schub schubgelenk
    schubachse linearachse glissiere deslizante corredera prismatica deslizamento 移动 平移 直线 滑动
""")
_OF_SLIDES = _words("""
    joint jnt axis rail guide motion drive unit stage actuator module gelenk achse liaison articulation axe articulacion
    eje giunto asse junta articulacao eixo 关节 轴 副 运动
""")
_SLIDE_SYMBOL = late_pattern(r"[pd][0-9]{0,3}")
"""``P2`` between ``R1`` and ``R3``, and the variable ``d2`` between ``θ1`` and ``θ3``."""
_SLIDE_IN_PROSE = late_pattern(r"\bprism[aá]ti|\bschubgelenk|移动副|移动关节", re.IGNORECASE)
_HINT = late_pattern("|".join(_TOTALS | _FRAMES | _SLIDES))
_LONGEST = 60


@lru_cache(maxsize=4096)
def kind_of(name: str) -> RowKind | None:
    """What a row seems to be by its name, if it is hardly a joint that turns: a total, a frame or a note, a slide."""
    if len(name) > _LONGEST:
        return None
    key = _key(name)
    if _consists_of(key, _TOTALS, _OF_TOTALS):
        return "total"
    if name and (not key or _consists_of(key, _FRAMES, _OF_FRAMES)):
        return "frame"
    return "slide" if _SLIDE_SYMBOL.fullmatch(key) or _consists_of(key, _SLIDES, _OF_SLIDES) else None


def speaks_of_slide(text: str) -> bool:
    """Whether prose speaks of a prismatic joint: ``joint 3 is prismatic``."""
    return _SLIDE_IN_PROSE.search(text) is not None


def holds_type(text: str, number: int) -> bool:
    """Whether a cell in a column that no field knows says that its joint does not turn.

    Args:
        text: the cell: ``prismatic``, ``fixed``, ``prismatic joint``, ``d2*``, ``slides (prismatic)``.
        number: the number of the row, which a symbol such as ``d2`` has to have.
    """
    if text.isalpha() and joint_type(text) not in (None, JointType.REVOLUTE):
        return True
    symbol = _SLIDE_SYMBOL.fullmatch(_key(text[:_LONGEST]))
    if symbol:
        return symbol[0][1:] in ("", str(number))
    return kind_of(text) == "slide" or speaks_of_slide(text)


def is_plain_label(text: str) -> bool:
    """Whether a cell in a column that no field knows says for sure nothing about the type of its joint."""
    return text.isdecimal() or not (kind_of(text) or holds_type(text, 0))


def is_base(name: str) -> bool:
    """Whether a name is that of a base, or of row 0: ``0 (from base)``."""
    key = _key(name[: _LONGEST + 1])
    return len(name) <= _LONGEST and (key == "0" or _consists_of(key, _BASES, _OF_FRAMES))


def are_joints(names: Collection[str], *, typed: bool) -> bool:
    """Whether none of some ASCII names is that of a row that is hardly a joint that turns.

    Args:
        names: in lower case.
        typed: whether each row has a type, which decides for all but totals.
    """
    text = NOT_LETTERS.sub("", "".join(names))  # a name that has a word has it here, too
    doubtful = _HINT.search(text) or not all(map(_key, names)) or any(map(_SLIDE_SYMBOL.fullmatch, map(_key, names)))
    kinds = set(map(kind_of, names)) if doubtful else set()
    return "total" not in kinds and (typed or kinds <= {None})


def _key(name: str) -> str:
    """A name without case, accents and separators."""
    if name.isascii():
        return NOT_LETTERS.sub("", name.lower())
    letters = unicodedata.normalize("NFKD", name).casefold()
    return NOT_LETTERS.sub("", "".join(letter for letter in letters if not unicodedata.combining(letter)))


def _consists_of(key: str, words: frozenset[str], others: frozenset[str]) -> bool:
    """Whether a name consists of words, others and digits, and has one of the words."""
    reached: list[bool | None] = [False, *[None] * len(key)]  # whether the name up to there has a word
    longest = max(map(len, words | others))
    for start in range(len(key)):
        if reached[start] is None:
            continue
        for end in range(start + 1, min(start + longest, len(key)) + 1):
            part = key[start:end]
            if part in words or part in others or part.isdigit():
                reached[end] = bool(reached[end] or reached[start] or part in words)
    return bool(reached[-1])
