"""Each usual change touches the files that CONTRIBUTING.md names: the change is made in a copy of the sources and works there.

`test_a_new_field` makes the first one, a number of the rows of a table.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[1]
TEMPLATES = ROOT / "pipeline/dh2urdf/scaffold/templates/minimal"
TABLE = "# convention: standard\na,alpha,d,theta\n0.3,0,0,0\n0.2,0,0,0\n"
URDF = """<robot name="arm"><link name="base_link"/><link name="tool0"/>
<joint name="j" type="continuous"><parent link="base_link"/><child link="tool0"/><axis xyz="0 0 1"/></joint></robot>"""


class Change(NamedTuple):
    """A change of the sources.

    Attributes:
        edits: a file, a text of it and the text that takes its place; an empty text stands for the end of the file.
        added: new files.
        files: what the command reads.
        command: the words behind ``dh2urdf``.
        shows: a text that is printed, or that is in the file ``out``.
    """

    edits: list[tuple[str, str, str]]
    files: dict[str, str]
    command: str
    shows: str
    added: dict[str, str] = {}  # noqa: RUF012 - never changed


def stage_of(kind: str, name: str) -> str:
    """The module of the scaffold for a stage of a kind."""
    text = (TEMPLATES / kind / "__package__.py.template").read_text("utf-8")
    for word, meaning in {"stage": name, "suffix": f".{name}", "summary": "a stage"}.items():
        text = text.replace(f"${word}", meaning)
    return text


CHANGES = {
    "a word of a header": Change(
        [
            (
                "plugins/dh2urdf_plugins/readers/words/vocabulary.toml",
                "en = 'convention, dh convention'",
                "en = 'convention, dh convention, dh style'",
            )
        ],
        {"arm.csv": "dh style,a,alpha,d\nmodified,0.3,0,0\nmodified,0.2,0,0\n"},
        "info arm.csv --json",
        '"convention": "modified"',
    ),
    "a unit": Change(
        [
            (
                "pipeline/dh2urdf/quantities/units.toml",
                '\nft = { factor = "0.3048"',
                '\nfathom = { factor = "1.8288" }\nft = { factor = "0.3048"',
            )
        ],
        {"arm.csv": TABLE.replace("0.3", "1 fathom")},
        "info arm.csv --json",
        "1.8288",
    ),
    "a rule of `check`": Change(
        [
            (
                "plugins/dh2urdf_check/rules/names.yaml",
                "",
                (
                    "\nname-of-a-tree:\n  fault: a robot named after a tree\n  at: /robot[@name = 'oak']\n"
                    "  says: the robot is an oak\n  fix: name it after an arm\n  consumers:\n    ros: [warns, says so]\n"
                ),
            ),
        ],
        {"oak.urdf": URDF.replace('"arm"', '"oak"')},
        "check oak.urdf --no-ask",
        "name-of-a-tree",
    ),
    "an emitter": Change(
        [
            (
                "plugins/dh2urdf_plugins/__init__.py",
                "    yield from (ros2.EMITTER,",
                "    from dh2urdf_plugins.formats import names\n\n    yield from (names.EMITTER, ros2.EMITTER,",
            )
        ],
        {"arm.csv": TABLE},
        "convert arm.csv --to names -o out",
        "joint_1,revolute",
        {"plugins/dh2urdf_plugins/formats/names.py": stage_of("emitter", "names")},
    ),
    "a simulator": Change(
        [
            (
                "plugins/dh2urdf_plugins/__init__.py",
                "    return LOADERS\n",
                "    from dh2urdf_plugins.loaders import engine\n\n    return (engine.LOADER, *LOADERS)\n",
            )
        ],
        {"arm.csv": TABLE, "run.yaml": "inputs: arm.csv\nloaders: engine\noutput: built\n"},
        "run run.yaml",
        "engine",
        {"plugins/dh2urdf_plugins/loaders/engine.py": stage_of("loader", "engine")},
    ),
    "a section of the run file": Change(
        [
            (
                "pipeline/dh2urdf/run_file/sections.py",
                "@dataclass(frozen=True, slots=True, kw_only=True)\nclass RunFile:\n",
                (
                    "@dataclass(frozen=True, slots=True, kw_only=True)\nclass OwnerSection:\n"
                    '    name: Text = key("who answers for the run", "nobody")\n\n\n'
                    "@dataclass(frozen=True, slots=True, kw_only=True)\nclass RunFile:\n"
                    '    owner: OwnerSection = key("who answers for the run", OwnerSection())\n'
                ),
            ),
            (
                "pipeline/dh2urdf/run_file/config.py",
                "    report: ReportSection = ReportSection()\n",
                "    report: ReportSection = ReportSection()\n    owner: object = None\n",
            ),
            (
                "pipeline/dh2urdf/run_file/config.py",
                "        report=report,\n",
                '        report=report,\n        owner=to.record(keys.OwnerSection, given["owner"], "owner"),\n',
            ),
        ],
        {"arm.csv": TABLE, "run.yaml": "inputs: arm.csv\nowner: {nmae: Ada}\noutput: built\n"},
        "run run.yaml",
        "nmae",
    ),
    "a command": Change(
        [
            (
                "plugins/dh2urdf_plugins/__init__.py",
                "@hookimpl\ndef dh2urdf_executors()",
                (
                    "@hookimpl\ndef dh2urdf_commands():\n    from dh2urdf.stages import Subcommand\n\n"
                    '    return [Subcommand(name="weigh", summary="Weigh.", function="dh2urdf_plugins.weigh:command")]\n\n\n'
                    "@hookimpl\ndef dh2urdf_executors()"
                ),
            )
        ],
        {},
        "weigh",
        "two stones",
        {
            "plugins/dh2urdf_plugins/weigh.py": 'import click\n\ncommand = click.Command("weigh", callback=lambda: click.echo("two stones"))\n'
        },
    ),
}


@pytest.mark.parametrize("what", CHANGES)
def test_it_works(what: str, tmp_path: Path) -> None:
    """The command has its effect with the change, in the sources of which nothing else is changed."""
    change, sources = CHANGES[what], tmp_path / "sources"
    for name in ("pipeline", "plugins"):
        shutil.copytree(ROOT / name, sources / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name, old, new in change.edits:
        text = (sources / name).read_text("utf-8")
        assert not old or text.count(old) == 1, (name, old)
        (sources / name).write_text(text.replace(old, new) if old else text + new, "utf-8")
    for name, text in change.added.items():
        (sources / name).write_text(text, "utf-8")
    for name, text in change.files.items():
        (tmp_path / name).write_text(text, "utf-8")
    path = os.pathsep.join([str(sources / "pipeline"), str(sources / "plugins")])
    done = subprocess.run(
        [sys.executable, "-m", "dh2urdf", *change.command.split()],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path, "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )
    out = tmp_path / "out"
    said = done.stdout + done.stderr + (out.read_text("utf-8") if out.is_file() else "")
    assert change.shows in said, said


def test_the_guide_names_the_files() -> None:
    """Each row of the table in CONTRIBUTING.md names every file that its change touches, and no other."""
    guide = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    rows = dict(re.findall(r"^\| (an? .+?) \| (.+) \|$", guide, re.MULTILINE))
    for what, change in CHANGES.items():
        named = set(re.findall(r"`([\w./]+\.\w+)`", rows[what]))
        edited = {path for path, _, _ in change.edits}
        touched = {*edited, *change.added}
        assert all(any(path.endswith(name) for path in touched) for name in named), (what, named)
        assert all(any(path.endswith(name) for name in named) for path in edited), (what, touched)
