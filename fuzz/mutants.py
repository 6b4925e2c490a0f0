"""Changes one thing in a module at a time, and looks whether the tests notice: mutation testing.

    python fuzz/mutants.py kinematics --count 60 --seed 1
    python fuzz/mutants.py readers --kind arm

For each group of modules (`GROUPS`) mutants are drawn among all places where an operator, a number, a condition or a
choice can be another one. The tests of the group run with each mutant in a fork of this process, until one of them
fails. What no test noticed is printed: a missing test, or a change that makes no difference.
"""

from __future__ import annotations

import argparse
import ast
import copy
import importlib.util
import os
import random
import resource
import signal
import sys
import time
from contextlib import suppress
from importlib.machinery import PathFinder, SourceFileLoader
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import CodeType

ROOT = Path(__file__).parents[1]
HOST, PLUGINS = ROOT / "pipeline" / "dh2urdf", ROOT / "plugins" / "dh2urdf_plugins"
CHECK, STUDIO = ROOT / "plugins" / "dh2urdf_check", ROOT / "plugins" / "dh2urdf_studio"


class Group(NamedTuple):
    """Modules, the tests that should notice a change of them, the quickest first, and how many mutants are drawn."""

    modules: tuple[Path, ...]
    tests: tuple[str, ...]
    count: int = 60


def _modules(folder: Path, names: str = "*") -> tuple[Path, ...]:
    return tuple(
        sorted(path for name in names.split() for path in folder.glob(f"{name}.py") if path.stem != "__init__")
    )


GROUPS = {
    "kinematics": Group(_modules(HOST / "kinematics", "chain proof walk"), ("tests/pipeline/kinematics",)),
    "transforms": Group(
        _modules(PLUGINS / "transforms", "alpha_swap assembly exact frames"), ("tests/plugins/transforms",)
    ),
    "read_back": Group(
        _modules(PLUGINS / "formats" / "urdf", "forms scanner"),
        ("tests/plugins/test_urdf_scanner.py", "tests/pipeline/kinematics/test_proof_of_many.py"),
    ),
    "readers": Group(_modules(PLUGINS / "readers", "header/* plain/* rows/* words/*"), ("tests/plugins/readers",), 200),
    "check": Group(_modules(CHECK), ("tests/check/test_rules.py", "tests/check"), 100),
    "settings": Group(_modules(HOST / "run_file"), ("tests/pipeline/run_file",), 100),
    "editing": Group(_modules(STUDIO / "editing"), ("tests/studio/editing",), 50),
}
SECONDS = 120
"""Of processor time for the tests of one mutant: one that takes longer runs for ever."""
READY = ("numpy", "hypothesis", "lxml.etree", "pydantic", "pytest", "rich.console", "yaml")
"""What is imported before the first fork. None of it imports what is mutated."""

# --- Mutants ----------------------------------------------------------------------------------------------------------

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.Mult,
    ast.MatMult: ast.Add,
}
NAMES = {"min": "max", "max": "min", "any": "all", "all": "any", "sin": "cos", "cos": "sin", "upper": "lower"}


def changes(node: ast.AST) -> Iterator[tuple[str, Callable[[Any], ast.AST]]]:  # noqa: C901 - a case for each kind of change
    """What can be changed in a node: in words, and a function that makes a new node of a copy."""
    match node:
        case ast.Compare(ops=[op, *_]) if type(op) in COMPARISONS:
            yield "comparison", lambda new: _with(new, ops=[COMPARISONS[type(op)](), *new.ops[1:]])
        case ast.BinOp(op=op) if type(op) in OPERATORS and not _is_text(node):
            yield "operator", lambda new: _with(new, op=OPERATORS[type(op)]())
        case ast.BoolOp(op=op):
            yield "and/or", lambda new: _with(new, op=ast.Or() if isinstance(op, ast.And) else ast.And())
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield "sign", lambda new: new.operand
        case ast.Constant(value=bool(value)):
            yield "truth", lambda new: _with(new, value=not value)
        case ast.Constant(value=int(value) | float(value)):
            yield "number", lambda new: _with(new, value=value + 1)
        case ast.If() | ast.IfExp() | ast.While():
            yield "condition", lambda new: _with(new, test=ast.UnaryOp(ast.Not(), new.test))
        case ast.Call(func=ast.Name(id=name)) if name in NAMES:
            yield "function", lambda new: _with(new, func=ast.Name(NAMES[name], ast.Load()))
        case ast.Call(func=ast.Attribute(attr=name)) if name in NAMES:
            yield "function", lambda new: _with(new, func=_with(new.func, attr=NAMES[name]))
        case ast.Continue():
            yield "break", lambda _new: ast.Break()
        case ast.Break():
            yield "continue", lambda _new: ast.Continue()
        case ast.Return(value=ast.expr() as value) if not isinstance(value, ast.Constant):
            yield "result", lambda new: _with(new, value=ast.Constant(None))


def _with(node: Any, **fields: Any) -> Any:
    for name, value in fields.items():
        setattr(node, name, value)
    return node


def _is_text(node: ast.BinOp) -> bool:
    return any(
        isinstance(each, ast.JoinedStr | ast.Constant) and not _is_number(each) for each in (node.left, node.right)
    )


