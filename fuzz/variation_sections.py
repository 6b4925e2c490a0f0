"""Random sections `variations` of a run file: every field, law and sampling, with right and wrong values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.quantities import Dimension
from dh2urdf.run_file.variation_section import JOINT_TYPES, LAWS
from dh2urdf.variations.sampling import Sampling
from dh2urdf.variations.variation import AXES, FIELDS, TYPE

if TYPE_CHECKING:
    import random

TABLES = {
    "ur5.csv": """\
# convention: standard
joint,a,alpha,d,lower,upper,velocity,effort,mass
shoulder_pan,0,pi/2,0.089,-2*pi,2*pi,3.15,150,3.7
shoulder_lift,-0.425,0,0,-2*pi,2*pi,3.15,150,8.393
elbow,-0.392,0,0,-pi,pi,3.15,150,2.33
wrist_1,0,pi/2,0.109,-2*pi,2*pi,3.2,28,1.219
wrist_2,0,-pi/2,0.0947,-2*pi,2*pi,3.2,28,1.219
wrist_3,0,0,0.0823,-2*pi,2*pi,3.2,28,0.1879
""",
    "mixed.yaml": """\
convention: modified
joints:
  - {joint: column, type: prismatic, a: 0, alpha: 0, d: 0, lower: 0, upper: 0.8, offset: 0.1, damping: 3, friction: 0.2}
  - {joint: turn, type: continuous, a: 0.3, alpha: pi/2, d: 0.2, velocity: 2, armature: 0.01}
  - {joint: bracket, type: fixed, a: 0.1, alpha: 0, d: 0, mass: 1}
  - {joint: swing, a: 0.25, alpha: -pi/2, d: 0, lower: -1, upper: 1, offset: 0.5, mass: 2, com: [0.1, 0, 0],
     inertia: {ixx: 0.02, iyy: 0.03, izz: 0.04}}
  - {joint: slide, type: prismatic, sign: -1, a: 0, alpha: 0, d: 0.1, theta: 0.2, lower: -0.2, upper: 0.3}
""",
    "bare.csv": "# convention: standard\njoint,a,alpha,d,type\none,0.4,0,0,revolute\ntwo,0.3,90 deg,0,revolute\n",
}
"""Tables of a run: with limits and masses, with every type of joint, and with next to nothing."""
JOINTS = {
    "ur5": ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"),
    "mixed": ("column", "turn", "bracket", "swing", "slide"),
    "bare": ("one", "two"),
}
MOST_RULES = 4
MOST_VARIANTS = 5

_USUAL = (0.0, 0.1, 0.5, 1.0, 1.5, 2.0, 3.1, 6.2)
_ODD = (1e-308, 5e-324, 1e-12, 7.2, 40.0, 1e4, 1e12, 1e150, 1.7e308)
_TEXTS = {
    Dimension.LENGTH: ("400 mm", "sqrt(2)/10", "1e-3"),
    Dimension.ANGLE: ("pi/2", "-90 deg", "1/3", "360 deg"),
    Dimension.MASS: ("2 kg", "500 g"),
    Dimension.TORQUE: ("3 N*m", "1/3"),
    Dimension.TURN_RATE: ("90 deg/s", "2*pi"),
}


def make_section(rng: random.Random, name: str) -> dict[str, Any]:
    """A variation, right or wrong, as plain data for YAML.

    Args:
        rng: where chance comes from.
        name: the name of the variation.
    """
    of = rng.choice(tuple(JOINTS))
    rules = [make_rule(rng, of) for _ in range(rng.randint(1, MOST_RULES))]
    section: dict[str, Any] = {"name": name, "of": of, "vary": rules}
    grids = [rule for rule in rules if "grid" in rule]
    # Without a count there are as many variants as the grids have points: of several joints soon a million.
    if len(grids) != 1 or isinstance(grids[0].get("joints"), list) or grids[0].get("joints") == "all":
        section["count"] = rng.randint(1, MOST_VARIANTS)
    if rng.random() < 0.9:
        section["sampling"] = rng.choice([sampling.value for sampling in Sampling])
    if rng.random() < 0.7:
        section["seed"] = rng.choice((0, 1, 7, 2**64 - 1))
    return section


def make_rule(rng: random.Random, of: str, field: str | None = None, law: str | None = None) -> dict[str, Any]:
    """A rule for a field by a law; any of them where none is given."""
    field = field or rng.choice(tuple(FIELDS))
    law = law or rng.choice(("choices", "grid") if FIELDS[field].dimension is None else LAWS)
    rule: dict[str, Any] = {"field": field, law: _values(rng, of, field, law)}
    if field != AXES:
        rule["joints"] = _joints(rng, of)
    return rule


def _joints(rng: random.Random, of: str) -> Any:
    names = JOINTS[of]
    kind = rng.random()
    if kind < 0.4:
        return "all"
    if kind < 0.6:
        return rng.choice(names)
    if kind < 0.8:
        return rng.randint(1, len(names) + (rng.random() < 0.05))
    some = rng.sample(range(1, len(names) + 1), rng.randint(1, len(names)))
    return [number if rng.random() < 0.5 else names[number - 1] for number in some]


def _values(rng: random.Random, of: str, field: str, law: str) -> Any:
    if field == TYPE:
        return [rng.choice(JOINT_TYPES) for _ in range(rng.randint(1, 4))]
    if field == AXES:
        return [rng.randint(1, len(JOINTS[of])) for _ in range(rng.randint(1, 3))]
    return _numbers(rng, field, law)


def _numbers(rng: random.Random, field: str, law: str) -> Any:
    match law:
        case "choices":
            return [_number(rng, field) for _ in range(rng.randint(1, 4))]
        case "grid" if rng.random() < 0.4:
            return {"from": _number(rng, field), "to": _number(rng, field), "points": rng.randint(2, 4)}
        case "grid":
            return [_number(rng, field) for _ in range(rng.randint(1, 3))]
        case "normal":
            law_of: dict[str, Any] = {"deviation": abs(_plain(rng, "mass")), "bounds": _range(rng, field)}
            return law_of | ({"mean": _number(rng, field)} if rng.random() < 0.5 else {})
    return _range(rng, "mass" if law == "log-uniform" else field)


def _range(rng: random.Random, field: str) -> list[Any]:
    if rng.random() < 0.05:
        return [_number(rng, field), _number(rng, field)]
    return sorted((_plain(rng, field), _plain(rng, field)))


def _number(rng: random.Random, field: str) -> Any:
    dimension = FIELDS[field].dimension
    if rng.random() < 0.2:
        texts = _TEXTS.get(dimension) if dimension and rng.random() < 0.95 else None
        return rng.choice(texts or ("1 kg", "1/3", "nonsense", "0x10", "1e999"))
    return _plain(rng, field)


def _plain(rng: random.Random, field: str) -> float:
    """A number: mostly one that arms have, sometimes at the ends of what a double holds, or one that is refused."""
    size = rng.choice(_ODD) if rng.random() < 0.08 else rng.choice(_USUAL) if rng.random() < 0.4 else 3 * rng.random()
    what = FIELDS[field]
    if (what.positive or not what.negative) and rng.random() < 0.98:
        return size or 0.3
    return -size if rng.random() < 0.3 else size
