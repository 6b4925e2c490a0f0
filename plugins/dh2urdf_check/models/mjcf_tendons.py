"""Rules about the paths of an MJCF's tendons, as MuJoCo's compiler has them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from dh2urdf.source import shown
from dh2urdf_check.models.models import Hit, elements_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from dh2urdf_plugins.formats.mjcf.elements import Elements


def hits(root: etree._Element, elements: Elements) -> Iterator[Hit]:
    """Findings about every tendon; one about each."""
    kinds = {
        joint.get("name"): elements.attributes(joint).get("type", "hinge") if joint.tag == "joint" else "free"
        for joint in elements_of(root, "joint", "freejoint")
        if joint.get("name")
    }
    for tendon in root.iterfind("tendon/*"):
        path = list(tendon.iterchildren("*"))
        problems = _of_joints(path, kinds) if tendon.tag == "fixed" else _of_sites([*map(_wrap, path)])
        problem = "has no path" if not path else next(problems, None)
        if problem:
            yield Hit("tendon-path", tendon, f"tendon {shown(tendon.get('name') or '')} {problem}")


def _wrap(element: etree._Element) -> tuple[str, str]:
    return str(element.tag), element.get("site") or ""


def _of_joints(path: list[etree._Element], kinds: dict[str | None, str]) -> Iterator[str]:
    seen = set[str | None]()
    for joint in (each.get("joint") for each in path):
        if joint in seen:
            yield f"has the joint {shown(joint or '')} twice"
        if kinds.get(joint) in {"ball", "free"}:
            yield f"has the joint {shown(joint or '')}, which has several values"
        seen.add(joint)


def _of_sites(path: list[tuple[str, str]]) -> Iterator[str]:
    if len(path) == 1:
        yield "has a path of one element"
    if path[-1][0] == "pulley":
        yield "ends with a pulley"
    for first, second in pairwise(path):
        if first[0] == "pulley" and first[0] == second[0]:
            yield "has a pulley behind a pulley"
        if first[0] == "site" and first == second:
            yield f"has the site {shown(first[1])} twice in a row"
    between = [("pulley", ""), *path, ("pulley", "")]
    for before, (tag, name), after in zip(between[:-2], path, between[2:], strict=True):
        if tag == "geom" and not before[0] == after[0] == "site":
            yield "has a geom that is not between two sites"
        if tag == "site" and before[0] == after[0] == "pulley":
            yield f"has the site {shown(name)} alone between pulleys"
