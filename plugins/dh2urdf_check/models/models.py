"""Inspects SDF and MJCF of any origin: what their consumers will do with it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.documents import read_bytes, xml_root
from dh2urdf.errors import Dh2UrdfError, InputError, ProofError
from dh2urdf.kinematics.mass import inertia_problem
from dh2urdf.manipulator import Inertia
from dh2urdf.source import Mark
from dh2urdf.stages import Finding, Inspection
from dh2urdf_check.document.tree import numbers_of
from dh2urdf_check.rules import Rule, rules_of, unread_include
from dh2urdf_plugins.formats.xml_files import FILE, LARGEST, mark_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

    from dh2urdf.robot import Robot

CONSUMERS = {
    "sdf": {"gazebo": "Gazebo: sdformat", "drake": "Drake", "pybullet": "PyBullet"},
    "mjcf": {"mujoco": "MuJoCo", "drake": "Drake", "pybullet": "PyBullet"},
}
"""The readers of each format that its rules speak of, by the names that ``--for`` takes."""


class Hit(NamedTuple):
    """A place where a rule is broken.

    Attributes:
        rule: the rule's name without the format.
        at: the element.
        message: what is there.
        of: the consumers that it matters to, where the rule as such names more.
    """

    rule: str
    at: etree._Element
    message: str
    of: Collection[str] | None = None


@dataclass(frozen=True, slots=True)
class Model:
    """A model as it is in its file.

    Attributes:
        root: the outermost element.
        path: the file.
    """

    root: etree._Element
    path: Path


@cache
def model_rules(name: str) -> dict[str, Rule]:
    """The rules of a format by name, in the order of their table."""
    return rules_of(name, CONSUMERS[name])


def inspect_model(
    path: Path, name: str, tag: str, hits: Callable[[Model], Iterable[Hit]], read: Callable[[Path], Robot]
) -> Inspection:
    """Findings about a model.

    Args:
        path: the file.
        name: the format.
        tag: its outermost element.
        hits: finds the faults of a model.
        read: reads the robot of a file, or raises an error of dh2urdf.

    Raises:
        InputError: the file cannot be read.
    """
    content = read_bytes(path, InputError, limit=LARGEST)
    try:
        root = tree_of(content, str(path), is_deep=name == "mjcf")
    except ProofError as error:
        (problem,) = error.problems
        mark = problem.mark or Mark(file=str(path))
        mark = replace(mark, line=max(mark.line or 1, 1), column=max(mark.column or 1, 1))
        return _inspection(name, [_finding(name, "not-xml", problem.message, mark)])
    root.set(FILE, str(path))
    if root.tag != tag:
        message = f"the outermost element is {root.tag}, not {tag}"
        return _inspection(name, [_finding(name, f"not-{tag}", message, mark_of(root))])
    broken = list(hits(Model(root, path)))
    found = [_finding(name, hit.rule, hit.message, mark_of(hit.at), hit.of) for hit in broken]
    found += _unread(name, root, [hit.at for hit in broken if hit.rule == "missing-include"])
    robot: Robot | None
    try:
        robot = read(path)
    except Dh2UrdfError:  # Findings report what is wrong; a model need not be an arm.
        robot = None
    return _inspection(
        name,
        sorted(
            (each for each in found if each.effects), key=lambda finding: finding.mark.line or 0 if finding.mark else 0
        ),
        robot,
    )


def _unread(name: str, root: etree._Element, missing: Collection[etree._Element]) -> Iterator[Finding]:
    """The files that a model includes and that are neither in its tree, as those of MJCF are, nor missing."""
    for element in (*root.iter("{*}include"), *root.iterfind("asset/model")):
        at = element.find("uri")
        at = element if at is None else at
        address = at.text if at is not element else element.get("file") or element.get("href")
        if address and at not in missing:
            yield unread_include(address.strip(), mark_of(element), CONSUMERS[name])


def parsed(content: bytes, path: Path) -> etree._Element:
    """The outermost element of a text whose reader knows namespaces.

    Raises:
        etree.XMLSyntaxError: it is not well-formed XML, or XML that `xml_root` refuses.
    """
    root = xml_root(content)
    root.set(FILE, str(path))
    return root


def elements_of(root: etree._Element, *tags: str) -> Iterator[etree._Element]:
    """The elements of some names, in the order of the file; all where none is named."""
    yield from root.iter(*(tags or (etree.Element,)))


def numbers(text: str | None, count: int) -> tuple[float, ...] | None:
    """As many finite numbers as a text should have; None where it has something else."""
    return numbers_of(text, count)


def fault_of_inertia(moments: Sequence[float]) -> str | None:
    """The rule that ixx, iyy, izz, ixy, ixz, iyz break; None where they are those of a body."""
    xx, yy, zz, xy, xz, yz = moments
    problem = inertia_problem(Inertia(ixx=xx, iyy=yy, izz=zz, ixy=xy, ixz=xz, iyz=yz))
    if problem is None:
        return None
    return "inertia-triangle-inequality" if "triangle" in problem else "inertia-not-positive-definite"


def _finding(name: str, rule: str, message: str, mark: Mark, of: Collection[str] | None = None) -> Finding:
    found = model_rules(name)[f"{name}-{rule}"]
    effects = tuple(effect for effect in found.effects if of is None or effect.consumer in of)
    return Finding(rule=found.name, message=message, fix=found.fix, effects=effects, mark=mark)


def _inspection(name: str, findings: list[Finding], robot: Robot | None = None) -> Inspection:
    return Inspection(consumers=CONSUMERS[name], findings=tuple(findings), robot=robot)
