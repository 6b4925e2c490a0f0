"""The pages of docs/ keep their word: every block of code in them is run, or read by what it is for.

The blocks of a page are taken in order, in a folder that holds `configs/`:

- a block with a title is the file of that name; a later block uses it, or it is read as a file of its kind;
- `sh` and `python` without a title are run; what they print is compared with the block ``text title="Output"`` below
  them, where ``…`` stands for anything, and a very small number for any other;
- `yaml` without a title is a run file, whole or a part of one, and a plan is made of it;
- comments above a block say what a reader need not see: ``<!-- exit status: 2 -->``, ``<!-- before: COMMANDS -->``, and
  ``<!-- not run: REASON -->``, which leaves a check of the syntax;
- ``<!-- example …: … -->`` is above tables that `test_tables_page.py` reads.

The README has its own tests, in `test_readme.py`.
"""

import configparser
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path

import click
import pytest
from child_python import ADDOPTS
from lxml import etree

from dh2urdf.cli import dh2urdf as program
from dh2urdf.plugin_system import load
from dh2urdf.report.schema import report_schema
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md"))

BLOCK = re.compile(
    r"^(?P<marks>(?:<!-- [^\n]* -->\n)*)```(?P<language>\w+)(?: title=\"(?P<title>[^\"]+)\")?\n(?P<body>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
MARK = re.compile(r"<!-- (?P<key>not run|before|exit status|example)[^:]*: (?P<value>.*) -->")
OUTPUT = "Output"
BASH = "/bin/bash"

NEEDED_MODULES = {
    "coming-from.md": "roboticstoolbox",
    "first-conversion.md": "mujoco",
    "index.md": "mujoco",
    "collisions.md": "pinocchio",
    "plugin-programs.md": "yourdfpy",
    "tables/other-files.md": "pyarrow",
}
NEEDED_PROGRAMS = {"simulators/ros.md": "check_urdf"}
NEEDED_LOADERS = {
    "simulators.md": ("pybullet", "mujoco", "pinocchio", "drake", "gazebo"),
    **{f"simulators/{name}.md": (name,) for name in ("pybullet", "mujoco", "pinocchio", "drake", "gazebo")},
}


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    page: str
    line: int
    language: str
    title: str
    body: str
    marks: dict[str, str] = field(hash=False)

    @property
    def place(self) -> str:
        return f"docs/{self.page}:{self.line}"

    @property
    def runs(self) -> bool:
        return self.language in ("sh", "python") and not self.title and "not run" not in self.marks


TAB = re.compile(r'^=== "[^"]+"$')


def page_text(path: Path) -> str:
    """A page with the contents of its tabs as if there were no tabs; every line stays the line that it is."""
    lines, inside = [], False
    for line in path.read_text("utf-8").splitlines(keepends=True):
        if TAB.match(line):
            inside = True
            lines.append("\n")
            continue
        inside = inside and (line.startswith("    ") or not line.strip())
        lines.append(line.removeprefix("    ") if inside else line)
    return "".join(lines)


def blocks_of(page: str) -> list[Block]:
    text = page_text(DOCS / page)
    return [
        Block(
            page=page,
            line=text[: found.start("language")].count("\n") + 1,
            language=found["language"],
            title=found["title"] or "",
            body=found["body"],
            marks={mark["key"]: mark["value"] for mark in MARK.finditer(found["marks"])},
        )
        for found in BLOCK.finditer(text)
    ]


BLOCKS = {page: blocks_of(page) for page in PAGES}


# --- What is done with a block ----------------------------------------------------------------------------------------


class Folder:
    """The folder of a page, in which its blocks are run.

    Attributes:
        path: the folder.
        types: what mypy keeps of dh2urdf.
        installed: where distributions are that the page has written and installed.
        ran: the blocks that were run.
    """

    def __init__(self, path: Path, types: Path) -> None:
        self.path = path
        self.types = types
        self.installed: list[Path] = []
        self.ran: list[Block] = []
        shutil.copytree(ROOT / "configs", path / "configs")

    def take(self, block: Block, output: Block | None) -> None:
        """Do with a block what it is for."""
        if block.title and block.title != OUTPUT:
            target = self.path / block.title
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(block.body, "utf-8")
        if block.runs:
            if before := block.marks.get("before"):
                self._start([BASH, "-euo", "pipefail", "-c", before], block)
            printed = self._shell(block) if block.language == "sh" else self._python(block)
            self.ran.append(block)
            if output:
                assert matches(printed, output.body), f"{output.place}: this is printed\n{printed}"
        else:
            READ[block.language](self, block)

    def _shell(self, block: Block) -> str:
        lines = [line for line in block.body.splitlines() if not self._sets_up(line)]
        return self._start([BASH, "-euo", "pipefail", "-c", "\n".join(lines)], block)

    def _python(self, block: Block) -> str:
        return self._start([sys.executable, "-c", block.body], block)

    def _start(self, command: list[str], block: Block) -> str:
        paths = [*map(str, self.installed), *filter(None, [os.environ.get("PYTHONPATH")])]
        result = subprocess.run(
            command,
            cwd=self.path,
            env={
                **os.environ,
                "COLUMNS": "120",
                "MYPY_CACHE_DIR": str(self.types),
                "PYTEST_ADDOPTS": ADDOPTS,
                "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
                "PYTHONPATH": os.pathsep.join(paths),
            },
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            encoding="utf-8",
            check=False,
            timeout=300,
        )
        wanted = int(block.marks.get("exit status", "0"))
        assert result.returncode == wanted, f"{block.place}: exit status {result.returncode}\n{result.stdout}"
        return result.stdout

    def _sets_up(self, line: str) -> bool:
        """Whether a line sets up a machine; then it is looked at, and what it installs is there already.

        A distribution that the page itself has written is installed, beside the others.
        """
        if line in ("python3 -m venv .venv", ". .venv/bin/activate"):
            return True
        words = shlex.split(line)
        if words[:2] == ["apt-get", "install"]:
            installed = (ROOT / ".ci" / "run").read_text("utf-8").split()
            assert set(words[2:]) <= set(installed), line
            return True
        if words[:2] != ["pip", "install"]:
            return False
        for word in words[2:]:
            if word.startswith("./"):
                self._install(self.path / word.partition("[")[0])
            elif word != "-e":
                _check_extras(word)
        return True

    def _install(self, source: Path) -> None:
        """Install a distribution for the commands of this page; changes of its source are seen, as with `-e`."""
        site = self.path / ".site"
        offline = ("--no-index", "--no-deps", "--no-build-isolation", "--quiet", "--disable-pip-version-check")
        subprocess.run([sys.executable, "-m", "pip", "install", *offline, "--target", site, source], check=True)
        modules = source / "src" if (source / "src").is_dir() else source
        self.installed = [modules, *self.installed, site]


def _check_extras(requirement: str) -> None:
    """A requirement is this project, with extras that it has."""
    found = re.fullmatch(r"(?:dh2urdf|\.)(?:\[([\w,]+)\])?", requirement)
    assert found, requirement
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    assert set(filter(None, (found[1] or "").split(","))) <= set(extras), requirement


def matches(printed: str, shown: str) -> bool:
    """Whether a page shows what was printed."""
    pattern = re.escape(_comparable(shown)).replace("…", ".*")
    return re.fullmatch(pattern, _comparable(printed), re.DOTALL) is not None


def _comparable(text: str) -> str:
    """A text with every rounding error replaced, and with lines as long as may be."""
    text = re.sub(
        r"\b\d+(?:\.\d+)?e-\d+\b|(?<=within )0(?= m)|(?<=largest error )0(?= m)|(?<=m and )0(?= rad)|(?<=│ ) *0(?= │)",
        "#",
        text,
    )
    return re.sub(r"[━ ]+", " ", text).strip()


def _read_shell(_folder: Folder, block: Block) -> None:
    subprocess.run([BASH, "-n", "-c", block.body], check=True)


def _read_python(_folder: Folder, block: Block) -> None:
    compile(block.body, block.place, "exec")


def _read_yaml(folder: Folder, block: Block) -> None:
    """A run file, or a part of one; one with a title is left to the commands that use it."""
    if block.title:
        return
    text = block.body if "inputs:" in block.body else f"{block.body}inputs: configs/tables/ur5.csv\n"
    for mesh in re.findall(r"configs/meshes/\w+\.stl", text):
        (folder.path / mesh).parent.mkdir(exist_ok=True)
        (folder.path / mesh).touch()
    (folder.path / ".run.yaml").write_text(text, "utf-8")
    plan = make_plan(load_config(folder.path / ".run.yaml"), load())
    assert plan.inputs
    assert all(path.is_file() for path, _ in plan.inputs)


def _read_json(_folder: Folder, block: Block) -> None:
    assert json.loads(block.body)


def _read_toml(_folder: Folder, block: Block) -> None:
    assert tomllib.loads(block.body)


def _read_xml(_folder: Folder, block: Block) -> None:
    etree.fromstring(block.body.encode())


def _read_ini(_folder: Folder, block: Block) -> None:
    assert block.title, f"{block.place}: a file without a title is used by nothing"
    parser = configparser.ConfigParser()
    parser.read_string(block.body)
    assert parser.sections()


def _read_csv(_folder: Folder, block: Block) -> None:
    assert block.title, f"{block.place}: a table without a title is used by nothing"


def _read_text(_folder: Folder, block: Block) -> None:
    assert block.title in ("", OUTPUT), block.place


READ: dict[str, Callable[[Folder, Block], None]] = {
    "sh": _read_shell,
    "python": _read_python,
    "yaml": _read_yaml,
    "json": _read_json,
    "toml": _read_toml,
    "xml": _read_xml,
    "csv": _read_csv,
    "ini": _read_ini,
    "text": _read_text,
}


# --- The tests --------------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("page", [page for page in PAGES if BLOCKS[page]])
def test_its_blocks_do_what_it_says(
    page: str, tmp_path: Path, types_cache: Path, require_loaders: Callable[..., None]
) -> None:
    """Every block is run or read, files that it shows are used, and what it says is printed is printed."""
    if module := NEEDED_MODULES.get(page):
        pytest.importorskip(module)
    if (name := NEEDED_PROGRAMS.get(page)) and shutil.which(name) is None:
        pytest.skip(f"{name} is not installed")
    require_loaders(*NEEDED_LOADERS.get(page, ()))
    folder = Folder(tmp_path, types_cache)
    blocks = [block for block in BLOCKS[page] if "example" not in block.marks]
    for block, after in zip_longest(blocks, blocks[1:]):
        folder.take(block, after if after and after.title == OUTPUT else None)
    text = page_text(DOCS / page)
    fences = len(re.findall(r"^```(?:sh|python)$", text, re.MULTILINE))
    assert len(folder.ran) == fences - len(re.findall(r"^<!-- not run: .* -->\n```\w+$", text, re.MULTILINE))


@pytest.mark.parametrize("page", PAGES)
def test_no_block_is_overlooked(page: str) -> None:
    """Every fence of a page belongs to a block, and every comment above one is known."""
    text = page_text(DOCS / page)
    assert text.count("```") == 2 * len(BLOCKS[page])
    for found in BLOCK.finditer(text):
        assert len(found["marks"].splitlines()) == len(MARK.findall(found["marks"])), found["marks"]


def test_what_is_not_run_needs_what_no_test_machine_has() -> None:
    """These blocks alone are not run, and each says why."""
    not_run = Counter(
        f"{page} {block.language}" for page in PAGES for block in BLOCKS[page] if "not run" in block.marks
    )
    several = {"fuzzing.md sh": 7, "plugin-cookbook.md python": 3, "ros2-packages.md sh": 2, "studio.md sh": 3}
    once = (
        "extract-others.md sh",
        "machines.md python",
        "machines.md sh",
        "simulators.md sh",
        "simulators/ros.md python",
    )
    more = ("simulators/coppeliasim.md python", "simulators/gazebo.md sh", "studio.md python")
    assert not_run == several | dict.fromkeys((*once, *more), 1)


def test_an_output_stands_below_what_prints_it() -> None:
    """Never below a block that is not run; so none is compared with nothing."""
    for page in PAGES:
        for before, block in zip([None, *BLOCKS[page]], BLOCKS[page], strict=False):
            assert block.title != OUTPUT or (before is not None and before.runs), block.place


def test_a_page_that_says_something_else_fails(tmp_path: Path) -> None:
    """The comparison sees another line, another number and a missing end, and forgives rounding errors."""
    assert matches("within 1.1e-16 m\nb\n", "within 2e-15 m\nb\n")
    assert matches("a\nb\nc\n", "a\n…\nc\n")
    assert not matches("a\nb\n", "a\n")
    assert not matches("tool0 at 0.42\n", "tool0 at 0.43\n")
    folder = Folder(tmp_path, tmp_path)
    block = Block(page="x.md", line=1, language="sh", title="", body="echo a; false", marks={})
    with pytest.raises(AssertionError, match=r"docs/x\.md:1: exit status 1"):
        folder.take(block, None)


@pytest.mark.parametrize("path", [ROOT / "README.md", *(DOCS / page for page in PAGES)], ids=lambda path: path.name)
def test_commands_in_the_text_have_these_flags(path: Path) -> None:
    """A command between backticks exists, and so does each of its flags."""
    text = BLOCK.sub("", page_text(path))
    context = click.Context(program, info_name="dh2urdf", **program.context_settings)
    for command in re.findall(r"`dh2urdf ([^`]+)`", text):
        words = [word for word in command.split() if word not in ("--debug", "--help", "--version")]
        if not words or words[0].isupper():
            continue
        known = program.get_command(context, words[0])
        assert known is not None, command
        flags = {flag for option in known.get_params(context) for flag in option.opts}
        assert {word for word in words if word.startswith("-")} <= flags | {"--help"}, command


LINK = re.compile(r"(?<!!)\[[^\]]*\]\((?P<target>[^)#\s]*)(?:#(?P<anchor>[^)\s]+))?\)|!\[[^\]]*\]\((?P<image>[^)]+)\)")


def anchors(path: Path) -> set[str]:
    """The anchors of a page, as a code host makes them of its headings."""
    text = BLOCK.sub("", page_text(path))
    titles = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.casefold()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("path", [ROOT / "README.md", *(DOCS / page for page in PAGES)], ids=lambda path: path.name)
def test_links_lead_somewhere_on_a_code_host_too(path: Path) -> None:
    """Every link between pages leads to a file of the repository and to a heading in it; mkdocs tries them in the site."""
    for link in LINK.finditer(BLOCK.sub("", page_text(path))):
        target = link["image"] or link["target"]
        if target.startswith(("http://", "https://")):
            continue
        file = path.parent / target if target else path
        assert file.exists(), link[0]
        if link["anchor"]:
            assert link["anchor"] in anchors(file), link[0]


def test_the_report_that_is_shown_has_all_keys() -> None:
    """docs/report.md shows a `report.json` with the keys of its schema."""
    (block,) = (block for block in BLOCKS["report.md"] if block.language == "json")
    assert list(json.loads(block.body)) == list(report_schema()["properties"])
