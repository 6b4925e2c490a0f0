"""The section `cells` of a run file: which arms stand where in one robot description."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.cells.cell import PLACES, TRIPLES, ArmCall, CellCall, PlacementRule
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import WORLD
from dh2urdf.robot import Origin
from dh2urdf.run_file.sections import ArmSection, CellSection, PlacementSection
from dh2urdf.run_file.variation_section import read_law
from dh2urdf.source import Messages, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.documents.document import Node
    from dh2urdf.run_file.reading import Reading

say = Messages(__file__)


def read_cells(entries: Iterable[tuple[Node, str]], to: Reading) -> tuple[CellCall, ...]:
    """The cells, each in its node at its place."""
    return to.distinct(to.entries(entries, CellSection, _cell), lambda cell: cell.name, "cells")


def _cell(given: CellSection, node: Node, field: str, to: Reading) -> CellCall | None:
    arms = []
    for index, (arm, entry) in enumerate(zip(given.arms, node.entries("arms"), strict=True)):
        with to.noting(entry, f"{field}.arms.{index}"):
            arms.append(_arm(arm, entry))
    vary = []
    names = [arm.name for arm in arms]
    for index, (rule, entry) in enumerate(zip(given.vary, node.entries("vary"), strict=True)):
        with to.noting(entry, f"{field}.vary.{index}"):
            vary.append(_rule(rule, entry, names))
    for name in ("count", "seed", "sampling") if not given.vary else ():
        if sampled := node.entry(name):
            to.note("nothing-sampled", sampled, f"{field}.{name}")
    if len(arms) < len(given.arms) or len(vary) < len(given.vary):
        return None
    count = node.entry("count")
    with to.noting(node, field):
        if problems := [*_wrong_arms(arms)]:
            raise ConfigError(problems)
        return CellCall(
            name=given.name,
            arms=_parents_first(arms),
            order=tuple(names),
            combine=given.combine,
            vary=tuple(vary),
            count=given.count,
            seed=given.seed,
            sampling=given.sampling,
            count_mark=count.mark if count else None,
            mark=node.mark,
        )
    return None


def _rule(given: PlacementSection, node: Node, arms: Sequence[str]) -> PlacementRule:
    if given.arm not in arms:
        near = did_you_mean(given.arm, arms)
        raise ConfigError(say("placed-arm-unknown", field="arm", found=given.arm, arms=arms, suggestion=near))
    (first, *_) = TRIPLES.get(given.field, (given.field,))
    law, _ = read_law(given.field, PLACES[first], node)
    return PlacementRule(arm=given.arm, field=given.field, law=law, mark=node.mark)


def _arm(given: ArmSection, node: Node) -> ArmCall:
    problems = []
    if given.name == WORLD or "/" in given.name:
        problems.append(say("arm-name-wrong", field="name", name=given.name))
    arm, slash, link = given.parent.partition("/")
    if given.parent != WORLD and not (arm and slash and link):
        holder = (arm or link).removesuffix("_tool0")  # as its link is called in the file that is written
        accepted = "world, or a link of another arm of the cell, such as left/tool0"
        near = did_you_mean(given.parent, [WORLD]) or f"an arm's tool is {shown(f'{holder}/tool0')}"
        problems.append(say("parent-wrong", field="parent", parent=given.parent, accepted=accepted, suggestion=near))
    if given.floating and given.parent != WORLD:
        problems.append(say("floating-on-link", field="floating", found=given.parent))
    if problems:
        raise ConfigError(problems)
    parent = node.entry("parent")
    return ArmCall(
        name=given.name,
        of=given.of,
        prefix=f"{given.name}_" if given.prefix is None else given.prefix,
        parent=None if given.parent == WORLD else arm,
        link=link or WORLD,
        placement=Origin(xyz=given.xyz, rpy=given.rpy),
        floating=given.floating,
        mark=node.mark,
        of_mark=(node.entry("of") or node).mark,
        parent_mark=parent.mark if parent else None,
    )


def _wrong_arms(arms: Sequence[ArmCall]) -> Iterator[Problem]:
    """Names and prefixes differ, and arms that stand on others stand on some of the cell."""
    for what in ("name", "prefix"):
        first: dict[str, ArmCall] = {}
        for arm in arms:
            word = getattr(arm, what)
            if first.setdefault(word, arm) is not arm:
                yield say("arms-alike", arm.mark, field="arms", found=word, what=what, first=first[word].mark)
    names = [arm.name for arm in arms]
    for arm in arms:
        if arm.parent is not None and arm.parent not in names:
            choices = [WORLD, *(f"{name}/LINK" for name in names if name != arm.name)]
            about = {
                "field": "arms",
                "found": f"{arm.parent}/{arm.link}",
                "suggestion": did_you_mean(arm.parent, names),
            }
            yield say("parent-unknown", arm.parent_mark, parent=arm.parent, arm=arm.name, choices=choices, **about)


def _parents_first(arms: Sequence[ArmCall]) -> tuple[ArmCall, ...]:
    """The arms so that each comes after the one that holds it, otherwise as they are written."""
    ordered: dict[str, ArmCall] = {}
    waiting = list(arms)
    while waiting:
        for arm in waiting:
            if arm.parent is None or arm.parent in ordered:
                ordered[arm.name] = arm
        left = [arm for arm in waiting if arm.name not in ordered]
        if len(left) == len(waiting):
            held = [f"{shown(arm.name)} on {shown(f'{arm.parent}/{arm.link}')}" for arm in left]
            mark, found = left[0].parent_mark, f"{left[0].parent}/{left[0].link}"
            raise ConfigError(say("arms-in-circle", mark, field="arms", found=found, arms=" and ".join(held)))
        waiting = left
    return tuple(ordered.values())
