"""How people spell numbers: what typesetting makes of a text, and texts that two people would read in two ways.

`plain_text` takes the typesetting off a cell, whatever its source: Markdown, HTML and LaTeX, and what marks a joint
variable. `misreading` names texts that the grammar of expressions would read with another meaning.
"""

from __future__ import annotations

import re
import tomllib
import unicodedata
from functools import cache
from pathlib import Path

DEGREE_SIGNS = "°º˚◦∘"
"""What is written for the degree sign: keyboards have ordinals beside it, and LaTeX makes it of a ring or a bullet."""
_DEGREE = str.maketrans(dict.fromkeys(DEGREE_SIGNS, "°"))
# What typesetting and PDF copies make of the signs. The raised dot is missing: it is a decimal point to some.
SIGNS = {
    **str.maketrans(dict.fromkeys("−–‒‐‑﹣－", "-")),
    **str.maketrans({"＋": "+", "×": "*", "∗": "*", "⁎": "*", "÷": "/", "⁄": "/", "∕": "/"}),
    **_DEGREE,
}
"""The signs of numbers, by the code points of the characters that are written in their place."""


def composed(text: str) -> str:
    """A text in Unicode's form NFKC, with one sign for the degree."""
    return unicodedata.normalize("NFKC", text.translate(_DEGREE))


_DATA = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))

# --- Typesetting ------------------------------------------------------------------------------------------------------

_LONGEST = 1000
_TYPESET = r"[_`\\$<{}~^(\[]|(?<!\w)\*|\*(?!\w)|[^\x00-\x7f]|(?i:var)"
"""What a text with typesetting has one of; the star of a product is none."""
_WRAPS = (
    *((mark, mark) for mark in ("***", "**", "*", "__", "_", "``", "`", "~~", "$$", "$")),
    ("\\(", "\\)"),
    *((f"<{tag}>", f"</{tag}>") for tag in ("b", "i", "em", "strong", "code")),
)
"""What is around a whole text in bold, italics, code or a formula."""
_WIDE = {code: code - 0xFEE0 for code in range(0xFF01, 0xFF5F)}
"""Fullwidth signs and digits."""
_VARIABLE_ALONE = frozenset(("*", "^*", "⋆", "★", "var", "var.", "variable"))
"""What marks the joint variable of its row without a symbol."""


@cache
def _typesetting() -> list[tuple[re.Pattern[str], str]]:
    """What is taken off, in order; most tables have no typesetting, and never compile it."""
    return [(re.compile(pattern), to) for pattern, to in _DATA["typesetting"]]


def plain_text(text: str) -> str:
    """A cell without its typesetting: ``**-π/2**`` is -π/2, ``$\\theta_1^{*}$`` is θ_1, and ``*`` is q.

    Args:
        text: the cell of a number, a type or a header; a longer one than any number comes back as it is.
    """
    if len(text) > _LONGEST or not re.search(_TYPESET, text):
        return text
    if text.isprintable() and not text.isascii():
        text = text.translate(_WIDE)
    text = unwrapped(text).translate(SIGNS)
    if text.strip().lower() in _VARIABLE_ALONE:
        return "q"
    for pattern, to in _typesetting():
        text = pattern.sub(to, text)
    text = text.strip()
    return text[1:-1] if text[:1] == "{" and text[-1:] == "}" else text


def unwrapped(text: str) -> str:
    """A text without the marks around it that make it bold, italic, code or a formula."""
    text = text.strip() if text[-1:] in "*_`~$)>" or text[:1] in "*_`~$\\<" else text
    for start, end in _WRAPS:
        inner = text[len(start) : -len(end)]
        if text.startswith(start) and text.endswith(end) and len(text) > len(start + end) and start not in inner:
            return unwrapped(inner.strip())
    return text


# --- What has two meanings --------------------------------------------------------------------------------------------


def misreading(text: str) -> tuple[str, str] | None:
    """What a text is that the grammar would take for another number, and what to write; None for any other text."""
    typed, plain = text.replace("−", "-").strip().lower(), text.translate(SIGNS).strip().lower()
    for entry in _DATA["misreadings"]:
        found = re.fullmatch(entry["pattern"], typed if "as_typed" in entry else plain)
        condition = entry.get("if")
        if found is None or (condition == "rises" and not _number(found[1]) < _number(found[2])):
            continue
        if condition == "twice" and _number(found[1]) and not (found[2] and found[1] == found[3]):
            continue
        return entry["is"].format(*found.groups()), entry["write"].format(*found.groups())
    return None


def _number(text: str) -> float:
    return float(text.replace(",", "."))


def advice(text: str) -> str | None:
    """What to write in place of a text that cannot be read, where its kind is known."""
    return next((advised for pattern, advised in _DATA["advice"] if re.match(pattern, text)), None)
