"""Reads the mappings of a run file, and gathers all that is wrong with them instead of stopping at the first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import Mark, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.documents.document import Node


class SectionReader:
    """What the readers of a run file's sections share.

    Attributes:
        problems: what is wrong; readers add to it.
    """

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = problems

    def entries(self, node: Node, known: Sequence[str], field: str) -> dict[str, Node]:
        """The entries of a mapping that has no other keys than the known ones."""
        if not isinstance(node.value, dict):
            accepted = f"a mapping of {', '.join(known)}"
            self.say(f"this cannot be {node.describe()}", node, field, accepted=accepted)
            return {}
        for key in node.value:
            if key not in known:
                near = did_you_mean(key, known)
                self.say(
                    f"a run file has no {shown(key)} here",
                    node,
                    f"{field}.{key}".lstrip("."),
                    mark=node.key_mark(key),
                    found=key,
                    accepted=", ".join(known),
                    suggestion=near
                    or ("the options of a stage stand under `options:`" if "options" in known else None),
                )
        return node.value

    def name(self, node: Node | None, field: str) -> str | None:
        """A text that must not be empty."""
        if node is None:
            return None
        if isinstance(node.value, (dict, list)) or node.value is None or not node.text:
            self.say(f"this cannot be {node.describe()}", node, field, accepted="a text")
            return None
        return node.text

    def say(
        self,
        message: str,
        node: Node,
        field: str,
        *,
        mark: Mark | None = None,
        found: str | None = None,
        accepted: str | None = None,
        suggestion: str | None = None,
    ) -> None:
        """Note a problem, at the node unless `mark` says where."""
        self.problems.append(
            Problem(
                message=message,
                mark=mark or node.mark,
                field=field or None,
                found=found or node.text,
                accepted=accepted,
                suggestion=suggestion,
            )
        )
