"""A robot description as it is in the file: elements with their places, nothing fixed and nothing refused.

`parsing` makes the tree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

DEEPEST = 1000
"""Elements inside each other that are kept; what stands deeper is passed over."""


@dataclass(slots=True, eq=False)
class Element:
    """An element and its place.

    Attributes:
        tag: its name, with the prefix that it has in the file.
        attributes: its attributes.
        line: the line where it begins, from 1.
        column: the column where it begins, from 1.
        children: the elements in it.
        text: the text at its beginning, without blanks around it.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    column: int
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def get(self, attribute: str) -> str | None:
        """The text of an attribute."""
        return self.attributes.get(attribute)

    def all(self, tag: str) -> list[Element]:
        """The children of a name."""
        return [child for child in self.children if child.tag == tag]

    def first(self, *path: str) -> Element | None:
        """The first child of a name, its first child of the next name, and so on."""
        element: Element | None = self
        for tag in path:
            element = next((child for child in element.children if child.tag == tag), None) if element else None
        return element

    def walk(self) -> Iterator[Element]:
        """This element and all in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))

    def numbers(self, attribute: str, count: int) -> tuple[float, ...] | None:
        """As many finite numbers as an attribute should hold; None where it holds something else."""
        return numbers_of(self.get(attribute), count)

    def number(self, attribute: str) -> float | None:
        """The finite number that an attribute holds; None where it holds something else."""
        found = self.numbers(attribute, 1)
        return found[0] if found else None


def numbers_of(text: str | None, count: int) -> tuple[float, ...] | None:
    """As many finite numbers as a text should hold; None where it holds something else."""
    words = (text or "").split()
    if len(words) != count or not all(word.isascii() and "_" not in word for word in words):
        # `float` takes 1_000 and the digits of other alphabets, which no reader does.
        return None
    try:
        found = tuple(map(float, words))
    except ValueError:
        return None
    return found if all(map(math.isfinite, found)) else None
