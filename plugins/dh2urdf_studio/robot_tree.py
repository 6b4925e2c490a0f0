"""The tree of `dh2urdf view`: robots, their links, and what these consist of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui.element import Element

from dh2urdf_studio.drawing.contents import contents

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from dh2urdf_studio.drawing.scene import Figure


class RobotTree(Element, component="robot_tree.js"):  # type: ignore[call-arg]  # Element is any type to mypy
    """A tree that folds; a link can be picked, and hidden in the scene."""

    def __init__(self, on_pick: Callable[[str | None], None], on_hide: Callable[[frozenset[str]], None]) -> None:
        super().__init__()
        self._nodes: frozenset[str] = frozenset()
        self.on("pick", lambda event: on_pick(self._known(event.args["node"])))
        self.on("hide", lambda event: on_hide(self._nodes.intersection(map(str, event.args["nodes"]))))

    def _known(self, node: object) -> str | None:
        return str(node) if node in self._nodes else None

    def show(self, figures: Sequence[Figure], hidden: Collection[str]) -> None:
        """The robots, and the links that are hidden, by the names of their nodes."""
        robots = [contents(figure) for figure in figures]
        self._nodes = frozenset(link["node"] for robot in robots for link in robot["links"])
        self.run_method("show", robots, sorted(hidden))

    def pick(self, node: str | None) -> None:
        """A link stands out, and is in sight."""
        self.run_method("choose", node)
