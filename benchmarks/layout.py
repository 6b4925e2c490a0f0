"""The layout of the code in figures: its parts, the imports between them, sizes, and how much of it a command enters.

    python benchmarks/layout.py
    python benchmarks/layout.py --tree ../before --python ../before/.venv/bin/python

A part is a module of the package `dh2urdf`, or a package in it with all that it holds. A part imports another where any
of its code does, for type checkers too. Parts that import each other, also by way of others, are a circle. The layers
are the longest way down from a part to one that imports none; a circle is one layer. Functions are counted without
bodies of classes, and without comprehensions.
"""

from __future__ import annotations

import argparse
import ast
import json
import subprocess
import sys
import tempfile
from collections import defaultdict
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ENTERED = """
import json, sys
entered = set()

def note(frame, event, _):
    module, code = frame.f_globals.get("__name__", ""), frame.f_code
    if event == "call" and module.startswith("dh2urdf") and code.co_flags & 2 and not code.co_name.startswith("<"):
        entered.add((module, code.co_qualname))

import dh2urdf.cli
sys.setprofile(note)
try:
    dh2urdf.cli.main(sys.argv[2:])
except SystemExit as end:
    assert not end.code, end.code
sys.setprofile(None)
open(sys.argv[1], "w").write(json.dumps([len({module for module, _ in entered}), len(entered)]))
"""
"""Runs a command, and notes the functions of dh2urdf that are called: their code has the flag CO_NEWLOCALS, 2."""


class Layout:
    """The modules of a package, and what they import of it.

    Attributes:
        files: the files of modules by their names.
        imports: pairs of parts, of which the first imports the second.
        circles: sets of parts that reach each other.
    """

    def __init__(self, package: Path) -> None:
        self.package = package
        self.files = {self._name(path): path for path in sorted(package.rglob("*.py"))}
        self.imports = {
            (here, there)
            for name, path in self.files.items()
            for imported in self._imports(path)
            if package.name not in (here := self._part(name), there := self._part(imported)) and here != there
        }
        self.circles = self._circles()

    @property
    def parts(self) -> set[str]:
        """The names of the parts."""
        return {self._part(name) for name in self.files} - {self.package.name}

    @property
    def largest_package(self) -> tuple[int, str]:
        """Lines of the largest package below the top, its own modules alone, and its name."""
        sizes: dict[str, int] = defaultdict(int)
        for name, path in self.files.items():
            package = name if path.stem == "__init__" else name.rpartition(".")[0]
            sizes[package] += lines(path)
        sizes.pop(self.package.name)
        return max(((size, name) for name, size in sizes.items()), default=(0, "none"))

    @property
    def layers(self) -> int:
        """How many layers there are."""
        place = {part: circle for circle in self.circles for part in circle}
        below = defaultdict(set)
        for here, there in self.imports:
            if place.get(here, here) != place.get(there, there):
                below[place.get(here, here)].add(place.get(there, there))

        @cache
        def height(part: object) -> int:
            return 1 + max(map(height, below[part]), default=0)  # type: ignore[index]

        return max(height(place.get(part, part)) for part in self.parts)

    def _name(self, path: Path) -> str:
        return ".".join(path.relative_to(self.package.parent).with_suffix("").parts).removesuffix(".__init__")

    def _part(self, name: str) -> str:
        return ".".join(name.split(".")[:2])

    def _imports(self, path: Path) -> set[str]:
        found = set()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom):
                found |= {f"{node.module}.{alias.name}" for alias in node.names} | {str(node.module)}
            elif isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
        return {name for full in found if (name := self._module(full))}

    def _module(self, name: str) -> str:
        """The module that a name is of; empty for one of another package."""
        return name if name in self.files else self._module(name.rpartition(".")[0]) if name else ""

    def _circles(self) -> list[frozenset[str]]:
        after = defaultdict(set)
        for here, there in self.imports:
            after[here].add(there)
        reached = {}
        for part in self.parts:
            reached[part], waiting = set(), [part]
            while waiting:
                new = after[waiting.pop()] - reached[part]
                reached[part] |= new
                waiting += new
        circles = {frozenset(o for o in reached[r] if r in reached[o]) for r in reached if r in reached[r]}
        return sorted(circles, key=len)


def lines(path: Path) -> int:
    """Lines of a file."""
    return len(path.read_text("utf-8").splitlines())


def all_lines(folder: Path) -> int:
    """Lines of the Python files below a folder."""
    return sum(map(lines, folder.rglob("*.py")))


def entered(python: Path, tree: Path, *words: str) -> str:
    """Modules and functions that a command enters."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "entered.json"
        command = [python, "-c", ENTERED, out, *words, "-o", Path(folder) / "ur5.urdf"]
        subprocess.run(command, cwd=tree, check=True, capture_output=True)
        modules, functions = json.loads(out.read_bytes())
    return f"{modules} modules, {functions} functions"


def figures(tree: Path, python: Path) -> dict[str, object]:
    """The figures of a tree."""
    host, plugins = tree / "pipeline" / "dh2urdf", tree / "plugins" / "dh2urdf_plugins"
    layout = Layout(host)
    inside = [pair for pair in layout.imports if any(circle.issuperset(pair) for circle in layout.circles)]
    size, package = layout.largest_package
    longest = max((*host.rglob("*.py"), *plugins.rglob("*.py")), key=lines)
    return {
        "parts": len(layout.parts),
        "imports between parts": len(layout.imports),
        "circles": ", ".join(f"of {len(circle)} parts" for circle in layout.circles) or "none",
        "imports in circles": len(inside),
        "layers": layout.layers,
        "lines of the host": all_lines(host),
        "lines of the plugins": all_lines(plugins),
        "lines of tests": all_lines(tree / "tests"),
        "longest module": f"{lines(longest)}, {longest.relative_to(tree)}",
        "largest package of the host": f"{size}, {package}",
        "convert ur5.csv enters": entered(python, tree, "convert", "configs/tables/ur5.csv"),
        "run ur5.yaml enters": entered(python, tree, "run", "configs/ur5.yaml", "-q", "--set", "loaders=[]"),
    }


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description="Print the layout of a tree in figures.")
    parser.add_argument("--tree", type=Path, default=ROOT, help="the tree")
    parser.add_argument("--python", type=Path, default=Path(sys.executable), help="the interpreter it is installed in")
    asked = parser.parse_args()
    for name, value in figures(asked.tree.resolve(), asked.python.absolute()).items():
        print(f"{name}: {value:,}" if isinstance(value, int) else f"{name}: {value}")


if __name__ == "__main__":
    main()
