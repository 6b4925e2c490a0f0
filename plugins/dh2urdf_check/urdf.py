"""A URDF as the rules see it: what its readers make of links, joints and addresses, as functions of XPath."""

from __future__ import annotations

import math
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.documents import is_file
from dh2urdf.kinematics.mass import principal_moments
from dh2urdf.manipulator import WORLD
from dh2urdf.source import shown
from dh2urdf_check.document import without_comments
from dh2urdf_check.finders import Document, text_of
from dh2urdf_check.links import MOVING, Links, half_sizes, implausible, is_refused_by_mujoco, law, tensor_of
from dh2urdf_check.meshes import MeshFile, is_found_by_pybullet, read_meshes, resolved
from dh2urdf_check.numbers import READ_BY, begun_numbers, drake_numbers, mujoco_numbers, numbers_of, urdfdom_numbers
from dh2urdf_check.rules import Hit, table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from dh2urdf_check.document import Parsed

_SIZES = {"size": 3, "radius": 1, "length": 1}
_MOST_BYTES = 2**27
"""Size of all mesh files of a description that are read [B]."""


class Urdf(Document):
    """A URDF: its links and joints, what moves as one body, and the files that it names."""

    def __init__(
        self,
        parsed: Parsed,
        path: Path,
        content: bytes,
        place: Callable[[etree._Element], str],
        packages: Mapping[str, Path],
    ) -> None:
        self.links = Links(parsed.root)
        self._packages = packages
        self._files: dict[str, Path | None] = {}
        super().__init__(parsed.root, path, self._functions_of(), place)
        self.text = without_comments(content.decode("latin-1"))

    def _functions_of(self) -> dict[str, Callable[..., Any]]:
        """The functions of XPath; those of links take the element of a link, or its name."""
        links = self.links
        compiler = links.root.find("mujoco/compiler")
        options: Mapping[str, str] = {} if compiler is None else compiler.attrib  # type: ignore[assignment]  # as texts
        fuses = options.get("fusestatic") != "false"  # MuJoCo merges what is fixed to the world into it.
        at_rest = [name for root in links.roots for name in links.body(root)] if fuses else links.roots
        static = {name for name in at_rest if fuses or name == WORLD}
        kinds = {joint.name: joint.kind for joint in links.joints}
        several = [joints for joints in links.holders.values() if len(joints) > 1]
        second = {joint.element for joints in several for joint in joints[1:]}
        hanging = links.reached & links.in_rings
        rings = {
            joint.element
            for joints in several
            if joints[0].child in hanging and any(each.parent in hanging for each in joints)
            for joint in joints[1:]
        }
        cut_off = {joint.child for joint in links.joints if joint.parent not in links.link}

        def kind_above(name: str) -> str:
            holder = links.holder(name)
            return holder.kind if holder else ""

        def of_link(holds: Callable[[str], Any]) -> Callable[..., Any]:
            def asked(_: object, found: Any) -> Any:  # noqa: ANN401 - what XPath has
                at = found[0] if isinstance(found, list) and found else found
                name = str(at.get("name")) if etree.iselement(at) else text_of(at)
                return holds(name) if name in links.link else False

            return asked

        def of_file(tell: Callable[[str], Any]) -> Callable[..., Any]:
            told = cache(tell)
            return lambda _, address: told(text_of(address))

        def of_element(tell: Callable[[etree._Element], Any], missing: object = "") -> Callable[..., Any]:
            return lambda _, found: tell(found[0]) if found else missing

        return {
            "moves": of_link(lambda name: kind_above(name) in MOVING),
            "is-fixed": of_link(lambda name: kind_above(name) == "fixed"),
            "is-held": of_link(lambda name: links.holder(name) is not None),
            "is-lost": of_link(lambda name: bool(links.roots) and name not in links.reached and name in links.holders),
            "merges-held": of_link(lambda name: links.holder(links.heads[name]) is not None),
            "moves-merged": of_link(lambda name: kind_above(links.heads[name]) in MOVING),
            "weightless": of_link(links.is_weightless),
            "light": of_link(links.is_light),
            "touches": of_link(self._touches),
            "massless-inertia": of_link(lambda name: self._law_of_merged(name) == "zero"),
            "kept": of_link(lambda name: name in links.kept),
            "refused-by-gazebo": of_link(lambda name: name in links.refused_by_gazebo),
            "without-centre": of_link(lambda name: name in links.without_centre),
            "holds-nothing": of_link(lambda name: name in links.holding_nothing),
            "implausible": of_element(implausible),
            "law": of_element(lambda at: "" if (tensor := tensor_of(at)) is None else law(tensor)),
            "is-sound": of_element(lambda at: (tensor := tensor_of(at)) is not None and not law(tensor), missing=False),
            "moments": of_element(_moments),
            "no-body": lambda _, found, moves: bool(found) and is_refused_by_mujoco(found[0], moves=moves),
            "least-size": self._least_size,
            "sides": of_element(lambda at: 2.0 * max(half_sizes(at) or (0.0,)), 0.0),
            "static": lambda _, name: text_of(name) in static,
            "kind": lambda _, name: kinds.get(text_of(name), ""),
            "is-second": of_element(lambda at: at in second, missing=False),
            "closes-a-ring": of_element(lambda at: at in rings, missing=False),
            "roots": lambda _: float(len(links.roots)),
            "is-cut-off": of_link(lambda name: name in cut_off),
            "root": lambda _: [links.link[name] for name in links.roots[:1]],
            "keeps-something": lambda _: bool(links.kept),
            "draws": lambda _: options.get("discardvisual") == "false",
            "fuses": lambda _: fuses,
            "colour": of_element(_colour),
            "defined": lambda _, name: self._defined.get(text_of(name), []),
            "file": of_file(self._state),
            "in-pybullet": of_file(lambda address: is_found_by_pybullet(address, self.path)),
            "mesh": lambda _, address, what: getattr(self._mesh(text_of(address)), what),
            "extent": self._extent,
        }

    def _touches(self, name: str) -> bool:
        """Whether MuJoCo computes a mass of the shapes of a link, or of one that is fixed to it."""
        found = [self.links.link[each] for each in self.links.body(name)]
        return any(each.find("inertial") is None and each.find("collision") is not None for each in found)

    def _law_of_merged(self, name: str) -> str:
        body = self.links.merged(self.links.body(self.links.heads[name]))
        return "" if body is None else law(body.inertia)

    def _least_size(self, context: Any, reader: str) -> float:  # noqa: ANN401 - what XPath has
        """The smallest of the sizes of a shape that a reader reads; infinite where it reads none."""
        texts = [(context.context_node.get(name), count) for name, count in _SIZES.items()]
        read = [READ_BY[reader](text, count) or () for text, count in texts if text is not None]
        return min((-1.0 if math.isnan(each) else each for numbers in read for each in numbers), default=math.inf)

    @cached_property
    def _defined(self) -> dict[str, list[etree._Element]]:
        """The first definition of each material."""
        found: dict[str, list[etree._Element]] = {}
        for material in (*self.links.root.iterfind("material"), *self.links.root.iterfind("link/visual/material")):
            if material.getparent() is self.links.root or len(material):
                found.setdefault(material.get("name") or "", [material])
        return found

    # --- Files --------------------------------------------------------------------------------------------------------

    def _resolved(self, address: str) -> Path | None:
        if address not in self._files:
            self._files[address] = resolved(address, self.path, self._packages)
        return self._files[address]

    def _state(self, address: str) -> str:
        """Of the file that an address means: `there`, `missing`, or `package` where its package is not found."""
        path = self._resolved(address)
        return "package" if path is None else "there" if is_file(path) else "missing"

    @cached_property
    def _meshes(self) -> dict[Path, MeshFile]:
        """What is in the mesh files that are there, up to a size of them all."""
        paths: dict[Path, None] = {}
        left = _MOST_BYTES
        for mesh in self.root.iter("mesh"):
            path = self._resolved(mesh.get("filename") or "")
            if path and path not in paths and is_file(path) and (left := left - path.stat().st_size) >= 0:
                paths[path] = None
        return read_meshes(paths)

    def _mesh(self, address: str) -> MeshFile:
        path = self._resolved(address)
        return self._meshes.get(path, MeshFile()) if path else MeshFile()

    def _extent(self, context: Any) -> float:  # noqa: ANN401 - what XPath has
        """The longest side of a mesh as it is used [m]; 0 where it is not known."""
        file = self._mesh(context.context_node.get("filename") or "")
        factors = numbers_of(context.context_node.get("scale"), 3) or (1.0, 1.0, 1.0)
        sides = file.sides or (0.0, 0.0, 0.0)
        return max(abs(file.unit * side * factor) for side, factor in zip(sides, factors, strict=True))


