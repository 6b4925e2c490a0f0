"""Paths that the system refuses to look at: names that are too long, links in a circle, folders without permission."""

import ast
import re
from pathlib import Path

import pytest
from command_line import Answer, Cli
from permissions import ordinary, pytest_linux

ROOT = Path(__file__).parents[1]
LONG = "x" * 300
TABLE = "# convention: standard\na,alpha,d\n0.4,0,0\n"
URDF = '<robot name="a"><link name="b">{}</link></robot>'
MJCF = '<mujoco>{}<worldbody><body><geom size="1"/><joint name="j"/></body></worldbody></mujoco>'
SDF = '<sdf version="1.7"><model name="m"><link name="l"/>{}</model></sdf>'
DESCRIPTIONS = {
    "mesh.urdf": URDF.format(f'<visual><geometry><mesh filename="{LONG}.stl"/></geometry></visual>'),
    "include.xml": MJCF.format(f'<include file="{LONG}.xml"/>'),
    "include.sdf": SDF.format(f"<include><uri>{LONG}</uri></include>"),
}
LOOKED_AT = ("exists", "is_dir", "is_file")
THEMSELVES = ("documents/text_files.py", "fence.py", "xacro_fence/files.py", "children/witness.py")
"""The module that looks without raising, and those that handle what is raised."""


def told(answer: Answer) -> str:
    """What a command prints; it blames neither itself nor a plugin."""
    text = f"{answer.stdout}\n{answer.stderr}"
    assert not any(words in text for words in ("internal error", "is broken", "Errno", "Traceback", "--debug")), text
    return text


@pytest.mark.parametrize("name", DESCRIPTIONS)
def test_a_description_that_names_a_file_with_a_long_name(cli: Cli, tmp_path: Path, name: str) -> None:
    """The file is not there. `check` and `extract` reported their own plugin as broken."""
    (tmp_path / name).write_text(DESCRIPTIONS[name])
    assert re.search("there is no mesh|is not (there|found|beside the file)", told(cli("check", name, status=1)))
    told(cli("extract", name, status=2))  # None is whole, or moves anything.


@pytest.mark.parametrize(
    "words",
    [
        ("run", "run.yaml"),
        ("check", f"{LONG}.urdf"),
        ("check", "arm.urdf", "--package-path", LONG),
        ("example", "ur5", "-o", f"{LONG}.csv"),
    ],
    ids=lambda words: " ".join(words).replace(LONG, "LONG"),
)
def test_a_name_that_is_too_long(cli: Cli, tmp_path: Path, words: tuple[str, ...]) -> None:
    """Each of these was an internal error, or a broken plugin of dh2urdf."""
    (tmp_path / "arm.urdf").write_text(URDF.format(""))
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(f"inputs: {LONG}.csv\n")
    assert "error: " in told(cli(*words, status=2))


@pytest.mark.parametrize("command", ["run", "convert", "check"])
def test_a_file_behind_a_link_that_leads_in_a_circle(cli: Cli, tmp_path: Path, command: str) -> None:
    """The link is named; there was an internal error."""
    (tmp_path / "loop").symlink_to("loop")
    said = told(cli(command, "loop/arm.csv", status=2))
    assert "the file cannot be read: Too many levels of symbolic links" in said


@pytest.mark.long
@pytest_linux
def test_folders_without_permission(tmp_path: Path) -> None:
    """One may be entered and not be listed, another may not be entered: there were internal errors, or broken plugins."""
    for name in ("blind", "closed", "open"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "arm.csv").write_text(TABLE)
    (tmp_path / "some.yaml").write_text("inputs: '[co]*/*.csv'\noutput: {directory: out}\n")
    (tmp_path / "none.yaml").write_text("inputs: c*/*.csv\n")
    (tmp_path / "arm.urdf").write_text(URDF.format(""))
    (tmp_path / "include.xml").write_text(MJCF.format('<include file="closed/b.xml"/>'))
    (tmp_path / "run.yaml").write_text("inputs: closed/arm.csv\n")
    places = {
        ("convert", "blind/amr.csv"): "blind/amr.csv: error: there is no such file",
        ("check", "closed/arm.urdf"): "closed/arm.urdf: error: the file cannot be read",
        ("check", "arm.urdf", "--package-path", "blind"): "'blind' cannot be read",
        ("check", "arm.urdf", "--package-path", "closed"): "'closed' cannot be read",
        ("check", "include.xml"): "'closed/b.xml' is not there",
        ("run", "run.yaml"): "'closed/arm.csv': the file cannot be read",
    }
    patterns = {
        ("run", "some.yaml"): (0, "'closed'"),
        ("run", "none.yaml"): (2, "'closed'"),
        ("run", "some.yaml", "-o", "closed/out"): (2, "'closed/out'"),
    }
    try:
        (tmp_path / "blind").chmod(0o311)
        (tmp_path / "closed").chmod(0)
        answers = {words: ordinary(tmp_path, *words) for words in places}
        patterned = {words: ordinary(tmp_path, *words) for words in patterns}
    finally:
        for name in ("blind", "closed"):
            (tmp_path / name).chmod(0o755)
    for words, answer in answers.items():
        assert places[words] in answer.stderr + answer.stdout, (words, answer)
        assert "internal error" not in answer.stderr
    # Of a pattern: a notice where it led to other files, an error where it did not; of the output: an error that names it.
    for words, (status, place) in patterns.items():
        assert patterned[words].returncode == status, patterned[words].stderr
        assert place in patterned[words].stderr
        assert "Permission denied" in patterned[words].stderr
        assert "Traceback" not in patterned[words].stderr


def test_nothing_else_looks_for_files() -> None:
    """`Path.is_file` and its relatives raise an error where the system refuses to look; those of `documents` do not."""
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for folder in ("pipeline/dh2urdf", "plugins")
        for path in sorted((ROOT / folder).rglob("*.py"))
        if not path.as_posix().endswith(THEMSELVES)
        for node in ast.walk(ast.parse(path.read_bytes()))
        if isinstance(node, ast.Attribute) and node.attr in LOOKED_AT
        if not (isinstance(node.value, ast.Name) and node.value.id in {"entry", "system"})  # os.DirEntry; fsspec
    ]
    assert found == []
