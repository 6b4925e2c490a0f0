"""Ways to write a description as the bytes of a file, most of them wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

HEAD = '<?xml version="1.0" encoding="utf-8"?>\n'

FORMS: dict[str, Callable[[str], bytes]] = {
    "plain": lambda text: (HEAD + text).encode(),
    "no declaration": lambda text: text.encode(),
    "BOM": lambda text: b"\xef\xbb\xbf" + (HEAD + text).encode(),
    "UTF-16": lambda text: (HEAD.replace("utf-8", "utf-16") + text).encode("utf-16"),
    "UTF-16 without BOM": lambda text: (HEAD.replace("utf-8", "utf-16") + text).encode("utf-16-le"),
    "UTF-32": lambda text: (HEAD.replace("utf-8", "utf-32") + text).encode("utf-32"),
    "Latin-1": lambda text: (
        HEAD.replace("utf-8", "iso-8859-1") + text.replace("robot", 'robot author="Jos\xe9"', 1)
    ).encode("latin-1", "replace"),
    "Latin-1 undeclared": lambda text: (HEAD + text.replace("robot", 'robot author="Jos\xe9"', 1)).encode(
        "latin-1", "replace"
    ),
    "leading newline": lambda text: ("\n" + HEAD + text).encode(),
    "leading text": lambda text: ("robot:\n" + HEAD + text).encode(),
    "two declarations": lambda text: (HEAD + HEAD + text).encode(),
    "comment first": lambda text: ("<!-- made by hand -->\n" + HEAD + text).encode(),
    "comment with --": lambda text: (HEAD + "<!-- a -- b -->\n" + text).encode(),
    "comment unclosed": lambda text: (HEAD + "<!-- a\n" + text).encode(),
    "bare &": lambda text: (HEAD + text.replace("robot", 'robot author="A & B"', 1)).encode(),
    "unknown entity": lambda text: (HEAD + text.replace("robot", 'robot author="&eacute;"', 1)).encode(),
    "CRLF": lambda text: (HEAD + text).replace("\n", "\r\n").encode(),
    "one line": lambda text: (HEAD + text).replace("\n", " ").encode(),
    "single quotes": lambda text: (HEAD + text).replace('"', "'").encode(),
    "quote missing": lambda text: (HEAD + text.replace('"', "", 1)).encode(),
    "cut": lambda text: (HEAD + text)[: len(text) * 3 // 4].encode(),
    "end tag missing": lambda text: (HEAD + text.replace("</link>", "", 1)).encode(),
    "end tag wrong": lambda text: (HEAD + text.replace("</link>", "</Link>", 1)).encode(),
    "robot not closed": lambda text: (HEAD + text.rstrip().removesuffix("</robot>")).encode(),
    "comment behind": lambda text: (HEAD + text + "<!-- made by hand -->\n").encode(),
    "namespace": lambda text: (
        HEAD + text.replace("<robot", '<robot xmlns:xacro="http://ros.org/wiki/xacro"', 1)
    ).encode(),
    "default namespace": lambda text: (HEAD + text.replace("<robot", '<robot xmlns="http://www.ros.org"', 1)).encode(),
    "prefix undeclared": lambda text: (HEAD + text.replace("</robot>", "<a:b/></robot>")).encode(),
    "wrapped": lambda text: (HEAD + f"<root>{text}</root>").encode(),
    "version 1.1": lambda text: (HEAD.replace("1.0", "1.1") + text).encode(),
    "processing instruction": lambda text: (HEAD + '<?xml-model href="x"?>\n' + text).encode(),
    "empty": lambda _: b"",
    "blank": lambda _: b"\n\n",
    "attribute without value": lambda text: (HEAD + text.replace("<robot", "<robot checked", 1)).encode(),
    "spaces around =": lambda text: (HEAD + text.replace("=", " = ")).encode(),
    "long line": lambda text: (HEAD + text.replace("\n", " " * 9000 + "\n", 1)).encode(),
    "character reference": lambda text: (HEAD + text.replace("robot", 'robot author="&#233;&#x1F600;"', 1)).encode(),
    "version attribute": lambda text: (HEAD + text.replace("<robot", '<robot version="1.0"', 1)).encode(),
    "version 2": lambda text: (HEAD + text.replace("<robot", '<robot version="2.0"', 1)).encode(),
    "version word": lambda text: (HEAD + text.replace("<robot", '<robot version="x"', 1)).encode(),
}
"""Ways to write a tree as the bytes of a file. What is no XML is refused in one sentence, whichever reader takes it."""