def _moments(inertia: etree._Element) -> str:
    """The principal moments of an inertia, as a sentence has them."""
    tensor = tensor_of(inertia)
    if tensor is None:
        return "those of no body"
    low, middle, high = principal_moments(tensor)
    return f"{low:.6g}, {middle:.6g} and {high:.6g} kg·m²"


def _colour(material: etree._Element) -> str:
    """What a material looks like, whatever its name."""
    colour, texture = material.find("color"), material.find("texture")
    numbers = begun_numbers((colour.get("rgba") if colour is not None else None) or "")
    return f"{numbers} {texture.get('filename') if texture is not None else None}"


# --- What each reader does with a text that is no plain number --------------------------------------------------------


_URDFDOM = frozenset({"pinocchio", "ros", "gazebo"})
"""The readers that have urdfdom."""
_ALL = frozenset({"pybullet", "mujoco", "drake"}) | _URDFDOM


def number_hits(document: Urdf) -> Iterator[Hit]:
    """Findings about every number at the places of ``rules/numbers.yaml``."""
    for place in table("numbers")["places"]:
        for element in document.select(place["at"]):
            for attribute, count in place["numbers"].items():
                text = element.get(attribute)
                if text is None:
                    continue
                if numbers_of(text, count) is None or urdfdom_numbers(text, count) is None:
                    yield from _misread(document, element, place, attribute, count)
                if place.get("alone") and text != text.strip() and numbers_of(text, 1):
                    message = f"{attribute} of {element.tag} is {shown(text)}, with blanks around the number"
                    yield Hit("misread-number", element, message, frozenset({"coppeliasim"}))


def _misread(
    document: Urdf, element: etree._Element, place: dict[str, str], attribute: str, count: int
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
