"""What plugins answer about many manipulators at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from other_fields import with_field

from dh2urdf.errors import StageError
from dh2urdf.robot import Link, Robot
from dh2urdf.stage_calls.calls import Call
from dh2urdf.stage_calls.column_calls import read_columns
from dh2urdf_plugins.formats.urdf import EMITTER, UrdfOptions

if TYPE_CHECKING:
    from dh2urdf.stages import Emitter

ROBOT = Robot(name="arm", links=(Link(name="base_link"),), joints=())


def call_of(groups: list[tuple[tuple[int, ...], Robot]]) -> Call[Emitter[Any]]:
    return Call(stage=with_field(EMITTER, "read_columns", lambda _: groups), options=UrdfOptions())


def test_a_group_of_nobody_is_left_out() -> None:
    """Nothing of it can be compared with a table."""
    assert read_columns(call_of([((), ROBOT), ((1, 0), ROBOT)]), [b"", b""]) == [((1, 0), ROBOT)]


@pytest.mark.parametrize("members", [(0, 0), (2,), (-1,)])
def test_members_are_those_that_were_given_once_at_most(members: tuple[int, ...]) -> None:
    with pytest.raises(StageError, match="not of 0 to 1, each once at most"):
        read_columns(call_of([(members, ROBOT)]), [b"", b""])
