"""Rules about the numbers of an MJCF that MuJoCo or Drake wants to be above or below something."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.source import shown
from dh2urdf_check.models.models import Hit, numbers
from dh2urdf_check.numbers import drake_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from lxml import etree


class _Bound(NamedTuple):
    """What a number may be.

    Attributes:
        of: the reader that minds; ``both`` for MuJoCo and Drake.
        least: the smallest number, or the one that it has to be above.
        above: whether it has to be above that one.
        below: what it has to be below.
        in_defaults: whether the reader minds in default classes, too.
    """

    of: str
    least: float = 0.0
    above: bool = False
    below: float = float("inf")
    in_defaults: bool = True


_MUJOCO, _DRAKE = _Bound("mujoco"), _Bound("drake")
_POSITIVE, _BOTH = _Bound("mujoco", above=True), _Bound("both", in_defaults=False)
_BOUNDS: dict[str, dict[str, _Bound]] = {
    "joint": {"damping": _DRAKE},
    "geom": {"friction": _DRAKE, "mass": _BOTH, "density": _BOTH},
    "spatial": {"width": _MUJOCO, "armature": _MUJOCO},
    "fixed": {"armature": _MUJOCO},
    "pulley": {"divisor": _POSITIVE},
    "sensor": {"noise": _MUJOCO, "cutoff": _MUJOCO},
    "position": {"kv": _MUJOCO, "dampratio": _MUJOCO, "timeconst": _MUJOCO, "kp": _DRAKE},
    "adhesion": {"ctrlrange": _MUJOCO},
    "damper": {"ctrlrange": _MUJOCO},
    "camera": {"fovy": _Bound("mujoco", least=float("-inf"), below=180.0, in_defaults=False)},
    "hfield": {"size": _POSITIVE},
    "mesh": {"maxhullvert": _Bound("mujoco", least=4.0)},
    "statistic": {"extent": _POSITIVE},
    "map": {"znear": _POSITIVE},
    "size": {"nconmax": _Bound("mujoco", least=-1.0), "nuserdata": _MUJOCO},
}
"""By element, or by the section that it is in."""


def hits(element: etree._Element, *, is_of_no_use: Callable[[etree._Element, str], bool]) -> Iterator[Hit]:
    """Findings about one element; `is_of_no_use` tells whether Drake passes over an attribute."""
    above = element.getparent()
    section = str(above.tag) if above is not None else ""
    tag = str(element.tag)
    about = f"{tag} {shown(element.get('name') or '')}" if element.get("name") else f"a {tag}"
    for name, bound in _BOUNDS.get(tag if tag in _BOUNDS and section != "equality" else section, {}).items():
        read = drake_numbers(text := element.get(name) or "")
        read = read if (tag, name) == ("hfield", "size") else read[:1]
        is_low = any(value <= bound.least if bound.above else value < bound.least for value in read)
        if not (is_low or any(value >= bound.below for value in read)) or (
            section == "default" and not bound.in_defaults
        ):
            continue
        what = f"{name} of {about} is {shown(text)}"
        if bound.of == "drake" or (bound.of == "both" and not is_of_no_use(element, "mass")):
            yield Hit("out-of-range", element, f"{what}, which is below 0")
        if bound.of != "drake":
            limit = f"above {bound.least:g}" if bound.above else f"{bound.least:g} or more"
            limit = limit if is_low else f"below {bound.below:g}"
            yield Hit("negative-number", element, f"{what}; it has to be {limit}", {"mujoco"})
    colour = numbers(element.get("rgba"), 4) if tag == "geom" else None
    if colour and not all(0.0 <= part <= 1.0 for part in colour):
        text = shown(element.get("rgba") or "")
        yield Hit("out-of-range", element, f"rgba of {about} is {text}", {"drake"})
