"""Other words in every message, as `pytest --other-words` has them: which tests ask what is said, and which what is done?"""

import re
from typing import Any

from dh2urdf.errors import PluginError
from dh2urdf.source import Problem
from dh2urdf.stages.inspections import Effect, Finding

WORD = re.compile(r"""('[^']*'|`[^`]*`|"[^"]*")|(?<![\w./_-])[a-z]{3,}(?![\w./_-])""")
"""A word of a message. Quoted texts, names, numbers and paths stay."""


def other(text: str) -> str:
    """The same text with its words spelt backwards, in capitals: what is changed twice stays as it was the first time."""
    return WORD.sub(lambda word: word[0] if word[1] else word[0][::-1].upper(), text)


def change() -> None:
    """Change the words of all problems, findings and faults of plugins that are made from now on in this process."""
    _change(Problem, {"message": "x"}, "accepted", "suggestion")
    _change(Finding, {"rule": "x", "message": "x", "fix": "x"})
    _change(Effect, {"consumer": "x", "severity": "note", "text": "x"})
    PluginError._message = lambda self: other(Exception.__str__(self))  # type: ignore[method-assign]


def _change(record: Any, fields: dict[str, str], *more: str) -> None:
    record(**fields)  # Its constructor may be written when it is called first.
    made, names = record.__init__, {"message", "fix", "text", *more}

    def make(self: Any, **given: Any) -> None:
        words = {name: other(text) for name, text in given.items() if name in names and isinstance(text, str)}
        made(self, **{**given, **words})

    record.__init__ = make
