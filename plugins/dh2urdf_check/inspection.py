"""Inspects URDF, xacro, SDF and MJCF of any origin: what every consumer will do with it, and the robot in it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from lxml import etree

from dh2urdf.documents import is_file, is_there
from dh2urdf.errors import Dh2UrdfError, ProofError
from dh2urdf.meshes import packages_in, with_its_own
from dh2urdf.source import Mark, shown
from dh2urdf.stages import Effect, Expansion, Finding, Inspection
from dh2urdf_check.document import line_of, read_text
from dh2urdf_check.finders import Document, text_of
from dh2urdf_check.meshes import is_found_by_pybullet
from dh2urdf_check.rules import CONSUMERS, Rule, rules, rules_of
from dh2urdf_check.urdf import Urdf
from dh2urdf_plugins.formats import foreign_mjcf, foreign_sdf
from dh2urdf_plugins.formats.mjcf.elements import compiler_of
from dh2urdf_plugins.formats.xml_files import mark_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from dh2urdf.robot import Robot
    from dh2urdf_check.document import Text
    from dh2urdf_check.rules import At

MODEL_CONSUMERS = {
    "sdf": {"gazebo": "Gazebo: sdformat", "drake": "Drake", "pybullet": "PyBullet"},
    "mjcf": {"mujoco": "MuJoCo", "drake": "Drake", "pybullet": "PyBullet"},
}
"""The readers of each format that its rules speak of, by the names that ``--for`` takes."""
_OUTERMOST = {"sdf": "sdf", "mjcf": "mujoco"}
_READ = ("package://", "http://", "https://")
_OF_OTHERS = ("actor", "gripper", "plugin", "state")
"""Elements of an SDF whose content is no part of a model, although it may be called so."""
_IN_SENSOR = ("pose", "sensor")
_POSITIONS = {"hinge": 1, "slide": 1, "ball": 4, "free": 7}
"""How many positions a joint of MJCF has."""


@cache
def model_rules(name: str) -> dict[str, Rule]:
    """The rules of a format by name, in the order of their table."""
    return rules_of(name, MODEL_CONSUMERS[name])


def inspect_urdf(path: Path, expansion: Expansion | None = None) -> Inspection:
    """Findings about a URDF; `expansion` has the packages where meshes of ``package://`` addresses are looked for."""
    return _inspected(path, "urdf", expansion or Expansion())


def inspect_xacro(path: Path, expansion: Expansion | None = None) -> Inspection:
    """Findings about a xacro, as xacro expands it behind a fence, with the arguments and packages of an expansion."""
    return _inspected(path, "xacro", expansion or Expansion())


def inspect_sdf(path: Path, expansion: Expansion | None = None) -> Inspection:
    """Findings about an SDF."""
    return _inspected(path, "sdf", expansion or Expansion())


def inspect_mjcf(path: Path, expansion: Expansion | None = None) -> Inspection:
    """Findings about an MJCF."""
    return _inspected(path, "mjcf", expansion or Expansion())


def _inspected(path: Path, form: str, expansion: Expansion) -> Inspection:
    """Findings about a file of a format."""
    known, consumers = (model_rules(form), MODEL_CONSUMERS[form]) if form in MODEL_CONSUMERS else (rules(), CONSUMERS)
    try:
        text = read_text(path, form, expansion)
    except ProofError as error:
        (problem,) = error.problems
        name = {"urdf": "not-xml", "xacro": "xacro-fails"}.get(form, f"{form}-not-xml")
        mark = problem.mark or Mark(file=str(path))
        mark = replace(mark, line=max(mark.line or 1, 1), column=mark.column or None)
        return Inspection(consumers=consumers, findings=(known[name].finding(problem.message, mark),))
    tag = _OUTERMOST.get(form, text.root.tag)
    if text.root.tag != tag:
        message, mark = f"the outermost element is {text.root.tag}, not {tag}", text.marks[text.root]
        return Inspection(consumers=consumers, findings=(known[f"{form}-not-{tag}"].finding(message, mark),))
    document: Document
    if form in MODEL_CONSUMERS:
        functions = _of_sdf(text.root, path) if form == "sdf" else _of_mjcf(text.root, path)
        document = Document(text.root, path, functions)
    else:
        document = Urdf(text, lambda at: _said(text, at), with_its_own(path, packages_in(expansion.package_paths)))
    hits = [*document.hits(known.values())]
    found: list[tuple[At, Finding]] = []
    found += ((hit.at, known[hit.rule].finding(hit.message, *_place(text, hit.at), of=hit.of)) for hit in hits)
    missed = known.get("mjcf-missing-include")
    found += ((each.include, missed.finding(each.message, mark_of(each.include))) for each in text.missing if missed)
    for element in text.marks if form != "sdf" else ():  # Files that an MJCF includes are in its tree already.
        is_include = str(element.tag).rpartition("}")[2].rpartition(":")[2] == "include"
        if is_include or (element.tag == "model" and form == "mjcf"):
            address = element.get("file") or next(map(str, element.attrib.values()), "")
            found.append((element, unread_include(address, consumers, *_place(text, element))))
    found.sort(key=lambda each: each[0][0] if isinstance(each[0], tuple) else line_of(each[0]))
    findings = tuple(finding for _, finding in found)
    return Inspection(consumers=consumers, findings=findings, robot=_robot(document, path, form))


def _robot(document: Document, path: Path, form: str) -> Robot | None:
    """The robot of a file; None where it is none."""
    if isinstance(document, Urdf):
        return document.robot
    try:
        robot: Robot = (foreign_sdf if form == "sdf" else foreign_mjcf)(path).robot
    except Dh2UrdfError:  # Findings report what is wrong; a model need not be an arm.
        return None
    return robot


def _place(text: Text, at: At) -> tuple[Mark, tuple[Mark, ...]]:
    """Where something is, and where the macros are called that it comes from."""
    if not isinstance(at, tuple):
        return text.marks[at], text.calls.get(at, ())
    if text.calls:
        return Mark(file=str(text.path), place=f"line {at[0]} of what it expands to"), ()
    return Mark(file=str(text.path), line=at[0], column=at[1]), ()


def _said(text: Text, at: etree._Element) -> str:
    """Where an element is, as messages say it."""
    mark = text.marks[at]
    return mark.in_file if mark.file == str(text.path) else f"{mark.in_file} of {mark.file}"


def unread_include(address: str, consumers: Mapping[str, str], mark: Mark, calls: tuple[Mark, ...] = ()) -> Finding:
    """What `check` does not look into: a file that the one that is inspected includes, by the address that it gives."""
    does = "may load it, and this file was checked without it"
    return Finding(
        rule="unread-include",
        message=f"{shown(address)} is included, and was not looked into",
        fix="check that file too; or check the description that a consumer makes of both",
        effects=tuple(Effect(consumer=consumer, severity="note", text=does) for consumer in consumers),
        mark=mark,
        calls=calls,
    )


# --- Functions of XPath in the rules of SDF and MJCF ------------------------------------------------------------------


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
