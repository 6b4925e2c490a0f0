"""Sentences of problems are data: every code that the program names has an entry, and every entry is named."""

import ast
import string
import tomllib
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.source import MESSAGES, TEMPLATES, Mark, Messages

ROOT = Path(__file__).parents[2]
FILES = [path for top in ("pipeline", "plugins") for path in (ROOT / top).rglob(MESSAGES)]
ALWAYS = {"robot", "joint", "field", "found"}


def texts_and_calls(messages: Path) -> tuple[set[str], list[tuple[str, set[str], bool, str]]]:
    """What the modules name whose nearest `messages.toml` this is.

    Returns:
        All texts; and of each call of `say` the code, its keywords, whether others come with ``**``, and the place.
    """
    texts: set[str] = set()
    calls = []
    for path in messages.parent.rglob("*.py"):
        if next(folder / MESSAGES for folder in path.parents if folder / MESSAGES in FILES) != messages:
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                texts.add(node.value)
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "say" and node.args:
                keywords = {keyword.arg for keyword in node.keywords if keyword.arg}
                several = any(keyword.arg is None for keyword in node.keywords)
                first = node.args[0]
                codes = [first.body, first.orelse] if isinstance(first, ast.IfExp) else [first]
                named = [str(code.value) for code in codes if isinstance(code, ast.Constant)]
                calls += [(code, keywords, several, f"{path.name}:{node.lineno}") for code in named]
    return texts, calls


def test_codes_and_entries_agree() -> None:
    """No code lacks its entry, no entry its code; no template names a value that a call of its code does not give.

    A function that hands a code on to `say` gets the code as a text, which only the words' table proves to be one.
    """
    faults = []
    for path in FILES:
        entries: dict[str, dict[str, Any]] = tomllib.loads(path.read_text("utf-8"))
        texts, calls = texts_and_calls(path)
        for code, keywords, several, place in calls:
            templates = " ".join(entries.get(code, {"message": "{an entry}"}).values())
            named = {name for _, name, _, _ in string.Formatter().parse(templates) if name}
            if (missing := named - keywords - ALWAYS) and not several:
                faults.append(f"{place}: {code} lacks {', '.join(sorted(missing))}")
        faults += [f"{path.parent.name}: nothing makes {code}" for code in entries.keys() - texts]
        faults += [code for code, entry in entries.items() if not entry.keys() <= {*TEMPLATES, "severity"}]
    assert faults == []


def test_a_template_quotes_and_lists(tmp_path: Path) -> None:
    """Texts are quoted as messages repeat them, several words are joined by commas, and the code goes with the problem."""
    (tmp_path / MESSAGES).write_text(
        '[unit-twice]\nmessage = "{found:quoted} is not {units}"\nseverity = "notice"\nsuggestion = "write {field}"\n'
    )
    say = Messages(str(tmp_path / "module.py"))
    problem = say("unit-twice", Mark(file="arm.csv", line=2), found="m\x1bm", field="a", units=["mm", "inch"])
    assert problem.message == "'m\\x1bm' is not mm, inch"
    assert (problem.code, problem.severity, problem.suggestion) == ("unit-twice", "notice", "write a")
    assert problem.as_json()["code"] == "unit-twice"
    assert say("unit-twice", found="m", units=(), suggestion="did you mean 'mm'?").suggestion == "did you mean 'mm'?"
    with pytest.raises(KeyError):
        say("no-such-code")
