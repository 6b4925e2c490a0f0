"""How people spell numbers: what typesetting makes of a text, and texts that two people would read in two ways.

`plain_text` takes the typesetting off a cell, whatever its source: Markdown, HTML and LaTeX, and what marks a joint
variable. `misreading` names texts that the grammar of expressions would read with another meaning.
"""

from __future__ import annotations

import re
import unicodedata

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


# --- Typesetting ------------------------------------------------------------------------------------------------------

_LONGEST = 1000
_TYPESET = r"[*_`\\$<{}~^(\[]|[^\x00-\x7f]|(?i:var)"
"""What a text with typesetting has one of."""
_WRAPS = (
    *((mark, mark) for mark in ("***", "**", "*", "__", "_", "``", "`", "~~", "$$", "$")),
    ("\\(", "\\)"),
    *((f"<{tag}>", f"</{tag}>") for tag in ("b", "i", "em", "strong", "code")),
)
"""What is around a whole text in bold, italics, code or a formula."""
_WIDE = {code: code - 0xFEE0 for code in range(0xFF01, 0xFF5F)}
"""Fullwidth signs and digits."""
_VARIABLE = r"(?<![^\W_])(\\?(?:q|θ|ϑ|theta|th|d))"
_STEPS = tuple(
    (re.compile(pattern), to)
    for pattern, to in (
        (r"(?i)</?(?:b|i|em|strong|code|var|span)>|\\(?:left|right|displaystyle|[,;:! ()\[\]])|\$", ""),
        (r"(?i)<sub>|\\textsubscript(?=\{)", "_"),
        (r"(?i)<sup>|\\textsuperscript(?=\{)", "^"),
        (r"(?i)</su[bp]>", ""),
        (r"\\(?:text(?:bf|it|rm)?|math(?:bf|it|rm|sf)|boldsymbol|bm|mbox|operatorname|num)\s*\{([^{}]*)\}", r"\1"),
        (r"\\ang\s*\{([^{}]*)\}", r"\1°"),
        (r"\\(?:SI|qty)\s*\{([^{}]*)\}\s*\{([^{}]*)\}", r"\1 \2"),
        (r"\^\s?\{?\s?(?:\\circ|°|o(?![a-z]))\s?\}?|\\(?:text)?degree(?![a-z])|\\circ(?![a-z])", "°"),
        (r"\^\s?\{?\s?(?:\\?ast|\\?star|\*|⋆|★)\s?\}?", "^*"),
        (r"\s?\\(?:cdot|times)\s?10\s?\^\s?\{?([+-]?[0-9]{1,3})\}?", r"e\1"),
        (r"\\(?:cdot|times)(?![a-z])", "*"),
        (r"\\q?quad(?![a-z])", " "),
        (r"\\([_*#%&|])", r"\1"),
        (r"\\(?:var)?theta(?![a-z])", "θ"),
        (r"([_^])\s?\{([^{}]*)\}", r"\1\2"),
        (r"\\sqrt\s*\{([^{}]*)\}", r"sqrt(\1)"),
        (r"\\[dt]?frac\s*\{([^{}]*)\}\s*\{([^{}]*)\}", r"((\1)/(\2))"),
        (rf"{_VARIABLE}_?\s?[(\[]\s?([0-9]{{1,3}}|i)\s?[)\]]", r"\1\2"),
        (rf"{_VARIABLE}(_?[0-9₀-₉i]{{0,3}})\s?\(\s?(?:t|var\.?|variable)\s?\)", r"\1\2"),
        (rf"{_VARIABLE}(_?[0-9₀-₉i]{{0,3}})\s?\^\*(_?[0-9i]{{0,3}})", r"\1\2\3"),
        (r"\\(?=[a-zA-Z])|~(?=\S)", ""),
    )
)
_VARIABLE_ALONE = frozenset(("*", "^*", "⋆", "★", "var", "var.", "variable"))
"""What marks the joint variable of its row without a symbol."""


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
    for pattern, to in _STEPS:
        text = pattern.sub(to, text)
    text = re.sub(r"[\u00a0\u2007\u2009\u202f]", " ", text).strip()
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

