import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from other_fields import with_field

from dh2urdf.errors import EmitterError, StageError
from dh2urdf.isolation.attribution import Plugin
from dh2urdf.plugin_system import KINDS, calls as attribution, load
from dh2urdf.plugin_system.calls import Call, blaming, depending_on, own_work
from dh2urdf.plugin_system.column_calls import read_columns
from dh2urdf.robot import Link, Robot
from dh2urdf.stages import Emitter, NoOptions
from dh2urdf_plugins.formats.urdf import EMITTER, UrdfOptions

# Every function of every record is tried by the commands in tests/test_failing_plugins.py.

STAGE = Emitter(name="usd", summary="s", emit=lambda *_: (), options=NoOptions, suffixes=())
PLUGIN = Plugin(name="lab = lab.plugin", distribution="lab 1.0")
CALL = Call(stage=STAGE, options=NoOptions(), plugin=PLUGIN)


def fail(error: BaseException) -> None:
    raise error


class TestBlaming:
    def test_a_refusal_is_no_fault(self) -> None:
        """An error of dh2urdf goes on as it is, from every stage."""
        refusal = EmitterError("this arm cannot be written")
        with pytest.raises(EmitterError) as caught, blaming(CALL):
            fail(refusal)
        assert caught.value is refusal
        with pytest.raises(EmitterError) as caught, depending_on(CALL):
            fail(refusal)
        assert caught.value is refusal


class TestDependingOn:
    def test_what_the_host_raises_within_is_its_own(self) -> None:
        """Also after a way between processes, on which an exception keeps its notes."""
        with pytest.raises(KeyError) as caught, depending_on(CALL), own_work():
            fail(KeyError("colour"))
        arrived = pickle.loads(pickle.dumps(caught.value))  # noqa: S301 - made here
        with pytest.raises(KeyError), depending_on(CALL):
            fail(arrived)


class TestBetweenProcesses:
    @pytest.mark.parametrize("kind", KINDS)
    def test_a_stage_is_found_again_in_its_plugin(self, kind: Any) -> None:
        """By the names of plugin, distribution and stage: the very same stage of the very same plugin."""
        for item in load().provided(kind):
            call = Call(stage=item.stage, options=item.stage.options(), plugin=item.plugin)
            again = pickle.loads(pickle.dumps(call))  # noqa: S301 - made here
            assert (again.kind, again.stage, again.options) == (kind, call.stage, call.options)
            assert (again.plugin.name, again.plugin.distribution) == (item.plugin.name, item.plugin.distribution)

    def test_no_other_plugin_is_imported_for_it(
        self, tmp_path: Path, install: Callable[..., None], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """A worker imports what the run uses, however many plugins are installed there."""
        item = next(iter(load().provided("emitter")))
        data = pickle.dumps(Call(stage=item.stage, options=item.stage.options(), plugin=item.plugin))
        install(tmp_path, "stranger", "raise SystemExit('nobody asked')")
        monkeypatch.syspath_prepend(tmp_path)
        attribution._catalog.cache_clear()  # as in a new process
        assert pickle.loads(data).stage is item.stage  # noqa: S301 - made here
        assert "stranger_lab" not in sys.modules


# --- What plugins answer about many manipulators at once

ROBOT = Robot(name="arm", links=(Link(name="base_link"),), joints=())


def call_of(groups: list[tuple[tuple[int, ...], Robot]]) -> Call[Emitter[Any]]:
    return Call(stage=with_field(EMITTER, "read_columns", lambda _: groups), options=UrdfOptions())


def test_a_group_of_nobody_is_left_out() -> None:
    """Nothing of it can be compared with a table."""
    assert read_columns(call_of([((), ROBOT), ((1, 0), ROBOT)]), [b"", b""]) == [((1, 0), ROBOT)]


@pytest.mark.parametrize("members", [(0, 0), (2,), (-1,)])
def test_members_are_those_that_were_given_once_at_most(members: tuple[int, ...]) -> None:
    with pytest.raises(StageError):
        read_columns(call_of([(members, ROBOT)]), [b"", b""])
