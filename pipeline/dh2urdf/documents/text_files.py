"""Text files from strangers: what is there is checked before it is read, and every byte is accounted for."""

from __future__ import annotations

import os
import re
import stat
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from contextlib import suppress
from pathlib import Path

from dh2urdf.errors import ConfigError, InputError, ManipulatorError
from dh2urdf.source import LONG_PATH, Mark, Messages, Problem, shown

say = Messages(__file__)

MAX_BYTES = 2**30
"""Size of a file that is still read at once [B]."""

ADDRESS = r"[A-Za-z][A-Za-z0-9.+-]+:(?:[/\\]|$)"
"""What a path begins with that was made of an address, such as ``s3://bucket/name``: it has one slash of two."""

_TEXT = "text in UTF-8, or in UTF-16 with a byte order mark"
_AS_CSV = "save the sheet as CSV (UTF-8)"
_BEGINNINGS = (
    (
        b"PK\x03\x04",
        "an Excel workbook (xlsx) or another zip archive",
        f"name it .xlsx if it is a workbook, or {_AS_CSV}",
    ),
    (b"\xd0\xcf\x11\xe0", "an Excel workbook (xls)", _AS_CSV),
    (b"PAR1", "a Parquet file", "name it .parquet"),
    (b"%PDF", "a PDF document", "copy the table out of it into a file of text"),
    (b"{\\rtf", "an RTF document", "save it as plain text"),
    (b"\x1f\x8b", "a gzip archive", "unpack it"),
    (b"7z\xbc\xaf", "a 7-Zip archive", "unpack it"),
    (b"\x89PNG", "a picture", "type its numbers into a file of text"),
    (b"\xff\xd8\xff", "a picture", "type its numbers into a file of text"),
    (b"version https://git-lfs", "a pointer of Git LFS", "`git lfs pull` replaces it by the file"),
    (b"<!doctype html", "a page of the web (HTML)", "download the file that the page shows"),
    (b"<html", "a page of the web (HTML)", "download the file that the page shows"),
)
"""How files of other kinds begin, what they are, and what to do."""

_ENCODINGS = ((BOM_UTF8, "utf-8"), (BOM_UTF16_LE, "utf-16-le"), (BOM_UTF16_BE, "utf-16-be"))
_UNACCEPTABLE = r"[^\t\n\r\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"
_UNACCEPTABLE_ASCII = r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]"  # The same where there is nothing else: it compiles at once.


def is_file(path: Path) -> bool:
    """Whether a file is there; not where that cannot be known.

    `Path.is_file` raises an error where a folder may not be entered, or a name is too long.
    """
    return os.path.isfile(path)  # noqa: PTH113


def is_folder(path: Path) -> bool:
    """Whether a folder is there; not where that cannot be known."""
    return os.path.isdir(path)  # noqa: PTH112


def is_there(path: Path) -> bool:
    """Whether a file or a folder is there; not where that cannot be known."""
    return os.path.exists(path)  # noqa: PTH110


def read_bytes(path: Path, error: type[InputError] = ConfigError, *, limit: int = MAX_BYTES) -> bytes:
    """What a file holds.

    Raises:
        InputError: of the type given, where there is no such file, or it cannot be read, or it is larger than the
            limit.
    """
    check_file(path, error)
    try:
        size = path.stat().st_size
        if size <= limit:
            return path.read_bytes()
    except OSError as reason:
        raise error(unreadable(path, reason)) from None
    raise error(say("file-too-large", Mark(file=str(path)), size=size / 2**20, most=limit / 2**20))


def tidy_path(path: Path) -> Path:
    """`configs/../build` as `build`, unless `configs` is a link."""
    tidy = Path(os.path.normpath(path))
    try:
        return tidy if os.path.realpath(tidy) == os.path.realpath(path) else path  # Path.resolve raises of a circle
    except UnicodeEncodeError:  # The locale has no such characters: whatever opens the file reports it.
        return path


def check_file(path: Path, error: type[InputError] = ConfigError) -> None:
    """Refuses what is not a file that can be read, and says what is there instead.

    Raises:
        InputError: of the type given: missing, a folder, a link to nothing, a pipe or device, no permission.
    """
    try:
        mode = path.stat().st_mode
        if stat.S_ISREG(mode):
            with path.open("rb"):
                return
    except (OSError, ValueError) as reason:  # ValueError: a null character in the path
        raise error(unreadable(path, reason)) from None
    mark = Mark(file=str(path))
    if stat.S_ISDIR(mode):
        raise error(say("folder-not-file", mark))
    raise error(say("device-not-file", mark))


