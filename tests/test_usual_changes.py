"""Each usual change touches the files that CONTRIBUTING.md names: the change is made in a copy of the sources and works there.

`test_a_new_field` makes the first one, a number of the rows of a table.
"""

import re
import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml
from child_python import python

ROOT = Path(__file__).parents[1]
TEMPLATES = ROOT / "pipeline/dh2urdf/scaffold/templates/minimal"
CHANGES = yaml.safe_load(Path(__file__).with_name("usual_changes.yaml").read_text("utf-8"))


def text_of(added: Any) -> str:
    """What is in a new file: its text, or the module of the scaffold for a stage of a kind."""
    if isinstance(added, str):
        return added
    text = (TEMPLATES / added["scaffold"] / "__package__.py.template").read_text("utf-8")
    for word, meaning in {"stage": added["name"], "suffix": f".{added['name']}", "summary": "a stage"}.items():
        text = text.replace(f"${word}", meaning)
    return text


@pytest.mark.parametrize("what", CHANGES)
def test_it_works(what: str, tmp_path: Path) -> None:
    """The command has its effect with the change, in the sources of which nothing else is changed."""
    change, sources = CHANGES[what], tmp_path / "sources"
    for name in ("pipeline", "plugins"):
        shutil.copytree(ROOT / name, sources / name, ignore=shutil.ignore_patterns("__pycache__"))
    for edit in change.get("edits", ()):
        text, old = (sources / edit["file"]).read_text("utf-8"), edit.get("old", "")
        assert not old or text.count(old) == 1, edit
        (sources / edit["file"]).write_text(text.replace(old, edit["new"]) if old else text + edit["new"], "utf-8")
    for name, added in change.get("added", {}).items():
        (sources / name).write_text(text_of(added), "utf-8")
    for name, text in change.get("files", {}).items():
        (tmp_path / name).write_text(text, "utf-8")
    path = (sources / "pipeline", sources / "plugins")
    done = python("-m", "dh2urdf", *change["command"].split(), folder=tmp_path, path=path, COLUMNS="200")
    out = tmp_path / "out"
    said = done.stdout + done.stderr + (out.read_text("utf-8") if out.is_file() else "")
    assert change["shows"] in said, said


def test_the_guide_names_the_files() -> None:
    """Each row of the table in CONTRIBUTING.md names every file that its change touches, and no other."""
    guide = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    rows = dict(re.findall(r"^\| (an? .+?) \| (.+) \|$", guide, re.MULTILINE))
    for what, change in CHANGES.items():
        named = set(re.findall(r"`([\w./]+\.\w+)`", rows[what]))
        edited = {edit["file"] for edit in change.get("edits", ())}
        touched = {*edited, *change.get("added", ())}
        assert all(any(path.endswith(name) for path in touched) for name in named), (what, named)
        assert all(any(path.endswith(name) for name in named) for path in edited), (what, touched)
