"""The fields of a table, and the headers and words by which people call them."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities import Dimension, is_unit


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a row.

    Attributes:
        name: what the project calls it.
        headers: what tables call it, in words.
        dimension: what it measures; None for words.
        linear: what it measures in the row of a prismatic joint, where that is something else.
    """

    name: str
    headers: tuple[str, ...]
    dimension: Dimension | None = None
    linear: Dimension | None = None


def _fields() -> dict[str, Field]:
    number, length, angle = Dimension.NUMBER, Dimension.LENGTH, Dimension.ANGLE
    fields = [
        Field("robot", ("robot", "manipulator", "model", "robot name", "manipulator name", "model name")),
        Field("convention", ("convention", "dh convention")),
        Field("index", ("i", "#", "index", "no", "nr")),
        Field("joint", ("joint", "joint name", "name")),
        Field("link", ("link", "link name")),
        Field("type", ("type", "joint type", "kind", "sigma", "σ", "r/p", "p/r")),
        Field("a", ("a", "r", "link length"), length),
        Field("alpha", ("alpha", "α", "twist", "link twist", "twist angle"), angle),
        Field("d", ("d", "link offset"), length),
        Field("theta", ("theta", "θ", "th", "joint angle"), angle),
        Field("offset", ("offset", "joint offset"), angle, length),
        Field("sign", ("sign", "direction", "dir"), number),
        Field("flip", ("flip", "flipped", "inverted", "reversed")),
        Field("lower", ("lower", "q_min", "min", "lower limit", "limit lower"), angle, length),
        Field("upper", ("upper", "q_max", "max", "upper limit", "limit upper"), angle, length),
        Field("velocity", ("velocity", "max velocity", "velocity limit"), Dimension.TURN_RATE, Dimension.SPEED),
        Field("effort", ("effort", "max effort", "effort limit"), Dimension.EFFORT),
        Field("mass", ("mass", "m"), Dimension.MASS),
        *(Field(f"com_{axis}", (f"com_{axis}",), length) for axis in "xyz"),
        *(Field(name, (name,), Dimension.INERTIA) for name in INERTIA_FIELDS),
        Field("radius", ("radius",), length),
        Field("damping", ("damping",), Dimension.DAMPING),
        Field("friction", ("friction",), Dimension.EFFORT),
        Field("armature", ("armature",), Dimension.INERTIA, Dimension.MASS),
    ]
    return {field.name: field for field in fields}


INERTIA_FIELDS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
COM_FIELDS = ("com_x", "com_y", "com_z")
FIELDS = _fields()
REQUIRED = ("a", "alpha", "d")

UNHELD_GEOMETRY = {
    "beta": "the angle of Hayati's convention",
    "β": "the angle of Hayati's convention",
    "gamma": "an angle of Khalil and Kleinfinger's convention",
    "γ": "an angle of Khalil and Kleinfinger's convention",
    "b": "a length of Khalil and Kleinfinger's convention",
    "q": "the joint variable",
    "qoffset": "an offset of the joint variable",
    "q0": "an angle or a length that may be theta, d or an offset",
    "phi": "an angle that may be theta or an offset",
    "φ": "an angle that may be theta or an offset",
    "angle": "an angle that may be theta, alpha or an offset",
    "home": "an angle or a length that may be theta, d or an offset",
    "thetaoffset": "an offset of theta alone",
    "θoffset": "an offset of theta alone",
    "doffset": "an offset of d alone",
    "mdh": "the convention as a number",
    "prismatic": "the type of a joint in another form",
    "revolute": "the type of a joint in another form",
}
"""Headers of what shapes the arm and no field holds: refused where a cell is not 0."""

_SEPARATORS = re.compile(r"[\s_.*{}-]")


def _key(plain: str) -> str:
    return _SEPARATORS.sub("", plain)


_WORDS = {_key(word): field for field in FIELDS.values() for word in field.headers}
_INDEXED = ("a", "r", "alpha", "α", "d", "theta", "θ")
_INDEX = re.compile(rf"({'|'.join(_INDEXED)})[\s_]*[\[{{(]*[\s]*[ijkn]\s*(-\s*1|m1)?\s*[\]}})]*")
_BRACKETED = re.compile(r"(.*[^\s])\s*[\[(]([^\[\]()]*)[\])]")
_LOOSE_UNIT = re.compile(r"(.+?)(?:\s*/\s*|\s*,\s*|\s+in\s+|[\s_-]+|(?=°))([^\s_/,°-]+(?:/s)?|°(?:/s)?)")


_SURE = 4


class Header(NamedTuple):
    """What a header says.

    Attributes:
        field: the field that it names; None where no field is called so.
        key: the header without its unit, and without case and separators.
        unit: the unit that it names.
        link: ``i``, or ``i-1`` for a parameter of the link before, as the modified convention has them.
    """

    field: Field | None
    key: str
    unit: str | None = None
    link: str | None = None


