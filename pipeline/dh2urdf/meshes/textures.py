"""The names of pictures and of files of materials in mesh files.

A DAE names pictures (COLLADA 1.4.1 and 1.5, element ``image``), an OBJ files of materials (``mtllib``), and these
pictures (``map_Kd`` and its kin, http://paulbourke.net/dataformats/mtl). Texts of unknown origin are read from front to
back, whatever is in them.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

NAMING = (".dae", ".gltf", ".mtl", ".obj")
"""How the names of files end that name others."""
_IMAGE = re.compile(rb"<image\b(?:(?!<image\b).)*?</image>", re.DOTALL)
_INIT_FROM = re.compile(rb"(<init_from[^<>]*>\s*(?:<ref>)?)([^<>]*)")
_LIBRARY = re.compile(rb"^([ \t]*mtllib[ \t]+)([^\r\n]*)", re.MULTILINE)
_URI = re.compile(rb'"uri"\s*:\s*"(?!data:)([^"]*)"')
_MAP = re.compile(rb"^[ \t]*(?:map_\w+|bump|disp|decal|refl|norm)[ \t]", re.IGNORECASE)
_VALUE = re.compile(rb"on|off|[-+.0-9eE]+|[rgbmlz]|sphere|cube_\w+")
"""A value of an option of a picture."""
_STATEMENT = re.compile(
    rb"^[ \t]*(?:newmtl[ \t]+[^\r\n]{1,200}|(?:K[adse]|T[fr]|N[si]|d|illum|P\w+)(?:[ \t]+[-+.0-9eE]+)+)[ \t]*$"
)
"""What the copy of a file of materials has beside pictures."""
_TGA_KINDS = (1, 2, 3, 9, 10, 11)


def is_picture(content: bytes, suffix: str) -> bool:
    """Whether the content of a file is that of a picture: PNG, JPEG or, of a file that is called so, BMP or TGA."""
    if content.startswith((b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff")):
        return True
    if suffix == ".bmp":
        return content[:2] == b"BM" and int.from_bytes(content[2:6], "little") == len(content)
    if suffix != ".tga" or len(content) < 18:  # noqa: PLR2004 - the bytes of its header
        return False
    if content[-18:] == b"TRUEVISION-XFILE.\0":  # of version 2.0; the first one has a header alone
        return True
    colours, kind, depth = content[1], content[2], content[16]
    width, height = (int.from_bytes(content[at : at + 2], "little") for at in (12, 14))
    is_whole = kind > 3 or 18 + width * height * depth // 8 <= len(content)  # noqa: PLR2004 - from 9 on, runs are packed
    return colours in {0, 1} and kind in _TGA_KINDS and depth in {8, 15, 16, 24, 32} and width * height > 0 and is_whole


def names_in(content: bytes, suffix: str) -> list[str]:
    """The names of other files in a file that ends in one of `NAMING`, each once."""
    if suffix == ".dae":
        images = _IMAGE.finditer(content)
        found = [_from_xml(each[2]) for image in images for each in _INIT_FROM.finditer(image[0])]
    elif suffix == ".mtl":
        found = [picture[1] for line in content.splitlines() if (picture := _picture_of(line))]
    elif suffix == ".obj":
        found = [_text(each[2]) for each in _LIBRARY.finditer(content)]
    else:
        found = [_text(each[1]) for each in _URI.finditer(content)]
    return [*dict.fromkeys(filter(None, found))]


def with_names(content: bytes, suffix: str, names: Mapping[str, str]) -> bytes:
    """The content of a file with other names of the files that it names; of a MTL, its statements alone."""

    def named(found: re.Match[bytes]) -> bytes:
        name = _from_xml(found[2]) if suffix == ".dae" else _text(found[2])
        return found[1] + names[name].encode() if name in names else found[0]

    if suffix == ".dae":
        return _IMAGE.sub(lambda image: _INIT_FROM.sub(named, image[0]), content)
    if suffix == ".obj":
        return _LIBRARY.sub(named, content)
    return b"".join(_material_lines(content, names))


def _text(name: bytes) -> str:
    return name.strip().decode("utf-8", "replace")


def _from_xml(name: bytes) -> str:
    from html import unescape

    return unescape(_text(name))


def _picture_of(line: bytes) -> tuple[bytes, str] | None:
    """A statement of a material up to the name of a picture, with options such as ``-bm 1.0``; and the name."""
    if not _MAP.match(line):
        return None
    words, at = line.split(), 1
    while at < len(words) - 1 and (words[at].startswith(b"-") or (at > 1 and _VALUE.fullmatch(words[at]))):
        at += 1
    return b" ".join(words[:at]), _text(b" ".join(words[at:]))


def _material_lines(content: bytes, names: Mapping[str, str]) -> Iterator[bytes]:
    """The statements of materials, those of pictures with their other names."""
    for line in content.splitlines():
        if _STATEMENT.match(line):
            yield line.strip() + b"\n"
        elif (found := _picture_of(line)) and found[1] in names:
            yield found[0] + b" " + names[found[1]].encode() + b"\n"
