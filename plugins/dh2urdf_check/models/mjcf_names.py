"""Rules about the names of an MJCF: each once among its kind, and all that are spoken of there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.errors import ProofError
from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.models.mjcf_compiled import MAKERS
from dh2urdf_check.models.models import Hit, Model, elements_of
from dh2urdf_plugins.formats.mjcf.elements import Elements

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

_BODIES = {"worldbody", "body", "frame", "replicate"}
_IN_BODIES = ("body", "joint", "freejoint", "geom", "site", "camera", "light")
_IN_ASSETS = ("mesh", "material", "texture", "hfield")
_SECTIONS = {"actuator": "actuator", "sensor": "sensor", "equality": "equality", "keyframe": "key"}
_OF_KINDS = {
    "joint": ("joint", "jointinparent", "joint1", "joint2"),
    "body": ("body", "body1", "body2", "subtree1", "subtree2"),
    "site": ("site", "site1", "site2", "refsite", "cranksite", "slidersite", "sidesite"),
    "geom": ("geom", "geom1", "geom2"),
    "tendon": ("tendon", "tendon1", "tendon2"),
    "actuator": ("actuator",),
    "camera": ("camera",),
}
_KINDS = {attribute: kind for kind, attributes in _OF_KINDS.items() for attribute in attributes}
"""What the attributes of constraints, actuators, sensors and tendons name."""
_OBJECTS = {"objname": "objtype", "refname": "reftype"}
"""Attributes that name a thing, and those that give its kind."""
_ASSETS = {
    "geom": {"mesh": "mesh", "material": "material", "hfield": "hfield"},
    **{tag: {"material": "material"} for tag in ("site", "spatial", "skin", "flex")},
    "material": {"texture": "texture"},
    "layer": {"texture": "texture"},
}
"""The assets that the attributes of elements name."""
OF_DRAKE = ("motor", "position")
"""The actuators that Drake reads."""
_RULES = {("actuator", "joint"): "actuator-of-nothing", ("contact", "body"): "exclude-of-nothing"}
_OF_ASSETS = {"mesh": "undefined-mesh", "material": "undefined-material"}


def hits(model: Model, *, complete: bool) -> Iterator[Hit]:
    """Findings about names; `complete`: every included file was read."""
    root = model.root
    names: dict[str, set[str]] = {"class": {"main"}, "body": {"world"}}
    for element in elements_of(root):
        parent = element.getparent()
        kind = _kind(element, parent)
        if element.tag == "default" and (of_class := element.get("class")):
            if of_class in names["class"] and parent is not None and parent.tag == "default":
                yield Hit("duplicate-name", element, f"another default class has the name {shown(of_class)}")
            names["class"].add(of_class)
        name = element.get("name") or (_stem(element) if kind in {"mesh", "texture", "hfield"} else None)
        if kind is None or not name:
            continue
        known = names.setdefault(kind, set())
        if name in known:
            rule = f"duplicate-{kind}" if kind in {"body", "joint"} else "duplicate-name"
            yield Hit(rule, element, f"another {kind} has the name {shown(name)}")
        known.add(name)
    if complete and not any(True for _ in elements_of(root, *MAKERS)):
        yield from _references(root, names)
        yield from _of_one(root)
        yield from _of_assets(Elements(root, str(model.path)), names)


def _kind(element: etree._Element, parent: etree._Element | None) -> str | None:
    """The set of names in which an element's name is; None where it names nothing."""
    if parent is None:
        return None
    if parent.tag in _BODIES and element.tag in _IN_BODIES:
        return "joint" if element.tag == "freejoint" else str(element.tag)
    if parent.tag == "asset" and element.tag in _IN_ASSETS:
        return str(element.tag)
    if parent.tag == "tendon":
        return "tendon"
    return _SECTIONS.get(str(parent.tag))


def _stem(asset: etree._Element) -> str | None:
    file = asset.get("file")
    return file.replace("\\", "/").rpartition("/")[2].rpartition(".")[0] if file else None


def _references(root: etree._Element, names: dict[str, set[str]]) -> Iterator[Hit]:
    for element in elements_of(root):
        parent = element.getparent()
        if parent is None:
            continue
        for attribute in ("class", "childclass") if element.tag != "default" else ():
            yield from _missing(element, attribute, "class", names, "undefined-class")
        section = _section(element)
        if section is None:
            continue
        for attribute, kind in _KINDS.items():
            by = "contact" if element.tag == "connect" else section
            for hit in _missing(element, attribute, kind, names, _RULES.get((by, kind), "undefined-name")):
                is_read = section != "actuator" or element.tag in OF_DRAKE
                yield hit if is_read else hit._replace(of={"mujoco"})
        for attribute, by in _OBJECTS.items():
            kind = (element.get(by) or "").removeprefix(
                "x"
            )  # A body's frame of inertia is called by body, its own xbody.
            if kind in {"body", "joint", "geom", "site", "camera", "tendon", "actuator"}:
                yield from _missing(element, attribute, kind, names, "undefined-name")


def _of_one(root: etree._Element) -> Iterator[Hit]:
    """Equalities of a thing with itself; Drake reads those of points alone."""
    for equality in root.iterfind("equality/*"):
        for kind in ("body", "joint", "site", "tendon", "geom"):
            one = equality.get(f"{kind}1")
            if one and one == equality.get(f"{kind}2"):
                of = {"mujoco", "drake"} if (equality.tag, kind) == ("connect", "body") else {"mujoco"}
                message = f"an equality of the {kind} {shown(one)} with itself"
                yield Hit("equality-with-itself", equality, message, of)


def _of_assets(elements: Elements, names: dict[str, set[str]]) -> Iterator[Hit]:
    """Assets that are not there; a default class may name one that no element of its takes."""
    wanted: set[tuple[str, str | None]] = set()
    named: list[tuple[etree._Element, str, str]] = []
    for element in elements_of(elements.root, *_ASSETS):
        parent = element.getparent()
        is_default = parent is not None and parent.tag == "default"
        for attribute, kind in _ASSETS[str(element.tag)].items():
            named.append((element, attribute, kind))
            if not is_default:
                wanted.add((kind, _taken(element, attribute, elements)))
    for element, attribute, kind in named:
        if (kind, element.get(attribute)) in wanted:
            for hit in _missing(element, attribute, kind, names, _OF_ASSETS.get(kind, "undefined-asset")):
                yield hit if element.tag == "geom" else hit._replace(of={"mujoco"})


def _taken(element: etree._Element, attribute: str, elements: Elements) -> str | None:
    """What an attribute is, that of its class included."""
    if element.get(attribute) is not None:
        return element.get(attribute)
    try:
        return elements.attributes(element).get(attribute)
    except ProofError:  # a class that is not there, of which another rule speaks
        return None


def _section(element: etree._Element) -> str | None:
    """The section of constraints, actuators or sensors that an element is in."""
    for above in element.iterancestors():
        if above.tag in {"actuator", "sensor", "equality", "contact", "tendon"}:
            return str(above.tag)
    return None


def _missing(
    element: etree._Element, attribute: str, kind: str, names: dict[str, set[str]], rule: str
) -> Iterator[Hit]:
    name, known = element.get(attribute), names.get(kind, set())
    if name and name not in known:
        near = did_you_mean(name, known)
        message = f"{attribute} of {element.tag} is {shown(name)}, and there is no such {kind}"
        yield Hit(rule, element, f"{message}: {near}" if near else message)
