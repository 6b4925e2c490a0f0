"""A locale or a terminal without UTF-8, and names of files that are no UTF-8: every command writes what it has to say."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import dh2urdf

MAIN = "from dh2urdf.cli import main; main()"
TABLE = (
    "# name: arm\n# convention: standard\njoint,type,a,alpha [deg],d\nγ_1,revolute,0,90,0.1\n関節2,revolute,0.3,0,0\n"
)
LOCALES = {
    "ASCII": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    "a terminal of Windows": {"PYTHONIOENCODING": "cp1252"},
}
NAMES = {"UTF-8": "Grün".encode(), "Latin-1": "Grün".encode("latin-1")}
COMMANDS = (
    (b"convert", b"--help"),
    (b"info", b"%s.csv"),
    (b"info", b"%s.csv", b"--json"),
    (b"convert", b"%s.csv"),
    (b"convert", b"%s.csv", b"--json"),
    (b"convert", b"%s.csv", b"-o", b"%s_out.urdf"),
    (b"convert", b"%s.csv", b"-o", b"%s_out.md"),
    (b"extract", b"%s.urdf"),
    (b"extract", b"%s.urdf", b"-o", b"%s_out.yaml"),
    (b"extract", b"%s.urdf", b"-o", b"%s_out.csv"),
    (b"check", b"%s.urdf"),
    (b"init", b"%s_new.csv"),
    (b"init", b"%s_new.yaml", b"--run", b"%s_run.yaml"),
    (b"run", b"run.yaml", b"-o", b"folder"),
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """With a table, a URDF and a run file."""
    urdf = dh2urdf.convert(TABLE, reader="csv").text
    for name in NAMES.values():
        for suffix, text in ((b".csv", TABLE), (b".urdf", urdf)):
            with open(os.path.join(os.fsencode(tmp_path), name + suffix), "w", encoding="utf-8") as file:  # noqa: PTH118, PTH123
                file.write(text)
    (tmp_path / "run.yaml").write_text("inputs: Grün.csv\n", encoding="utf-8")
    return tmp_path


def called(words: tuple[bytes, ...], name: bytes, folder: Path, locale: str) -> subprocess.CompletedProcess[bytes]:
    clean = {key: value for key, value in os.environ.items() if key[:3] != "LC_" and key[:6] != "PYTHON"}
    return subprocess.run(
        [sys.executable, "-c", MAIN, *(word.replace(b"%s", name) for word in words)],
        cwd=folder,
        env={**clean, "LANG": "C.UTF-8", **LOCALES[locale]},
        capture_output=True,
        check=False,
    )


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="only here names of files are bytes")
@pytest.mark.parametrize(("locale", "name"), [("ASCII", "Latin-1"), ("a terminal of Windows", "UTF-8")])
def test_no_command_fails_at_a_character(folder: Path, locale: str, name: str) -> None:
    """What a terminal lacks is escaped; only a run file whose paths the locale cannot have is refused."""
    wrong = []
    for words in COMMANDS:
        answer = called(words, NAMES[name], folder, locale)
        is_refused = words[0] == b"run" and locale == "ASCII"
        status = 2 if is_refused else 0
        if answer.returncode != status or b"internal error" in answer.stderr or b"Traceback" in answer.stderr:
            wrong.append((words, answer.returncode, answer.stderr[-300:]))
    assert wrong == []


@pytest.mark.parametrize("name", NAMES)
def test_what_is_written_is_utf8(folder: Path, name: str) -> None:
    """A table of a description has its name in a comment, and a run file the path of its table; both are read back."""
    called((b"extract", b"%s.urdf", b"-o", b"out.yaml"), NAMES[name], folder, "ASCII")
    assert [row.joint for row in dh2urdf.read(folder / "out.yaml").rows] == ["γ_1", "関節2"]
    called((b"init", b"%s_new.yaml", b"--run", b"new_run.yaml"), NAMES[name], folder, "ASCII")
    text = (folder / "new_run.yaml").read_text("utf-8")
    assert ("Grün_new.yaml" in text) is (name == "UTF-8")
