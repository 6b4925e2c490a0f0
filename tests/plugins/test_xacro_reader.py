from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import ProofError
from dh2urdf_plugins.formats.xacro.reader import expand, read_xacro

if TYPE_CHECKING:
    from pathlib import Path

ROBOT = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">{}</robot>'


def written(path: Path, body: str) -> Path:
    path.write_text(ROBOT.format(body), encoding="utf-8")
    return path


def test_the_robot_is_the_one_that_xacro_expands(tmp_path: Path) -> None:
    """Arguments have their defaults, expressions their values."""
    path = written(tmp_path / "r.xacro", '<xacro:arg name="side" default="left"/><link name="$(arg side)_${1 + 1}"/>')
    assert [link.name for link in read_xacro(path).links] == ["left_2"]
    assert b'name="right_2"' in expand(path, {"side": "right"})


def test_a_folder_with_brackets_is_no_pattern(tmp_path: Path) -> None:
    """xacro takes an included file's name for a pattern; the folder of the file has no part in it."""
    folder = tmp_path / "arms [2024]*"
    folder.mkdir()
    written(folder / "part.xacro", '<link name="l"/>')
    path = written(folder / "r.xacro", '<xacro:include filename="part.xacro"/>')
    assert [link.name for link in read_xacro(path).links] == ["l"]


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('<link name="${nothing}"/>', "xacro cannot expand it: name 'nothing' is not defined"),
        ('<link name="${1/0}"/>', "xacro cannot expand it: division by zero"),
        ('<xacro:include filename="none.xacro"/>', "xacro cannot expand it: No such file or directory"),
        ("<link", "xacro cannot expand it: not well-formed"),
        ("<link/>", "r.xacro (expanded):2: error: link lacks the attribute name"),
    ],
)
def test_what_xacro_cannot_expand_is_an_error_with_its_reason(tmp_path: Path, body: str, message: str) -> None:
    """Whatever xacro raises becomes one error that names the file."""
    path = written(tmp_path / "r.xacro", body)
    with pytest.raises(ProofError) as caught:
        read_xacro(path)
    assert str(caught.value).startswith(str(path))
    assert message in str(caught.value)


def test_nothing_is_printed_and_no_state_is_left(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """xacro prints warnings to the terminal and keeps its root folder in a global."""
    import xacro

    before = xacro.root_dir
    read_xacro(written(tmp_path / "r.xacro", '<xacro:property name="pi" value="3"/><link name="l" xacro:x="1"/>'))
    with pytest.raises(ProofError):
        read_xacro(tmp_path / "none.xacro")
    assert capfd.readouterr() == ("", "")
    assert xacro.root_dir == before
