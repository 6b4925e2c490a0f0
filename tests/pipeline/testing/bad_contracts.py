"""The contract tests of stages that each break one clause: run by test_breaches.py, and by nobody else."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import bad_lab
import subtle_lab
from other_fields import with_field

from dh2urdf.stages import EditsInColumns
from dh2urdf.testing import (
    EditContract,
    EmitterContract,
    ExecutorContract,
    LoaderContract,
    ReaderContract,
    TransformContract,
    plain_robot,
    reference_manipulators,
)
from dh2urdf_plugins.readers.table import TableOptions

if TYPE_CHECKING:
    from dh2urdf.testing.stage_contract import StageContract

LINE = "arm{} 0.5 0.25\n"


class Lines(ReaderContract):
    example = LINE.format("")

    def many(self, count: int) -> str:
        return "".join(LINE.format(number) for number in range(count))


def of(contract: type[StageContract], stage: Any, **changes: Any) -> type[StageContract]:
    """The contract tests of a stage with other fields, of its record or of its capabilities."""
    for field, value in changes.items():
        stage = with_field(stage, field, value)
    return type("TestBad", (contract,), {"stage": stage})


# All kinds
TestNameless = of(EmitterContract, bad_lab.EMITTER, name="My Emitter")
TestMute = of(EmitterContract, bad_lab.EMITTER, summary="")
TestNoRecord = of(EmitterContract, {"name": "bad"})
TestUnexplained = of(EmitterContract, bad_lab.EMITTER, options=bad_lab.Unexplained)
TestUnmeasured = of(EmitterContract, bad_lab.EMITTER, options=bad_lab.Unmeasured)
TestRequired = of(EmitterContract, bad_lab.EMITTER, options=bad_lab.Required)
TestThawed = of(EmitterContract, bad_lab.EMITTER, options=bad_lab.Thawed)
TestListed = of(EmitterContract, bad_lab.EMITTER, options=bad_lab.Listed)
TestUnequal = of(EmitterContract, bad_lab.EMITTER, options=bad_lab.Unequal)
TestStrange = of(EmitterContract, bad_lab.EMITTER, options=bad_lab.Strange)
TestNotInstalled = of(EmitterContract, bad_lab.EMITTER)


class TestHeavy(EmitterContract):
    stage = bad_lab.EMITTER
    plugin = "bad_lab"


class TestHeavyInside(LoaderContract):
    stage = subtle_lab.HEAVY
    plugin = "subtle_lab"


# Readers
TestRejecting = of(Lines, bad_lab.READER, read=subtle_lab.read_and_reject)
TestUnmarked = of(Lines, bad_lab.READER, read=bad_lab.read_without_marks)
TestGreedy = of(Lines, bad_lab.READER, read=bad_lab.read_all_first)
TestReaderByHash = of(Lines, bad_lab.READER, read=bad_lab.read_by_hash)
TestCaching = of(Lines, bad_lab.READER, read=bad_lab.read_with_cache)
TestCarelessReader = of(Lines, bad_lab.READER, read=bad_lab.read_carelessly)
TestErrorsElsewhere = of(Lines, bad_lab.READER, read=bad_lab.read_elsewhere)
TestTracingAnother = of(Lines, bad_lab.READER, trace=bad_lab.trace_another)
TestTracingNothing = of(Lines, bad_lab.READER, trace=bad_lab.trace_nothing)
TestTracingMillimetres = of(Lines, bad_lab.READER, trace=bad_lab.trace_in_millimetres)
TestTracingNoPlace = of(Lines, bad_lab.READER, trace=bad_lab.trace_no_place)
TestTracing = of(Lines, bad_lab.READER, trace=bad_lab.trace)
TestColumnsWithoutMarks = of(Lines, bad_lab.READER, read_columns=bad_lab.read_columns_without_marks)
TestColumnsTwice = of(Lines, bad_lab.READER, read_columns=bad_lab.read_columns_twice)
TestInColumns = of(Lines, bad_lab.READER, read_columns=bad_lab.read_columns)
TestCellsInMetres = of(Lines, bad_lab.READER, read_cells=bad_lab.read_cells_in_metres, options=TableOptions)
TestCellsWithoutPlaces = of(Lines, bad_lab.READER, read_cells=bad_lab.read_cells_without_places, options=TableOptions)


class TestGreedyDocument(Lines):
    stage = replace(bad_lab.READER, read=bad_lab.read_all_first)
    is_document = True


class TestUntold(ReaderContract):
    stage = bad_lab.READER
    example = LINE.format(1) + LINE.format(2)


# Transforms
TestRefusing = of(TransformContract, bad_lab.TRANSFORM, transform=subtle_lab.refuse)
TestRaising = of(TransformContract, bad_lab.TRANSFORM, transform=subtle_lab.raise_at_a_good_arm)
TestMassless = of(TransformContract, bad_lab.TRANSFORM, transform=bad_lab.transform_without_masses)
TestOtherArm = of(TransformContract, bad_lab.TRANSFORM, transform=bad_lab.transform_without_tool)
TestTransformByHash = of(TransformContract, bad_lab.TRANSFORM, transform=bad_lab.transform_by_hash)
TestLogging = of(TransformContract, bad_lab.TRANSFORM, transform=bad_lab.transform_with_log)
TestForcing = of(TransformContract, bad_lab.TRANSFORM, transform=bad_lab.transform_by_force)
TestCarelessTransform = of(TransformContract, bad_lab.TRANSFORM, transform=bad_lab.transform_carelessly)
TestOneForAll = of(TransformContract, bad_lab.TRANSFORM, transform_columns=bad_lab.transform_columns)

# Edits
TestRenamingArms = of(EditContract, bad_lab.EDIT, edit_table=bad_lab.edit_name)
TestLooseRobots = of(EditContract, bad_lab.EDIT, edit_robot=bad_lab.edit_loosely)
TestMovingTool = of(EditContract, bad_lab.EDIT, edit_robot=bad_lab.edit_tool)
TestEditByHash = of(EditContract, bad_lab.EDIT, edit_table=bad_lab.edit_by_hash)
TestEditWithLog = of(EditContract, bad_lab.EDIT, edit_table=bad_lab.edit_with_log)
TestEditByForce = of(EditContract, bad_lab.EDIT, edit_table=bad_lab.edit_by_force)
TestCarelessEdit = of(EditContract, bad_lab.EDIT, edit_table=bad_lab.edit_carelessly)
TestFirstForAll = of(EditContract, bad_lab.EDIT, edit_table=bad_lab.edit_by_first, capabilities=(EditsInColumns(),))

# Emitters
TestThroughC = of(EmitterContract, bad_lab.EMITTER, emit=subtle_lab.emit_through_c)
TestMoving = of(EmitterContract, bad_lab.EMITTER, emit=subtle_lab.emit_and_move)
TestWatching = of(EmitterContract, bad_lab.EMITTER, emit=subtle_lab.emit_and_watch)
TestOneByOne = of(EmitterContract, bad_lab.EMITTER, emit=subtle_lab.emit_one_by_one)
TestRefusingEmitter = of(EmitterContract, bad_lab.EMITTER, emit=subtle_lab.emit_or_refuse)
TestLambdas = of(EmitterContract, bad_lab.EMITTER, emit=subtle_lab.emit_lambdas)


class TestSorting(EmitterContract):
    stage = replace(bad_lab.EMITTER, emit=subtle_lab.emit_sorted)
    robots = tuple(map(plain_robot, reference_manipulators()))


TestElsewhere = of(EmitterContract, bad_lab.EMITTER, emit=bad_lab.emit_elsewhere)
TestTwo = of(EmitterContract, bad_lab.EMITTER, emit=bad_lab.emit_two)
TestUnescaped = of(EmitterContract, bad_lab.EMITTER, emit=bad_lab.emit_unescaped)
TestToDisk = of(EmitterContract, bad_lab.EMITTER, emit=bad_lab.emit_to_disk)
TestEmitterByHash = of(EmitterContract, bad_lab.EMITTER, emit=bad_lab.emit_by_hash)
TestForcingEmitter = of(EmitterContract, bad_lab.EMITTER, emit=bad_lab.emit_by_force)
TestAscii = of(EmitterContract, bad_lab.EMITTER, emit=bad_lab.emit_ascii)
TestRounded = of(EmitterContract, bad_lab.EMITTER, emit=bad_lab.emit_remembered, read_back=bad_lab.read_back)
TestAgainstItself = of(EmitterContract, bad_lab.EMITTER, check=bad_lab.check)
TestSameForAll = of(EmitterContract, bad_lab.EMITTER, emit_columns=bad_lab.emit_columns)

# Loaders
TestForgetting = of(LoaderContract, bad_lab.LOADER, open=subtle_lab.load_and_forget)
TestLogKeeping = of(LoaderContract, bad_lab.LOADER, open=subtle_lab.load_and_log)
TestHalf = of(LoaderContract, bad_lab.LOADER, open=bad_lab.load_some)
TestCredulous = of(LoaderContract, bad_lab.LOADER)
TestClock = of(LoaderContract, bad_lab.LOADER, open=bad_lab.load_at_some_time)
TestRemembering = of(
    LoaderContract, bad_lab.LOADER, open=bad_lab.load_and_remember, prepare=bad_lab.prepare_and_remember
)
TestLeaving = of(LoaderContract, bad_lab.LOADER, open=bad_lab.load_and_leave)
TestChanging = of(LoaderContract, bad_lab.LOADER, open=bad_lab.load_in_place)
TestCarelessLoader = of(LoaderContract, bad_lab.LOADER, open=bad_lab.load_carelessly)
TestNoTime = of(LoaderContract, bad_lab.LOADER, options=bad_lab.Never)

# Executors
TestSpawning = of(ExecutorContract, subtle_lab.SPAWNING)
TestUnordered = of(ExecutorContract, bad_lab.EXECUTOR, map=subtle_lab.whoever_is_done)
TestAtOnce = of(ExecutorContract, bad_lab.EXECUTOR, map=subtle_lab.at_once)
TestBackwards = of(ExecutorContract, bad_lab.EXECUTOR, map=bad_lab.as_they_come)
TestAllAtOnce = of(ExecutorContract, bad_lab.EXECUTOR, map=bad_lab.all_at_once)
TestOtherErrors = of(ExecutorContract, bad_lab.EXECUTOR, map=bad_lab.with_other_errors)
TestLosing = of(ExecutorContract, bad_lab.EXECUTOR, map=bad_lab.losing_the_last)
TestByName = of(ExecutorContract, bad_lab.EXECUTOR, map=bad_lab.by_name)
TestFragile = of(ExecutorContract, bad_lab.EXECUTOR, map=bad_lab.in_a_pool)
TestDaemon = of(ExecutorContract, bad_lab.EXECUTOR, map=bad_lab.with_a_daemon)
