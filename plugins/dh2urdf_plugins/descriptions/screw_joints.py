"""The joints of a file of screw axes: names, types and limits, as the reader of YAML tables reads them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.documents import Item
from dh2urdf.manipulator import JointType
from dh2urdf.source import Problem, shown
from dh2urdf.stages import Rejected
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.statements.shapes import refuse_unknown_keys
from dh2urdf_plugins.readers.words.fields import joint_type
from dh2urdf_plugins.readers.yaml_file.reading import read_table

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.documents import Node
    from dh2urdf.manipulator import DHRow

KEYS = ("name", "link", "type", "limits", "damping", "friction", "armature")
"""Keys of a joint: those of a joint in a table that do not depend on its frame."""
_STATED = ("name", "units")


def is_said_to_slide(root: Node, number: int) -> bool:
    """Whether the file declares a joint as prismatic."""
    entries = root.value if isinstance(root.value, dict) else {}
    joints = entries.get("joints")
    listed = joints.value if joints is not None and isinstance(joints.value, list) else []
    joint = listed[number].value if number < len(listed) else None
    word = joint.get("type") if isinstance(joint, dict) else None
    return word is not None and joint_type(word.text or "") is JointType.PRISMATIC


def read_joints(
    root: Node, default_name: str, slides: Sequence[bool], add: Callable[[Problem], None]
) -> tuple[str, tuple[DHRow, ...]]:
    """The arm's name, and a row for each joint whose numbers mean nothing.

    Args:
        root: the file.
        default_name: the arm's name where the file has none.
        slides: whether each joint slides.
        add: takes what is wrong, and notices; there are no rows where something is wrong.
    """
    entries = root.value if isinstance(root.value, dict) else {}
    joints = entries.get("joints")
    count = len(slides)
    listed = [replace(root, value={}) for _ in slides]
    if joints is not None:
        listed = joints.value if isinstance(joints.value, list) else []
        if len(listed) != count:
            found = f"a list of {len(listed)}" if listed else joints.describe()
            message = f"joints is {found}, and there are {count} axes"
            accepted = f"a list of {count} names, or of {count} mappings with {', '.join(KEYS)}"
            add(Problem(message=message, mark=joints.mark, field="joints", found=joints.text, accepted=accepted))
            return "", ()
    rows = [_row(node, add, is_sliding=is_sliding) for node, is_sliding in zip(listed, slides, strict=True)]
    table = {key: entries[key] for key in _STATED if key in entries} | {
        "convention": replace(root, value="standard", text="standard"),
        "joints": replace(root, value=rows),
    }
    arm = read_table(Item(replace(root, value=table)), default_name)
    if isinstance(arm, Rejected):
        for problem in arm.problems:
            add(problem)
        return "", ()
    for notice in arm.notices:
        add(notice)
    for row, is_sliding in zip(arm.rows, slides, strict=True):
        _check_type(row, add, is_sliding=is_sliding)
    return arm.name, arm.rows


def _row(node: Node, add: Callable[[Problem], None], *, is_sliding: bool) -> Node:
    """A joint as the row of a table, all of whose numbers are 0; a text is its name."""
    entries = {"name": node} if node.text is not None else node.value
    if not isinstance(entries, dict):
        return node
    refuse_unknown_keys(replace(node, value=entries), KEYS, "a joint of screw axes", add)
    zero = replace(node, value=0, text="0")
    word = "prismatic" if is_sliding else "revolute"
    given = {"type": replace(node, value=word, text=word), **dict.fromkeys(REQUIRED, zero), **entries}
    return replace(node, value=given, text=None)


def _check_type(row: DHRow, add: Callable[[Problem], None], *, is_sliding: bool) -> None:
    if row.type is JointType.FIXED or (row.type is JointType.PRISMATIC) is not is_sliding:
        add(
            Problem(
                message=f"joint {shown(row.joint)} is {row.type}, and its axis is that of a joint that "
                f"{'slides' if is_sliding else 'turns'}",
                mark=row.mark,
                joint=row.joint,
                field="type",
                found=row.type,
                accepted="prismatic" if is_sliding else "revolute, continuous",
            )
        )
