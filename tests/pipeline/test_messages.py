"""Sentences of problems are data: every code that the program names has an entry, and every entry is named."""

from __future__ import annotations

import ast
import string
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.source import MESSAGES, TEMPLATES, Mark, Messages

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[2]
FILES = [path for top in ("pipeline", "plugins") for path in (ROOT / top).rglob(MESSAGES)]
ALWAYS = {"robot", "joint", "field", "found"}


def calls(folder: Path) -> Iterator[tuple[str, set[str], bool, str]]:
    """Calls of `say` below a folder: the code, its keywords, whether others may come with ``**``, and the place."""
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name) or node.func.id != "say":
                continue
            keywords = {keyword.arg for keyword in node.keywords if keyword.arg}
            codes = [item.value for item in ast.walk(node.args[0]) if isinstance(item, ast.Constant)]
            several = any(keyword.arg is None for keyword in node.keywords)
            for code in codes:
                if isinstance(code, str):
                    yield code, keywords, several, f"{path.name}:{node.lineno}"


def test_codes_and_entries_agree() -> None:
    """No code lacks its entry, no entry its code; no template names a value that a call of its code does not give."""
    faults = []
    for path in FILES:
        entries: dict[str, dict[str, Any]] = tomllib.loads(path.read_text("utf-8"))
        used = set()
        for code, keywords, several, place in calls(path.parent):
            used.add(code)
            templates = " ".join(entries.get(code, {"message": "{an entry}"}).values())
            named = {name for _, name, _, _ in string.Formatter().parse(templates) if name}
            if (missing := named - keywords - ALWAYS) and not several:
                faults.append(f"{place}: {code} lacks {', '.join(sorted(missing))}")
        faults += [f"{path.parent.name}: nothing makes {code}" for code in entries.keys() - used]
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
