"""The edit `rename`: other names of joints and links."""

from typing import Any

import pytest

from dh2urdf.errors import EditError
from dh2urdf.manipulator import Manipulator
from dh2urdf.testing import reference_manipulators
from dh2urdf_plugins.edits.rename import RenameOptions, edit_table

UR5 = reference_manipulators()[0]  # joint_1 to joint_6, link_1 to link_6


def names(table: Manipulator) -> list[str]:
    return [name for row in table.rows[:2] for name in (row.joint, row.link)]


@pytest.mark.parametrize(
    ("options", "found"),
    [
        ({"prefix": "left_"}, ["left_joint_1", "left_link_1", "left_joint_2", "left_link_2"]),
        ({"prefix": "l_", "of": "joints"}, ["l_joint_1", "link_1", "l_joint_2", "link_2"]),
        ({"pattern": r"(\w+)_(\d)", "replacement": r"\2_\1"}, ["1_joint", "1_link", "2_joint", "2_link"]),
        ({"pattern": "^joint_", "replacement": "axis", "prefix": "a/"}, ["a/axis1", "a/link_1", "a/axis2", "a/link_2"]),
        ({"pattern": "^joint_"}, ["1", "link_1", "2", "link_2"]),
    ],
)
def test_names(options: dict[str, Any], found: list[str]) -> None:
    """The pattern first, then the prefix; of joints, of links, or of all. Nothing else changes."""
    edited = edit_table(UR5, RenameOptions(**options))
    assert names(edited) == found
    assert (edited.fk([0.3] * 6) == UR5.fk([0.3] * 6)).all()
    assert edited.notices == UR5.notices


def test_names_that_cannot_be_are_refused() -> None:
    """All of them at once: what they were, and what they would be."""
    with pytest.raises(EditError, match="the joints 'joint_1' and 'joint_2' are both 'joint'") as refused:
        edit_table(UR5, RenameOptions(pattern=r"_\d"))
    assert len(refused.value.problems) == 10
    with pytest.raises(EditError, match="the link 'link_1' has no name after the edit `rename`"):
        edit_table(UR5, RenameOptions(pattern="^.*$", of="links"))