_MONTHS = "jan|feb|m[aä]r|mrz|apr|may|mai|jun|jul|aug|sep|oct|okt|nov|dec|dez"
_DATES = (
    r"(?a)\d{1,4}([-/.])\d{1,2}\1\d{1,4}(?:[T ]+[\d:.]+Z?)?|\d{1,2}-\d{1,2}|\d{1,2}-\d{4}|\d{4}-\d{1,2}"
    r"|\d{1,2}\.\d{1,2}\.|\d{1,2}:\d{2}(?::\d{2})?(?: *[ap]m)?"
    rf"|\d{{1,4}}[-/. ]*(?:{_MONTHS})[a-z]*\.?(?:[-/., ]*\d{{1,4}})?|(?:{_MONTHS})[a-z]*\.?[-/., ]*\d{{1,4}}"
)
_IN_BRACKETS = (
    r"(?i)\s*\(\s*((?=[0.,]*[1-9])[0-9.,]+(?:e[+-]?[0-9]+)?)\s*(?:[^\W\d_]{1,3}|°)?\s*\)\s*(?:[^\W\d_]{1,3}|°)?\s*"
)
_PLAIN = r"(?:[0-9]+(?:[.,][0-9]+)?|[.,][0-9]+)"
_UNIT = r"(?:\s*(?:[cmµ]?m|in|ft|deg|rad|°))?"
_POWER = rf"\s*[+-]?{_PLAIN}\s*\*\s*10(?:[+-]\s*|\s+[+-])[0-9]{{1,2}}\s*(?:(?:[^\W\d]|°).*)?"
"""A power of ten whose exponent is no longer raised: ``3×10-3``."""
_TWO_NUMBERS = rf"\s*({_PLAIN}){_UNIT}(?:-|\s*–\s*)({_PLAIN}){_UNIT}\s*"
"""What may be a difference or a range: ``0.3–0.5``."""
_QUOTIENT = rf"\s*[+-]?({_PLAIN}){_UNIT}/([+-]?)({_PLAIN}){_UNIT}\s*"


def misreading(text: str) -> tuple[str, str] | None:
    """What a text is that the grammar would take for another number, and what to write; None for any other text."""
    plain = text.translate(SIGNS)
    if re.fullmatch(_DATES, plain.strip().lower()):
        return (
            "it is a date",
            "format the column of the spreadsheet as text; put spaces around the sign of a difference",
        )
    if number := re.fullmatch(_IN_BRACKETS, plain):
        return (
            f"a number in brackets is negative to a spreadsheet and positive to a person: -{number[1]}, or {number[1]}",
            f"write -{number[1]} or {number[1]}, without the brackets",
        )
    if "*" in plain and re.fullmatch(_POWER, plain):
        return "it may be a power of ten whose exponent is no longer raised", "write the exponent with e: 1e-3"
    if (two := re.fullmatch(_TWO_NUMBERS, text.replace("−", "-"))) and _number(two[1]) < _number(two[2]):
        return "it may be a range, or a difference", "write bounds in a column limits; put spaces around a minus"
    if (two := re.fullmatch(_QUOTIENT, plain)) and (_number(two[1]) == 0 or (two[2] and two[1] == two[3])):
        return "it may be two numbers, or a quotient", "write the number that holds; put spaces around the sign"
    return None


def _number(text: str) -> float:
    return float(text.replace(",", "."))


_ADVICE = tuple(
    (re.compile(pattern), advised)
    for pattern, advised in (
        (r"\s*[+-]?[0-9]*,[0-9]+\s*$", "write a decimal point, and no separators of thousands: 0.425, 1234.5"),
        (
            r"\s*[+-]?[0-9]{1,3}(?:[.,'’ \u00a0\u2009\u202f][0-9]{3})+",
            "write it without separators of thousands: 1234.5",
        ),
        (r"[^*^²³]*(?:\*\*|\^|[²³⁰⁴-⁹⁺⁻])", "powers are not accepted: write the product, or the number, as in 1e-3"),
        (r"\s*(?:±|\+/-|\+-|-\+)", "write the two numbers, lower and upper, each with its own sign"),
        (r"[^°]*[0-9]\s*°\s*[0-9]", "write decimal degrees: 12.5° for 12°30'"),
        (r"[^±]*[0-9]\s*±", "write the number alone, without its tolerance"),
        (r"(?i)\s*(?:[-–—]+|/|n\.?/?a\.?|none|null)\s*$", "write 0 if that is meant"),
    )
)


def advice(text: str) -> str | None:
    """What to write in place of a text that cannot be read, where its kind is known."""
    return next((advised for pattern, advised in _ADVICE if pattern.match(text)), None)
