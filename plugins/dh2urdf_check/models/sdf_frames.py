"""Rules about what the frames of an SDF are attached to and placed by, and about the two ends of a joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.models.models import Hit

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from lxml import etree


def hits(model: etree._Element, parts: Mapping[str, etree._Element], *, has_more: bool) -> Iterator[Hit]:
    """Findings about a model; `parts` are its links, joints, frames and models by name."""
    frames, holder, pose = {*parts, "__model__"}, model.getparent(), model.find("pose")
    if pose is not None and pose.get("relative_to") and holder is not None and holder.tag == "sdf":
        message = f"relative_to of model {shown(model.get('name') or '')} is {shown(pose.get('relative_to') or '')}"
        yield Hit("undefined-frame", pose, f"{message}, and the model is in no world", {"gazebo", "drake"})
    is_nested = holder is not None and holder.tag == "model"  # There, sdformat takes what is no link, too.
    links = {name for name, part in parts.items() if is_nested or part.tag == "link"}
    for attribute, known in (("canonical_link", links), ("placement_frame", frames)):
        if target := model.get(attribute):
            yield from undefined(model, attribute, target, known, has_more=has_more)
    for xyz in model.iterfind("joint//xyz[@expressed_in]"):
        if target := xyz.get("expressed_in"):
            for hit in undefined(xyz, "expressed_in", target, frames, has_more=has_more):
                yield hit._replace(of={"drake"})
    yield from _circles(parts)


def _circles(parts: Mapping[str, etree._Element]) -> Iterator[Hit]:
    """Frames that lead to themselves, and joints of one body."""
    attached = {
        name: onto
        for name, part in parts.items()
        if (onto := part.get("attached_to") if part.tag == "frame" else _text(part, "child"))
    }
    placed = attached | {
        name: target
        for name, part in parts.items()
        if (pose := part.find("pose")) is not None and (target := pose.get("relative_to"))
    }
    ends, ends_placed = _ends(attached), _ends(placed)
    for way, found, what in ((attached, ends, "attached to"), (placed, ends_placed, "placed by")):
        for name in way:
            if found[name] is None and (way is attached or ends.get(name, name) is not None):
                message = f"{parts[name].tag} {shown(name)} is {what} itself, by way of {shown(way[name])}"
                yield Hit("frame-cycle", parts[name], message)
    for name, part in parts.items():
        parent, child = _text(part, "parent"), _text(part, "child")
        if not parent or not child:
            continue
        if parent == name or (ends.get(parent) or parent) == (ends.get(child) or child):
            yield Hit("joint-of-one-link", part, f"joint {shown(name)} joins {shown(parent)} to {shown(child)}")


def _text(part: etree._Element, end: str) -> str:
    return (part.findtext(end) or "").strip() if part.tag == "joint" else ""


def _ends(way: Mapping[str, str]) -> dict[str, str | None]:
    """What each name leads to; None where that is a circle."""
    ends: dict[str, str | None] = {}
    for start in way:
        name, passed = start, dict[str, None]()
        while name in way and name not in ends and name not in passed:
            passed[name] = None
            name = way[name]
        end = None if name in passed else ends.get(name, name)
        ends.update(dict.fromkeys(passed, end))
    return ends


def undefined(
    at: etree._Element, attribute: str, target: str, frames: Collection[str], *, has_more: bool
) -> Iterator[Hit]:
    """A frame that is not in a model; with models in it that are not read, it may have any but the world."""
    if target not in frames and "::" not in target and (not has_more or target == "world"):
        owner = at.getparent() if at.tag == "pose" else at
        about = f"{attribute} of {owner.tag} {shown(owner.get('name') or '')}" if owner is not None else attribute
        near = did_you_mean(target, frames)
        message = f"{about} is {shown(target)}, which is not there"
        yield Hit("undefined-frame", at, f"{message}: {near}" if near else message)
