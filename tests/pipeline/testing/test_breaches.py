"""A deliberately bad plugin for each clause of each contract, and what the contract tests declare about it."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from bad_contracts import BREACHES, GOOD
from child_python import ADDOPTS
from lxml import etree

from dh2urdf.testing import EditContract, EmitterContract, ExecutorContract, LoaderContract, ReaderContract
from dh2urdf.testing.robot_contracts import TransformContract
from dh2urdf.testing.stage_contract import InputContract, StageContract

pytestmark = pytest.mark.long

HERE = Path(__file__).parent
KINDS = (ReaderContract, TransformContract, EditContract, EmitterContract, LoaderContract, ExecutorContract)
CONTRACTS = (*KINDS, InputContract, StageContract)


@pytest.fixture(scope="module")
def failures(tmp_path_factory: pytest.TempPathFactory) -> dict[int, str]:
    """What one run of pytest declares about each bad plugin, by its number; a test that passed is not in it."""
    report = tmp_path_factory.mktemp("breaches") / "report.xml"
    tests = [f"{HERE / 'bad_contracts.py'}::TestBad{n}::{case[3]}" for n, case in enumerate([*GOOD, *BREACHES])]
    path = os.pathsep.join(filter(None, [str(HERE), str(HERE.parents[1] / "shared"), os.environ.get("PYTHONPATH")]))
    subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--noconftest", f"--junit-xml={report}", *tests],
        env={**os.environ, "PYTHONPATH": path, "PYTEST_ADDOPTS": ADDOPTS},
        cwd=report.parent,
        capture_output=True,
        check=False,
    )
    return {
        int(case.get("classname").rpartition("TestBad")[2]): case.find("failure").text
        for case in etree.parse(report).iter("testcase")
        if case.find("failure") is not None
    }


@pytest.mark.parametrize(
    ("number", "case"), enumerate(BREACHES, len(GOOD)), ids=[f"{case[3]}-{case[4]}" for case in BREACHES]
)
def test_a_breach_is_told(failures: dict[int, str], number: int, case: tuple[Any, ...]) -> None:
    """The message names the stage and the clause, and says what was found, what is accepted and what to do."""
    contract, _, _, clause, found = case
    first, second, third, fourth = re.split(r"\n    (?! )", failures[number])
    assert re.match(rf"\w+ '[^']+' breaks the contract, clause {clause}: ", first)
    assert first.endswith(getattr(contract, clause).__doc__)
    assert second.startswith("found: ")
    assert found in second
    assert third.startswith("accepted: ")
    assert fourth.startswith("what to do: ")


def test_what_python_starts_for_itself_is_nobodys_fault(failures: dict[int, str]) -> None:
    """A pool of spawned processes leaves multiprocessing's resource tracker, and leaves nothing behind."""
    assert failures.keys() & set(range(len(GOOD))) == set()


def test_every_clause_has_a_bad_plugin() -> None:
    """No clause goes untried: for each test of each contract there is a plugin that fails it."""
    tried = {(base, case[3]) for case in BREACHES for base in case[0].__mro__ if case[3] in vars(base)}
    clauses = {(contract, name) for contract in CONTRACTS for name in vars(contract) if name.startswith("test_")}
    assert clauses <= tried
