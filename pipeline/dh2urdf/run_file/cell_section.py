"""The section `cells` of a run file: which arms stand where in one robot description."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.cells.cell import WORLD, ArmCall, CellCall
from dh2urdf.quantities.quantity import Dimension
from dh2urdf.robot import Origin
from dh2urdf.run_file.placements import PlacementReader
from dh2urdf.source import did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.documents.document import Node

ARM_KEYS = ("name", "of", "prefix", "parent", "xyz", "rpy")
ACCEPTED_PARENT = "world, or a link of another arm of the cell, such as left/tool0"


class CellsReader(PlacementReader):
    """Reads the cells of a run file and gathers what is wrong with them."""

    def read(self, section: Node) -> tuple[CellCall, ...]:
        """The cells that nothing is wrong with."""
        cells: dict[str, CellCall] = {}
        for index, node in enumerate(section.value if isinstance(section.value, list) else []):
            cell = self._cell(node, f"cells.{index}")
            if cell and cell.name in cells:
                first = cells[cell.name].mark
                self.say(
                    f"two cells are named {shown(cell.name)}",
                    node,
                    f"cells.{index}.name",
                    found=cell.name,
                    accepted="names that differ",
                    suggestion=f"the first stands at {first}",
                )
            elif cell:
                cells[cell.name] = cell
        return tuple(cells.values())

    def _cell(self, node: Node, field: str) -> CellCall | None:
        before = len(self.problems)
        given = self.entries(node, ("name", "arms"), field)
        name = self._needed(node, given, "name", field, "`name: NAME`, after which its files are named")
        arms = given.get("arms")
        calls: list[ArmCall] = []
        if arms is not None and isinstance(arms.value, list) and arms.value:
            calls = [arm for i, entry in enumerate(arms.value) if (arm := self._arm(entry, f"{field}.arms.{i}"))]
        elif isinstance(node.value, dict):
            self.say(
                "this cell has no arms",
                arms or node,
                f"{field}.arms",
                accepted="a list such as [{name: left, of: ur5}, {name: right, of: ur5, xyz: [0, -0.5, 0]}]",
            )
        if len(self.problems) > before or name is None:
            return None
        self._check_names(calls, node, field)
        ordered = self._parents_first(calls, node, field)
        return None if len(self.problems) > before else CellCall(name=name, arms=ordered, mark=node.mark)

    def _arm(self, node: Node, field: str) -> ArmCall | None:
        before = len(self.problems)
        given = self.entries(node, ARM_KEYS, field)
        name = self._needed(node, given, "name", field, "`name: NAME`")
        of = self._needed(node, given, "of", field, "`of: NAME`, the name of a manipulator of this run")
        if name is not None and (name == WORLD or "/" in name):
            message = f"an arm cannot be named {shown(name)}: parents are written as world or ARM/LINK"
            self.say(message, given["name"], f"{field}.name", accepted="another name")
        prefix = given.get("prefix")
        if prefix is not None and (prefix.text is None or isinstance(prefix.value, (dict, list))):
            self.say(f"this cannot be {prefix.describe()}", prefix, f"{field}.prefix", accepted='a text, also ""')
        parent, link = self._parent(given.get("parent"), f"{field}.parent")
        placement = Origin(
            xyz=self.vector(given.get("xyz"), f"{field}.xyz", Dimension.LENGTH),
            rpy=self.vector(given.get("rpy"), f"{field}.rpy", Dimension.ANGLE),
        )
        if len(self.problems) > before or name is None or of is None:
            return None
        return ArmCall(
            name=name,
            of=of,
            prefix=f"{name}_" if prefix is None else prefix.text or "",
            parent=parent,
            link=link,
            placement=placement,
            mark=node.mark,
            of_mark=given["of"].mark,
            parent_mark=given["parent"].mark if "parent" in given else None,
        )

    def _needed(self, node: Node, given: dict[str, Node], key: str, field: str, accepted: str) -> str | None:
        if key not in given and isinstance(node.value, dict):
            what = "arm" if ".arms." in field else "cell"
            self.say(f"this {what} has no {shown(key)}", node, f"{field}.{key}", accepted=accepted)
        return self.name(given.get(key), f"{field}.{key}")

    def _parent(self, node: Node | None, field: str) -> tuple[str | None, str]:
        """The arm and its link that hold an arm; no arm for the world."""
        text = self.name(node, field)
        if node is None or text is None or text == WORLD:
            return None, WORLD
        arm, slash, link = text.partition("/")
        if not (arm and slash and link):
            near = did_you_mean(text, [WORLD]) or f"an arm's tool is {shown(f'{arm or link}/tool0')}"
            self.say(f"{shown(text)} is no parent", node, field, accepted=ACCEPTED_PARENT, suggestion=near)
        return arm, link

    # --- The arms of one cell

    def _check_names(self, arms: Sequence[ArmCall], node: Node, field: str) -> None:
        """Names, and prefixes, which every arm's base_link gets, differ."""
        for what in ("name", "prefix"):
            first: dict[str, ArmCall] = {}
            for arm in arms:
                word = getattr(arm, what)
                if word in first:
                    self.say(
                        f"two arms of this cell have the {what} {shown(word)}",
                        node,
                        f"{field}.arms",
                        mark=arm.mark,
                        found=word,
                        accepted=f"a {what} of its own for each",
                        suggestion=f"the first stands at {first[word].mark}",
                    )
                first.setdefault(word, arm)

    def _parents_first(self, arms: Sequence[ArmCall], node: Node, field: str) -> tuple[ArmCall, ...]:
        """The arms so that each comes after the one that holds it, otherwise as they are written."""
        names = [arm.name for arm in arms]
        orphans = [arm for arm in arms if arm.parent is not None and arm.parent not in names]
        for arm in orphans:
            self.say(
                f"the cell has no arm {shown(str(arm.parent))} that could hold {shown(arm.name)}",
                node,
                f"{field}.arms",
                mark=arm.parent_mark,
                found=f"{arm.parent}/{arm.link}",
                accepted=", ".join([WORLD, *(f"{name}/LINK" for name in names if name != arm.name)]),
                suggestion=did_you_mean(str(arm.parent), names),
            )
        if orphans:
            return ()
        ordered: dict[str, ArmCall] = {}
        waiting = list(arms)
        while waiting:
            for arm in waiting:
                if arm.parent is None or arm.parent in ordered:
                    ordered[arm.name] = arm
            left = [arm for arm in waiting if arm.name not in ordered]
            if len(left) == len(waiting):
                circle = " and ".join(f"{shown(arm.name)} on {shown(f'{arm.parent}/{arm.link}')}" for arm in left)
                self.say(
                    f"these arms hold each other in a circle: {circle}",
                    node,
                    f"{field}.arms",
                    mark=left[0].parent_mark,
                    found=f"{left[0].parent}/{left[0].link}",
                    accepted="a parent for each, so that every way leads to the world",
                )
                return ()
            waiting = left
        return tuple(ordered.values())
