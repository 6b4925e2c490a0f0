"""A cell without its typesetting."""

from __future__ import annotations

import re

_SIGNS = tuple(
    (re.compile(pattern), plain)
    for pattern, plain in (
        (r"\\(?:text|mbox|boldsymbol|emph|(?:math|text)(?:rm|bf|it|sf|tt))\{([^{}]*)\}", r"\1"),
        (r"\\sqrt\s*\{([^{}]*)\}", r"sqrt(\1)"),
        (r"\\[dt]?frac\{(-?[\w.\\]+)\}\{(\d+)\}", r"\1/\2"),
        (r"\\[dt]?frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1)/(\2)"),
        (r"\s*(?:\^\s*\{?\s*\\circ\s*\}?|\\degree(?![a-z])|\\textdegree(?![a-z]))", "°"),
        (r"\s*\\(?:times|cdot)\s*10\s*\^\s*\{?\s*([+-]?\d+)\s*\}?", r"e\1"),
        (r"\\(?:times|cdot)(?![a-z])", "*"),
        (r"\\[,;:! ]|~|\\q?quad(?![a-z])", " "),
        (r"(\d)\s*\\pi(?![a-z])", r"\1*pi"),
        (r"\\(pi|theta|alpha|min|max)(?![a-z])", r"\1"),
        (r"(\*\*|`)(.+?)\1", r"\2"),
        (r"\b(?:np|numpy|math|sp|std)\.|(?<!\\)[{}$]", ""),
        (r"\bM_PI\b", "pi"),
        (r"\\([\\`*_{}\[\]()#+.!|&%$-])", r"\1"),
        (r"(\d+(?:\.\d*)?|\.\d+)(?=\\?(?:π|pi)\b)", r"\1*"),
    )
)
"""Signs of LaTeX, Markdown and programs, and what a person would type."""


def plain_text(cell: str) -> str:
    """A cell without the signs of LaTeX and Markdown; what is not known stays, and the reader names it."""
    for pattern, plain in _SIGNS:
        cell = pattern.sub(plain, cell)
    return " ".join(cell.split())
