from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from dh2urdf.documents import check_file, decoded, read_bytes
from dh2urdf.errors import ConfigError, TableError


def refusal(path: Path) -> str:
    with pytest.raises(ConfigError) as caught:
        read_bytes(path)
    return str(caught.value)


def test_a_missing_file_suggests_its_neighbours(tmp_path: Path) -> None:
    """A slip in a file name is answered with the names that are near."""
    (tmp_path / "ur5.csv").touch()
    (tmp_path / "panda.yaml").touch()
    assert refusal(tmp_path / "ur55.csv").endswith(
        "ur55.csv: error: there is no such file\n    did you mean 'ur5.csv'?"
    )
    assert "did you mean" not in refusal(tmp_path / "zzz")


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    """It is the folder that is missing, not the file."""
    assert f"there is no folder '{tmp_path / 'x'}'" in refusal(tmp_path / "x" / "y.csv")


def test_a_link_to_nothing_says_where_it_leads(tmp_path: Path) -> None:
    """A dangling link is told from a missing file."""
    link = tmp_path / "a.csv"
    link.symlink_to("gone.csv")
    assert "this link leads to 'gone.csv', where there is no file" in refusal(link)


def test_a_loop_of_links_is_refused(tmp_path: Path) -> None:
    """A link to itself is an error in one line."""
    link = tmp_path / "a.csv"
    link.symlink_to(link)
    assert "the file cannot be read: " in refusal(link)
    assert "\n" not in refusal(link)


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    """A folder is refused as such."""
    assert "this is a folder, not a file" in refusal(tmp_path)


def test_a_pipe_is_refused_without_waiting_for_it(tmp_path: Path) -> None:
    """A named pipe that nobody writes to would wait for ever."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    assert "this is a pipe or a device, not a file" in refusal(pipe)
    assert "write what comes out of it into a file" in refusal(pipe)


def test_the_reason_of_the_system_is_passed_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file without permission is told in one line; root, who may read all, runs this test too."""
    path = tmp_path / "a.csv"
    path.touch(mode=0)

    def refuse(*_arguments: object) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "open", refuse)
    assert refusal(path) == f"{path}: error: the file cannot be read: Permission denied"


@pytest.mark.parametrize("name", ["a\0b", "x" * 300])
def test_impossible_names_are_refused(tmp_path: Path, name: str) -> None:
    """A path that no file can have is an error, not an exception of another kind."""
    assert "the file cannot be read: " in refusal(tmp_path / name)


def test_a_file_beyond_the_limit_is_refused(tmp_path: Path) -> None:
    """A file larger than what is read at once is told its bound."""
    path = tmp_path / "big"
    path.write_bytes(b"x" * 11)
    with pytest.raises(TableError, match="too much to be read at once"):
        read_bytes(path, TableError, limit=10)
    assert read_bytes(path, limit=11) == b"x" * 11
    check_file(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_utf8_and_utf16_are_read(encoding: str) -> None:
    """UTF-8 with and without a byte order mark, and UTF-16 of either order with one."""
    bom = "\ufeff" if encoding in ("utf-16-le", "utf-16-be") else ""
    assert decoded((bom + "é🤖\r\n\t").encode(encoding), "f") == "é🤖\r\n\t"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("a,b\r\nü".encode("latin-1"), "f:2:1: error: byte 0xfc is no UTF-8 text"),
        (b"a\rb\xff", "f:2:2: error: byte 0xff is no UTF-8 text"),
        ("ab".encode("utf-16") + b"c", "f:1:3: error: byte 0x63 is no UTF-16 text"),
        ("a\nb".encode("utf-16-le"), "f:1:2: error: the character U+0000"),
        ("a\u2028b", "f:1:2: error: the character U+2028"),
        ("a\x1bb", "f:1:2: error: the character U+001B"),
        ("a\ud800", "f:1:2: error: the character U+D800"),
    ],
)
def test_what_is_no_text_is_refused_with_its_place(content: bytes | str, message: str) -> None:
    """The first byte or character that is no text is named with line and column."""
    with pytest.raises(ConfigError) as caught:
        decoded(content, "f")
    assert str(caught.value).startswith(message)
