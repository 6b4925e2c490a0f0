"""Stages that each break one clause of a contract, and what the contract says: run by test_breaches.py only."""

from __future__ import annotations

from typing import Any

import bad_lab as lab
import subtle_lab as subtle
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


Case = tuple[type[Any], Any, dict[str, Any], str, str]
"""A contract, a stage, other fields of its record or of its capabilities, a clause, and what is found."""


def of(contract: type[Any], stage: Any, cases: list[tuple[dict[str, Any], str, str]]) -> list[Case]:
    return [(contract, stage, changes, f"test_{clause}", found) for changes, clause, found in cases]


IN_METRES = {"read_cells": lab.read_cells_in_metres, "options": TableOptions}
WITHOUT_PLACES = {"read_cells": lab.read_cells_without_places, "options": TableOptions}
BY_FIRST = {"edit_table": lab.edit_by_first, "capabilities": (EditsInColumns(),)}
ROUNDED = {"emit": lab.emit_remembered, "read_back": lab.read_back}
REMEMBERING = {"open": lab.load_and_remember, "prepare": lab.prepare_and_remember}

# fmt: off
BREACHES: list[Case] = [
    *of(EmitterContract, EMITTER, [
        ({"name": "My Emitter"}, "record", "the name 'My Emitter'"),
    ]),
    *of(EmitterContract, EMITTER, [
        ({"options": lab.Unexplained}, "options", "'speed' has no description"),
        ({"options": lab.Unmeasured}, "options", "'speed' measures 'lenght'"),
        ({"options": lab.Required}, "options", "'speed' has no default"),
        ({"options": lab.Thawed}, "options", "Thawed is a dataclass that can be changed"),
        ({}, "registering_imports_nothing_heavy", "no installed plugin provides the emitter"),
    ]),
    *of(Heavy, EMITTER, [
        ({}, "registering_imports_nothing_heavy", "registering bad_lab imported numpy"),
    ]),
    *of(HeavyInside, subtle.HEAVY, [
        ({}, "registering_imports_nothing_heavy", "subtle_lab imported numpy"),
    ]),
    *of(Lines, READER, [
        ({"read": subtle.read_and_reject}, "is_deterministic", ".problems[0].message is once "),
        ({"read": lab.read_without_marks}, "gives_tables", "the mark None of the manipulator 'arm'"),
        ({"read": lab.read_all_first}, "streams", "manipulators were given, though half of the file"),
    ]),
    *of(Document, READER, [
        ({"read": lab.read_all_first}, "streams", "500 of 500 manipulators were made before"),
    ]),
    *of(Untold, READER, [
        ({}, "streams", "the example holds 2 manipulators, and nothing says what a file of many holds"),
    ]),
    *of(Lines, READER, [
        ({"read": lab.read_with_cache}, "does_nothing_else", "table.cache"),
        ({"read": lab.read_carelessly}, "raises_documented_errors_only", "Error: "),
        ({"read": lab.read_elsewhere}, "errors_name_the_file", "Manipulator.from_dh():row 1"),
        ({"trace": lab.trace_nothing}, "traces_what_it_reads", "0 rows in the trace of 'arm', which"),
        ({"trace": lab.trace_in_millimetres}, "traces_what_it_reads", "'0.5' in mm as a of "),
        ({"read_columns": lab.read_columns_without_marks}, "reads_columns_as_tables", ".mark is once "),
        (IN_METRES, "reads_cells_as_files", "[(400.0, 1.57"),
        (WITHOUT_PLACES, "reads_cells_as_files", "['cells of a test:3'] for a cell that is no number"),
    ]),
    *of(TransformContract, TRANSFORM, [
        ({"transform": lab.transform_without_masses}, "makes_robots_that_readers_take", "moves and has no mass"),
        ({"transform": lab.transform_without_tool}, "keeps_the_kinematics", "tool0 of 'panda' is off by 0.107 m"),
        ({"transform": lab.transform_with_log}, "does_nothing_else", "subprocess.Popen"),
        ({"transform_columns": lab.transform_columns}, "many_at_once_are_the_same", "joints[2].origin.xyz[2] is once"),
    ]),
    *of(EditContract, EDIT, [
        ({"edit_table": lab.edit_name}, "returns_what_it_was_given", "the name 'ur5_2' for the Manip"),
        ({"edit_robot": lab.edit_loosely}, "robots_stay_what_readers_take", "of the arm 'ur5': "),
        ({"edit_robot": lab.edit_tool}, "keeps_the_kinematics", "'ur5' is off by 0.168 m"),
        (BY_FIRST, "many_at_once_are_the_same", "rows[0].d is once"),
    ]),
    *of(EmitterContract, EMITTER, [
        ({"emit": subtle.emit_and_move}, "does_nothing_else", "os.chdir of .."),
        ({"emit": subtle.emit_and_watch}, "does_nothing_else", "left the thread watcher"),
        ({"emit": subtle.emit_lambdas}, "does_nothing_else", "returns cannot be pickled: "),
        ({"emit": subtle.emit_one_by_one}, "files_have_plain_names_and_content", "<generator object emit_one"),
        ({"emit": lab.emit_elsewhere}, "files_have_plain_names_and_content", "'../robot.bad' is not a plain"),
        ({"emit": lab.emit_two}, "files_have_plain_names_and_content", "'arm-7_parts.bad', which has"),
    ]),
    *of(Kept, EMITTER, [
        ({"emit": subtle.emit_sorted}, "keeps_its_input", "].name is once "),
    ]),
    *of(EmitterContract, EMITTER, [
        ({"emit": lab.emit_unescaped}, "files_are_well_formed", "arm-7.bad.xml of the robot"),
        ({"emit": lab.emit_by_hash}, "is_deterministic", "[0][0].content is once "),
        (ROUNDED, "reads_back_the_same_arm", "tool0 of 'ur5' is off by "),
        ({"check": lab.check}, "finds_no_fault_in_its_own_files", "it is no good"),
        ({"emit_columns": lab.emit_columns}, "many_at_once_are_the_same", "[0].content is once "),
    ]),
    *of(LoaderContract, LOADER, [
        ({"open": subtle.load_and_forget}, "leaves_nothing_behind", "import time; time.sleep("),
        ({"open": subtle.load_and_log}, "leaves_nothing_behind", "the file simulator.log"),
        ({"open": lab.load_some}, "measures_the_arm", "1 of 3 poses were measured; 0 of 6 mov"),
        ({"options": lab.Never}, "measures_the_arm", "time_limit is 0.0, not seconds or None"),
        ({}, "finds_another_arm", "position_error 0.0 m, of an arm expected 0.1 m beside"),
        ({"open": lab.load_at_some_time}, "report_is_plain_data", "mass is once "),
        ({"open": lab.load_in_place}, "leaves_nothing_behind", "[0] is once b'"),
        (REMEMBERING, "reports_the_same_whatever_was_loaded_before", "alone and after `prepare`: mass is once 1"),
        ({"open": lab.load_carelessly}, "raises_documented_errors_only", "subsection not found"),
    ]),
    *of(ExecutorContract, EXECUTOR, [
        ({"map": subtle.whoever_is_done}, "results_come_in_order", " 20, 2"),
        ({"map": lab.by_name}, "results_come_in_order", "AttributeError("),
        ({"map": lab.all_at_once}, "takes_tasks_as_they_are_needed", "10001 tasks were taken before 40 results"),
        ({"map": lab.in_a_pool}, "a_worker_that_ends_costs_one_task", "BrokenProcessPool"),
        ({"map": lab.with_a_daemon}, "leaves_nothing_behind", "import time; time.sleep(60"),
    ]),
]
GOOD: list[Case] = [
    *of(Lines, READER, [
        ({"trace": lab.trace}, "traces_what_it_reads", ""),
        ({"read_columns": lab.read_columns}, "reads_columns_as_tables", ""),
    ]),
    *of(ExecutorContract, EXECUTOR, [
        ({"map": subtle.in_spawned_processes}, "leaves_nothing_behind", ""),
    ]),
]
# fmt: on
"""Clauses that are kept, though it may not seem so."""


def bad(contract: type[Any], stage: Any, changes: dict[str, Any]) -> type[Any]:
    """The contract tests of a stage with other fields."""
    for field, value in changes.items():
        stage = with_field(stage, field, value)
    return type("TestBad", (contract,), {"stage": stage})


globals().update({f"TestBad{n}": bad(*case[:3]) for n, case in enumerate([*GOOD, *BREACHES])})
