"""Which walls stand around a child that works on a stranger's file, and what the user reads where the kernel offers none."""

import os
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest
from command_line import Cli

from dh2urdf.isolation import fence
from dh2urdf.meshes import load_scene
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

WHY = "this kernel offers no Landlock: Function not implemented"
BOX = """
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""
TABLE = "convention: standard\njoints:\n  - {name: j1, type: revolute, a: 0.3, alpha: 0, d: 0.1, mesh: part.obj}\n"


@pytest.fixture
def no_landlock(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A kernel whose Landlock is switched off: the question for its version fails, as the package reports it."""
    landlock = pytest.importorskip("landlock")

    def refuse() -> int:
        raise landlock.LandlockError("Function not implemented")

    monkeypatch.setattr(landlock, "landlock_abi_version", refuse)
    monkeypatch.delenv(fence.TRUST, raising=False)
    for kept in (fence.missing_wall, fence._tell):
        kept.cache_clear()
    yield
    for kept in (fence.missing_wall, fence._tell):
        kept.cache_clear()


@pytest.mark.skipif(sys.platform != "linux", reason="Landlock is Linux's")
def test_the_kernel_is_asked() -> None:
    """The answer is that of the system call itself."""
    import ctypes

    create_ruleset, version = 444, 1
    has_landlock = ctypes.CDLL(None).syscall(create_ruleset, None, 0, version) > 0
    assert (fence.missing_wall() == "") == has_landlock
    assert fence.walls().startswith("Landlock, limits" if has_landlock else "no wall of the kernel (this kernel offers")


@pytest.mark.usefixtures("no_landlock")
def test_version_names_the_missing_wall(cli: Cli) -> None:
    """`dh2urdf --version` says that the kernel offers none, why, and what follows."""
    assert f"no wall of the kernel ({WHY}; meshes need --trust), limits" in cli("--version").stdout


@pytest.mark.usefixtures("no_landlock")
def test_mesh_asks_for_trust(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without Landlock a mesh is not read unless the user trusts it."""
    pytest.importorskip("trimesh")
    with pytest.raises(
        ValueError, match=r"^this kernel offers no Landlock: .*; `--trust` \(or DH2URDF_TRUST=1\) reads"
    ):
        load_scene(BOX.encode(), ".obj", process=False)
    monkeypatch.setenv(fence.TRUST, "1")
    assert len(load_scene(BOX.encode(), ".obj", process=False).geometry) == 1


@pytest.mark.usefixtures("no_landlock")
@pytest.mark.parametrize("place", ["before", "after"])
def test_command_takes_trust_for_itself_alone(cli: Cli, tmp_path: Path, place: str) -> None:
    """`convert` of a table with a mesh fails, and works with `--trust`, which no later command inherits."""
    pytest.importorskip("trimesh")
    (tmp_path / "arm.yaml").write_text(TABLE)
    (tmp_path / "part.obj").write_text(BOX)
    words = ("convert", "arm.yaml", "-o", "arm.urdf")
    trusting = ("--trust", *words) if place == "before" else (*words, "--trust")
    cli(*words, status=2)
    cli(*trusting)
    assert fence.TRUST not in os.environ
    assert (tmp_path / "arm.urdf").is_file()


@pytest.mark.usefixtures("no_landlock")
def test_the_user_is_told_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of a xacro, whose fence still has two walls: on standard error in a command, as a warning in a library."""
    pytest.importorskip("xacro")
    path = tmp_path / "arm.xacro"
    path.write_text('<robot name="arm"><link name="a"/></robot>')
    monkeypatch.setattr(fence, "is_own", lambda: False)  # Another test may have claimed this process.
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RuntimeWarning)
        for _ in range(2):
            assert b'name="arm"' in expand_foreign(path).content
    text = f"{WHY}; the fence around files of unknown origin is Python's audit hook and limits of the system"
    assert [str(each.message) for each in caught] == [text]
    fence._tell.cache_clear()
    monkeypatch.setattr(fence, "is_own", lambda: True)
    for _ in range(2):
        expand_foreign(path)
    assert capsys.readouterr().err == f"notice: {text}\n"
