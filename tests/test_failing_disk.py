"""A disk that fails at any call of the system: one sentence, and never an internal error."""

import errno
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="calls of other systems have other names"),
    pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc"),
]

SHARED = Path(__file__).parent / "shared"
READ, WRITE = "open,close,read", "open,close,read,write,fsync,rename,unlink,mkdir,rmdir"
TABLE = "# convention: standard\nrobot, joint, a, alpha, d\narm, j1, 0.4, pi/2, 0.1\narm, j2, 0.3, 0, 0\n"
RUN = """\
inputs: arm.csv
variations: [{{of: arm, count: 3, seed: 7, vary: {{joints: all, field: mass, uniform: [1, 5]}}}}]
output: {{directory: out{}}}
execution: {{stage: local, options: {{workers: 1}}}}
report: {{html: false}}
"""
REASONS = (os.strerror(errno.EIO), os.strerror(errno.EBADF), "error closing file")
"""What is said of a fault; the second by Python's `rmtree`, which closes a folder twice, and the third by Arrow."""
LAYOUTS = {"files": "", "shards": ", layout: shards, size: 2"}


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library that makes calls fail."""
    target = tmp_path_factory.mktemp("disk") / "failing_disk.so"
    words = ["gcc", "-shared", "-fPIC", "-O1", str(SHARED / "failing_disk.c"), "-o", str(target), "-ldl"]
    subprocess.run(words, check=True)
    return target


def faults(library: Path, folder: Path, calls: str, *words: str) -> list[tuple[str, int, int, str]]:
    """What comes of a command, by the call that fails and its number."""
    script = [sys.executable, str(SHARED / "failing_disk.py"), str(library), str(folder), calls, *words]
    environment = {**os.environ, "LD_PRELOAD": str(library)}
    answer = subprocess.run(script, env=environment, capture_output=True, text=True, check=False, timeout=900)
    assert answer.returncode == 0, answer.stderr
    return [tuple(json.loads(line)) for line in answer.stdout.splitlines()]


def check(found: list[tuple[str, int, int, str]], calls: str) -> None:
    """Each fault is reported as an error of a file, with path and reason, or has changed nothing."""
    assert {call for call, *_ in found} >= set(calls.split(","))
    for call, number, status, said in found:
        place = f"{call} {number}: {said}"
        assert status in {0, 2}, place
        assert "internal error" not in said, place
        assert "Traceback" not in said, place
        assert "authors" not in said, place  # of a reader
        if status:
            assert any(reason in said for reason in REASONS), place
            assert any(name in said for name in ("arm.", "run.yaml", "out", "table.csv", "'.'")), place


@pytest.mark.parametrize(
    ("words", "calls"),
    [
        (("check", "arm.urdf"), READ),
        (("convert", "arm.csv", "-o", "new/arm.urdf"), "open,close,read,write,rename,mkdir"),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_commands_about_one_file(
    tmp_path: Path, library: Path, dh2urdf: Callable[..., object], words: tuple[str, ...], calls: str
) -> None:
    """Whatever call fails, the command ends with status 2 and the sentence of a file that cannot be read or written."""
    (tmp_path / "arm.csv").write_text(TABLE)
    dh2urdf("convert", "arm.csv", "-o", "arm.urdf")
    check(faults(library, tmp_path, calls, *words), calls)


@pytest.mark.long
@pytest.mark.parametrize("resume", [False, True], ids=["new", "resumed"])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_runs(tmp_path: Path, library: Path, dh2urdf: Callable[..., object], layout: str, *, resume: bool) -> None:
    """Of whole runs too: journal, manifest, table, reports, lock and shards, also those of an earlier run."""
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(RUN.format(LAYOUTS[layout]))
    calls = "open,close,read,write,rename,unlink,mkdir"
    if resume:
        dh2urdf("run", "run.yaml")
        damaged = next(path for path in (tmp_path / "out").rglob("*[13].*") if path.suffix in {".urdf", ".tar"})
        damaged.write_bytes(damaged.read_bytes()[:3000])
    check(faults(library, tmp_path, calls, "run", "run.yaml", *(["--resume"] if resume else [])), calls)
