"""Start-up: with many distributions and plugins installed against none, and against Python itself.

Two environments are made, both with dh2urdf and what it needs; one of them has 200 other distributions besides, some of
which have entry points of their own, and 10 plugins. Every command is started afresh and in turn, so that what else
the machine does falls on all; medians and their ratios are printed. Run it with the interpreter of an environment that
has dh2urdf installed:

    python benchmarks/startup.py
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
import venv
from functools import partial
from importlib.metadata import distribution
from pathlib import Path
from re import split
from statistics import median
from typing import TYPE_CHECKING

from measuring import Turn, in_turn, machine, seconds, table

import dh2urdf
import dh2urdf_plugins

if TYPE_CHECKING:
    from collections.abc import Sequence

PACKAGES = (dh2urdf, dh2urdf_plugins)
DISTRIBUTIONS = 200
"""Other distributions, such as a laboratory's environment has."""
PLUGINS = 10
BOUND = 1.5
"""What the commands may take with all of them, against none."""
IMPORT_BOUND = 3.0
"""What `import dh2urdf` may take, against Python that does nothing."""

_MAIN = "import sys; from dh2urdf.cli import main; sys.exit(main())"
COMMANDS = {
    "python -c pass": ("-c", "pass"),
    "import dh2urdf": ("-c", "import dh2urdf"),
    "dh2urdf --help": ("-c", _MAIN, "--help"),
    "dh2urdf plugins": ("-c", _MAIN, "plugins"),
}
NONE, MANY = ", none", ", many"

METADATA = "Metadata-Version: 2.4\nName: {name}\nVersion: 1.0\nSummary: {name}\nRequires-Dist: dh2urdf\n\n{text}"
TEXT = "A long description, as most distributions have one.\n" * 200
PLUGIN = '''
"""A plugin as authors write it: its stage is imported inside its hook."""
from dh2urdf.hookspecs import hookimpl


@hookimpl
def dh2urdf_emitters():
    from {name}.emitter import EMITTER
    return [EMITTER]
'''
EMITTER = """
from dataclasses import dataclass, field
from dh2urdf.stages import EmittedFile, Emitter


@dataclass(frozen=True, kw_only=True)
class Options:
    bullet: str = field(default="-", metadata={{"help": "what a line begins with"}})


def emit(robot, stem, options):
    lines = [f"{{options.bullet}} {{joint.name}}" for joint in robot.moving_joints]
    return [EmittedFile(name=f"{{stem}}.txt", content="\\n".join(lines).encode())]


EMITTER = Emitter(name="{name}", summary="joints", emit=emit, options=Options, suffixes=(".{name}",))
"""


def environment(place: Path) -> Path:
    """An environment with dh2urdf and what it needs, and nothing else; its folder of packages."""
    venv.create(place, symlinks=True, with_pip=False)
    (site,) = place.glob("lib/python*/site-packages")
    for name in _needed("dh2urdf"):
        found = distribution(name)
        tops = {file.parts[0] for file in found.files or () if file.parts[0] not in {"..", "__pycache__"}}
        for top in tops:
            # An editable installation has a folder of the package's data there, which is not the package.
            if not top.endswith(".pth") and top not in {package.__name__ for package in PACKAGES}:
                (site / top).symlink_to(Path(str(found.locate_file(top))))
    for package in PACKAGES:
        (site / package.__name__).symlink_to(Path(str(package.__file__)).parent)
    return site


def _needed(name: str) -> list[str]:
    """A distribution and all that it requires without extras."""
    found = [name]
    for each in found:
        for requirement in distribution(each).requires or ():
            needed = split(r"[^\w.-]", requirement)[0].lower()
            if ";" not in requirement and needed not in found:
                found.append(needed)
    return found


def fill(site: Path, count: int, plugins: int) -> None:
    """Install other distributions, as pip would, of which the last ones are plugins."""
    for number in range(count):
        name = f"other_{number:03d}"
        is_plugin = number >= count - plugins
        package = site / name
        package.mkdir()
        (package / "__init__.py").write_text(PLUGIN.format(name=name) if is_plugin else "")
        if is_plugin:
            (package / "emitter.py").write_text(EMITTER.format(name=name))
        info = site / f"{name}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(METADATA.format(name=name, text=TEXT))
        (info / "RECORD").write_text(f"{name}/__init__.py,,\n" * 50)
        if is_plugin:
            (info / "entry_points.txt").write_text(f"[dh2urdf]\n{name} = {name}\n")
        elif number % 3 == 0:  # as in a real environment of 220 distributions
            (info / "entry_points.txt").write_text(f"[console_scripts]\n{name} = {name}:main\n{name}-x = {name}:x\n")


def start(site: Path, words: Sequence[str], _folder: Path | None = None) -> str:
    """What a command prints that is started in the environment to which a folder of packages belongs."""
    python = site.parents[2] / "bin" / "python"
    return subprocess.run([python, "-I", *words], check=True, capture_output=True, text=True).stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=30)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        none, many = environment(place / "none"), environment(place / "many")
        fill(many, DISTRIBUTIONS, PLUGINS)
        more = [line for line in start(many, COMMANDS["dh2urdf plugins"]).splitlines() if "[other_" in line]
        if len(more) != PLUGINS:
            raise SystemExit(f"{len(more)} of {PLUGINS} plugins are listed")
        sides = {
            f"{name}{where}": partial(start, site, words)
            for name, words in COMMANDS.items()
            for site, where in ((none, NONE), (many, MANY))
        }
        (turns := place / "turns").mkdir()
        in_turn(sides, 1, turns)
        times = in_turn(sides, rounds, turns)
        print(machine(place, ["dh2urdf", "click", "pluggy"]))
    print(f"\n{DISTRIBUTIONS} other distributions, {PLUGINS} of them plugins; median of {rounds} starts each\n")
    bare = seconds(times[f"python -c pass{NONE}"])
    rows = [_row(name, times[name + NONE], times[name + MANY], bare) for name in COMMANDS]
    table(["", "none [ms]", "× python", "many [ms]", "many / none", "bound"], rows)


def _row(name: str, none: list[Turn], many: list[Turn], bare: float) -> list[str]:
    # Of turns that are beside each other: what else the machine does at the time falls on both.
    ratio = median(more.seconds / less.seconds for less, more in zip(none, many, strict=True))
    bounds = {"import dh2urdf": f"≤ {IMPORT_BOUND:g} × python"}
    bound = bounds.get(name, f"≤ {BOUND:g}" if name.startswith("dh2urdf") else "")
    alone = seconds(none)
    return [
        name,
        f"{1000 * alone:.1f}",
        f"{alone / bare:.2f}",
        f"{1000 * seconds(many):.1f}",
        f"{ratio:.2f}",
        bound,
    ]


if __name__ == "__main__":
    main()