def _is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)


def _mutable(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes of a module that can be changed: no annotations, no decorators, and nothing that is only for types."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in {"annotation", "returns", "decorator_list", "type_params"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            is_for_types = isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING"
            if isinstance(child, ast.AST) and not is_for_types:
                yield from _mutable(child)


class Mutant(NamedTuple):
    """One change of one module.

    Attributes:
        path: the module.
        line: where the change is.
        kind: what was changed.
        was: the text before.
        instead: the text after.
        tree: the module, changed.
    """

    path: Path
    line: int
    kind: str
    was: str
    instead: str
    tree: ast.Module

    def __str__(self) -> str:
        place = f"{self.path.relative_to(ROOT)}:{self.line}"
        return f"{place}: {self.kind}: {_first(self.was)} -> {_first(self.instead)}"


def _first(text: str) -> str:
    return text.partition("\n")[0][:90]


def mutants(path: Path) -> list[Mutant]:
    """All mutants of a module."""
    tree = ast.parse(path.read_text("utf-8"))
    found = []
    for node in _mutable(tree):
        for kind, change in changes(node):
            was, copied = ast.unparse(node), copy.deepcopy(tree)
            places = zip(ast.walk(tree), ast.walk(copied), strict=True)
            twin = next(other for own, other in places if own is node)
            parent, name, index = _place(copied, twin)
            new = ast.copy_location(change(twin), twin)
            if index is None:
                setattr(parent, name, new)
            else:
                getattr(parent, name)[index] = new
            ast.fix_missing_locations(copied)
            found.append(Mutant(path, getattr(node, "lineno", 0), kind, was, ast.unparse(new), copied))
    return found


def _place(tree: ast.AST, wanted: ast.AST) -> tuple[ast.AST, str, int | None]:
    for parent in ast.walk(tree):
        for name, value in ast.iter_fields(parent):
            if value is wanted:
                return parent, name, None
            if isinstance(value, list):
                for index, child in enumerate(value):
                    if child is wanted:
                        return parent, name, index
    raise AssertionError


# --- Trying one -------------------------------------------------------------------------------------------------------


class _Changed(SourceFileLoader):
    """Loads a mutant in place of its module."""

    mutant: Mutant

    def get_code(self, fullname: str) -> CodeType:  # noqa: ARG002 - the interface of loaders
        return compile(self.mutant.tree, str(self.mutant.path), "exec")


class _Finder:
    """Finds the mutant where its module is imported."""

    def __init__(self, mutant: Mutant) -> None:
        self.mutant = mutant

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        spec = PathFinder.find_spec(name, path, target)
        if spec is None or spec.origin != str(self.mutant.path):
            return None
        loader = _Changed(name, spec.origin)
        loader.mutant = self.mutant
        return importlib.util.spec_from_file_location(name, spec.origin, loader=loader)


def survives(mutant: Mutant | None, tests: tuple[str, ...], kind: str, log: Path) -> bool:
    """Whether all tests pass with a mutant: in a fork, in which nothing of the project has been imported."""
    number = os.fork()
    if number == 0:
        with log.open("w") as file:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        os.setpgid(0, 0)
        if mutant is not None:
            sys.meta_path.insert(0, _Finder(mutant))  # type: ignore[arg-type]
        import pytest

        status = pytest.main(["-x", "-q", "-p", "no:cacheprovider", "--assert=plain", "-n0", "-m", kind, *tests])
        os._exit(int(status != 0))
    _, status = os.waitpid(number, 0)
    with suppress(ProcessLookupError):
        os.killpg(number, signal.SIGKILL)  # What the tests have started.
    return status == 0


def main() -> None:
    """Try mutants of a group, and print those that no test notices."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("group", choices=GROUPS)
    parser.add_argument("--count", type=int, help="how many mutants: those of the group, if left out")
    parser.add_argument("--kind", default="", help="of the tests: arm, words, speed; all, if left out")
    parser.add_argument("--seed", default="1", help="of the draw")
    parser.add_argument("--log", type=Path, default=Path("mutants.log"), help="what the tests of the last one print")
    parser.add_argument("--tests", nargs="*", help="other tests than those of the group")
    words = parser.parse_args()
    group = GROUPS[words.group]
    tests = tuple(words.tests or group.tests)
    for module in READY:
        importlib.import_module(module)
    began = time.monotonic()
    if not survives(None, tests, words.kind, words.log):
        sys.exit(f"the tests fail without a mutant: see {words.log}")
    print(f"the tests pass without a mutant, in {time.monotonic() - began:.1f} s", flush=True)
    drawn = [mutant for path in group.modules for mutant in mutants(path)]
    print(f"{len(drawn)} mutants of {len(group.modules)} modules", flush=True)
    drawn = random.Random(words.seed).sample(drawn, min(words.count or group.count, len(drawn)))
    left = []
    for number, mutant in enumerate(drawn, start=1):
        if survives(mutant, tests, words.kind, words.log):
            left.append(mutant)
            print(f"{number}: survives: {mutant}", flush=True)
    print(f"{len(drawn) - len(left)} of {len(drawn)} mutants were noticed")


if __name__ == "__main__":
    main()
