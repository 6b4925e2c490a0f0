from __future__ import annotations

import ast
from pathlib import Path

from dh2urdf import cli

COMMANDS = [path for path in Path(cli.__file__).parent.glob("*.py") if path.name not in ("__init__.py", "answers.py")]


def test_every_command_gives_its_answer_as_one() -> None:
    """While a command is at work `click.echo` is for remarks: where it writes by itself would be standard error."""
    assert len(COMMANDS) > 10
    for path in COMMANDS:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "click.echo":
                assert "err" in [word.arg for word in node.keywords], f"{path.name}:{node.lineno}"
