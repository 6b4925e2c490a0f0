"""Rules about names, and about the tree that links and joints are."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.manipulator import WORLD
from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.document.description import ALL, MOVING, TYPES, Hit, few
from dh2urdf_check.gazebo import kept

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description, JointNode
    from dh2urdf_check.document.tree import Element

_BLANKS = " \t\n"
"""What sdformat takes from the ends of a name."""
_RESERVED = re.compile(r"world|__.*__", re.DOTALL)


def hits(description: Description) -> Iterator[Hit]:
    """Findings about names and the tree."""
    yield from _robot_name(description)
    yield from _names(description)
    yield from _shared_names(description)
    yield from _ends(description)
    yield from _tree(description)


def _robot_name(description: Description) -> Iterator[Hit]:
    root = description.root
    if not root.get("name"):
        of = ALL if root.get("name") is None else frozenset({"drake", "gazebo"})
        yield Hit("robot-without-name", root, "the robot has no name", of)
    elif not (root.get("name") or "").strip():
        yield Hit("robot-without-name", root, "the name of the robot is blank", {"gazebo"})


def _has_its_name(element: Element, heads: set[str]) -> bool:
    """Whether sdformat asks for the name of a link or joint: those of what it merges into the link above are gone."""
    child = element.first("child")
    return (element.get("name") if element.tag == "link" else child and child.get("link")) in heads


def _names(description: Description) -> Iterator[Hit]:
    root = description.root
    heads = {body[0].name for body in description.once(kept)}
    is_only_link = len(root.all("link")) == 1
    nameless_joints = [joint.get("name") for joint in root.all("joint")].count("")
    for element in root.children:
        kind, name = element.tag, element.get("name")
        if kind not in {"link", "joint"}:
            continue
        if not name:
            alone = kind == "link" and is_only_link  # urdfdom calls it by the empty name then
            takers = {"pinocchio", "ros"} if alone else set()
            if kind == "link" and name is not None:
                takers.add("mujoco")
            if kind == "joint" and name is not None:
                takers = {"mujoco", "drake"}
                if nameless_joints == 1:
                    takers |= {"pinocchio", "ros"} | (set() if _has_its_name(element, heads) else {"gazebo"})
            yield Hit("missing-name", element, f"a {kind} has no name", ALL - takers)
            continue
        if not name.strip(_BLANKS) and _has_its_name(element, heads):
            yield Hit("missing-name", element, f"the name of a {kind} is blank", {"gazebo"})


def _shared_names(description: Description) -> Iterator[Hit]:
    """Names of links and joints that SDF keeps, and of the model, that collide or that SDF has for itself."""
    heads = {body[0].name: body[0] for body in description.once(kept)}
    joints = [joint for joint in description.joints if joint.child in heads and joint.parent in description.link]
    for joint in joints:
        if joint.name in heads:
            yield Hit("joint-named-like-link", joint.element, f"joint {shown(joint.name)} has the name of a link")
    named = [("joint", joint.name, joint.element) for joint in joints]
    named += [("link", name, head.element) for name, head in heads.items() if name != WORLD]
    for kind, name, element in [("robot", description.root.get("name") or "", description.root), *named]:
        if _RESERVED.fullmatch(name):
            yield Hit("reserved-name", element, f"the name of a {kind} is {shown(name)}", {"gazebo"})
    if world := description.link.get(WORLD):
        of = {"gazebo"} if WORLD in heads else set[str]()
        of |= {"mujoco"} if any(joint.kind in MOVING for joint in description.holders.get(WORLD, ())) else set()
        yield Hit("reserved-name", world.element, f"the link {shown(WORLD)} is not the root", of)


def _ends(description: Description) -> Iterator[Hit]:
    """A joint is of a known type and between two links."""
    has_nameless_link = any(link.get("name") == "" for link in description.root.all("link"))
    for joint in description.joints:
        yield from _type(joint)
        about = f"joint {shown(joint.name)}"
        for end, name in (("parent", joint.parent), ("child", joint.child)):
            found = joint.element.first(end)
            if not name and (found is None or found.get("link") is None):
                yield Hit("missing-parent-or-child", joint.element, f"{about} has no {end}")
            elif not name:
                of = ALL - {"mujoco"} if has_nameless_link else None
                yield Hit("empty-parent-or-child", joint.element, f"the {end} of {about} is an empty name", of)
            elif name not in description.link:
                near = did_you_mean(name, description.link)
                message = f"the {end} of {about} is {shown(name)}, and there is no such link"
                of = ALL - {"drake"} if name == WORLD else None
                yield Hit("undefined-link", found or joint.element, f"{message}: {near}" if near else message, of)


def _type(joint: JointNode) -> Iterator[Hit]:
    if joint.kind in TYPES:
        return
    near = did_you_mean(joint.kind, TYPES)
    message = f"joint {shown(joint.name)} has " + (f"the type {shown(joint.kind)}" if joint.kind else "no type")
    refusing = ALL - {"drake"} if joint.element.get("type") == "" else ALL
    if joint.kind == "spherical":
        refusing -= {"pybullet"} if _is_limited(joint) else {"pybullet", "mujoco"}
    yield Hit("unknown-joint-type", joint.element, f"{message}: {near}" if near else message, refusing)


def _is_limited(joint: JointNode) -> bool:
    """Whether the range of a ball joint begins elsewhere than at 0, which MuJoCo minds."""
    limit = joint.element.first("limit")
    lower, upper = (limit.number(name) if limit else None for name in ("lower", "upper"))
    return bool(lower) and upper is not None and lower is not None and lower < upper


def _tree(description: Description) -> Iterator[Hit]:
    if not description.root.all("link"):
        yield Hit("no-link", description.root, "the robot has no link")
    cut_off = {joint.child for joint in description.joints if joint.parent not in description.link}
    for root in description.roots[1:]:
        if root.name in cut_off:  # the finding of the joint reports it
            continue
        message = f"no joint connects link {shown(root.name)} with {shown(description.roots[0].name)}"
        yield Hit("several-roots", root.element, message)
    if description.link and not description.roots:
        yield Hit("no-root", description.links[0].element, "every link hangs from another, in a circle")
        return
    yield from _several_parents(description)
    reached = description.reached()
    circle = [
        joint for joint in description.joints if joint.child in description.holders and joint.child not in reached
    ]
    if circle:
        yield Hit(
            "cycle",
            circle[0].element,
            f"the links {few(joint.child for joint in circle)} hang from each other in a circle",
        )


def _several_parents(description: Description) -> Iterator[Hit]:
    if all(len(joints) == 1 for joints in description.holders.values()):
        return
    reached, rings, closes = description.reached(), description.rings(), _closes_a_loop(description)
    for name, joints in description.holders.items():
        hangs = name in reached and any(rings[joint.parent] == rings[name] for joint in joints)
        for joint in joints[1:]:
            message = f"joint {shown(joint.name)} moves link {shown(name)}, as joint {shown(joints[0].name)} does"
            if hangs:
                yield Hit("cycle-from-root", joint.element, f"{message}, and hangs from it")
            else:
                yield Hit("several-parents", joint.element, message, None if closes else ALL - {"drake"})


def _closes_a_loop(description: Description) -> bool:
    """Whether joints connect links in a ring, whichever end of a joint is called its parent."""
    group = {name: name for name in description.link}

    def head(name: str) -> str:
        while group[name] != name:
            group[name] = group[group[name]]  # halves the way
            name = group[name]
        return name

    for joints in description.holders.values():
        for joint in joints:
            parent, child = head(joint.parent), head(joint.child)
            if parent == child:
                return True
            group[child] = parent
    return False
