"""Names for lengths and angles: ``L1``, ``a2``, ``d_4``, each defined once for a table.

They are defined in a comment or a line above or below the table (``# L1 = 0.091``, ``a2=0.35, d4=0.4``), in a cell
(``a2 = 0.35``, ``L1 (130 mm)``), under the key `symbols`, or by the option of that name. A bare number takes the unit
of the column that the name is used in, as if it were written there.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeVar

from dh2urdf.quantities.grammar import Intermediate, Parser, is_symbol, symbol_key
from dh2urdf.quantities.spellings import plain_text
from dh2urdf.quantities.units import Dimension, QuantityError
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.source import Mark, Problem

say = Messages(__file__)

T = TypeVar("T")
MAX_SYMBOLS = 1000
MAX_LINE = 1000
"""Characters of a comment that are looked at."""
_NAME = r"[^\W\d_]\w{0,15}(?:\{\w{1,8}\})?"
_REST = rf"(?:(?!\s{_NAME}\s?=)[^,;=:()]|\([^()]*\))*"
"""The rest of a length: it ends at a bracket that it did not open, and before the next name that is defined."""
_DEFINITION = rf"(?<![\w.\\])({_NAME})\s?(?:=|:(?=\s))\s?([-+.0-9]{_REST}|[^\W\d_]\w*\s?[-+*/]{_REST})"
"""A name and what it stands for, in prose too: ``L1 = 91 mm``."""
_SYMBOL = r"[^\W\d_]{1,2}_?\{?[0-9]{1,2}\}?"
_IN_CELL = rf"(?:({_NAME})\s?=\s?([^=]+)|({_NAME}(?=\s)|{_SYMBOL})\s?\(([^()]*[0-9][^()]*)\))"
"""A name that is written for nothing but a length: one that is not used is worth a notice."""


class Symbols(dict[str, Intermediate]):
    """What names stand for, by `symbol_key`; asking for one marks it as used."""

    def __init__(self) -> None:
        """No names yet."""
        super().__init__()
        self.used = set[str]()
        self.places: dict[str, tuple[str, Mark]] = {}

    def get(self, key: str, default: T | None = None) -> Intermediate | T | None:  # type: ignore[override]
        """What a name stands for."""
        if key in self:
            self.used.add(key)
        return super().get(key, default)

    def without(self, key: str) -> Symbols:
        """The names but for one, which is a joint variable in some row."""
        if key not in self:
            return self
        others = self.copy()
        del others[key]
        return others

    def copy(self) -> Symbols:
        """The same names, to which others may be added; which of them are used is known here, too."""
        others = Symbols()
        others.update(self)
        others.places, others.used = {**self.places}, self.used
        return others

    def define(self, name: str, text: str, mark: Mark, *, decimal_comma: bool = False) -> Problem | None:
        """Takes a definition; returns what is wrong with it."""
        key = symbol_key(name)
        if not is_symbol(name):
            return say("no-name", mark, field="symbols", found=name)
        try:
            value = Parser(plain_text(text), Dimension.LENGTH, decimal_comma=decimal_comma, symbols=self).parse()
        except QuantityError as error:
            about = {"reason": error.message, "accepted": error.accepted}
            return say("no-length", mark, field="symbols", found=name, **about)
        if value.variable or value.dimension not in (None, Dimension.LENGTH, Dimension.ANGLE):
            return say("no-length-or-angle", mark, field="symbols", found=name, text=text)
        if key in self and (self[key].number, self[key].dimension) != (value.number, value.dimension):
            return say("defined-twice", mark, field="symbols", found=name, where=self.places[key][1])
        if len(self) >= MAX_SYMBOLS:
            return say("many-names", mark, field="symbols", found=name, limit=MAX_SYMBOLS)
        self[key] = value
        self.places.setdefault(key, (name, mark))
        return None

    def take_line(self, line: str, mark: Mark, *, decimal_comma: bool = False) -> Iterator[Problem]:
        """Takes the definitions in a comment; what reads like none is prose."""
        for match in re.finditer(_DEFINITION, plain_line(line)) if "=" in line or ":" in line else ():
            name, text = match[1], match[2].strip().rstrip(".")
            if is_symbol(name):
                problem = self.define(name, text, mark, decimal_comma=decimal_comma)
                if problem and problem.code == "defined-twice":
                    yield problem

    @staticmethod
    def is_definition(text: str) -> bool:
        """Whether a text is nothing but definitions: ``L1 = 91 mm, L2 = 80 mm``."""
        line = plain_line(text.strip())
        return "=" in line and not re.sub(_DEFINITION, "", line).strip(" ,;.")

    def take_cell(self, text: str, mark: Mark, *, decimal_comma: bool = False) -> tuple[str, Problem | None]:
        """The text of a cell without the name that it defines, and what is wrong with the definition."""
        if not ("=" in text or text.endswith(")")) or not (match := re.fullmatch(_IN_CELL, text)):
            return text, None
        name, value = match[1] or match[3], (match[2] or match[4]).strip()
        if not is_symbol(name) or not re.search("[0-9]", value):
            return text, None
        problem = self.define(name, value, mark, decimal_comma=decimal_comma)
        self.used.add(symbol_key(name))
        return value, problem

    def unused(self) -> Problem | None:
        """A notice of names that are defined and not used."""
        names = [name for key, (name, _) in self.places.items() if key not in self.used and re.fullmatch(_SYMBOL, name)]
        if not names:
            return None
        return say("not-used", self.places[symbol_key(names[0])][1], field="symbols", names=names)


def plain_line(line: str) -> str:
    """A comment without typesetting, as far as it is short enough to define anything."""
    return re.sub(r"\s(?:and|und|et|y)\s", ", ", plain_text(line[:MAX_LINE]))
