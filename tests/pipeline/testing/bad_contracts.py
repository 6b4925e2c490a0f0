"""Stages that each break one clause of a contract, and what the contract says: run by test_breaches.py only."""

from __future__ import annotations

from typing import Any

import bad_lab
import subtle_lab
from bad_lab import EDIT, EMITTER, EXECUTOR, LOADER, READER, TRANSFORM
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

LINE = "arm{} 0.5 0.25\n"


class Lines(ReaderContract):
    example = LINE.format("")

    def many(self, count: int) -> str:
        return "".join(LINE.format(number) for number in range(count))


class Document(Lines):
    is_document = True


class Untold(ReaderContract):
    example = LINE.format(1) + LINE.format(2)


class Heavy(EmitterContract):
    plugin = "bad_lab"


class HeavyInside(LoaderContract):
    plugin = "subtle_lab"


class Kept(EmitterContract):
    robots = tuple(map(plain_robot, reference_manipulators()))


def f(**changes: Any) -> dict[str, Any]:
    """Other fields of the record of a stage, or of its capabilities."""
    return changes


IN_METRES = f(read_cells=bad_lab.read_cells_in_metres, options=TableOptions)
WITHOUT_PLACES = f(read_cells=bad_lab.read_cells_without_places, options=TableOptions)
BY_FIRST = f(edit_table=bad_lab.edit_by_first, capabilities=(EditsInColumns(),))
ROUNDED = f(emit=bad_lab.emit_remembered, read_back=bad_lab.read_back)
REMEMBERING = f(open=bad_lab.load_and_remember, prepare=bad_lab.prepare_and_remember)

