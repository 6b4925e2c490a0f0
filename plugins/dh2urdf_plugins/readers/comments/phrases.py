"""Phrases in comments that declare units, the convention or both: `MDH, lengths in mm, angles in degrees`.

A phrase that consists of nothing but units, what they measure and the convention is a statement like
`units: {length: mm}` and `convention: modified`. A comment with any other word is prose.
"""

from __future__ import annotations

import re
import unicodedata
from itertools import takewhile
from typing import TYPE_CHECKING

from dh2urdf.quantities import UNITS, unit_word
from dh2urdf_plugins.readers.header.units import KEY_OF
from dh2urdf_plugins.readers.words.fields import CONVENTION_CHOICES, convention_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import Convention
    from dh2urdf.quantities import Unit

_MEASURES = {
    "length": "length lengths distance distances dimension dimensions translation translations linear länge längen "
    "laenge laengen abmessungen longueur longueurs longitud longitudes lunghezza lunghezze",
    "angle": "angle angles angular rotation rotations winkel ángulo ángulos angulo angulos angolo angoli",
    "mass": "mass masses weight weights massen gewicht gewichte masa masas",
    "inertia": "inertia inertias trägheit trägheiten trägheitsmomente inertie inerties inercia inercias inerzia",
    "effort": "effort efforts torque torques moment momente drehmoment drehmomente couple couples par coppia coppie",
    "velocity": "velocity velocities speed speeds geschwindigkeit geschwindigkeiten vitesse vitesses velocidad "
    "velocidades velocità",
}
MEASURE_WORDS = {word: key for key, words in _MEASURES.items() for word in words.split()}
FIELD_WORDS = {"a": "length", "r": "length", "d": "length", "alpha": "angle", "α": "angle"} | {
    "theta": "angle",
    "θ": "angle",
}
UNIT_WORDS = frozenset(
    "unit units einheit einheiten unité unités unite unites unidad unidades unità unita uom".split()  # noqa: SIM905
)
FILLERS = frozenset(
    "all the are is in given measured expressed and of with table value values number numbers every both as by for "  # noqa: SIM905
    "alle alles sind ist und werte die der toutes tous les sont en et valeurs todas todos las los están están y "
    "valores tutte tutti le gli i sono e valori everything parameters parameter link joint measurement "
    "measurements used using use uses system here one each this note follows according to form".split()
)
_OF_CONVENTIONS = frozenset(
    "dh denavit hartenberg convention konvention convención convencion convenzione notation mdh sdh".split()  # noqa: SIM905
)
"""Words that show that `standard`, or the name of an author, is the convention."""
_COUNTED = frozenset(
    "joint joints axis axes link links row rows line fig figure table tab eq equation section sec chapter page version "  # noqa: SIM905
    "rev step example case note part frame frames theta alpha dh th".split()
)
"""What has a number and is no model of a robot."""
_AROUND_MODELS = frozenset(("the", "a", "robot", "arm", "manipulator"))
_ROBOTS = frozenset(
    "abb agilex aubo baxter comau denso dobot doosan emika epson fanuc franka gofa iiwa interbotix jaco jaka kawasaki "  # noqa: SIM905
    "kinova kuka lbr mico mitsubishi motoman nachi niryo panda puma rethink sawyer scara stanford staubli stäubli "
    "techman ufactory unimate unimation viperx widowx yaskawa yumi".split()
)
"""Names of makers and models that are no other words where a convention is behind them."""
_SIGNS = "-\u2013\u2014.,:;()"
_NO_LETTERS = r"\bd-h\b|['\u2019]s\b"
_PARTS = r"[-\u2010\u2011]"
_BREAKS = r"[\s,;:=&()\[\]{}|\u2013\u2014\u2192\uff1a\uff0c]+|\.(?=\s|$)|->|(?<=\s)[-/](?=\s)"
_WITH_SLASH = r"(?:[^\W\d_]|°)+(?:/(?:[^\W\d_]|°)+)+"
"""``deg/s`` is one unit, ``mm/deg`` are two."""
_INCHES = r"(?<![·*-])\bin\b(?=\s*(?:[,;/)\]}&.]|and\b|$))"
"""The unit, where another word would follow the preposition."""
_TORQUE = r"\b(k?n|kgf?|lbf?|ozf?)(?:ewtons?)?[\s*-]\s?(mm|cm|m(?=et[er]{2}s?\b)|m\b|in|ft)(?:et[er]{2}s?|ch)?\b"
"""A unit of torques in two words: ``N cm``, ``newton metres``."""
_OF_TORQUES = ("torque", "moment", "effort", "couple", "coppi")
_ONE_UNIT = (
    r"\b(?:1|one|each|every|an?)\s+((?:(?:length|linear|angle|angular)\s+)?)(?:units?|einheit|unité|unidad|unità)\s*"
    r"(?:=|:|\b(?:is|equals|means|represents|ist|est|es)\b)\s*(?:(?:1|one|an?)\b\s*|(?=1[^\W\d])1)"
)
"""A unit by what one of it is: ``1 unit = 1 mm``."""


