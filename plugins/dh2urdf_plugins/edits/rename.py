"""The edit ``rename``: other names of joints and links."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from dh2urdf.errors import EditError
from dh2urdf.source import Messages, Problem
from dh2urdf.stages import Edit, EditsInColumns
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import Manipulator

say = Messages(__file__)


@dataclass(frozen=True, slots=True, kw_only=True)
class RenameOptions:
    """How names change: first by the pattern, then the prefix is put before them."""

    prefix: str = option("text before every name, such as left_", "")
    pattern: str = option("regular expression of Python: what it matches in a name is replaced", "")
    replacement: str = option(r"text in place of each match; \1 is the pattern's first group", "")
    of: Literal["all", "joints", "links"] = option("which names: those of joints, of links, or all", "all")

    def __post_init__(self) -> None:
        if self.replacement and not self.pattern:
            raise ValueError("replacement: there is no pattern whose matches it could replace")
        try:
            re.sub(self.pattern, self.replacement, "")
        except (re.error, IndexError) as error:
            raise ValueError(f"pattern or replacement is no regular expression: {error}") from None

    def renamed(self, name: str) -> str:
        """Another name for a joint or link."""
        return self.prefix + (re.sub(self.pattern, self.replacement, name) if self.pattern else name)


def edit_table(manipulator: Manipulator, options: RenameOptions) -> Manipulator:
    """The manipulator with other names of its joints, of its links, or of both.

    base_link, flange and tool0 are the same in every robot, and keep their names; the arm of a cell has a prefix for
    these too.
    """
    from dh2urdf.fields import replace_unchecked

    joints = [row.joint if options.of == "links" else options.renamed(row.joint) for row in manipulator.rows]
    links = [row.link if options.of == "joints" else options.renamed(row.link) for row in manipulator.rows]
    problems = [
        *_problems("joint", [row.joint for row in manipulator.rows], joints),
        *_problems("link", [row.link for row in manipulator.rows], links),
    ]
    if problems:
        raise EditError(problem.about(robot=manipulator.name, mark=manipulator.mark) for problem in problems)
    named = zip(manipulator.rows, joints, links, strict=True)
    rows = tuple(replace_unchecked(row, joint=joint, link=link) for row, joint, link in named)
    notices = manipulator.notices
    if all((new.joint, new.link) == (old.joint, old.link) for new, old in zip(rows, manipulator.rows, strict=True)):
        notices = (*notices, say("edit-changes-nothing", field="edits", edit="rename", what="name"))
    return replace_unchecked(manipulator, rows=rows, notices=notices)


def _problems(what: str, before: Sequence[str], after: Sequence[str]) -> Iterator[Problem]:
    """What is wrong with the new names of joints or links, each fault once."""
    first: dict[str, str] = {}
    for old, new in zip(before, after, strict=True):
        other = first.setdefault(new, old)
        if not new.strip():
            yield say("name-gone", field="edits", found=new, what=what, old=old)
        elif other != old:
            yield say("names-alike", field="edits", found=new, what=what, other=other, old=old)


EDIT = Edit(
    name="rename",
    summary="other names of joints and links: a prefix, or a pattern and its replacement",
    options=RenameOptions,
    edit_table=edit_table,
    capabilities=(EditsInColumns(),),
)
