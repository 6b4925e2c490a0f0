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


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("ur55.csv", "ur55.csv: error: there is no such file\n    did you mean 'ur5.csv'?"),
        ("x/y.csv", "there is no folder '"),
        ("dangling", "this link leads to 'gone.csv', where there is no file"),
        ("loop", "the file cannot be read: "),
        (".", "this is a folder, not a file"),
        ("pipe", "this is a pipe or a device, not a file"),
        ("a\0b", "the file cannot be read: "),
        ("x" * 300, "the file cannot be read: "),
    ],
)
def test_what_is_no_file_is_refused(tmp_path: Path, name: str, says: str) -> None:
    """What is there instead is named; nobody waits for a pipe."""
    (tmp_path / "ur5.csv").touch()
    (tmp_path / "dangling").symlink_to("gone.csv")
    (tmp_path / "loop").symlink_to("loop")
    os.mkfifo(tmp_path / "pipe")
    assert says in refusal(tmp_path / name)


def test_the_reason_of_the_system_is_passed_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file without permission is reported in one line; root, who may read all, runs this test too."""
    path = tmp_path / "a.csv"
    path.touch(mode=0)

    def refuse(*_arguments: object) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "open", refuse)
    assert refusal(path) == f"{path}: error: the file cannot be read: Permission denied"


def test_a_file_beyond_the_limit_is_refused(tmp_path: Path) -> None:
    """The message about a file that is too large names the bound."""
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
