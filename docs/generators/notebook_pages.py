"""Notebooks of docs/notebooks: run without a kernel, and as pages of the site.

A kernel would bring a dozen packages for three lines of work: run each cell in one namespace, keep what it prints, and
keep what its last expression looks like.
"""

from __future__ import annotations

import ast
import io
import json
from contextlib import chdir, redirect_stdout
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[1] / "notebooks"
ROOT = Path(__file__).parents[2]


def executed(notebook: dict[str, Any]) -> dict[str, Any]:
    """A notebook with the outputs of its cells, which are run from the root of the repository, in order."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    cells, count = [], 0
    with chdir(ROOT):
        for cell in notebook["cells"]:
            if cell["cell_type"] != "code":
                cells.append(cell)
                continue
            count += 1
            outputs = _outputs("".join(cell["source"]), namespace, count)
            cells.append({**cell, "execution_count": count, "outputs": outputs})
    return {**notebook, "cells": cells}


def _outputs(source: str, namespace: dict[str, Any], count: int) -> list[dict[str, Any]]:
    """What a cell prints, and its last expression as text and, if it has that form, as HTML."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed, value = io.StringIO(), None
    with redirect_stdout(printed):
        exec(compile(tree, "<cell>", "exec"), namespace)  # noqa: S102 - a cell of our own notebook
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "<cell>", "eval"), namespace)  # noqa: S307
    outputs: list[dict[str, Any]] = []
    if text := printed.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": _lines(text)})
    if value is not None:
        data = {"text/plain": _lines(repr(value))}
        if hasattr(value, "_repr_html_"):
            data["text/html"] = _lines(value._repr_html_())
        outputs.append({"output_type": "execute_result", "execution_count": count, "data": data, "metadata": {}})
    return outputs


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


def page(name: str) -> str:
    """A notebook as Markdown: the words, the code, and the outputs that are kept in its file."""
    notebook = json.loads((FOLDER / f"{name}.ipynb").read_text("utf-8"))
    blocks = []
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            blocks.append(source)
            continue
        blocks.append(f"```python\n{source}\n```")
        for output in cell["outputs"]:
            data = output.get("data", {})
            if html := "".join(data.get("text/html", [])):
                blocks.append(" ".join(html.split("\n")))
            else:
                text = "".join(output.get("text") or data["text/plain"]).rstrip("\n")
                blocks.append(f'```text title="Output"\n{text}\n```')
    return "\n\n".join(blocks)
