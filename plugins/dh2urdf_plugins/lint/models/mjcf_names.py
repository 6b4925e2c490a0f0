"""Rules about the names of an MJCF: each once among its kind, and all that are spoken of there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import did_you_mean, shown
from dh2urdf_plugins.lint.models.models import Hit, Model, elements_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

_BODIES = {"worldbody", "body", "frame", "replicate"}
_IN_BODIES = ("body", "joint", "freejoint", "geom", "site", "camera", "light")
_IN_ASSETS = ("mesh", "material", "texture", "hfield")
_MAKERS = ("composite", "flexcomp", "replicate", "attach", "plugin", "model")
"""Elements that make others, whose names no file has."""
_SECTIONS = {"actuator": "actuator", "sensor": "sensor", "equality": "equality"}
_JOINT_ATTRIBUTES = {"joint": "joint", "jointinparent": "joint", "joint1": "joint", "joint2": "joint"}
_BODY_ATTRIBUTES = {"body": "body", "body1": "body", "body2": "body"}
_SITE_ATTRIBUTES = {"site": "site", "site1": "site", "site2": "site", "refsite": "site", "cranksite": "site"}
_ASSETS = {"mesh": "mesh", "material": "material"}
_RULES = {"actuator": "actuator-of-nothing", "contact": "exclude-of-nothing"}


def hits(model: Model, *, complete: bool) -> Iterator[Hit]:
    """Findings about names; `complete`: every included file was read."""
    root = model.root
    names: dict[str, set[str]] = {"class": {"main"}, "body": {"world"}}
    for element in elements_of(root):
        parent = element.getparent()
        kind = _kind(element, parent)
        if element.tag == "default" and element.get("class"):
            names["class"].add(element.get("class") or "")
        name = element.get("name") or (_stem(element) if kind == "mesh" else None)
        if kind is None or not name:
            continue
        known = names.setdefault(kind, set())
        if name in known:
            rule = f"duplicate-{kind}" if kind in {"body", "joint"} else "duplicate-name"
            yield Hit(rule, element, f"another {kind} has the name {shown(name)}")
        known.add(name)
    if complete and not any(True for _ in elements_of(root, *_MAKERS)):
        yield from _references(root, names)


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


def _stem(mesh: etree._Element) -> str | None:
    file = mesh.get("file")
    return file.replace("\\", "/").rpartition("/")[2].rpartition(".")[0] if file else None


def _references(root: etree._Element, names: dict[str, set[str]]) -> Iterator[Hit]:
    for element in elements_of(root):
        parent = element.getparent()
        if parent is None:
            continue
        for attribute in ("class", "childclass") if element.tag != "default" else ():
            yield from _missing(element, attribute, "class", names, "undefined-class")
        if element.tag == "geom":
            for attribute, kind in _ASSETS.items():
                yield from _missing(element, attribute, kind, names, f"undefined-{kind}")
        section = _section(element)
        if section is None:
            continue
        for attribute, kind in {**_JOINT_ATTRIBUTES, **_BODY_ATTRIBUTES, **_SITE_ATTRIBUTES}.items():
            if attribute == "body" and section == "actuator":
                continue
            yield from _missing(element, attribute, kind, names, _RULES.get(section, "undefined-name"))


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
