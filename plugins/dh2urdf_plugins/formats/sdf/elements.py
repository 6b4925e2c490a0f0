"""What a reader of SDF asks of its elements: words, numbers and poses, and where they are at q = 0.

Models of older versions of SDF in the words of version 1.7, as sdformat converts them. From the specifications of these
versions (http://sdformat.org/spec): before 1.7 the attribute of a pose for the frame that it is in was ``frame``. The
axis of a joint was in the frame of its model with ``use_parent_model_frame``, and before 1.5 always; sdformat keeps
that to models that are in no other, since these versions had no models in models.

From the specification (http://sdformat.org/tutorials, "Pose Frame Semantics" and "Model Composition"): a pose is
relative to the frame that it names, else a joint's to its child, a frame's to what it is attached to, and a link's to
the model. The frame of a model is ``__model__``; it moves with the model's canonical link, the first one where none is
named. What is in the model ``n`` of a model is called ``n::…`` outside of it, and the frame of the model is called
``n``: `flatten` makes one model of them.
"""

from __future__ import annotations

from collections import defaultdict
from math import radians
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.manipulator import WORLD
from dh2urdf.robot import Origin
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf_plugins.formats.xml_files import D, FileElements

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

MODEL = "__model__"
"""The frame of the model that an element is in."""
IN_MODEL = "use_parent_model_frame"
"""The element of an axis that said whether the axis is in the frame of the model."""
_OWN_AXES_SINCE = (1, 5)
FRAMES_SINCE = (1, 7)
LONGEST_VERSION = 20
"""Characters of the text of a version that are looked at."""
PLACED_BY = "placement_frame"
"""The attribute of a model, and of the frame that is made of it, with the frame whose pose the pose of the model is."""
AT_INCLUDED = "at an included model"
"""The type of a joint whose parent is in a model that is not read."""
_NAMED = ("link", "joint", "frame")


class SdfElements(FileElements):
    """Reads the elements of one file."""

    def name(self, element: etree._Element) -> str:
        """The name of an element."""
        return self.text(element, "name")

    def word(self, element: etree._Element, tag: str) -> str:
        """The text of a child."""
        return (self.child(element, tag).text or "").strip()

    def pose(self, element: etree._Element) -> RigidTransform:
        """The pose of an element in the frame that it names."""
        return self.origin(element).transform

    def origin(self, element: etree._Element) -> Origin:
        """The pose of an element as it is written."""
        pose = element.find("pose")
        if pose is None or not (text := pose.text) or text.isspace():  # It is where the frame is that it names.
            return Origin()
        if pose.get("rotation_format") == "quat_xyzw":
            x, y, z, *quaternion = self.read(element, "pose", text, 7)
            return Origin.of(RigidTransform(self.quaternion(element, quaternion), (x, y, z)))
        x, y, z, roll, pitch, yaw = self.read(element, "pose", text, 6)
        if is_true(pose.get("degrees")):
            roll, pitch, yaw = radians(roll), radians(pitch), radians(yaw)
        return Origin(xyz=(x, y, z), rpy=(roll, pitch, yaw))

    def number(self, element: etree._Element, path: str, default: D) -> float | D:
        """A number below an element; the default where there is none."""
        return default if element.find(path) is None else self.numbers(element, path, 1)[0]

    def numbers(
        self, element: etree._Element, path: str, count: int, default: Sequence[float] | None = None
    ) -> Sequence[float]:
        """As many numbers below an element as the count; the default where there are none."""
        found = element.find(path)
        if found is None and default is not None:
            return default
        text = (found.text if found is not None else None) or ""
        if "limit/" in path and text.strip().lstrip("+-").lower() in ("inf", "infinity"):
            return [float(text)]  # There is no limit.
        return self.read(element, path, text, count)


def is_true(word: str | None) -> bool:
    """Whether a word is that of SDF for true."""
    return (word or "").strip().lower() in {"1", "true"}


def modernise(root: etree._Element) -> None:
    """Writes the poses and axes of a file as version 1.7 has them; the elements are changed."""
    words = (root.get("version") or "")[:LONGEST_VERSION].split(".")
    version = tuple(int(word) for word in words if word.isdecimal())
    if not version or version >= FRAMES_SINCE:
        return
    for pose in root.iter("pose"):
        if frame := pose.get("frame"):
            pose.set("relative_to", frame)
    for axis in root.iter("axis"):
        xyz, word = axis.find("xyz"), axis.find(IN_MODEL)
        is_nested = len(list(axis.iterancestors("model"))) > 1
        is_old = version < _OWN_AXES_SINCE and not is_nested
        if xyz is not None and (is_old if word is None else is_true(word.text)):
            xyz.set("expressed_in", MODEL)
        if word is not None:
            axis.remove(word)


