"""Pages, docstrings, comments and messages are written in plain English: words that nobody uses keep out."""

import io
import re
import tokenize
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md")] + sorted(
    (ROOT / "docs").rglob("*.md")
)
CODE = ("pipeline", "plugins", "examples", "configs", "docs/generators", "fuzz", "benchmarks", "hatch_build.py")
SUFFIXES = {".py", ".md", ".yaml", ".csv", ".in", ".toml", ".js"}
POOR = {
    r"\bmend(s|ed|ing)?\b": "fix",
    r"\bwho(m)?ever\b": "who, the person that, each caller that",
    r"\bas ever\b": "as before",
    r"\bsays so\b": "reports it",
    r"\b(is|are|was|were|be|been) told\b(?! apart)": "is reported, gets",
    r"\bevery how many": "every n-th",
    r"\b(is|are|was|were|be|been) said\b": "is reported, is given, the message",
    r"\b(say|says|said|tell|tells|told) of\b": "reports, declares about, names",
    r"\bnobody says\b": "by default",
    r"\bthat of those\b": "the noun again",
    r"\bof whatever\b": "of any",
    r"\bstands? (in|at|there|behind|beside|below|above)\b": "is, contains",
    r"(?<=\w) \[1\]": "no unit at all",
}
"""Words, and what to write instead."""
OUTPUT = re.compile(r"^```.*?^```$|^<!--.*?-->$|`[^`\n]*`", re.MULTILINE | re.DOTALL)
"""What programs print, and what is typed."""


def poor_words(text: str, line: int = 1) -> list[tuple[int, str, str]]:
    """The poor words of a text that begins in a line: the line of each, the word, and what to write."""
    return [
        (line + text[: match.start()].count("\n"), match[0], better)
        for word, better in POOR.items()
        for match in re.finditer(word, text, re.IGNORECASE)
    ]


def in_python(source: str) -> list[tuple[int, str, str]]:
    """The poor words of comments, docstrings and other strings: names are not read."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    texts = [token for token in tokens if token.type in (tokenize.COMMENT, tokenize.STRING, FSTRING)]
    return [found for token in texts for found in poor_words(token.string, token.start[0])]


FSTRING = getattr(tokenize, "FSTRING_MIDDLE", tokenize.STRING)
"""The text between the braces of an f-string: a token of its own from Python 3.12 on."""


def in_page(text: str) -> list[tuple[int, str, str]]:
    """The poor words of a page, without those in output and in code."""
    return poor_words(OUTPUT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text))


def written(found: list[tuple[int, str, str]]) -> str:
    return "\n".join(f"line {line}: {word!r}: write {better}" for line, word, better in found)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_has_plain_words(page: Path) -> None:
    """Each poor word is named with its line, and with the word to write."""
    assert written(in_page(page.read_text("utf-8"))) == ""


def packages() -> list[Path]:
    """The files and folders below which the sources are, each for a test of its own."""
    found = []
    for name in CODE:
        for path in (ROOT / name / "dh2urdf", ROOT / name):
            if path.is_dir():
                found += sorted(each for each in path.iterdir() if each.is_dir() or each.suffix in SUFFIXES)
                break
        else:
            found.append(ROOT / name)
    return found


@pytest.mark.parametrize("package", packages(), ids=lambda path: path.relative_to(ROOT).as_posix())
def test_code_has_plain_words(package: Path) -> None:
    """Docstrings, comments, messages, help texts, rules, templates and examples."""
    found = {}
    for path in sorted(package.rglob("*")) if package.is_dir() else [package]:
        if path.suffix not in SUFFIXES or "__pycache__" in path.parts:
            continue
        text = path.read_text("utf-8")
        if not poor_words(text):
            continue
        poor = in_python(text) if path.suffix == ".py" else in_page(text) if path.suffix == ".md" else poor_words(text)
        if poor:
            found[path.relative_to(ROOT).as_posix()] = poor
    assert "\n".join(f"{path}\n{written(poor)}" for path, poor in found.items()) == ""


def test_a_poor_word_is_found() -> None:
    """In a sentence, a comment, a docstring and a message; neither in output, nor in code, nor in a name."""
    assert [word for _, word, _ in in_page("```text\nwhoever\n```\n\n`whoever` and whoever")] == ["whoever"]
    source = 'whoever = f"it is said {1}"  # it stands in it\n\n"""A text\n\nby whomever."""\n'
    assert [(line, word) for line, word, _ in in_python(source)] == [(1, "is said"), (1, "stands in"), (5, "whomever")]
