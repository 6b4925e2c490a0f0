"""Regular expressions that most commands do not need.

Compiling one takes 0.1 to 0.5 ms, and the readers know about a hundred, most of them for what is rare in tables. These
are compiled when they are first used, and not at every start.
"""

from __future__ import annotations

import re
from typing import Any, cast


class _LatePattern:
    """Stands for a pattern: finds a method of it, and keeps the method."""

    def __init__(self, text: str, flags: int) -> None:
        self._given = text, flags

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - whatever a pattern has
        if name.startswith("__"):
            raise AttributeError(name)
        found = getattr(re.compile(*self._given), name)
        setattr(self, name, found)
        return found


def late_pattern(text: str, flags: int = 0) -> re.Pattern[str]:
    """A regular expression, as `re.compile` returns it, that is compiled when it is first used."""
    return cast("re.Pattern[str]", _LatePattern(text, flags))
