"""Which files of a folder are whole descriptions, and which are only parts that others include."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.documents import read_bytes
from dh2urdf.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

_LONGEST_SEARCHED = 2**24
"""Size of a file that is searched for what it includes [B]."""
_XACRO_INCLUDE = re.compile(rb"<xacro:include\s[^>]*?filename\s*=\s*[\"']([^\"']+)[\"']")
_MJCF_INCLUDE = re.compile(rb"<include\s[^>]*?file\s*=\s*[\"']([^\"']+)[\"']")
_WAY = re.compile(r"^.*[)}]/*|^/+|^(?:\.{1,2}/)+")
_NAMED = re.compile(rb"<robot\b[^>]*?\sname\s*=")


def urdfs(roots: Mapping[Path, str]) -> Iterator[Path]:
    """Files whose outermost element is ``robot``, or that are called ``.urdf`` and begin with no element.

    The outermost element of SRDF, which says what MoveIt does with a robot, is ``robot`` too.
    """
    for path, tag in roots.items():
        if (
            not _is_xacro(path)
            and ".srdf" not in path.suffixes
            and (tag == "robot" or (not tag and path.suffix.lower() == ".urdf"))
        ):
            yield path


def xacros(roots: Mapping[Path, str]) -> Iterator[Path]:
    """Files called ``.xacro`` whose robot has a name, and that no other includes."""
    files = {path: _content(path) for path, tag in roots.items() if _is_xacro(path) and tag in {"robot", ""}}
    included = _included(files.values(), _XACRO_INCLUDE)
    for path, content in files.items():
        if not _is_one_of(path, included) and ".srdf" not in path.suffixes and _NAMED.search(content):
            yield path


def sdfs(roots: Mapping[Path, str]) -> Iterator[Path]:
    """Files whose outermost element is ``sdf``, or that are called ``.sdf`` and begin with no element."""
    for path, tag in roots.items():
        if tag == "sdf" or (not tag and path.suffix.lower() == ".sdf"):
            yield path


def mjcfs(roots: Mapping[Path, str]) -> Iterator[Path]:
    """Files whose outermost element is ``mujoco``, and that no other includes."""
    files = {path: _content(path) for path, tag in roots.items() if tag == "mujoco"}
    included = _included(files.values(), _MJCF_INCLUDE)
    yield from (path for path in files if not _is_one_of(path, included))


def _is_xacro(path: Path) -> bool:
    return path.suffix.lower() == ".xacro"


def _content(path: Path) -> bytes:
    try:
        return read_bytes(path, InputError, limit=_LONGEST_SEARCHED)
    except InputError:  # The inspection of the file reports it.
        return b"<robot name=''/>"


def _included(contents: Iterable[bytes], pattern: re.Pattern[bytes]) -> set[str]:
    """The ends of the paths that are included: what follows a package, an argument, or the way to another folder."""
    found = (match.decode("utf-8", "replace") for content in contents for match in pattern.findall(content))
    return {_WAY.sub("", name.replace("\\", "/")) for name in found}


def _is_one_of(path: Path, ends: set[str]) -> bool:
    """Whether a path has one of some ends."""
    parts = path.absolute().parts
    return any("/".join(parts[-count:]) in ends for count in range(1, len(parts) + 1))
