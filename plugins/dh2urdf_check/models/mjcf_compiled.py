"""Rules about what only MuJoCo's compiler asks of an MJCF: its poses, masses, keyframes and files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.documents import is_file
from dh2urdf.errors import ProofError
from dh2urdf.source import shown
from dh2urdf_check.models.mjcf_meshes import format_hits, hits as hits_of_meshes
from dh2urdf_check.models.mjcf_needs import hits as hits_of_needs
from dh2urdf_check.models.mjcf_tendons import hits as hits_of_tendons
from dh2urdf_check.models.models import Hit, Model, elements_of, numbers
from dh2urdf_check.numbers import mujoco_numbers
from dh2urdf_plugins.formats.mjcf.elements import Elements, compiler_of
from dh2urdf_plugins.formats.mjcf.shapes import WITHOUT_MASS
from dh2urdf_plugins.formats.xml_files import mark_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from lxml import etree

MAKERS = ("composite", "flexcomp", "replicate", "attach", "plugin", "model")
"""Elements that make others, which no file has."""
_CHANGES_MASSES = ("boundmass", "boundinertia", "balanceinertia")
_FILES = {
    "mesh": ("meshdir", ("file",)),
    "hfield": ("meshdir", ("file",)),
    "skin": ("meshdir", ("file",)),
    "texture": ("texturedir", ("file", *(f"file{side}" for side in ("right", "left", "up", "down", "front", "back")))),
}
MEASURES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}
"""How many sizes a geom needs; one with `fromto`, the radius."""
_SIZES = {"free": (7, 6), "ball": (4, 3)}
"""Positions and velocities of joints that have several."""


def changes_masses(compiler: Mapping[str, str]) -> bool:
    """Whether the compiler makes other masses and inertias of those that are written."""
    return any((compiler.get(name) or "0").strip() not in {"0", "false", ""} for name in _CHANGES_MASSES)


def hits(model: Model, *, complete: bool) -> Iterator[Hit]:
    """Findings about a model; `complete`: every included file was read."""
    root = model.root
    for compiler in root.iterchildren("compiler"):
        if compiler.get("coordinate") == "global":
            yield Hit("global-coordinates", compiler, "poses are given in the world: coordinate is 'global'")
    meshes: dict[etree._Element, Path] = {}
    yield from _files(model, meshes)
    if complete and not any(True for _ in elements_of(root, *MAKERS)):
        elements = Elements(root, str(model.path))
        try:
            found = [*_keyframes(root, elements), *_masses(root, elements)]
            found += [*_free_joints(root, elements), *_sizes(root, elements)]
            found += [
                *hits_of_needs(root, elements),
                *hits_of_tendons(root, elements),
                *hits_of_meshes(elements, meshes),
            ]
        except ProofError:  # of a class or a number, about which other rules speak
            return
        yield from found


def _files(model: Model, meshes: dict[etree._Element, Path]) -> Iterator[Hit]:
    """Files that are neither where the compiler looks for them nor beside what names them; finds the meshes."""
    compiler = compiler_of(model.root)
    strip = compiler.get("strippath") == "true"
    for asset in model.root.iterfind("asset/*"):
        option, attributes = _FILES.get(str(asset.tag), ("", ()))
        folder = Path(compiler.get(option) or compiler.get("assetdir") or "")
        beside = Path(mark_of(asset, str(model.path)).file).parent
        for file in filter(None, map(asset.get, attributes)):
            path = Path(Path(file).name if strip else file)
            places = (model.path.parent / folder / path, beside / path)
            if asset.tag == "mesh":
                yield from format_hits(asset, file)
                found = next(filter(is_file, places), None)
                if found is not None:
                    meshes[asset] = found
            if not any(map(is_file, places)):
                rule, what = ("missing-mesh", "mesh") if asset.tag == "mesh" else ("missing-asset-file", asset.tag)
                yield Hit(rule, asset, f"the {what} file {shown(str(folder / file))} is not there")


def _joints(root: etree._Element, elements: Elements) -> list[str]:
    """The types of all joints."""
    return [
        "free" if joint.tag == "freejoint" else elements.attributes(joint).get("type", "hinge")
        for joint in elements_of(root, "joint", "freejoint")
        if _body(joint) is not None
    ]


def _body(element: etree._Element) -> etree._Element | None:
    """The body that an element is in, within frames or not; None where it is in none."""
    above = element.getparent()
    while above is not None and above.tag == "frame":
        above = above.getparent()
    return above if above is not None and above.tag == "body" else None


def _free_joints(root: etree._Element, elements: Elements) -> Iterator[Hit]:
    for joint in elements_of(root, "joint", "freejoint"):
        body = _body(joint)
        if body is None or _body(body) is None:
            continue
        if joint.tag == "freejoint" or elements.attributes(joint).get("type") == "free":
            message = f"a free joint in body {shown(body.get('name') or '')}, which is in another body"
            yield Hit("free-joint-below", joint, message)


def _sizes(root: etree._Element, elements: Elements) -> Iterator[Hit]:
    """Sizes that are not above 0, or too few; of none at all another rule speaks. Drake takes a sphere of 0."""
    for geom in elements_of(root, "geom", "site"):
        above = geom.getparent()
        if above is None or above.tag in {"default", "spatial"}:
            continue
        given = elements.attributes(geom)
        kind, text = given.get("type", "sphere"), given.get("size", "")
        count = 1 if given.get("fromto") else MEASURES.get(kind, 0)
        read = next((found for most in (1, 2, 3) if (found := mujoco_numbers(text, most))), ())
        if (
            not count
            or (text.strip() and not read)
            or "size" not in given
            or given.get("mesh")
            or (count == 1 and kind in {"box", "ellipsoid"})
        ):
            continue
        if geom.tag == "site":  # It has sizes of its own for those that are not written.
            is_wrong = any(size <= 0.0 for size in read[:count])
        else:
            is_wrong = len(read) < count or not all(size > 0.0 for size in read[:count])
        if is_wrong:
            is_nothing = kind == "sphere" and read and not read[0] < 0.0
            of = {"mujoco"} if is_nothing or geom.tag == "site" else {"mujoco", "drake"}
            yield Hit("size-not-positive", geom, f"size of a {kind} is {shown(text)}: it needs {count} above 0", of)


def _keyframes(root: etree._Element, elements: Elements) -> Iterator[Hit]:
    """Keyframes with another count of numbers than the model has joints or actuators."""
    kinds = _joints(root, elements)
    positions, velocities = (sum(_SIZES.get(kind, (1, 1))[place] for kind in kinds) for place in (0, 1))
    actuators = sum(1 for section in root.iterchildren("actuator") for _ in section.iterchildren("*"))
    for key in root.iterfind("keyframe/key"):
        for name, count in (("qpos", positions), ("qvel", velocities), ("ctrl", actuators)):
            written = len((key.get(name) or "").split())
            if written and written != count:
                of = "actuators" if name == "ctrl" else "joints"
                message = (
                    f"{name} of key {shown(key.get('name') or '')} has {written} numbers, and the {of} need {count}"
                )
                yield Hit("long-keyframe" if written > count else "short-keyframe", key, message)


def _masses(root: etree._Element, elements: Elements) -> Iterator[Hit]:
    """Bodies that move and weigh nothing, with all that is fixed to them."""
    if changes_masses(elements.compiler):
        return
    weighs: dict[etree._Element, bool] = {}
    for body in reversed(list(elements_of(root, "body"))):  # What it holds comes before it.
        own = list(elements.held(body, "body", "geom", "joint", "freejoint"))
        moves = any(each.tag in {"joint", "freejoint"} for each in own)
        carried = [each for each in own if each.tag == "body" and weighs.get(each, True)]
        weighs[body] = bool(_has_mass(body, own, elements) or carried)
        if moves and not weighs[body]:
            name = shown(body.get("name") or "")
            yield Hit("weightless-body", body, f"body {name} moves, and nothing gives it a mass")
        if moves:  # It carries itself; what holds it needs a mass of its own.
            weighs[body] = False


def _has_mass(body: etree._Element, own: list[etree._Element], elements: Elements) -> bool:
    whence = elements.compiler.get("inertiafromgeom", "auto")
    if body.find("inertial") is not None and whence != "true":
        return True  # Another rule speaks of its mass.
    if whence == "false":
        return False
    first, last = numbers(elements.compiler.get("inertiagrouprange"), 2) or (0.0, 5.0)
    for geom in own:
        if geom.tag != "geom":
            continue
        given = elements.attributes(geom)
        mass, density, group = (numbers(given.get(name), 1) for name in ("mass", "density", "group"))
        nothing = mass == (0.0,) or (mass is None and density == (0.0,)) or given.get("type") in WITHOUT_MASS
        if not nothing and first <= (group or (0.0,))[0] <= last:
            return True
    return False