def flatten(model: etree._Element) -> str | None:
    """Takes the links, joints and frames of nested models into a model, and returns its canonical link.

    That is the one that it names, else its first own link, else that of the first model in it.
    """
    canonical = model.get("canonical_link") or next((link.get("name") for link in model.iterchildren("link")), None)
    for inner in model.findall("model"):
        name, includes = inner.get("name", ""), inner.find(".//include") is not None
        own = flatten(inner)
        carrier = own or (AT_INCLUDED if includes else None)
        frame = etree.Element("frame", name=name, attached_to=f"{name}::{carrier}" if carrier else MODEL)
        canonical = canonical or (f"{name}::{own}" if own else None)
        frame.sourceline = inner.sourceline
        if placed := inner.get(PLACED_BY):
            frame.set(PLACED_BY, _outside(placed, name))
        frame.extend(inner.findall("pose"))
        _place_in(frame, MODEL)
        children = list(inner.iterchildren(*_NAMED))
        for child in children:
            _rename(child, name)
        for child in [frame, *children]:
            inner.addprevious(child)
        model.remove(inner)
    return canonical


def leave_out_attached(model: etree._Element, not_read: Callable[[etree._Element, str], None]) -> None:
    """Takes joints and frames out of a model that includes others, where they are at what is not in it.

    A joint that moves what is in the model stays, as one of the type `AT_INCLUDED`, so that nobody takes what is behind
    it for held by the world. `not_read` takes each of the others, and the words for it.
    """
    known = {element.get("name") for element in model.iterchildren(*_NAMED)} | {MODEL, WORLD}
    parts = list(model.iterchildren("joint", "frame"))
    at: defaultdict[str | None, list[etree._Element]] = defaultdict(list)
    for each in parts:
        for target in _references(each):
            at[target].append(each)
    for each in parts:  # Behind them come those at what is left out.
        if each.getparent() is not model or _references(each) <= known:
            continue
        not_read(each, f"a {each.tag} at an included model")
        if (name := each.get("name")) in known:
            known.discard(name)
            parts += at[name]
        child = each.find("child")
        if child is not None and (child.text or "").strip() in known:
            each[:] = [child]
            etree.SubElement(each, "parent").text = WORLD
            each.set("type", AT_INCLUDED)
        else:
            model.remove(each)


def _references(element: etree._Element) -> set[str]:
    """What the place of a joint or frame, and its axis, depend on."""
    named = [
        *((end.text or "").strip() for end in element.iterchildren("parent", "child")),
        element.get("attached_to"),
        *(pose.get("relative_to") for pose in element.iterchildren("pose")),
        *(axis.get("expressed_in") for axis in element.iterfind("axis/xyz")),
    ]
    return {name for name in named if name}


def _rename(element: etree._Element, name: str) -> None:
    """Makes an element of the model `name` one of the model around that."""
    element.set("name", _outside(element.get("name"), name))
    if element.tag == "frame":
        element.set("attached_to", _outside(element.get("attached_to"), name))
    for each in element.iter("parent", "child"):
        each.text = _outside((each.text or "").strip(), name)
    for each in element.iter("mimic", "pose", "xyz", "frame"):
        for attribute in ("joint", "relative_to", "expressed_in", PLACED_BY):
            if each.get(attribute):
                each.set(attribute, _outside(each.get(attribute), name))
    if element.tag == "link":
        _place_in(element, name)


def _place_in(element: etree._Element, frame: str) -> None:
    """Has the pose of an element name the frame that it is in, unless it names one."""
    pose = element.find("pose")
    if pose is None:
        pose = etree.SubElement(element, "pose")
    pose.set("relative_to", pose.get("relative_to") or frame)


def _outside(word: str | None, name: str) -> str:
    """What the model around the model `name` calls something in that."""
    return WORLD if word == WORLD else name if word in {None, "", MODEL} else f"{name}::{word}"


class _Place(NamedTuple):
    """Where a link, joint or frame of a model is."""

    kind: str  # which of the three
    reference: str  # the frame that its pose is relative to
    pose: RigidTransform  # its frame in that one
    moves_with: str  # what a joint or frame is rigidly joined to


