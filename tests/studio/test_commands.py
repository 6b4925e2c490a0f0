"""What `dh2urdf studio` and `dh2urdf view` refuse before they serve; what they serve is in tests/studio."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from conftest import Answer

pytest.importorskip("nicegui")

TWO = "# convention: standard\nrobot,a,alpha,d\nfirst,1,0,0\nsecond,2,0,0\n"


def test_which_of_several_robots(cli: Callable[..., Answer], tmp_path: Path) -> None:
    """A table of several manipulators wants a name, and says which there are."""
    (tmp_path / "two.csv").write_text(TWO)
    answer = cli("studio", "two.csv", status=2)
    assert "the table holds several manipulators" in answer.stderr
    assert "--robot NAME, with one of first, second" in answer.stderr
    answer = cli("studio", "two.csv", "--robot", "secnd", status=2)
    assert "the table holds no 'secnd'" in answer.stderr
    assert "did you mean 'second'?" in answer.stderr


@pytest.mark.parametrize("command", ["studio", "view"])
def test_a_file_that_is_not_there(cli: Callable[..., Answer], command: str) -> None:
    """It is an error on the command line, and nothing is served."""
    answer = cli(command, "nowhere.csv", "--no-browser", status=2)
    assert "nowhere.csv" in answer.stderr
    assert answer.stdout == ""


def test_all_wrong_files_are_told_at_once(cli: Callable[..., Answer], tmp_path: Path) -> None:
    """Each with its own place."""
    for name, alpha in (("one.csv", "x"), ("two.csv", "y")):
        (tmp_path / name).write_text(f"# convention: standard\na,alpha,d\n1,{alpha},0\n")
    answer = cli("view", "one.csv", "two.csv", status=2)
    assert "one.csv:3:3" in answer.stderr
    assert "two.csv:3:3" in answer.stderr


@pytest.mark.parametrize("port", ["-1", "65536", "http"])
def test_a_port_is_a_number(cli: Callable[..., Answer], port: str) -> None:
    """Anything that is no port is refused."""
    assert "--port" in cli("studio", "--port", port, status=2).stderr
