"""dh2urdf in somebody's program: threads work side by side, and nothing of the process is switched."""

import gc
import locale
import logging
import os
import signal
import subprocess
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path

import pytest

import dh2urdf

TABLES = Path(__file__).parents[1] / "configs" / "tables"
NAMES = ("ur5", "stanford", "scara")

PRINTING = """
import sys, threading
from pathlib import Path
import dh2urdf

tables, out, done = Path(sys.argv[1]), Path(sys.argv[2]), threading.Event()

def convert(number):
    for turn in range(6):
        dh2urdf.convert(tables / "ur5.csv", out / f"{number}_{turn}", formats=["urdf", "xacro"])

def say():
    for line in range(3000):
        print("line", line)
        print("word", line, file=sys.stderr)
    while not done.wait(0.001):
        print("more")
        print("more", file=sys.stderr)

speaker = threading.Thread(target=say)
workers = [threading.Thread(target=convert, args=(number,)) for number in range(3)]
for thread in (speaker, *workers):
    thread.start()
for thread in workers:
    thread.join()
done.set()
speaker.join()
"""


def test_what_other_threads_print_arrives(tmp_path: Path) -> None:
    """While three threads make and prove xacros, a fourth prints: every line of it is there, and none besides."""
    command = [sys.executable, "-c", PRINTING, str(TABLES), str(tmp_path)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    for said, word in ((ran.stdout, "line"), (ran.stderr, "word")):
        lines = said.splitlines()
        expected = [f"{word} {number}" for number in range(3000)]
        assert [line for line in lines if line != "more" and line not in {*expected}] == []
        assert [line for line in lines if line != "more"] == expected
    assert len(list(tmp_path.glob("*/*.urdf.xacro"))) == 18


@pytest.mark.long
def test_threads_give_what_one_after_the_other_gives(tmp_path: Path) -> None:
    """Conversions, runs, proofs of xacros and checks in eight threads: the same bytes and the same answers."""

    def work(place: tuple[int, str]) -> dict[str, object]:
        number, name = place
        folder = tmp_path / str(number)
        (folder / "one").mkdir(parents=True)
        dh2urdf.convert(TABLES / f"{name}.csv", folder / "one", formats=["urdf", "xacro", "sdf"])
        output = {"directory": str(folder / "run")}
        page = {"html": number % 4 == 0}  # its drawings take longer than all else
        dh2urdf.run({"inputs": str(TABLES / f"{name}.csv"), "output": output, "report": page})
        findings = dh2urdf.check(folder / "one" / f"{name}.urdf.xacro").findings
        files = {
            str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(folder.rglob("*"))
            if path.suffix in {".urdf", ".sdf", ".xacro"}
        }
        return {"files": files, "rules": [finding.rule for finding in findings]}

    expected = {name: work((number, name)) for number, name in enumerate(NAMES)}
    assert all(len(each["files"]) > 4 for each in expected.values())  # type: ignore[arg-type]
    places = [(10 + number, NAMES[number % 3]) for number in range(6)]
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(work, places)) == [expected[name] for _, name in places]


def _quick() -> tuple[object, ...]:
    return (gc.isenabled(), sys.stdout, sys.stderr, len(warnings.filters), os.getcwd())  # noqa: PTH109 - much quicker


def _thorough() -> tuple[object, ...]:
    return (
        gc.get_threshold(),
        gc.get_freeze_count(),
        locale.setlocale(locale.LC_ALL),
        [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)],
        dict(os.environ),
        warnings.showwarning,
        [logging.getLogger(name).level for name in ("", "distributed", "tornado")],
        sys.getrecursionlimit(),
    )


def test_nothing_of_the_process_is_switched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """At no moment of a conversion, a run and a check: collector, streams, signals, folder, warnings and the rest."""
    monkeypatch.setattr("dh2urdf.isolation.process._OWN", [])  # a test of the command line may have claimed the process
    seen: set[tuple[object, ...]] = set()
    calls = count()

    def work(folder: Path) -> None:
        dh2urdf.convert(TABLES / "ur5.csv", folder / "one", formats=["urdf", "xacro"])
        # Without the page: matplotlib changes the filters of warnings for a moment, for every caller.
        output = {"output": {"directory": str(folder / "run")}, "report": {"html": False}}
        dh2urdf.run({"inputs": str(TABLES / "ur5.csv"), **output})
        dh2urdf.check(folder / "one" / "ur5.urdf.xacro")

    def watch(_frame: object, event: str, _argument: object) -> None:
        if event == "call" and next(calls) % 50 == 0:
            seen.add(_quick())

    work(tmp_path / "first")  # importing libraries may add filters of warnings
    before = _quick(), _thorough()
    sys.setprofile(watch)
    try:
        work(tmp_path / "second")
    finally:
        sys.setprofile(None)
    assert next(calls) > 50_000
    assert seen == {before[0]}
    assert (_quick(), _thorough()) == before
