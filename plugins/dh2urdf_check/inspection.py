"""Inspects URDF, xacro, SDF and MJCF of any origin: what every consumer will do with it, and the robot in it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from lxml import etree

from dh2urdf.documents import is_file, is_there, kind_of_file, read_bytes
from dh2urdf.errors import Dh2UrdfError, InputError, ProofError
from dh2urdf.meshes import packages_in, with_its_own
from dh2urdf.source import Mark
from dh2urdf.stages import Expansion, Inspection
from dh2urdf_check.document import NotXmlError, parse
from dh2urdf_check.finders import Document, text_of
from dh2urdf_check.meshes import is_found_by_pybullet
from dh2urdf_check.rules import CONSUMERS, Hit, Rule, rules, rules_of, unread_include
from dh2urdf_check.urdf import Urdf, number_hits
from dh2urdf_plugins.formats import foreign_mjcf, foreign_sdf
from dh2urdf_plugins.formats.mjcf.elements import compiler_of, include_files
from dh2urdf_plugins.formats.xml_files import FILE, LARGEST, mark_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from dh2urdf_check.document import Parsed
    from dh2urdf_check.rules import At
    from dh2urdf_plugins.xacro_fence.places import Place

_PROLOGUE = b'<?xml version="1.0" encoding="utf-8"?>' + 5 * b"\n"
"""As many lines as the command `xacro` writes before the robot: a line without an element is one of its output."""


def inspect_urdf(path: Path, expansion: Expansion | None = None) -> Inspection:
    """Findings about a URDF; `expansion` has the packages where meshes of ``package://`` addresses are looked for."""
    return _inspection(path, read_bytes(path, InputError, limit=LARGEST), expansion)


def inspect_xacro(path: Path, expansion: Expansion | None = None) -> Inspection:
    """Findings about a xacro, as xacro expands it behind a fence, with the arguments and packages of an expansion."""
    from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

    read_bytes(path, InputError, limit=LARGEST)
    try:
        expanded = expand_foreign(path, expansion)
    except ProofError as error:
        (problem,) = error.problems
        mark = problem.mark or Mark(file=str(path))
        return _only(rules()["xacro-fails"], CONSUMERS, problem.message, replace(mark, line=mark.line or 1))
    return _inspection(path, _PROLOGUE + expanded.content, expansion, expanded.places)


def _inspection(
    path: Path, content: bytes, expansion: Expansion | None, places: list[Place | None] | None = None
) -> Inspection:
    """Findings about a text; `places` are those of its elements, where it was expanded."""
    packages = with_its_own(path, packages_in((expansion or Expansion()).package_paths))
    try:
        parsed = parse(content)
    except NotXmlError as error:
        reason = f"it is {found[0]}" if (found := kind_of_file(content)) else error.reason
        line, column = error.at
        mark = Mark(file=str(path), line=line, column=column)
        return _only(rules()["not-xml"], CONSUMERS, f"no reader takes this: {reason}", mark)
    origins = _Origins(path, parsed, places)
    document = Urdf(parsed, path, content, origins.said, packages)
    hits = [*document.hits(rules().values()), *number_hits(document)]
    if parsed.complaint is not None:
        reason, at = parsed.complaint
        hits.append(Hit("not-strict-xml", at, reason, frozenset(CONSUMERS)))
    hits.sort(key=lambda hit: origins.place(hit.at))
    findings = [rules()[hit.rule].finding(hit.message, *origins.of(hit.at), hit.of) for hit in hits]
    for each in parsed.places:
        if str(each.tag).rpartition(".")[2] == "include":
            mark, calls = origins.of(each)
            address = next(map(str, each.attrib.values()), None)
            findings.append(unread_include(address, mark, CONSUMERS, calls))
    robot = document.links.robot(origins.in_text)
    return Inspection(consumers=CONSUMERS, findings=tuple(findings), robot=robot)


def _only(rule: Rule, consumers: Mapping[str, str], message: str, mark: Mark) -> Inspection:
    """An inspection with one finding, about a file of which nothing else can be checked."""
    return Inspection(consumers=consumers, findings=(rule.finding(message, mark),))


