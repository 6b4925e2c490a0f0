"""Texts of a URDF that are no plain numbers, and what each reader does with them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import shown
from dh2urdf_check.numbers import drake_numbers, mujoco_numbers, numbers_of, urdfdom_numbers
from dh2urdf_check.rules import Hit, table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from dh2urdf_check.finders import Document

_URDFDOM = frozenset({"pinocchio", "ros", "gazebo"})
"""The readers that have urdfdom."""
_ALL = frozenset({"pybullet", "mujoco", "drake"}) | _URDFDOM


def hits(document: Document) -> Iterator[Hit]:
    """Findings about every number at the places of ``rules/numbers.yaml``."""
    for place in table("numbers")["places"]:
        for element in document.select(place["at"]):
            for attribute, count in place["numbers"].items():
                text = element.get(attribute)
                if text is None:
                    continue
                if numbers_of(text, count) is None or urdfdom_numbers(text, count) is None:
                    yield from _said(document, element, place, attribute, count)
                if place.get("alone") and text != text.strip() and numbers_of(text, 1):
                    message = f"{attribute} of {element.tag} is {shown(text)}, with blanks around the number"
                    yield Hit("misread-number", element, message, frozenset({"coppeliasim"}))


def _said(
    document: Document, element: etree._Element, place: dict[str, str], attribute: str, count: int
) -> Iterator[Hit]:
    """What each reader that reads an attribute does with it, which is not plain numbers."""
    text = element.get(attribute) or ""

    def holds(path: str | None) -> bool:
        return path is not None and bool(document.select(f"boolean({path})", element))

    readers = _ALL - {reader for reader in _ALL if holds(place.get(f"not read by {reader}"))}
    readers = _URDFDOM if "urdfdom alone" in place else readers
    is_required, is_plain = "required" in place, numbers_of(text, count) is not None
    refused = set(_URDFDOM) if urdfdom_numbers(text, count) is None and "in a joint" in place else set()
    if not is_plain:
        if (mujoco_numbers(text, count) is None and (is_required or text.strip())) or holds(place.get("no body")):
            refused.add("mujoco")
        if drake_numbers(text, 0 if attribute == "scale" else count) is None:
            refused.add("drake")
        if element.tag == "axis" and len([word for word in text.split(" ") if word]) < count:
            refused.add("pybullet")
    refused &= readers
    kind, what = ("number", "one finite number") if count == 1 else ("vector", f"{count} finite numbers")
    what = ": urdfdom takes blanks between numbers alone" if is_plain else f", not {what}"
    message = f"{attribute} of {element.tag} is {shown(text)}{what}"
    of_all = {"coppeliasim"} if not is_plain and readers & {"pybullet", "drake"} else set()
    if refused or (of_all and kind == "number"):
        yield Hit(f"invalid-{kind}", element, message, frozenset(refused | of_all))
        of_all = set()
    misread = readers - refused - (set() if urdfdom_numbers(text, count) is None else _URDFDOM)
    misread &= _URDFDOM if is_plain else _ALL
    if misread:
        yield Hit(f"misread-{kind}", element, message, frozenset(misread | of_all))
