"""What the command leaves in the output folder, whatever tables are called and whatever happens meanwhile."""

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
import unicodedata
from collections.abc import Callable, Iterable
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from child_python import python
from interrupted import at_every_step
from lxml import etree

MAIN = "from dh2urdf.cli import main; main()"
INTERRUPTED = "dh2urdf: interrupted; nothing half-written is left; `--resume` goes on from there\n"
ROWS = ((0, 1.5707963267948966, 0.2), (0.4, 0, 0.1), (0.3, 0.5, 0))
URDF = "a,alpha,d\n0,pi/2,0.2\n0.4,0,0.1\n"
HOSTILE = (
    *("../../escaped", "/etc/passwd", "..\\..\\escaped", "C:\\escaped", ".hidden", "-rf", "con", "aux.urdf", "~", "*"),
    *("$(touch escaped)", "${1/0}", "`touch escaped`", "a b; c", "<robot>&amp;", "'\"", "report", "report.json"),
    *("Arm", "aRM", "arm_macro", "ARM.URDF", "straße", "STRASSE", "機械臂", "🦾", "x" * 200, "x" * 199 + "y"),
    *(unicodedata.normalize("NFC", "Ä"), unicodedata.normalize("NFD", "ä")),
)


def table(names: Iterable[str]) -> str:
    """A CSV table with one manipulator for each name."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["robot", "a", "alpha", "d"])
    writer.writerows([name, *row] for name in names for row in ROWS)
    return text.getvalue()


def run_file(folder: Path, *, emitters: str = "[urdf, xacro]") -> None:
    (folder / "run.yaml").write_text(
        f"inputs: [{{path: arms.csv, options: {{convention: standard}}}}]\nemitters: {emitters}\n"
        "output: {directory: out}\nexecution: {stage: local, options: {workers: 1}}\n"
    )


def files(folder: Path) -> dict[str, bytes]:
    """Everything below a folder, hidden files included; folders are empty."""
    return {str(path.relative_to(folder)): path.read_bytes() if path.is_file() else b"" for path in folder.rglob("*")}


def is_whole(path: Path) -> bool:
    content = path.read_bytes()
    return content.endswith(b"</robot>\n") and etree.fromstring(content).tag == "robot"


# --- Names ------------------------------------------------------------------------------------------------------------


def test_whatever_manipulators_are_called_their_files_stay_in_the_folder(
    dh2urdf: Any, tmp_path: Path, reports: frozenset[str]
) -> None:
    """Paths, devices, hidden files, shell words, markup: each name has files of its own, directly in the folder."""
    (tmp_path / "arms.csv").write_text(table(HOSTILE), "utf-8")
    run_file(tmp_path)
    dh2urdf("run", "run.yaml", "--json")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["arms.csv", "out", "run.yaml"]
    found = list((tmp_path / "out").iterdir())
    assert all(path.is_file() and not path.is_symlink() for path in found)
    names = [unicodedata.normalize("NFC", path.name).casefold() for path in found]
    assert len(set(names)) == len(names) == 3 * len(HOSTILE) + len(reports)
    assert not any(name.startswith((".", "-")) for name in names)
    assert all(len(path.name.encode()) <= 255 for path in found)


# --- Failures ---------------------------------------------------------------------------------------------------------


def test_a_failed_conversion_leaves_nothing_and_touches_nothing(dh2urdf: Any, tmp_path: Path) -> None:
    """A table that is refused makes no file and no folder, and an older file stays as it was."""
    (tmp_path / "bad.csv").write_text("a,alpha,d\n0,pi/2,x\n")
    (tmp_path / "old.urdf").write_text("old")
    before = files(tmp_path)
    for target in ("new.urdf", "new/new.urdf", "old.urdf", "new.xacro"):
        dh2urdf("convert", "bad.csv", "--convention", "standard", "-o", target, status=2)
        assert files(tmp_path) == before


def test_in_a_run_the_bad_ones_keep_their_older_files(dh2urdf: Any, tmp_path: Path, reports: frozenset[str]) -> None:
    """Of many manipulators the good ones get new files, and those of a bad one stay as an earlier run left them."""
    (tmp_path / "arms.csv").write_text(table(["one", "two", "three"]))
    run_file(tmp_path)
    dh2urdf("run", "run.yaml")
    before = files(tmp_path / "out")
    (tmp_path / "arms.csv").write_text(
        table(["one", "two", "three"]).replace("two,0.4", "two,nan").replace("0.3", "0.5")
    )
    dh2urdf("run", "run.yaml", status=1)
    after = files(tmp_path / "out")
    changed = {name for name in before if before[name] != after[name]} - reports
    assert set(after) == set(before)
    assert changed == {f"{name}{end}" for name in ("one", "three") for end in (".urdf", "_macro.xacro")}


# --- A system that refuses --------------------------------------------------------------------------------------------


def command(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    # Byte code would be among the files that fail.
    return python("-c", MAIN, *words, folder=folder, PYTHONDONTWRITEBYTECODE="1")


def test_standard_output_that_takes_nothing_is_one_line(tmp_path: Path) -> None:
    """Where the file behind `>` is on a full disk, the command says so; it is no fault of the program."""
    (tmp_path / "arms.csv").write_text(table(["one"]))
    run_file(tmp_path)
    words = [sys.executable, "-c", MAIN, "run", "run.yaml", "--json"]
    with Path("/dev/full").open("wb") as full:
        result = subprocess.run(words, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert result.returncode == 2
    assert result.stderr == "error: cannot write to standard output: No space left on device\n"


def forbidden_folder(tmp_path: Path) -> tuple[Path, str]:
    """A folder in which nobody may write, not even the superuser, and what the system declares about it."""
    if Path("/proc/self").is_dir():
        return Path("/proc/dh2urdf"), "No such file or directory"
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o500)
    return folder, "Permission denied"


def test_a_folder_that_may_not_be_written_is_one_line(tmp_path: Path) -> None:
    """Without permission nothing is written, and one line says where and why, of a conversion and of a run."""
    (tmp_path / "arm.csv").write_text(URDF)
    (tmp_path / "arms.csv").write_text(table(["one", "two"]))
    run_file(tmp_path)
    folder, reason = forbidden_folder(tmp_path)
    before = files(tmp_path)
    one = command(tmp_path, "convert", "arm.csv", "--convention", "standard", "-o", str(folder / "arm.urdf"))
    many = command(tmp_path, "run", "run.yaml", "-o", str(folder))
    for result in (one, many):
        assert (result.returncode, result.stdout) == (2, "")
        assert result.stderr.splitlines()[0] == f"error: cannot write to the folder '{folder}': {reason}"
    assert files(tmp_path) == before


@pytest.mark.parametrize(
    ("target", "said"),
    [
        ("arm.csv/arm.urdf", "cannot write to the folder 'arm.csv': it is a file, not a folder"),
        ("x" * 300 + ".urdf", "File name too long"),
    ],
)
def test_a_target_that_cannot_be_is_refused(tmp_path: Path, target: str, said: str) -> None:
    """A file where a folder is needed, and a name that no file system takes."""
    (tmp_path / "arm.csv").write_text(URDF)
    before = files(tmp_path)
    result = command(tmp_path, "convert", "arm.csv", "--convention", "standard", "-o", target)
    assert (result.returncode, result.stdout, said in result.stderr) == (2, "", True)
    assert files(tmp_path) == before


# --- Interrupts -------------------------------------------------------------------------------------------------------

ARMS = 400


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("to_all", [True, False], ids=["to all processes", "to the command alone"])
def test_an_interrupted_run_says_so_and_leaves_whole_files_alone(
    tmp_path: Path, number: signal.Signals, *, to_all: bool
) -> None:
    """Ctrl-C of a terminal, `kill`, and the end of a service, whenever they come: one line, status 130, no half file."""
    (tmp_path / "arms.csv").write_text(table(f"arm{number}" for number in range(ARMS)))
    run_file(tmp_path, emitters="[urdf]")
    out, written = tmp_path / "out", 30
    (tmp_path / "tmp").mkdir()
    with subprocess.Popen(
        [sys.executable, "-c", MAIN, "run", "run.yaml"],
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(tmp_path / "tmp")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        while len(list(out.glob("*.urdf")) if out.is_dir() else []) < written and process.poll() is None:
            time.sleep(0.001)
        assert process.poll() is None, "the run ended before it was interrupted"
        (os.killpg if to_all else os.kill)(process.pid, number)
        printed, said = process.communicate(timeout=60)
    assert (process.returncode, printed, said) == (130, "", INTERRUPTED)
    assert [path.name for path in (tmp_path / "tmp").iterdir()] == []
    if (out / ".dh2urdf").exists():  # from which another run goes on
        assert [path.name for path in (out / ".dh2urdf").iterdir()] == ["journal"]
    left = [path for path in out.iterdir() if path.name != ".dh2urdf"]
    assert written <= len(left) < ARMS
    assert all(path.suffix == ".urdf" and is_whole(path) for path in left)


def test_no_arm_writes_over_the_files_of_the_run(dh2urdf: Callable[..., Any], tmp_path: Path) -> None:
    """A table in JSON of an arm called ``report`` would be ``report.json``, which is the report of the run."""
    (tmp_path / "arms.csv").write_text(f"# convention: standard\n{table(('report', 'Index', 'arm'))}", encoding="utf-8")
    (tmp_path / "run.yaml").write_text(
        "inputs: arms.csv\noutput: {directory: out}\nemitters: [urdf, {stage: table, options: {formats: [json]}}]\n",
        encoding="utf-8",
    )
    dh2urdf("run", "run.yaml")
    report = json.loads((tmp_path / "out" / "report.json").read_bytes())
    assert report["exit_status"] == 0
    entries = [file for arm in report["manipulators"] for file in arm["files"]]
    for entry in entries:
        content = (tmp_path / "out" / entry["path"]).read_bytes()
        assert sha256(content).hexdigest() == entry["sha256"], entry["path"]
    assert [entry["path"] for entry in entries if entry["stage"] == "table"] == [
        "report-2.json",
        "Index-2.json",
        "arm.json",
    ]


# --- In the middle of anything ----------------------------------------------------------------------------------------


def test_an_interrupt_between_any_two_steps_leaves_no_temporary_folder(tmp_path: Path) -> None:
    """A folder for temporary files is gone whatever step of its making, its use and its removal is interrupted."""
    from dh2urdf.output.whole_files import staging

    def use() -> None:
        with staging(tmp_path / "out") as folder:
            (folder / "file").write_text("half")

    interrupted = 0
    for was_interrupted in at_every_step(use):
        interrupted += was_interrupted
        assert list(tmp_path.rglob("*")) in ([], [tmp_path / "out"]), f"interrupt {interrupted}"
    assert interrupted > 50
