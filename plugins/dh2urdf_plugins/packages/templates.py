"""Text files as templates: what is fixed is in a file, and words are filled in where ``@NAME@`` is written."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path


@cache
def _template(name: str) -> str:
    return (Path(__file__).parent / f"{name}.in").read_text("utf-8")


def filled(template: str, **words: str) -> str:
    """A template below this folder, without its suffix ``.in``, with its words.

    A word alone in a line of the template is indented as the line is; where it is empty, the line is left out.
    """

    def line(match: re.Match[str]) -> str:
        margin, name = match[1], match[2]
        return "".join(f"{margin}{each}\n" if each else "\n" for each in words[name].split("\n")) if words[name] else ""

    def word(match: re.Match[str]) -> str:
        return line(match) if match[2] else words[match[3]]

    # At once: a word may be a robot's name, and look like a place.
    return re.sub(r"^([ ]*)@([A-Z_]+)@\n|@([A-Z_]+)@", word, _template(template), flags=re.MULTILINE)