def declared(text: str) -> dict[str, str]:
    """What a phrase declares that says nothing besides, by key, as YAML: the units, the convention, or both.

    ``all lengths in mm, angles in degrees``, ``units [mm, deg]``, ``mm/deg``, ``1 unit = 1 mm``, ``modified DH
    convention, units: mm``.
    """
    said: dict[str, str] = {}
    named: set[Convention] = set()
    fields, measured, is_convention = set[str](), set[str](), False
    for word in () if is_prose(text) else _words(text):
        if word in UNIT_WORDS or word in FILLERS:
            continue
        if key := MEASURE_WORDS.get(word) or FIELD_WORDS.get(word):
            measured.add(key)
            fields.update({word.replace("r", "a")} & {"a", "d"})
            continue
        unit = unit_called(word)
        key = KEY_OF.get(unit.dimension) if unit else None
        if unit and key:
            if said.setdefault(key, unit.symbol) != unit.symbol:
                return {}
            continue
        for part in re.split(_PARTS, word):
            convention = None if part in ("dh", "denavit", "hartenberg") else convention_of(part)
            if convention is None and part not in _OF_CONVENTIONS:
                return {}
            named |= {convention} if convention else set()
            is_convention |= part in _OF_CONVENTIONS and word != text.casefold()  # `MDH` alone may be a name
    if len(named) > 1 or (named and not is_convention) or not measured <= said.keys() or len(fields) == 1:
        return {}
    found = {"units": "{" + ", ".join(f"{key}: {unit}" for key, unit in said.items()) + "}"} if said else {}
    return found | ({"convention": str(*named)} if named else {})


def without_model(text: str) -> str | None:
    """A comment without the model of a robot at one of its ends: ``UR5 - modified DH``; None where it has none.

    A name with a number is known as a model: ``UR5e``, ``KR 16``, in ``modified DH parameters of the UR5e`` too; of
    others those that robots alone have: ``Panda``, ``KUKA iiwa``.
    """
    words = text.split()
    if lead := _model_words(words):
        return " ".join(words[lead:]).lstrip("-\u2013\u2014:,; ") or None
    ends = [place for place, word in enumerate(words) if word in ("of", "for")]
    if not ends:
        return None
    named = [word for word in words[ends[-1] + 1 :] if word.casefold() not in _AROUND_MODELS]
    return " ".join(words[: ends[-1]]) if named and _model_words(named) == len(named) else None


def is_model(text: str) -> bool:
    """Whether a text is the name of a robot, and nothing besides: ``UR10``, ``KUKA KR 16``."""
    words = text.split()
    return bool(words) and _model_words(words) == len(words)


def _model_words(words: Sequence[str]) -> int:
    """How many words at the beginning name a robot: its maker, and its model."""
    plain = [word.strip(_SIGNS).casefold() for word in words]
    makers = sum(1 for _ in takewhile(_ROBOTS.__contains__, plain))
    model = next((count for count in (2, 1) if _is_model(words[makers : makers + count])), 0)
    if makers and not model:  # `Puma 560`
        model = int("".join(plain[makers : makers + 1]).isdecimal())
    named = min(makers + model, len(words))
    return named + (sum(1 for _ in takewhile(_AROUND_MODELS.__contains__, plain[named:])) if named else 0)


def _is_model(words: Sequence[str]) -> bool:
    if not words or len(words) > 2:  # noqa: PLR2004 - a name and its number
        return False
    first, *number = (word.strip(_SIGNS) for word in words)
    letters = "".join(character for character in first if character.isalpha())
    if len(letters) < len("UR") or not first[0].isalpha() or letters.casefold() in _COUNTED:
        return False
    return number[0].isdecimal() and first[0].isupper() if number else letters != first and first.isalnum()


def unit_of_measure(key: str, value: str) -> str | None:
    """The unit that a key such as ``length_unit``, ``lengths`` or ``unit of angles`` declares, as YAML; or None."""
    words = [word for word in _words(key.replace("_", " ").replace("-", " ")) if word not in FILLERS]
    measures = [MEASURE_WORDS.get(word) for word in words if word not in UNIT_WORDS]
    if len(measures) != 1 or measures[0] is None:
        return None
    said = declared(value)
    return said["units"] if list(said) == ["units"] and said["units"].startswith(f"{{{measures[0]}:") else None


def is_prose(text: str) -> bool:
    """Whether a text begins with a plain word that is none of a phrase: looked at before any pattern is."""
    first = text.casefold().partition(" ")[0]
    if not (first.isascii() and first.isalpha()):
        return False
    of_units = first in UNIT_WORDS or first in FILLERS or first in MEASURE_WORDS or first in FIELD_WORDS
    if of_units or first in _OF_CONVENTIONS or first in CONVENTION_CHOICES or unit_called(first):
        return False
    return "onven" not in text.casefold() or convention_of(first) is None  # `modifiziert convention`


def _words(text: str) -> list[str]:
    plain = unicodedata.normalize("NFC", text).casefold()
    plain = re.sub(_TORQUE, r"\1·\2", plain) if any(word in plain for word in _OF_TORQUES) else plain
    plain = re.sub(_INCHES, "inch", plain) if "in" in plain else plain
    plain = re.sub(_ONE_UNIT, r"\1 unit ", plain) if "uni" in plain or "ein" in plain else plain
    plain = re.sub(_NO_LETTERS, lambda match: "dh" if match[0] == "d-h" else "", plain)
    return [
        word for word in re.split(_BREAKS, re.sub(_WITH_SLASH, _one_or_two, plain) if "/" in plain else plain) if word
    ]


def _one_or_two(match: re.Match[str]) -> str:
    return match[0] if unit_called(match[0]) else match[0].replace("/", " ")


def unit_called(word: str) -> Unit | None:
    """The unit of any dimension that a word stands for."""
    return UNITS.get(unit_word(word))
