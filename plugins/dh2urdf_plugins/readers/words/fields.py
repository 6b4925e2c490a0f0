"""The fields of a table: the one list of headers, of which readers, schema and docs are made, and words in cells."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities import Dimension
from dh2urdf.row_fields import COM, INERTIA, ROW_FIELDS, RowField
from dh2urdf_plugins.readers.words.word_keys import key_of, keys_of


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a row, or several fields that share a cell.

    Attributes:
        name: what the project calls it.
        headers: what tables call it, in English words and symbols.
        dimension: what it measures; None for words.
        linear: what it measures in the row of a prismatic joint, where that is something else.
        around: words that may stand before or behind its headers and say nothing new: ``max`` of ``max speed``.
        parts: the fields that a cell of it holds, where it is several.
    """

    name: str
    headers: tuple[str, ...]
    dimension: Dimension | None = None
    linear: Dimension | None = None
    around: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()

    @property
    def others(self) -> dict[str, tuple[str, ...]]:
        """What tables call it in other languages, by language."""
        from dh2urdf_plugins.readers.words.other_words import other_headers

        return other_headers().get(self.name, {})

    @property
    def words(self) -> tuple[str, ...]:
        """All of its headers, in every language."""
        return (*self.headers, *(word for words in self.others.values() for word in words))


_OF = "of, the, de, du, des, la, le, del, della, dell, di, da, do, 的"
_JOINT = "joint, axis, gelenk, achse, achs, achsen, axe, articulation, articulaire"
_JOINT += ", eje, articulación, articular, asse, giunto, junta, articulação, eixo, 关节, 轴"
_LINK = "link, body, glied, corps, segment, eslabón, cuerpo, membro, corpo, elo, 连杆, 杆件"
_MOST = "max, maximum, limit, maximal, maximale, maximales, maximaler, maxi"
_MOST += ", máximo, máxima, massimo, massima, limite, límite, 最大"
_BOUND = "limit, limits, bound, position, pos, angle, value, q, theta, travel"
_BOUND += ", grenze, grenzwert, gelenkgrenze, winkel, anschlag, limite, borne, butée, angle articulaire"
_BOUND += ", límite, ángulo, valor, angolo, finecorsa, ângulo, 限位, 角度"
_CENTRES = "com, cog, center of mass, centre of mass, center of gravity, centre of gravity"
_TENSORS = "inertia, inertia tensor, inertia matrix, tensor of inertia, moment of inertia, moments of inertia"


def _words(text: str) -> tuple[str, ...]:
    return tuple(text.split(", ")) if text else ()


def _field(
    name: str,
    headers: str,
    *,
    dimension: Dimension | None = None,
    around: str = "",
    parts: tuple[str, ...] = (),
) -> Field:
    """A field; what it measures is that of the number in `ROW_FIELDS`, or of its first part."""
    number = ROW_FIELDS.get(parts[0] if parts else name, RowField(dimension))
    return Field(name, _words(headers), number.dimension, number.linear, _words(around), parts)


def _com(axis: str) -> Field:
    of_words = (f"{word} {axis}, {axis} {word}" for word in _words(_CENTRES))
    headers = f"com_{axis}, c{axis}, {axis}c, cg{axis}, {axis}cg, {', '.join(of_words)}"
    return _field(f"com_{axis}", headers, around=_LINK)


def _moment(name: str) -> Field:
    axes = name[1:]
    numbers = axes.translate(str.maketrans("xyz", "123"))
    twins = {axes, axes[::-1]}
    headers = ", ".join([name, *(f"i{twin}" for twin in twins - {axes}), f"j{axes}", f"i{numbers}", f"inertia {axes}"])
    return _field(name, headers, around=_LINK)


