"""Names of rows that hardly are joints: totals of a spreadsheet, bases, flanges and tools, notes.

A word counts only where the whole name consists of such words: `tool_joint` and `EE frame` do, `wrist_flange_rotation`
and `base_yaw` do not.
"""

from __future__ import annotations

import unicodedata
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

from dh2urdf.patterns import late_pattern

if TYPE_CHECKING:
    from collections.abc import Collection

RowKind = Literal["total", "frame"]


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
_HINT = late_pattern("|".join(_TOTALS | _FRAMES))
_NO_LETTERS = late_pattern(r"[\W_]+")
_LONGEST = 60


@lru_cache(maxsize=4096)
def kind_of(name: str) -> RowKind | None:
    """What a row seems to be by its name, if it is hardly a joint: a total, or a frame, a note and the like."""
    if len(name) > _LONGEST:
        return None
    key = _key(name)
    if _consists_of(key, _TOTALS, _OF_TOTALS):
        return "total"
    return "frame" if name and (not key or _consists_of(key, _FRAMES, _OF_FRAMES)) else None


def is_base(name: str) -> bool:
    """Whether a name is that of a base, or of row 0: ``0 (from base)``."""
    key = _key(name[: _LONGEST + 1])
    return len(name) <= _LONGEST and (key == "0" or _consists_of(key, _BASES, _OF_FRAMES))


def are_joints(names: Collection[str], *, typed: bool) -> bool:
    """Whether none of some ASCII names is that of a row that is hardly a joint.

    Args:
        names: in lower case.
        typed: whether each row has a type, which decides for all but totals.
    """
    text = _NO_LETTERS.sub("", "".join(names))  # a name that has a word has it here, too
    kinds = set(map(kind_of, names)) if _HINT.search(text) or not all(map(_key, names)) else set()
    return "total" not in kinds and (typed or "frame" not in kinds)


def _key(name: str) -> str:
    """A name without case, accents and separators."""
    if name.isascii():
        return _NO_LETTERS.sub("", name.lower())
    letters = unicodedata.normalize("NFKD", name).casefold()
    return _NO_LETTERS.sub("", "".join(letter for letter in letters if not unicodedata.combining(letter)))


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
