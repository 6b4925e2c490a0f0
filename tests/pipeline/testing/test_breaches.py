"""A deliberately bad plugin for each clause of each contract, and what the contract tests declare about it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from child_pytest import ADDOPTS
from lxml import etree

from dh2urdf.testing import (
    EditContract,
    EmitterContract,
    ExecutorContract,
    LoaderContract,
    ReaderContract,
    TransformContract,
)
from dh2urdf.testing.stage_contract import StageContract

pytestmark = pytest.mark.long

HERE = Path(__file__).parent
CONTRACTS = (ReaderContract, TransformContract, EditContract, EmitterContract, LoaderContract, ExecutorContract)

BREACHES = [
    ("TestNameless", "test_record", "the name 'My Emitter'"),
    ("TestMute", "test_record", "the summary ''"),
    ("TestNoRecord", "test_record", "dict {'name': 'bad'}"),
    ("TestUnmeasured", "test_options_are_explained", "the option 'speed' measures 'lenght'"),
    ("TestUnexplained", "test_options_are_explained", "the option 'speed' has no description"),
    ("TestRequired", "test_options_are_explained", "the option 'speed' has no default"),
    ("TestThawed", "test_options_are_frozen", "Thawed is a dataclass that can be changed"),
    ("TestListed", "test_options_are_frozen", "a value that can be changed (unhashable type: 'list')"),
    ("TestUnequal", "test_options_come_from_a_run_file", "Unequal(speed=1.0) and "),
    ("TestStrange", "test_schema", "pydantic cannot say what its options are"),
    ("TestNotInstalled", "test_registering_imports_nothing_heavy", "no installed plugin provides the emitter 'bad'"),
    ("TestHeavy", "test_registering_imports_nothing_heavy", "registering bad_lab imported numpy"),
    ("TestHeavyInside", "test_registering_imports_nothing_heavy", "registering subtle_lab imported numpy"),
    # Readers
    ("TestRejecting", "test_is_deterministic", ".problems[0].message is once "),
    ("TestUnmarked", "test_gives_tables", "the mark None of the manipulator 'arm'"),
    ("TestGreedy", "test_streams", "manipulators were given, though half of the file"),
    ("TestGreedyDocument", "test_streams", "500 of 500 manipulators were made before the first was given"),
    ("TestUntold", "test_streams", "the example holds 2 manipulators, and nothing says what a file of many holds"),
    ("TestReaderByHash", "test_is_deterministic", "[0].rows[0].joint is once "),
    ("TestCaching", "test_keeps_its_input", "table.cache"),
    ("TestCarelessReader", "test_raises_documented_errors_only", "Error: "),
    ("TestErrorsElsewhere", "test_errors_name_the_file", "Manipulator.from_dh():row 1"),
    ("TestTracingAnother", "test_traces_what_it_reads", "[0].name is once 'arm' and once 'another'"),
    ("TestTracingNothing", "test_traces_what_it_reads", "0 rows in the trace of 'arm', which has 1"),
    ("TestTracingMillimetres", "test_traces_what_it_reads", "'0.5' in mm as a of "),
    ("TestTracingNoPlace", "test_traces_what_it_reads", "the place None of a of "),
    ("TestColumnsWithoutMarks", "test_reads_columns_as_tables", "[0].mark is once "),
    ("TestColumnsTwice", "test_reads_columns_as_tables", "ValueError"),
    ("TestCellsInMetres", "test_reads_cells_as_files", "[(400.0, 1.57"),
    ("TestCellsWithoutPlaces", "test_reads_cells_as_files", "['cells of a test:3'] for a cell that is no number"),
    # Transforms
    ("TestRefusing", "test_is_deterministic", " is once 'error: "),
    ("TestRaising", "test_does_nothing_else", "KeyError: 'panda'\n        "),
    ("TestMassless", "test_makes_robots_that_readers_take", "moves and has no mass"),
    ("TestOtherArm", "test_keeps_the_kinematics", "tool0 of 'panda' is off by 0.107 m"),
    ("TestTransformByHash", "test_is_deterministic", "[0].comment is once "),
    ("TestLogging", "test_does_nothing_else", "started a process (subprocess.Popen): "),
    ("TestForcing", "test_keeps_its_input", "name is once 'ur5' and once 'mine'"),
    ("TestCarelessTransform", "test_raises_documented_errors_only", "ValueError: math domain error at a body of nega"),
    ("TestOneForAll", "test_many_at_once_are_the_same", "joints[2].origin.xyz[2] is once"),
    # Edits
    ("TestRenamingArms", "test_returns_what_it_was_given", "with the name 'ur5_2' for the Manipulator 'ur5'"),
    ("TestLooseRobots", "test_robots_stay_what_readers_take", "of the arm 'ur5': "),
    ("TestMovingTool", "test_keeps_the_kinematics", "tool0 of 'ur5' is off by 0.168 m"),
    ("TestEditByHash", "test_is_deterministic", "[0].rows[0].joint is once "),
    ("TestEditWithLog", "test_does_nothing_else", "started a process (subprocess.Popen): "),
    ("TestEditByForce", "test_keeps_its_input", "rows is once "),
    ("TestCarelessEdit", "test_raises_documented_errors_only", "ValueError: math domain error at a body of negative"),
    ("TestFirstForAll", "test_many_at_once_are_the_same", "rows[0].d is once"),
    # Emitters
    ("TestThroughC", "test_writes_nothing_itself", "left the file arm-7.xml"),
    ("TestMoving", "test_writes_nothing_itself", "os.chdir of .."),
    ("TestWatching", "test_writes_nothing_itself", "left the thread watcher"),
    ("TestOneByOne", "test_files_have_plain_names_and_content", "<generator object emit_one_by_one at"),
    ("TestRefusingEmitter", "test_is_deterministic", " is once 'error: "),
    ("TestLambdas", "test_writes_nothing_itself", "what it returns cannot be pickled: "),
    ("TestSorting", "test_keeps_its_input", "].name is once "),
    ("TestElsewhere", "test_files_have_plain_names_and_content", "a file named '../robot.bad' for the stem 'arm-7'"),
    ("TestTwo", "test_files_have_plain_names_and_content", "'arm-7_parts.bad', which has '_parts.bad' behind the stem"),
    ("TestUnescaped", "test_files_are_well_formed", "arm-7.bad.xml of the robot "),
    ("TestToDisk", "test_writes_nothing_itself", "wrote "),
    ("TestEmitterByHash", "test_is_deterministic", "[0][0].content is once "),
    ("TestForcingEmitter", "test_keeps_its_input", "links[0]"),
    ("TestAscii", "test_raises_documented_errors_only", "UnicodeEncodeError: "),
    ("TestRounded", "test_reads_back_the_same_arm", "tool0 of 'ur5' is off by "),
    ("TestAgainstItself", "test_finds_no_fault_in_its_own_files", "it is no good"),
    ("TestSameForAll", "test_many_at_once_are_the_same", "[0].content is once "),
    # Loaders
    ("TestForgetting", "test_leaves_nothing_behind", "import time; time.sleep(61)"),
    ("TestLogKeeping", "test_leaves_nothing_behind", "the file simulator.log"),
    ("TestHalf", "test_measures_the_arm", "1 of 3 poses were measured; 0 of 6 moving joints"),
    ("TestCredulous", "test_finds_another_arm", "position_error 0.0 m, of an arm expected 0.1 m beside where it is"),
    ("TestClock", "test_report_is_plain_data", "mass is once "),
    ("TestLeaving", "test_leaves_nothing_behind", "import time; time.sleep(60)"),
    ("TestChanging", "test_keeps_its_input", "it is once b'"),
    (
        "TestRemembering",
        "test_reports_the_same_whatever_was_loaded_before",
        "of 'panda', alone and after `prepare`: mass is once 1",
    ),
    ("TestCarelessLoader", "test_raises_documented_errors_only", "ValueError: subsection not found"),
    ("TestNoTime", "test_settings_follow_from_the_options", "time_limit is 0.0, not seconds or None"),
    # Executors
    ("TestUnordered", "test_results_come_in_order", " 20, 2"),  # the order is the threads' own
    ("TestAtOnce", "test_errors_come_in_their_place", "[], and then the error, of the reciprocals"),
    ("TestBackwards", "test_results_come_in_order", "[78, 76, 74, "),
    ("TestAllAtOnce", "test_takes_tasks_as_they_are_needed", "10001 tasks were taken before 40 results"),
    ("TestOtherErrors", "test_errors_come_in_their_place", "[1.0, 0.5], and RuntimeError was raised: a task failed"),
    ("TestLosing", "test_errors_of_the_tasks_come_in_their_place", "[0, 2, 4], and then the error"),
    ("TestByName", "test_what_it_hands_over_is_pickled", "AttributeError: '_Scaled' object has no attribute"),
    ("TestFragile", "test_a_worker_that_ends_costs_one_task", "BrokenProcessPool: "),
    ("TestDaemon", "test_leaves_nothing_behind", "import time; time.sleep(60)"),
]
TESTED = [(plugin, clause) for plugin, clause, _ in BREACHES]
KEPT = [
    ("TestTracing", "test_traces_what_it_reads"),
    ("TestInColumns", "test_reads_columns_as_tables"),
    # Before any other executor starts processes in the same interpreter: the helpers would be there already.
    ("TestSpawning", "test_leaves_nothing_behind"),
    # What it changes here is not to be there already where its input is compared.
    ("TestSorting", "test_files_have_plain_names_and_content"),
]
"""Clauses that are kept, though it may not seem so."""


@pytest.fixture(scope="module")
def failures(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], str]:
    """What one run of pytest declares about each bad plugin, by class and clause; a test that passed is not in it."""
    report = tmp_path_factory.mktemp("breaches") / "report.xml"
    tests = [f"{HERE / 'bad_contracts.py'}::{plugin}::{clause}" for plugin, clause in [*KEPT, *TESTED]]
    path = os.pathsep.join(filter(None, [str(HERE), str(HERE.parents[1] / "shared"), os.environ.get("PYTHONPATH")]))
    subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--noconftest", f"--junit-xml={report}", *tests],
        env={**os.environ, "PYTHONPATH": path, "PYTEST_ADDOPTS": ADDOPTS},
        cwd=report.parent,
        capture_output=True,
        check=False,
    )
    return {
        (case.get("classname").rpartition(".")[2], case.get("name")): case.find("failure").text
        for case in etree.parse(report).iter("testcase")
        if case.find("failure") is not None
    }


@pytest.mark.parametrize(("plugin", "clause", "found"), BREACHES, ids=[plugin for plugin, _, _ in BREACHES])
def test_a_breach_is_told(failures: dict[tuple[str, str], str], plugin: str, clause: str, found: str) -> None:
    """The message names the stage and the clause, and says what was found, what is accepted and what to do."""
    message = failures[plugin, clause]
    first, second, third, fourth = re.split(r"\n    (?! )", message)
    assert re.match(rf"\w+ '[^']+' breaks the contract, clause {clause}: ", first)
    assert any(first.endswith(getattr(contract, clause).__doc__) for contract in CONTRACTS if hasattr(contract, clause))
    assert second.startswith("found: ")
    assert found in second
    assert third.startswith("accepted: ")
    assert fourth.startswith("what to do: ")


def test_what_python_starts_for_itself_is_nobodys_fault(failures: dict[tuple[str, str], str]) -> None:
    """A pool of spawned processes leaves multiprocessing's resource tracker, and leaves nothing behind."""
    assert failures.keys() & set(KEPT) == set()


def test_every_clause_has_a_bad_plugin(failures: dict[tuple[str, str], str]) -> None:
    """No clause goes untried: for each test of each contract there is a plugin that fails it."""
    tried = {(message.split()[0], clause) for (_, clause), message in failures.items()}
    for contract in CONTRACTS:
        assert {name for name in vars(contract) if name.startswith("test_")} == {
            clause for kind, clause in tried if kind == contract.kind and clause in vars(contract)
        }
    common = {name for name in vars(StageContract) if name.startswith("test_")}
    assert common <= {clause for _, clause in tried}