def _fields() -> dict[str, Field]:
    fields = [
        _field("robot", "robot, manipulator, model, robot name, manipulator name, model name, arm, arm name"),
        _field("convention", "convention, dh convention"),
        _field(
            "index",
            "i, #, index, no, nr, number, num, n°, joint number, joint no, joint nr, joint index, joint #, "
            "axis number, axis no",
        ),
        _field("joint", "joint, joint name, name, joint id, axis, axis name, joints"),
        _field("link", "link, link name, body, links"),
        _field("type", "type, joint type, kind, sigma, σ, r/p, p/r, type of joint, axis type"),
        _field("a", "a, r, link length, length"),
        _field("alpha", "alpha, α, twist, link twist, twist angle, link twist angle"),
        _field("d", "d, link offset, joint distance"),
        _field("theta", "theta, θ, th, joint angle, theta offset, offset theta, theta const, joint angle offset"),
        _field("offset", "offset, joint offset"),
        _field("beta", "beta, β", dimension=Dimension.ANGLE),
        _field("gamma", "gamma, γ", dimension=Dimension.ANGLE),
        _field("b", "b", dimension=Dimension.LENGTH),
        _field(
            "sign",
            "sign, direction, dir, polarity, rotation direction, direction of rotation",
            dimension=Dimension.NUMBER,
            around=_JOINT,
        ),
        _field("flip", "flip, flipped, inverted, reversed"),
        _field(
            "limits",
            "limits, limit, range, qlim, range of motion, motion range, working range, stroke, travel",
            around=f"{_JOINT}, {_OF}, motion, movement, position, angle, angular, q, theta",
            parts=("lower", "upper"),
        ),
        _field(
            "lower",
            "lower, q_min, min, lower limit, limit lower, low, lo, minimum, q_lo, lower bound",
            around=f"{_JOINT}, {_OF}, {_BOUND}",
        ),
        _field(
            "upper",
            "upper, q_max, max, upper limit, limit upper, high, hi, maximum, q_hi, upper bound",
            around=f"{_JOINT}, {_OF}, {_BOUND}",
        ),
        _field(
            "velocity",
            "velocity, speed, vel, omega, max velocity, velocity limit, v_max, qd_max, q_dot_max, dot_q_max, dq_max, "
            "theta_dot_max, dtheta_max",
            around=f"{_JOINT}, {_MOST}, {_OF}, angular, rotational, rotation",
        ),
        _field(
            "effort",
            "effort, torque, force, tau, max effort, effort limit, peak torque",
            around=f"{_JOINT}, {_MOST}, {_OF}",
        ),
        _field(
            "mass",
            "mass, m, m_i, weight",
            around=f"{_LINK}, {_OF}",
        ),
        _field(
            "com",
            f"{_CENTRES}, com position",
            around=f"{_LINK}, {_OF}, position, location, vector, xyz",
            parts=COM,
        ),
        *map(_com, "xyz"),
        _field(
            "inertia",
            _TENSORS,
            around=f"{_LINK}, {_OF}",
            parts=INERTIA,
        ),
        *map(_moment, INERTIA),
        _field("radius", "radius", around=_LINK),
        _field(
            "damping",
            "damping, viscous friction, viscous damping, damping coefficient, viscous friction coefficient",
            around=f"{_JOINT}",
        ),
        _field(
            "friction",
            "friction, coulomb friction, dry friction, friction loss",
            around=f"{_JOINT}",
        ),
        _field("armature", "armature, reflected inertia, reflected rotor inertia"),
    ]
    known = {each.name: each for each in fields}
    return known | {name: _field(name, name) for name in ROW_FIELDS if name not in known}


FIELDS = _fields()
GROUPS = {name: each for name, each in FIELDS.items() if each.parts}
"""Fields whose cells hold several others."""


@cache
def header_fields() -> dict[str, Field]:
    """The field of each header in every language, by the header's key."""
    return {key: each for each in FIELDS.values() for word in each.words for key in keys_of(word)}


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
_CONVENTION_WORDS = {key_of(word): kind for kind, words in _CONVENTIONS.items() for word in words} | {
    "standarddh": Convention.STANDARD,
    "classicdh": Convention.STANDARD,
    "denavithartenberg": Convention.STANDARD,
    "modifieddenavithartenberg": Convention.MODIFIED,
}
_OF_ALL = frozenset(("dh", "denavit", "hartenberg", "convention", "notation", "parameters"))
"""Words that the names of both conventions may have."""
_FLIP_WORDS = {
    **dict.fromkeys(_words("true, yes, 1, wahr, ja, vrai, oui, verdadero, sí, vero, sì, si"), True),
    **dict.fromkeys(_words("false, no, 0, falsch, nein, faux, non, falso"), False),
}

_NOUNS = ("joint", "关节")
"""The nouns that may follow a type: ``prismatic joint``."""

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
    key = key_of(word) if any(map(str.isalpha, word)) else word  # `-1` is not 1
    key = next((key.removesuffix(noun) for noun in _NOUNS if key.endswith(noun)), key)
    if key in _TYPE_WORDS:
        return _TYPE_WORDS[key]
    from dh2urdf_plugins.readers.words.other_words import OTHER_TYPES

    return OTHER_TYPES.get(key)


def convention_of(text: str) -> Convention | None:
    """The convention that a word means."""
    key = key_of(text.strip().casefold()).removesuffix("convention")
    if key in _CONVENTION_WORDS:
        return _CONVENTION_WORDS[key]
    from dh2urdf_plugins.readers.words.other_words import OTHER_CONVENTIONS

    if key in OTHER_CONVENTIONS:
        return OTHER_CONVENTIONS[key]
    words = "".join(letter if letter.isalnum() else " " for letter in text.casefold()).split()
    known = _CONVENTION_WORDS | OTHER_CONVENTIONS
    named = {known.get(key_of(word)) for word in words if word not in _OF_ALL}  # `modified DH (Craig)`
    return named.pop() if len(named) == 1 else None


def flip_of(text: str) -> bool | None:
    """The truth value that a word means."""
    return _FLIP_WORDS.get(text.strip().casefold())
