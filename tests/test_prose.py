"""The pages for users are written in plain English: words that nobody uses keep out."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
POOR = {
    r"\bmend(s|ed|ing)?\b": "fix",
    r"\bwhoever\b": "who, the person that",
    r"\bas ever\b": "as before",
    r"\bsays so\b": "reports it",
    r"\b(is|are) told\b": "is reported",
    r"\bevery how many": "every n-th",
    r"\bit is said\b": "it is written",
    r"\bwhat is said\b": "the message",
    r" \[1\]": "no unit at all",
}
"""Words, and what to write instead."""
OUTPUT = re.compile(r"^```.*?^```$|^<!--.*?-->$|`[^`\n]*`", re.MULTILINE | re.DOTALL)
"""What programs print, and what is typed."""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_has_plain_words(page: Path) -> None:
    """Each poor word is named with its line, and with the word to write."""
    text = OUTPUT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), page.read_text("utf-8"))
    found = [
        f"{page.name}:{text[: match.start()].count(chr(10)) + 1}: {match[0]!r}: write {better}"
        for word, better in POOR.items()
        for match in re.finditer(word, text)
    ]
    assert found == []


def test_a_poor_word_is_found() -> None:
    """In a sentence, and neither in output nor in code."""
    text = OUTPUT.sub("", "```text\nwhoever\n```\n\n`whoever` and whoever")
    assert re.findall(r"\bwhoever\b", text) == ["whoever"]