@lru_cache(maxsize=1024)
def read_header(text: str) -> Header:
    """What a header says: ``a``, ``alpha_{i-1}``, ``Link length [mm]``, ``d/mm``, ``theta (deg)``, ``aᵢ₋₁``."""
    plain = unicodedata.normalize("NFKC", re.sub("[º˚]", "°", text)).casefold()
    plain = re.sub(r"[\\$]", "", plain).replace("−", "-").strip()
    header = _named(plain)
    if header.field:
        return header
    for pattern in (_BRACKETED, _LOOSE_UNIT):
        match = pattern.fullmatch(plain)
        if match and (front := _named(match[1].strip())).key:
            bracketed = pattern is _BRACKETED
            # What stands loose behind a name is its unit only if it is one: `com x` and `comment` are no units.
            if (front.field and front.field.dimension and (bracketed or is_unit(match[2]))) or (
                bracketed and front.key in UNHELD_GEOMETRY
            ):
                return front._replace(unit=match[2].strip())
            if bracketed and front.field:
                return front
            if bracketed or is_unit(match[2]):
                return header._replace(key=front.key)
    return header


def _named(plain: str) -> Header:
    if match := _INDEX.fullmatch(plain):
        return Header(_WORDS[match[1]], match[1], link="i-1" if match[2] else "i")
    key = _key(plain)
    return Header(_WORDS.get(key), key)


@lru_cache(maxsize=1024)
def misspelt(key: str) -> Field | None:
    """The field that a word of four letters or more misses by one slip, or with all its letters, as `tetha` does."""
    keys = (key, key.removesuffix("i"))  # `tehta_i`
    for word, field in _WORDS.items():
        if len(word) >= _SURE and any(one_slip(key, word) or _is_shuffled(key, word) for key in keys):
            return field
    return None


def _is_shuffled(key: str, word: str) -> bool:
    """Whether a longer word has the letters of another, the first one in its place."""
    return len(word) > _SURE and key[:1] == word[:1] and key != word and sorted(key) == sorted(word)


def one_slip(left: str, right: str) -> bool:
    """Whether two words differ by one letter more, less, other, or by two neighbours exchanged."""
    if left == right or abs(len(left) - len(right)) > 1:
        return False
    start = next((k for k, (x, y) in enumerate(zip(left, right, strict=False)) if x != y), min(len(left), len(right)))
    rest, other = left[start:], right[start:]
    return (
        rest[1:] == other[1:]
        or rest[1:] == other
        or rest == other[1:]
        or (rest[:2] == other[1::-1] and rest[2:] == other[2:])
    )


# --- Words ------------------------------------------------------------------------------------------------------------

_TYPES = {
    JointType.REVOLUTE: ("revolute", "r", "rotational", "rotary", "rotation", "hinge", "0"),
    JointType.PRISMATIC: ("prismatic", "p", "linear", "t", "translational", "translation", "sliding", "1"),
    JointType.CONTINUOUS: ("continuous", "c"),
    JointType.FIXED: ("fixed", "f", "static", "rigid"),
}
_CONVENTIONS = {
    Convention.STANDARD: ("standard", "dh", "sdh", "classic", "classical", "distal", "spong", "paul"),
    Convention.MODIFIED: ("modified", "mdh", "modified dh", "craig", "proximal"),
}
_TYPE_WORDS = {word: kind for kind, words in _TYPES.items() for word in words}
_CONVENTION_WORDS = {_key(word): kind for kind, words in _CONVENTIONS.items() for word in words} | {
    "standarddh": Convention.STANDARD,
    "classicdh": Convention.STANDARD,
    "denavithartenberg": Convention.STANDARD,
    "modifieddenavithartenberg": Convention.MODIFIED,
}
_FLIP_WORDS = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}

ACCEPTED_TYPES = "; ".join(", ".join(words) for words in _TYPES.values())
ACCEPTED_CONVENTIONS = (
    f"{', '.join(_CONVENTIONS[Convention.STANDARD])} for A = Rz(theta) Tz(d) Tx(a) Rx(alpha); "
    f"{', '.join(_CONVENTIONS[Convention.MODIFIED])} for A = Rx(alpha) Tx(a) Rz(theta) Tz(d)"
)
ACCEPTED_FLIPS = "true or false"
TYPE_CHOICES = tuple(_TYPE_WORDS)
CONVENTION_CHOICES = tuple(_CONVENTION_WORDS)


def joint_type(text: str) -> JointType | None:
    """The joint type that a word means."""
    word = text.strip().casefold()
    return _TYPE_WORDS.get(_key(word) if any(map(str.isalpha, word)) else word)  # `-1` is not 1


def convention_of(text: str) -> Convention | None:
    """The convention that a word means."""
    key = _key(text.strip().casefold()).removesuffix("convention")
    return _CONVENTION_WORDS.get(key)


def flip_of(text: str) -> bool | None:
    """The truth value that a word means."""
    return _FLIP_WORDS.get(text.strip().casefold())