class Places:
    """The places of everything in a model that `flatten` has flattened, with its canonical link."""

    def __init__(self, elements: SdfElements, model: etree._Element, canonical: str | None) -> None:
        self._elements, self._model = elements, model
        self._canonical = canonical or WORLD
        self._bodies: dict[str, str] = {}  # what `body` has found, so that a chain of frames is walked once
        self._rest: dict[str, RigidTransform] = {}  # what `_at_rest` has found in the model
        self._links = {elements.name(link) for link in model.iterchildren("link")}
        self._places = dict[str, _Place]()
        for element in [each for tag in _NAMED for each in model.iterchildren(tag)]:
            # A link has no such attribute, and is placed in the model; so is a frame that has none.
            is_joint = element.tag == "joint"
            moves_with = elements.word(element, "child") if is_joint else element.get("attached_to") or MODEL
            pose = element.find("pose")
            reference = (None if pose is None else pose.get("relative_to")) or moves_with
            place = _Place(str(element.tag), reference, elements.pose(element), moves_with)
            self._places[self.key(element)] = place
        placed = {elements.name(each): by for each in model.iterchildren("frame") if (by := each.get(PLACED_BY))}
        for name in sorted(placed, key=lambda name: -name.count("::")):  # The innermost models first.
            place = self._places[name]
            self._places[name] = place._replace(pose=place.pose @ self._at_rest(placed[name], name).inverse)
        self._in_world = self._model_in_world()
        if by := model.get(PLACED_BY):
            self._in_world = self._in_world @ self._at_rest(by).inverse

    def key(self, element: etree._Element) -> str:
        """The name by which an element is found.

        Before version 1.7 a joint may have that of a link. One whose parent is not read has a place that nobody knows.
        """
        name = self._elements.name(element)
        is_joint = element.tag == "joint" and (name in self._links or element.get("type") == AT_INCLUDED)
        return f"joint {name}" if is_joint else name

    def holder(self, name: str, body: str) -> str:
        """What holds a link or frame: the frame that it is posed in, where that is on the same body, else the body."""
        reference = self._places[name].reference
        is_link = reference in self._places and self._places[reference].kind != "joint"
        return reference if is_link and self.body(reference) == body else body

    def body(self, name: str) -> str:
        """The link, or the world, that a frame is rigidly joined to."""
        way: dict[str, None] = {}
        while name not in self._bodies and name != WORLD:
            place = None if name == MODEL else self._known(name)
            if place is not None and place.kind == "link":
                break
            way[name] = None
            name = self._canonical if place is None else place.moves_with
            if name in way:
                raise self._elements.error(self._model, "frame-of-itself", name=name)
        body = self._bodies.get(name, name)
        self._bodies.update(dict.fromkeys(way, body))
        return body

    def rest_in_world(self) -> None:
        """What is in the model is in the world, since no joint moves its canonical link."""
        self._canonical = WORLD
        self._bodies.clear()

    def between(self, base: str, name: str) -> RigidTransform:
        """The pose of one frame in another at q = 0; where it is written so, without a rounding."""
        if base == WORLD and self._in_world != IDENTITY:
            return self._in_world @ self.between(MODEL, name)
        if name in (WORLD, MODEL):
            out = self._in_world.inverse if name == WORLD else IDENTITY
            return self._at_rest(base).inverse @ out
        place = self._known(name)
        if place.reference == base or {place.reference, base} <= {WORLD, MODEL}:
            return place.pose
        if base in self._places and self._places[base].reference == name:
            return self._places[base].pose.inverse
        return self._at_rest(base).inverse @ self._at_rest(name)

    def _at_rest(self, name: str, base: str = MODEL) -> RigidTransform:
        """The pose of a frame in the model, or in a frame that it is placed by, at q = 0."""
        found = self._rest if base == MODEL else {base: IDENTITY}
        way: dict[str, _Place] = {}
        while name not in found and name not in {WORLD, MODEL}:
            way[name] = place = self._known(name)
            name = place.reference
            if name in way:
                raise self._elements.error(self._model, "pose-of-itself", name=name)
        pose = found.get(name, IDENTITY)
        for each, place in reversed(way.items()):
            pose = found[each] = pose @ place.pose
        return pose

    def _known(self, name: str) -> _Place:
        if name not in self._places:
            raise self._elements.error(self._model, "frame-unknown", name=name)
        return self._places[name]

    def _model_in_world(self) -> RigidTransform:
        """The pose of the model in its world, by the frames and models of the world that it is relative to."""
        around = self._model.getparent()
        others = {} if around is None else {each.get("name"): each for each in around.iterchildren("frame", "model")}
        pose, at, seen = IDENTITY, self._model, {self._model}
        while True:
            own = at.find("pose")
            pose = self._elements.pose(at) @ pose
            named = (None if own is None else own.get("relative_to")) or at.get("attached_to") or WORLD
            if named == WORLD:
                return pose
            if (onto := others.get(named)) is None or onto in seen or (onto.tag == "model" and onto.get(PLACED_BY)):
                raise self._elements.error(self._model, "model-placed-elsewhere", name=named)
            seen.add(onto)
            at = onto