class _Origins:
    """Where the elements of a text come from: the text itself, or the files that it was expanded from."""

    def __init__(self, path: Path, parsed: Parsed, places: list[Place | None] | None) -> None:
        self._path, self._parsed = path, parsed
        self._sources = None if places is None else dict(zip(parsed.places, places, strict=True))

    def place(self, at: At) -> tuple[int, int]:
        """The line and column in the text."""
        return at if isinstance(at, tuple) else self._parsed.places[at]

    def in_text(self, at: At) -> Mark:
        """A place in the text."""
        line, column = self.place(at)
        return Mark(file=str(self._path), line=line, column=column)

    def of(self, at: At) -> tuple[Mark, tuple[Mark, ...]]:
        """Where something is, and where the macros are called that it comes from."""
        if self._sources is None:
            return self.in_text(at), ()
        if not isinstance(at, tuple) and (found := self._sources[at]):
            from dh2urdf_plugins.xacro_fence.expansion import mark_of

            return mark_of(found), tuple(map(mark_of, found.calls))
        return Mark(file=str(self._path), place=f"line {self.place(at)[0]} of what it expands to"), ()

    def said(self, at: etree._Element) -> str:
        """Where an element is, as messages say it."""
        mark = self.of(at)[0]
        return mark.in_file if mark.file == str(self._path) else f"{mark.in_file} of {mark.file}"


# --- SDF and MJCF -----------------------------------------------------------------------------------------------------


MODEL_CONSUMERS = {
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
    return rules_of(name, MODEL_CONSUMERS[name])


def inspect_sdf(path: Path, _expansion: Expansion | None = None) -> Inspection:
    """Findings about an SDF."""
    return _inspected(path, "sdf", "sdf", foreign_sdf)


def inspect_mjcf(path: Path, _expansion: Expansion | None = None) -> Inspection:
    """Findings about an MJCF."""
    return _inspected(path, "mjcf", "mujoco", foreign_mjcf)


def _inspected(path: Path, name: str, tag: str, read: Callable[[Path], Any]) -> Inspection:
    """Findings about a model whose outermost element is to be `tag`."""
    content, known, consumers = read_bytes(path, InputError, limit=LARGEST), model_rules(name), MODEL_CONSUMERS[name]
    try:
        root = tree_of(content, str(path), is_deep=name == "mjcf")
    except ProofError as error:
        (problem,) = error.problems
        mark = problem.mark or Mark(file=str(path))
        mark = replace(mark, line=max(mark.line or 1, 1), column=max(mark.column or 1, 1))
        return _only(known[f"{name}-not-xml"], consumers, problem.message, mark)
    root.set(FILE, str(path))
    if root.tag != tag:
        message = f"the outermost element is {root.tag}, not {tag}"
        return _only(known[f"{name}-not-{tag}"], consumers, message, mark_of(root))
    included = include_files(root, path) if name == "mjcf" else ()
    found = [known["mjcf-missing-include"].finding(each.message, mark_of(each.include)) for each in included]
    document = Document(root, path, _of_sdf(root, path) if name == "sdf" else _of_mjcf(root, path))
    hits = [*document.hits(known.values())]
    found += [known[hit.rule].finding(hit.message, mark_of(hit.at), of=hit.of) for hit in hits]  # type: ignore[arg-type]  # no rule is of the text
    missing = {hit.at for hit in hits if hit.rule == "sdf-missing-include"}
    for element in (*root.iter("{*}include"), *root.iterfind("asset/model")):  # Files of MJCF are in its tree already.
        uri = element.find("uri")
        address = uri.text if uri is not None else element.get("file") or element.get("href")
        if address and (element if uri is None else uri) not in missing:
            found.append(unread_include(address.strip(), mark_of(element), consumers))
    found.sort(key=lambda finding: (finding.mark.line or 0) if finding.mark else 0)
    try:
        robot = read(path).robot
    except Dh2UrdfError:  # Findings report what is wrong; a model need not be an arm.
        robot = None
    return Inspection(consumers=consumers, findings=tuple(found), robot=robot)


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
