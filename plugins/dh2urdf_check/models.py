"""Inspects SDF and MJCF of any origin: what their consumers will do with it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from lxml import etree

from dh2urdf.documents import is_file, is_there, read_bytes
from dh2urdf.errors import Dh2UrdfError, InputError, ProofError
from dh2urdf.source import Mark
from dh2urdf.stages import Finding, Inspection
from dh2urdf_check.addresses import is_found_by_pybullet
from dh2urdf_check.finders import Document, text_of
from dh2urdf_check.rules import Rule, rules_of, unread_include
from dh2urdf_plugins.formats import foreign_mjcf, foreign_sdf
from dh2urdf_plugins.formats.mjcf.elements import compiler_of, include_files
from dh2urdf_plugins.formats.xml_files import FILE, LARGEST, mark_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

    from dh2urdf.stages import Expansion

CONSUMERS = {
    "sdf": {"gazebo": "Gazebo: sdformat", "drake": "Drake", "pybullet": "PyBullet"},
    "mjcf": {"mujoco": "MuJoCo", "drake": "Drake", "pybullet": "PyBullet"},
}
"""The readers of each format that its rules speak of, by the names that ``--for`` takes."""
_READ = ("package://", "http://", "https://")
_OF_OTHERS = ("actor", "gripper", "plugin", "state")
"""Elements of an SDF whose content is no part of a model, although it may be called so."""
_IN_SENSOR = ("pose", "sensor")
_POSITIONS = {"hinge": 1, "slide": 1, "ball": 4, "free": 7}
"""How many positions a joint of MJCF has."""


@cache
def model_rules(name: str) -> dict[str, Rule]:
    """The rules of a format by name, in the order of their table."""
    return rules_of(name, CONSUMERS[name])


def inspect_sdf(path: Path, _expansion: Expansion | None = None) -> Inspection:
    """Findings about an SDF.

    Raises:
        InputError: the file cannot be read.
    """
    return _inspected(path, "sdf", "sdf", foreign_sdf)


def inspect_mjcf(path: Path, _expansion: Expansion | None = None) -> Inspection:
    """Findings about an MJCF.

    Raises:
        InputError: the file cannot be read.
    """
    return _inspected(path, "mjcf", "mujoco", foreign_mjcf)


def _inspected(path: Path, name: str, tag: str, read: Callable[[Path], Any]) -> Inspection:
    """Findings about a model whose outermost element is to be `tag`."""
    content = read_bytes(path, InputError, limit=LARGEST)
    try:
        root = tree_of(content, str(path), is_deep=name == "mjcf")
    except ProofError as error:
        (problem,) = error.problems
        mark = problem.mark or Mark(file=str(path))
        mark = replace(mark, line=max(mark.line or 1, 1), column=max(mark.column or 1, 1))
        return _only(name, "not-xml", problem.message, mark)
    root.set(FILE, str(path))
    if root.tag != tag:
        return _only(name, f"not-{tag}", f"the outermost element is {root.tag}, not {tag}", mark_of(root))
    known, found = model_rules(name), list[Finding]()
    if name == "mjcf":
        rule = known["mjcf-missing-include"]
        for each in include_files(root, path):
            found.append(rule.finding(each.message, rule.outcomes, mark_of(each.include)))
    of_format = _of_sdf if name == "sdf" else _of_mjcf
    document = Document(root, path, of_format(root, path))
    hits = [*document.hits(known.values())]
    found += [known[hit.rule].finding(hit.message, hit.of, mark_of(hit.at)) for hit in hits]  # type: ignore[arg-type]  # no rule is of the text
    found += _unread(name, root, {hit.at for hit in hits if hit.rule == "sdf-missing-include"})
    found.sort(key=lambda finding: (finding.mark.line or 0) if finding.mark else 0)
    try:
        robot = read(path).robot
    except Dh2UrdfError:  # Findings report what is wrong; a model need not be an arm.
        robot = None
    return Inspection(consumers=CONSUMERS[name], findings=tuple(found), robot=robot)


def _only(name: str, rule: str, message: str, mark: Mark) -> Inspection:
    found = model_rules(name)[f"{name}-{rule}"]
    return Inspection(consumers=CONSUMERS[name], findings=(found.finding(message, found.outcomes, mark),))


def _unread(name: str, root: etree._Element, missing: Collection[object]) -> Iterator[Finding]:
    """The files that a model includes and that are neither in its tree, as those of MJCF are, nor missing."""
    for element in (*root.iter("{*}include"), *root.iterfind("asset/model")):
        at = element.find("uri")
        at = element if at is None else at
        address = at.text if at is not element else element.get("file") or element.get("href")
        if address and at not in missing:
            yield unread_include(address.strip(), mark_of(element), CONSUMERS[name])


def _of_sdf(root: etree._Element, path: Path) -> dict[str, Callable[..., Any]]:
    """The functions of XPath in the rules of SDF."""
    of_models: list[etree._Element] = []
    waiting = [root]
    while waiting:
        element = waiting.pop()
        of_models.append(element)
        inner = [child for child in element.iterchildren(etree.Element) if child.tag not in _OF_OTHERS]
        waiting += [child for child in inner if not {":", "{"} & set(str(child.tag))][::-1]

    def parts(_: object, tags: str) -> list[etree._Element]:
        """The elements of models by their names; of sensors, all of them only where every name is asked for."""
        names = tags.split()
        if names == ["*"]:
            return of_models
        named = (each for each in of_models if each.tag in names)
        return [each for each in named if each.tag in _IN_SENSOR or next(each.iterancestors("sensor"), None) is None]

    def included(_: object, uri: Any) -> bool:  # noqa: ANN401 - what XPath has
        address = text_of(uri)
        name = address.partition("://")[2] or address
        beside = any(is_there(folder / name) for folder in (path.parent, path.parent.parent))
        return address.startswith(_READ) or beside

    return {
        "parts": parts,
        "included": included,
        "found-by-pybullet": lambda _, uri: is_found_by_pybullet(unquote(text_of(uri)), path),
    }


def _of_mjcf(root: etree._Element, path: Path) -> dict[str, Callable[..., Any]]:
    """The functions of XPath in the rules of MJCF."""
    compiler = compiler_of(root)
    folder = path.parent / (compiler.get("meshdir") or compiler.get("assetdir") or "")

    def asset(_: object, file: Any) -> bool:  # noqa: ANN401 - what XPath has
        name = text_of(file)
        name = Path(name).name if compiler.get("strippath") == "true" else name
        return is_file(folder / name)

    def positions(_: object) -> float:
        joints = [each for each in root.iterfind("worldbody//joint") if each.getparent() is not None]
        free = len(root.findall("worldbody//freejoint"))
        return float(7 * free + sum(_POSITIONS.get(joint.get("type", "hinge"), 1) for joint in joints))

    stems = {Path(mesh.get("file") or "").stem for mesh in root.iterfind("asset/mesh") if not mesh.get("name")}
    return {
        "asset": asset,
        "positions": positions,
        "names-a-file": lambda _, name: text_of(name) in stems,
    }