BREACHES: list[tuple[type[Any], Any, dict[str, Any], str, str]] = [
    (EmitterContract, EMITTER, f(name="My Emitter"), "test_record", "the name 'My Emitter'"),
    (EmitterContract, EMITTER, f(summary=""), "test_record", "the summary ''"),
    (EmitterContract, {"name": "bad"}, {}, "test_record", "dict {'name': 'bad'}"),
    (EmitterContract, EMITTER, f(options=bad_lab.Unexplained), "test_options", "'speed' has no description"),
    (EmitterContract, EMITTER, f(options=bad_lab.Unmeasured), "test_options", "'speed' measures 'lenght'"),
    (EmitterContract, EMITTER, f(options=bad_lab.Required), "test_options", "'speed' has no default"),
    (EmitterContract, EMITTER, f(options=bad_lab.Thawed), "test_options", "Thawed is a dataclass that can be changed"),
    (EmitterContract, EMITTER, f(options=bad_lab.Listed), "test_options", "a value that can be changed (unhashable"),
    (EmitterContract, EMITTER, f(options=bad_lab.Unequal), "test_options", "Unequal(speed=1.0) and "),
    (EmitterContract, EMITTER, f(options=bad_lab.Strange), "test_options", "pydantic cannot say what its options are"),
    (
        EmitterContract,
        EMITTER,
        {},
        "test_registering_imports_nothing_heavy",
        "no installed plugin provides the emitter",
    ),
    (Heavy, EMITTER, {}, "test_registering_imports_nothing_heavy", "registering bad_lab imported numpy"),
    (HeavyInside, subtle_lab.HEAVY, {}, "test_registering_imports_nothing_heavy", "subtle_lab imported numpy"),
    # Readers
    (Lines, READER, f(read=subtle_lab.read_and_reject), "test_is_deterministic", ".problems[0].message is once "),
    (Lines, READER, f(read=bad_lab.read_without_marks), "test_gives_tables", "the mark None of the manipulator 'arm'"),
    (Lines, READER, f(read=bad_lab.read_all_first), "test_streams", "manipulators were given, though half of the file"),
    (Document, READER, f(read=bad_lab.read_all_first), "test_streams", "500 of 500 manipulators were made before"),
    (
        Untold,
        READER,
        {},
        "test_streams",
        "the example holds 2 manipulators, and nothing says what a file of many holds",
    ),
    (Lines, READER, f(read=bad_lab.read_with_cache), "test_does_nothing_else", "table.cache"),
    (Lines, READER, f(read=bad_lab.read_carelessly), "test_raises_documented_errors_only", "Error: "),
    (Lines, READER, f(read=bad_lab.read_elsewhere), "test_errors_name_the_file", "Manipulator.from_dh():row 1"),
    (Lines, READER, f(trace=bad_lab.trace_another), "test_traces_what_it_reads", "once 'arm' and once 'another'"),
    (Lines, READER, f(trace=bad_lab.trace_nothing), "test_traces_what_it_reads", "0 rows in the trace of 'arm', which"),
    (Lines, READER, f(trace=bad_lab.trace_in_millimetres), "test_traces_what_it_reads", "'0.5' in mm as a of "),
    (Lines, READER, f(trace=bad_lab.trace_no_place), "test_traces_what_it_reads", "the place None of a of "),
    (
        Lines,
        READER,
        f(read_columns=bad_lab.read_columns_without_marks),
        "test_reads_columns_as_tables",
        ".mark is once ",
    ),
    (Lines, READER, f(read_columns=bad_lab.read_columns_twice), "test_reads_columns_as_tables", "ValueError"),
    (Lines, READER, IN_METRES, "test_reads_cells_as_files", "[(400.0, 1.57"),
    (Lines, READER, WITHOUT_PLACES, "test_reads_cells_as_files", "['cells of a test:3'] for a cell that is no number"),
    # Transforms
    (TransformContract, TRANSFORM, f(transform=subtle_lab.refuse), "test_is_deterministic", " is once 'error: "),
    (
        TransformContract,
        TRANSFORM,
        f(transform=subtle_lab.raise_at_a_good_arm),
        "test_does_nothing_else",
        "KeyError: 'p",
    ),
    (
        TransformContract,
        TRANSFORM,
        f(transform=bad_lab.transform_without_masses),
        "test_makes_robots_that_readers_take",
        "moves and has no mass",
    ),
    (
        TransformContract,
        TRANSFORM,
        f(transform=bad_lab.transform_without_tool),
        "test_keeps_the_kinematics",
        "tool0 of 'panda' is off by 0.107 m",
    ),
    (
        TransformContract,
        TRANSFORM,
        f(transform=bad_lab.transform_with_log),
        "test_does_nothing_else",
        "subprocess.Popen",
    ),
    (
        TransformContract,
        TRANSFORM,
        f(transform_columns=bad_lab.transform_columns),
        "test_many_at_once_are_the_same",
        "joints[2].origin.xyz[2] is once",
    ),
    # Edits
    (
        EditContract,
        EDIT,
        f(edit_table=bad_lab.edit_name),
        "test_returns_what_it_was_given",
        "the name 'ur5_2' for the Manip",
    ),
    (
        EditContract,
        EDIT,
        f(edit_robot=bad_lab.edit_loosely),
        "test_robots_stay_what_readers_take",
        "of the arm 'ur5': ",
    ),
    (EditContract, EDIT, f(edit_robot=bad_lab.edit_tool), "test_keeps_the_kinematics", "'ur5' is off by 0.168 m"),
    (EditContract, EDIT, f(edit_table=bad_lab.edit_by_force), "test_keeps_its_input", "rows is once "),
    (
        EditContract,
        EDIT,
        f(edit_table=bad_lab.edit_carelessly),
        "test_raises_documented_errors_only",
        "math domain error",
    ),
    (EditContract, EDIT, BY_FIRST, "test_many_at_once_are_the_same", "rows[0].d is once"),
    # Emitters
    (EmitterContract, EMITTER, f(emit=subtle_lab.emit_through_c), "test_does_nothing_else", "left the file arm-7.xml"),
    (EmitterContract, EMITTER, f(emit=subtle_lab.emit_and_move), "test_does_nothing_else", "os.chdir of .."),
    (EmitterContract, EMITTER, f(emit=subtle_lab.emit_and_watch), "test_does_nothing_else", "left the thread watcher"),
    (
        EmitterContract,
        EMITTER,
        f(emit=subtle_lab.emit_lambdas),
        "test_does_nothing_else",
        "returns cannot be pickled: ",
    ),
    (EmitterContract, EMITTER, f(emit=bad_lab.emit_to_disk), "test_does_nothing_else", "wrote "),
    (
        EmitterContract,
        EMITTER,
        f(emit=subtle_lab.emit_one_by_one),
        "test_files_have_plain_names_and_content",
        "<generator object emit_one_by_one at",
    ),
    (
        EmitterContract,
        EMITTER,
        f(emit=bad_lab.emit_elsewhere),
        "test_files_have_plain_names_and_content",
        "'../robot.bad' is not a plain file name",
    ),
    (
        EmitterContract,
        EMITTER,
        f(emit=bad_lab.emit_two),
        "test_files_have_plain_names_and_content",
        "'arm-7_parts.bad', which has '_parts.bad' behind the stem",
    ),
    (Kept, EMITTER, f(emit=subtle_lab.emit_sorted), "test_keeps_its_input", "].name is once "),
    (
        EmitterContract,
        EMITTER,
        f(emit=bad_lab.emit_unescaped),
        "test_files_are_well_formed",
        "arm-7.bad.xml of the robot",
    ),
    (EmitterContract, EMITTER, f(emit=bad_lab.emit_by_hash), "test_is_deterministic", "[0][0].content is once "),
    (
        EmitterContract,
        EMITTER,
        f(emit=bad_lab.emit_ascii),
        "test_raises_documented_errors_only",
        "UnicodeEncodeError: ",
    ),
    (EmitterContract, EMITTER, ROUNDED, "test_reads_back_the_same_arm", "tool0 of 'ur5' is off by "),
    (EmitterContract, EMITTER, f(check=bad_lab.check), "test_finds_no_fault_in_its_own_files", "it is no good"),
    (
        EmitterContract,
        EMITTER,
        f(emit_columns=bad_lab.emit_columns),
        "test_many_at_once_are_the_same",
        "[0].content is once ",
    ),
    # Loaders
    (
        LoaderContract,
        LOADER,
        f(open=subtle_lab.load_and_forget),
        "test_leaves_nothing_behind",
        "import time; time.sleep(",
    ),
    (LoaderContract, LOADER, f(open=subtle_lab.load_and_log), "test_leaves_nothing_behind", "the file simulator.log"),
    (
        LoaderContract,
        LOADER,
        f(open=bad_lab.load_some),
        "test_measures_the_arm",
        "1 of 3 poses were measured; 0 of 6 mov",
    ),
    (
        LoaderContract,
        LOADER,
        f(options=bad_lab.Never),
        "test_measures_the_arm",
        "time_limit is 0.0, not seconds or None",
    ),
    (LoaderContract, LOADER, {}, "test_finds_another_arm", "position_error 0.0 m, of an arm expected 0.1 m beside"),
    (LoaderContract, LOADER, f(open=bad_lab.load_at_some_time), "test_report_is_plain_data", "mass is once "),
    (LoaderContract, LOADER, f(open=bad_lab.load_in_place), "test_leaves_nothing_behind", "[0] is once b'"),
    (
        LoaderContract,
        LOADER,
        REMEMBERING,
        "test_reports_the_same_whatever_was_loaded_before",
        "alone and after `prepare`: mass is once 1",
    ),
    (
        LoaderContract,
        LOADER,
        f(open=bad_lab.load_carelessly),
        "test_raises_documented_errors_only",
        "subsection not found",
    ),
    # Executors
    (ExecutorContract, EXECUTOR, f(map=subtle_lab.whoever_is_done), "test_results_come_in_order", " 20, 2"),
    (
        ExecutorContract,
        EXECUTOR,
        f(map=subtle_lab.at_once),
        "test_results_come_in_order",
        "[], and then ZeroDivisionErr",
    ),
    (
        ExecutorContract,
        EXECUTOR,
        f(map=bad_lab.with_other_errors),
        "test_results_come_in_order",
        "RuntimeError('a task",
    ),
    (
        ExecutorContract,
        EXECUTOR,
        f(map=bad_lab.losing_the_last),
        "test_results_come_in_order",
        "[0, 2, 4], and then Look",
    ),
    (ExecutorContract, EXECUTOR, f(map=bad_lab.by_name), "test_results_come_in_order", "AttributeError("),
    (
        ExecutorContract,
        EXECUTOR,
        f(map=bad_lab.all_at_once),
        "test_takes_tasks_as_they_are_needed",
        "10001 tasks were taken before 40 results",
    ),
    (
        ExecutorContract,
        EXECUTOR,
        f(map=bad_lab.in_a_pool),
        "test_a_worker_that_ends_costs_one_task",
        "BrokenProcessPool",
    ),
    (
        ExecutorContract,
        EXECUTOR,
        f(map=bad_lab.with_a_daemon),
        "test_leaves_nothing_behind",
        "import time; time.sleep(60",
    ),
]
GOOD: list[tuple[type[Any], Any, dict[str, Any], str, str]] = [
    (Lines, READER, f(trace=bad_lab.trace), "test_traces_what_it_reads", ""),
    (Lines, READER, f(read_columns=bad_lab.read_columns), "test_reads_columns_as_tables", ""),
    # First of the executors that start processes: the helpers of multiprocessing would be there already.
    (ExecutorContract, EXECUTOR, f(map=subtle_lab.in_spawned_processes), "test_leaves_nothing_behind", ""),
]
"""Clauses that are kept, though it may not seem so."""


def bad(contract: type[Any], stage: Any, changes: dict[str, Any]) -> type[Any]:
    """The contract tests of a stage with other fields."""
    for field, value in changes.items():
        stage = with_field(stage, field, value)
    return type("TestBad", (contract,), {"stage": stage})


globals().update({f"TestBad{n}": bad(*case[:3]) for n, case in enumerate([*GOOD, *BREACHES])})
