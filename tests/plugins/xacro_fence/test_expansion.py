"""Hostile files: each ends within its limit, runs nothing, reads nothing outside, and is refused by name.

What makers write goes on working: the same constructs expand as in the real xacro, byte by byte.
"""

import importlib
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

import pytest
import yaml
from command_line import Cli

from dh2urdf.errors import CrashError, InputError, ProofError
from dh2urdf.isolation import run_in_child
from dh2urdf.stages import Expansion
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

ROBOT = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">{}</robot>'
SECRET = "a-secret-of-the-user"  # noqa: S105 - a canary
LIMIT = 20.0


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a file of a stranger, beside a folder with a secret."""
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "secret.yaml").write_text(f"word: {SECRET}\n")
    (tmp_path / "home" / "secret.xacro").write_text(ROBOT.format(f'<link name="{SECRET}"/>'))
    monkeypatch.setenv("SECRET", SECRET)
    folder = tmp_path / "arm"
    folder.mkdir()
    return folder


def bomb(depth: int, width: int) -> str:
    macros = "".join(
        f'<xacro:macro name="m{level}">{f"<xacro:m{level + 1}/>" * width}</xacro:macro>' for level in range(depth)
    )
    return f'{macros}<xacro:macro name="m{depth}"><link name="l"/></xacro:macro><xacro:m0/>'


ATTACKS: dict[str, Sequence[str]] = yaml.safe_load(
    Path(__file__).with_name("hostile_files.yaml").read_text("utf-8")
) | {
    "texts that double": (
        '<xacro:property name="a0" value="aaaaaaaaaa"/>'
        + "".join(f'<xacro:property name="a{k + 1}" value="${{a{k}}}${{a{k}}}"/>' for k in range(40))
        + '<link name="${a40}"/>',
        "steps|a size of more",
    ),
    "lists that double": (
        '<xacro:property name="a0" value="${[1]}"/>'
        + "".join(f'<xacro:property name="a{k + 1}" value="${{[a{k}, a{k}]}}"/>' for k in range(40))
        + '<link name="${a40}"/>',
        "a size of more",
    ),
    "macros": (bomb(11, 8), "more than 5000000 steps|did not finish|memory"),
}


def attack(folder: Path, name: str) -> Path:
    path = folder / "r.xacro"
    path.write_text(ROBOT.format(ATTACKS[name][0]))
    if name == "entities":
        path.write_text('<!DOCTYPE robot [<!ENTITY e SYSTEM "../home/secret.yaml">]><robot name="r">&e;</robot>')
    if name == "encoding":
        path.write_text('<?xml version="1.0" encoding="UTF-7"?>\n+ADwAIQ-DOCTYPE robot><robot name="r"/>')
    (folder / "part.xacro").write_text(ROBOT.format('<xacro:property name="z" value="1"/>'))
    (folder / "link.xacro").symlink_to("../home/secret.xacro")
    if hasattr(os, "mkfifo"):
        os.mkfifo(folder / "pipe")
    (folder / "object.yaml").write_text("!!python/object/apply:os.system ['touch ran']\n")
    (folder / "formats.yaml").write_text("a: '{0.__class__}'\n")
    (folder / "units.yaml").write_text("a: !degrees '().__class__'\n")
    return path


@pytest.mark.parametrize("name", ATTACKS)
def test_a_hostile_file_is_refused_by_name(package: Path, name: str) -> None:
    """Within the limit, with nothing of the secret in what is said, and nothing left behind."""
    import re

    path = attack(package, name)
    before = sorted(package.iterdir())
    started = time.monotonic()
    with pytest.raises(ProofError) as caught:
        expand_foreign(path, timeout=3.0 if name in ("macros", "loops") else LIMIT)
    assert time.monotonic() - started < LIMIT + 5
    said = str(caught.value)
    assert re.search(ATTACKS[name][1], said), said
    assert SECRET not in said
    assert sorted(package.iterdir()) == before


@pytest.mark.parametrize("name", [name for name in ATTACKS if name not in ("macros", "loops")])  # these take seconds
def test_no_command_runs_a_hostile_file(cli: Cli, package: Path, name: str) -> None:
    """`check`, `convert`, `info` and a run refuse what cannot be expanded behind the fence, and `run` takes no xacro."""
    path = attack(package, name)
    before = sorted(package.iterdir())
    (package.parent / "run.yaml").write_text(f"inputs: {path.relative_to(package.parent)}\n")
    answers = [
        cli("check", path, status=1),
        *(cli(command, path, status=2) for command in ("convert", "info", "run")),
        cli("run", package.parent / "run.yaml", status=2),
    ]
    assert all(SECRET not in answer.stdout + answer.stderr for answer in answers)
    assert sorted(package.iterdir()) == before


# --- The layers below, each by itself ----------------------------------------------------------------------------------


@pytest.fixture
def functions(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Functions of a module that a child process can import."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    return importlib.import_module("fenced_functions")


@pytest.mark.parametrize(
    ("deed", "found"),
    [
        ("read inside", "kept"),
        ("read outside", "FenceError"),
        ("read by descriptor", "FenceError"),
        ("write inside", "FenceError"),
        ("append inside", "FenceError"),
        ("remove", "FenceError"),
        ("run", "FenceError"),
        ("shell", "FenceError"),
        ("fork", "FenceError"),
        ("connect", "FenceError"),
        ("library", "FenceError"),
        ("memory", "MemoryError"),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="the limits are those of POSIX")
def test_a_fenced_process_can_only_read_inside(functions: ModuleType, package: Path, deed: str, found: str) -> None:
    (package / "inside.txt").write_text("kept")
    value = run_in_child(functions.fenced, package, deed, timeout=LIMIT).value
    assert value == found
    assert (package / "inside.txt").read_text() == "kept"


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="the limits are those of POSIX")
def test_a_fenced_process_ends_when_its_time_is_over(functions: ModuleType, package: Path) -> None:
    with pytest.raises(CrashError, match=r"crashed \((CPU time limit exceeded|cputime limit exceeded|killed)"):
        run_in_child(functions.fenced, package, "time", timeout=60.0)


@pytest.mark.skipif(sys.platform != "linux", reason="Landlock is Linux's")
def test_the_kernel_refuses_too_where_it_can(functions: ModuleType, package: Path) -> None:
    from landlock import landlock_abi_version

    try:
        landlock_abi_version()
    except Exception as error:  # noqa: BLE001 - the library's own error for a kernel without it
        pytest.skip(f"this kernel has no Landlock: {error}")
    assert run_in_child(functions.landlocked, package, timeout=LIMIT).value == "refused by the kernel"


PARENT = """
import sys
from pathlib import Path
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign
print("started", flush=True)
expand_foreign(Path(sys.argv[1]), timeout=600)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="children are looked for in /proc")
def test_a_child_ends_with_the_command_that_was_killed(package: Path) -> None:
    path = attack(package, "loops")
    with subprocess.Popen([sys.executable, "-c", PARENT, str(path)], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        parent.stdout.readline()
        children = Path(f"/proc/{parent.pid}/task/{parent.pid}/children")
        deadline = time.monotonic() + LIMIT
        while not (found := children.read_text().split()):
            assert time.monotonic() < deadline
            time.sleep(0.02)
        time.sleep(0.5)
        parent.kill()
    while any(alive(int(child)) for child in found):
        assert time.monotonic() < deadline
        time.sleep(0.02)


def alive(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


# --- What makers write --------------------------------------------------------------------------------------------------

REAL = """
import sys
import xacro
from xacro import substitution_args
substitution_args._eval_find = substitution_args._eval_dict["find"] = lambda name: sys.argv[2]
document = xacro.process_file(sys.argv[1], mappings={})
sys.stdout.buffer.write(document.documentElement.toprettyxml(indent="  ", encoding="utf-8"))
"""


def test_what_makers_write_expands_as_in_the_real_xacro() -> None:
    """Packages, YAML with units, namespaces, blocks, comprehensions, conditions: byte by byte."""
    folder = Path(__file__).parent / "arm_description"
    path = folder / "urdf" / "arm.urdf.xacro"
    real = subprocess.run([sys.executable, "-c", REAL, path, folder], capture_output=True, check=True).stdout
    assert expand_foreign(path).content == real
    assert b"2.96705972839" in real


@pytest.mark.parametrize(
    "words",
    [("-o", "arm.urdf.xacro"), ("-o", "arm.urdf.xacro", "--frames", "dh"), ("-o", "ws", "--to", "ros2")],
    ids=" ".join,
)
def test_what_is_written_expands_as_in_the_real_xacro(
    cli: Cli, tmp_path: Path, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The xacro and the ROS package of a UR5: their YAML files, conditions and macros, byte by byte."""
    table = tmp_path / "ur5.csv"
    cli("example", "ur5", "-o", table)
    monkeypatch.chdir(tmp_path)
    cli("convert", table, *words)
    tops = [path for path in tmp_path.rglob("*.xacro") if b"<robot" in path.read_bytes()]
    assert tops
    for path in tops:
        folder = next((each for each in path.parents if (each / "package.xml").is_file()), path.parent)
        real = subprocess.run(
            [sys.executable, "-c", REAL, path.name, folder], cwd=path.parent, capture_output=True, check=True
        )
        assert expand_foreign(path).content == real.stdout


def test_what_is_refused_has_its_place(package: Path) -> None:
    """File, line and column of the element, the expression, and what is refused."""
    path = attack(package, "guards")
    path.write_text(path.read_text().replace("<link", "\n  <link"))
    with pytest.raises(ProofError) as caught:
        expand_foreign(path)
    (problem,) = caught.value.problems
    assert (problem.mark.file, problem.mark.line, problem.mark.column) == (str(path), 2, 3)
    assert "when evaluating expression" in problem.message


def test_a_package_is_read_where_it_is_named(tmp_path: Path) -> None:
    """And nowhere else; the message says which are known."""
    other = tmp_path / "elsewhere" / "src" / "grippers"
    other.mkdir(parents=True)
    (other / "package.xml").write_text("<package><name>grippers</name></package>")
    (other / "hand.xacro").write_text(ROBOT.format('<link name="hand"/>'))
    path = tmp_path / "arm" / "r.xacro"
    path.parent.mkdir()
    path.write_text(ROBOT.format('<xacro:include filename="$(find grippers)/hand.xacro"/>'))
    for folder in (other, other.parent, tmp_path / "elsewhere"):
        assert b'name="hand"' in expand_foreign(path, Expansion(package_paths=(folder,))).content
    for folder, message in (
        (path.parent, f"no folder in '{path.parent}' holds a package.xml"),
        (path, f"there is no folder of packages '{path}'"),
    ):
        with pytest.raises(InputError, match=message):
            expand_foreign(path, Expansion(package_paths=(folder,)))
    with pytest.raises(ProofError, match=r"the package 'grippers' is not known \(known: none\)"):
        expand_foreign(path)


def test_arguments_have_the_values_that_are_given(tmp_path: Path) -> None:
    path = tmp_path / "r.xacro"
    path.write_text(ROBOT.format('<xacro:arg name="side" default="left"/><link name="$(arg side)"/>'))
    assert b'"right"' in expand_foreign(path, Expansion(arguments={"side": "right"})).content
    path.write_text(ROBOT.format('<xacro:arg name="side"/><link name="$(arg side)"/>'))
    with pytest.raises(ProofError, match=r"missing attribute 'default'"):
        expand_foreign(path)
    path.write_text(ROBOT.format('<link name="$(arg side)"/>'))
    with pytest.raises(ProofError, match=r"the argument 'side' has no value: give it one, side:=VALUE"):
        expand_foreign(path)