def unreadable(path: Path, reason: OSError | ValueError) -> Problem:
    """Why a file cannot be read, and what is there instead."""
    mark = Mark(file=shown(str(path), LONG_PATH)[1:-1])
    if isinstance(reason, FileNotFoundError):
        if path.is_symlink():
            return say("link-to-nothing", mark, target=path.readlink())
        if re.match(ADDRESS, str(path)):
            return say("address-not-file", mark)
        if not is_folder(path.parent):
            return say("no-folder", mark, folder=shown(str(path.parent), LONG_PATH))
        from difflib import get_close_matches

        near: list[str] = []
        with suppress(PermissionError):
            names = sorted(entry.name for entry in path.parent.iterdir())
            near = get_close_matches(path.name, names, n=3, cutoff=0.7)
        suggestion = f"did you mean {' or '.join(repr(name) for name in near)}?" if near else None
        return say("no-such-file", mark, suggestion=suggestion)
    why = reason.strerror if isinstance(reason, OSError) and reason.strerror else str(reason)
    return say("file-unreadable", mark, reason=why)


def kind_of_file(content: bytes) -> tuple[str, str] | None:
    """What a file is by its first bytes, with its article, and what to do; None for text, and what is not known."""
    first = content[:100].removeprefix(BOM_UTF8)
    page = first.lstrip().lower() if b"<" in first else b""
    for beginning, kind, advice in _BEGINNINGS:
        if first.startswith(beginning) or page.startswith(beginning):
            return kind, advice
    return None


def refuse_other_kind(
    content: bytes, file: str, error: type[InputError | ManipulatorError], wanted: str, accepted: str
) -> None:
    """Refuses what begins as a file of another kind.

    Args:
        content: the file, or its beginning.
        file: what messages call it.
        error: what is raised.
        wanted: what the file was taken for, with its article.
        accepted: what is accepted.

    Raises:
        InputError, ManipulatorError: of the type given.
    """
    if found := kind_of_file(content):
        kind, advice = found
        about = {"kind": kind, "wanted": wanted}
        raise error(say("other-kind-of-file", Mark(file=file), accepted=accepted, suggestion=advice, **about))


def decoded(content: bytes | str, file: str, error: type[InputError] = ConfigError) -> str:
    """The text of a file in UTF-8 or UTF-16, without its byte order mark.

    Raises:
        InputError: of the type given, where bytes are no text, or a character is one that no text file holds.
    """
    if isinstance(content, bytes):
        refuse_other_kind(content, file, error, "a text file", _TEXT)
        bom, encoding = next(((b, e) for b, e in _ENCODINGS if content.startswith(b)), (b"", "utf-8"))
        try:
            text = content[len(bom) :].decode(encoding)
        except UnicodeDecodeError as reason:
            before = content[len(bom) : len(bom) + reason.start].decode(encoding)
            byte = reason.object[reason.start]
            mark = _mark_after(before, file)
            raise error(say("not-in-encoding", mark, byte=byte, encoding=encoding[:6].upper())) from None
    else:
        text = content.removeprefix("\ufeff")
    if match := re.search(_UNACCEPTABLE_ASCII if text.isascii() else _UNACCEPTABLE, text):
        character = match[0].encode("unicode_escape").decode("ascii")
        code = "nul-in-text" if match[0] == "\0" else "control-character"
        raise error(say(code, _mark_after(text[: match.start()], file), found=character, number=ord(match[0])))
    return text


def encoded(text: str) -> bytes:
    """A text as UTF-8, also where it has names of files whose bytes the locale does not know, or that are no UTF-8."""
    content = text.encode(errors="surrogateescape")
    try:
        content.decode()
    except UnicodeDecodeError:
        return text.encode(errors="backslashreplace")
    return content


def _mark_after(before: str, file: str) -> Mark:
    lines = re.split(r"\r\n|\n|\r", before)
    return Mark(file=file, line=len(lines), column=len(lines[-1]) + 1)
