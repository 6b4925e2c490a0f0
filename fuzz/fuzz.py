"""Coverage-guided fuzzing of everything that reads what strangers wrote, with atheris (libFuzzer for Python).

    pip install -e '.[fuzz]'
    python fuzz/fuzz.py                        # every target, 15 s each
    python fuzz/fuzz.py csv yaml --seconds 600
    python fuzz/fuzz.py csv --seconds 600 --keep    # what covers new code goes into fuzz/corpus

Each target runs in a process of its own, from the corpus and from the project's reference tables. An input that breaks
a target is written to fuzz/found/, its traceback is printed, and the exit status is 1. Fix the bug and move the input
to fuzz/corpus/<target>/, where `tests/test_fuzz.py` sees that it stays fixed.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).parent
CORPUS = HERE / "corpus"
FOUND = HERE / "found"
REFERENCE = HERE.parent / "tests" / "reference" / "inputs"

TARGETS = ("csv", "yaml", "expression", "urdf", "sdf", "mjcf", "xacro", "run_file")
SUFFIXES = {"csv": ".csv", "yaml": ".yaml"}
"""Reference tables that a target starts from too."""
LONGEST = 2000
"""Length of an input [B]: what a reader does with a longer one it does with this one."""
TIME_LIMIT = 10
"""How long one input may take before it is a finding [s]: a thousand times the usual."""
MEMORY_LIMIT = 2048
"""How much memory one process may take [MiB]."""


class Result(NamedTuple):
    """What a target's process said at its end."""

    target: str
    status: int
    inputs: int
    per_second: int
    units: int


def main() -> int:
    """Fuzz some targets, one after the other, and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"one of {', '.join(TARGETS)}; all by default")
    parser.add_argument("--seconds", type=int, default=15, help="how long for each target")
    parser.add_argument("--runs", type=int, default=-1, help="how many inputs for each target; no bound by default")
    parser.add_argument("--seed", type=int, default=0, help="of the mutations; another one each time by default")
    parser.add_argument("--keep", action="store_true", help="add what covers new code to the corpus")
    parser.add_argument("--process", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if unknown := set(given.targets) - set(TARGETS):
        parser.error(f"no target is called {', '.join(sorted(unknown))}; the targets are {', '.join(TARGETS)}")
    if given.process:
        fuzz(given.targets[0], given.seconds, given.runs, given.seed, keep=given.keep)
    targets = given.targets or TARGETS
    results = [in_process(target, given.seconds, given.runs, given.seed, keep=given.keep) for target in targets]
    print(f"\n{'target':12} {'inputs':>9} {'per second':>11} {'corpus':>7}")
    for result in results:
        failed = "" if result.status == 0 else f"   FAILED: see {FOUND.relative_to(HERE.parent)}/"
        print(f"{result.target:12} {result.inputs:9} {result.per_second:11} {result.units:7}{failed}")
    return int(any(result.status for result in results))


def in_process(target: str, seconds: int, runs: int, seed: int, *, keep: bool) -> Result:
    """Fuzz a target in a process of its own: libFuzzer ends the process that it runs in."""
    command = [sys.executable, __file__, target, "--process", f"--seconds={seconds}", f"--runs={runs}"]
    command += [f"--seed={seed}", *(["--keep"] * keep)]
    done = subprocess.run(command, check=False, stderr=subprocess.PIPE, text=True, errors="replace")
    if done.returncode:
        print(done.stderr[-8000:], file=sys.stderr)

    def last(pattern: str) -> int:
        found = re.findall(pattern, done.stderr)
        return int(found[-1]) if found else 0

    return Result(
        target,
        done.returncode,
        last(r"stat::number_of_executed_units:\s*(\d+)"),
        last(r"stat::average_exec_per_sec:\s*(\d+)"),
        last(r"corp: (\d+)"),
    )


def fuzz(name: str, seconds: int, runs: int, seed: int, *, keep: bool) -> None:
    """Fuzz a target in this process, and end it."""
    import atheris

    corpus = CORPUS / name
    seeds = [path for folder in (corpus, REFERENCE) for path in sorted(folder.glob("*")) if _is_seed(path, name)]
    with atheris.instrument_imports(include=["dh2urdf", "dh2urdf_check", "dh2urdf_plugins"]):
        from targets import TARGETS as FUNCTIONS

        function = FUNCTIONS[name]
        for path in seeds:  # What is imported where it is used is imported now, where it is instrumented.
            function(path.read_bytes())
    FOUND.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for path in seeds:
            shutil.copy(path, folder)
        first = [str(corpus), folder] if keep else [folder]  # libFuzzer adds to the first folder.
        flags = [f"-max_total_time={seconds}", f"-runs={runs}", f"-max_len={LONGEST}", f"-timeout={TIME_LIMIT}"]
        flags += [
            f"-seed={seed}",
            f"-rss_limit_mb={MEMORY_LIMIT}",
            f"-artifact_prefix={FOUND}/{name}-",
            "-print_final_stats=1",
        ]
        if (words := HERE / "words" / f"{name}.txt").exists():
            flags.append(f"-dict={words}")
        atheris.Setup([sys.argv[0], *flags, *first], function)
        atheris.Fuzz()


def _is_seed(path: Path, name: str) -> bool:
    return path.is_file() and path.stat().st_size <= LONGEST and (path.parent != REFERENCE or _reads(path, name))


def _reads(path: Path, name: str) -> bool:
    return path.suffix == SUFFIXES.get(name)


if __name__ == "__main__":
    sys.exit(main())
