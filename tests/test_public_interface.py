"""What a third party may import stays as it is, or says so.

`PUBLIC` lists it. `tests/public_interface/recorded.json` has every signature and field of it as the code has it, and
`released.json` as the last version of the interface had it; a release makes the second a copy of the first. Before the
first release there is none, and nothing to compare with.
"""

import ast
import importlib
import inspect
import json
import re
from collections.abc import Iterator
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar, TypeVarTuple

import pytest

from dh2urdf.hookspecs import INTERFACE_VERSION

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "compatibility.md"
RECORDED = Path(__file__).parent / "public_interface" / "recorded.json"
RELEASED = RECORDED.with_name("released.json")
COMMAND = "pytest tests/test_public_interface.py --renew"
TABLE = re.compile(r"(?<=<!-- public: )(?P<remark>[^>]*-->\n)(?P<table>.*?)(?=<!-- /public -->)", re.DOTALL)

PUBLIC = {
    "dh2urdf": "the commands as functions, and the records of arms: the Python API",
    "dh2urdf.cells.floating": "robots of which something floats, as formats have them in which only the root can",
    "dh2urdf.cells.attachments": "robots from descriptions, bolted to other robots: grippers, tools, cameras, bases",
    "dh2urdf.columns": "many manipulators or robots that differ in numbers only, for stages that work on all at once",
    "dh2urdf.commands": "tables as files, which are read back before anybody gets them",
    "dh2urdf.documents": "YAML with the place of every value, and text files in whatever encoding",
    "dh2urdf.errors": "every exception, with its exit status",
    "dh2urdf.fields": "what the fields of records accept, and copies and records without these checks",
    "dh2urdf.hookspecs": "the hooks, and the version of this interface",
    "dh2urdf.isolation": "a function in a child process, which may crash, and may be shut off from the machine",
    "dh2urdf.kinematics": "the DH product and forward kinematics",
    "dh2urdf.kinematics.mass": "mass, centre and inertia of shapes and of compounds",
    "dh2urdf.manipulator": "the contents of a table: readers make it, transforms accept it",
    "dh2urdf.measuring": "what a simulator has of an arm, compared with the robot that was written",
    "dh2urdf.meshes": "mesh files: where descriptions name them, their triangles, and the body that they enclose",
    "dh2urdf.output": "files that are written whole or not at all, and which names of many have been seen",
    "dh2urdf.plugin_system": "the catalog of the stages that are installed, and their options",
    "dh2urdf.quantities": "numbers with units, as expressions, and the shortest text of a number",
    "dh2urdf.results": "the types of reports as plain data, for type checkers",
    "dh2urdf.robot": "what will be written: transforms make it, emitters take it",
    "dh2urdf.robot_check": "the rules that every robot keeps",
    "dh2urdf.robot_check.contacts": "capsules around shapes, and arms of a cell that overlap where their joints start",
    "dh2urdf.rotations": "rotations and rigid transforms, exact at quarter turns",
    "dh2urdf.source": "a place in a file, and a problem there",
    "dh2urdf.stages": "the records that a plugin gives, one for each kind of stage",
    "dh2urdf.stages.foreign_robot": "robot descriptions of any origin: the robot, and the joints that follow others",
    "dh2urdf.table_text": "a table as its author types it: texts in cells, and where each stands",
    "dh2urdf.table_text.texts": "the numbers of a manipulator as the texts of a table",
    "dh2urdf.testing": "contract tests for the stages of a plugin, and fixtures",
    "dh2urdf.variations.drawn_links": "links that do not follow the lengths of their table",
    "dh2urdf_plugins.readers.table": "the grammar of all tables: rows of cells become manipulators",
}
"""Modules that a third party may import, and what each is for. Of each, whatever it defines without an underscore."""


# --- What a module offers ---------------------------------------------------------------------------------------------


def interface_of(module: ModuleType) -> dict[str, Any]:
    """Every public name of a module, and what it is."""
    every = {name: getattr(module, name) for name in sorted(public_names(module))}
    return {name: shape_of(value) for name, value in every.items() if not isinstance(value, TypeVar | TypeVarTuple)}


def public_names(module: ModuleType) -> set[str]:
    """The names of ``__all__``; without it, those that the module defines itself."""
    listed = getattr(module, "__all__", None)
    names = set(defined_in(Path(str(module.__file__)))) if listed is None else set(listed)
    return {name for name in names if not name.startswith("_") and hasattr(module, name)}


def defined_in(path: Path) -> Iterator[str]:
    for node in ast.parse(path.read_text("utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign):
            yield from (target.id for target in node.targets if isinstance(target, ast.Name))
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.target.id


def shape_of(value: Any) -> Any:
    """What a caller relies on: a signature, fields, members, or the type of a constant."""
    if isinstance(value, type):
        return class_shape(value)
    if isinstance(value, ModuleType):
        return "a module"
    if callable(value) and hasattr(value, "__module__") and inspect.isroutine(inspect.unwrap(value)):
        return without_addresses(str(inspect.signature(value)))
    if isinstance(value, str | int | float) and not isinstance(value, Enum):
        return f"{type(value).__name__} {value!r}"
    return type(value).__name__


def class_shape(kind: type[Any]) -> dict[str, Any]:
    shape: dict[str, Any] = {"bases": [base.__name__ for base in kind.__bases__ if base is not object]}
    if issubclass(kind, Enum):
        shape["members"] = {member.name: repr(member.value) for member in kind}
    elif is_dataclass(kind):
        shape["fields"] = {each.name: field_shape(each) for each in fields(kind) if not each.name.startswith("_")}
    elif "__init__" in vars(kind):
        shape["init"] = without_addresses(str(inspect.signature(kind.__init__)))
    elif hasattr(kind, "_fields"):
        shape["fields"] = {name: str(kind.__annotations__[name]) for name in kind._fields}
    members = {}
    for name, member in sorted(vars(kind).items()):
        plain = member.__func__ if isinstance(member, staticmethod | classmethod) else member
        if name.startswith("_") or name in shape.get("fields", ()):
            continue
        if inspect.isfunction(plain):
            members[name] = without_addresses(str(inspect.signature(plain)))
        elif isinstance(plain, property) or type(plain).__name__ == "cached_property":
            members[name] = "property"
    return shape | ({"methods": members} if members else {})


def field_shape(each: Any) -> str:
    text = str(each.type)
    if each.default_factory is not MISSING:
        return f"{text} = {each.default_factory.__name__}()"
    return text if each.default is MISSING else without_addresses(f"{text} = {each.default!r}")


def without_addresses(text: str) -> str:
    return re.sub(r" at 0x[0-9a-f]+", "", text)


def present() -> dict[str, Any]:
    """The interface as the code has it."""
    modules = {name: interface_of(importlib.import_module(name)) for name in sorted(PUBLIC)}
    return {"version": INTERFACE_VERSION, "modules": modules}


def read(path: Path) -> dict[str, Any]:
    return dict(json.loads(path.read_text("utf-8")))


# --- What has changed -------------------------------------------------------------------------------------------------


def changes(old: dict[str, Any], new: dict[str, Any]) -> dict[str, str]:
    """What is added, changed or removed, by name: a module, ``module.name``, or what is gone of a ``module.Class``."""
    found: dict[str, str] = {}
    for module in sorted({*old["modules"], *new["modules"]}):
        before, after = old["modules"].get(module), new["modules"].get(module)
        if before is None or after is None:
            found[module] = "added" if before is None else "removed"
            continue
        for name in sorted({*before, *after}):
            if before.get(name) != after.get(name):
                word = "changed" if name in before and name in after else "added" if name in after else "removed"
                found[f"{module}.{name}"] = word
                gone = parts(before.get(name)) - parts(after.get(name)) if word == "changed" else ()
                found |= {f"{module}.{name}.{part}": "removed" for part in sorted(gone)}
    return {name: word for name, word in found.items() if name != "dh2urdf.hookspecs.INTERFACE_VERSION"}


def parts(shape: Any) -> set[str]:
    """The names of a class that its users may say: fields, members and methods."""
    groups = ("fields", "members", "methods") if isinstance(shape, dict) else ()
    return {name for group in groups for name in shape.get(group, ())}


def newest_section(changelog: str) -> str:
    """What the changelog declares about the newest version."""
    return changelog.split("\n## ")[1]


def unmentioned(names: dict[str, str], section: str) -> list[str]:
    """The names that no code span of a section speaks of: whole, or without their module, or with more behind them."""
    spans = [re.split(r"[^\w.]", span)[0] for span in re.findall(r"`([^`]+)`", section)]
    return [name for name in names if name not in spans and (name in PUBLIC or name.rpartition(".")[2] not in spans)]


def released() -> dict[str, Any]:
    return read(RELEASED if RELEASED.exists() else RECORDED)


def version_of(record: dict[str, Any]) -> tuple[int, int]:
    major, minor = record["version"].split(".")
    return int(major), int(minor)


def wrong_version(old: dict[str, Any], new: dict[str, Any]) -> str:
    """Why the version of the interface does not go with what has changed; empty where it does."""
    words = set(changes(old, new).values())
    is_settled = version_of(old) >= (1, 0)  # before that, a minor version may take something away
    if is_settled and "removed" in words and version_of(new)[0] <= version_of(old)[0]:
        return f"something public is gone since interface {old['version']}: the major number has to be higher"
    if words and version_of(new) <= version_of(old):
        return f"something public is new or other since interface {old['version']}: the version has to be higher"
    return ""


class TestTheInterface:
    def test_it_is_as_it_is_recorded(self, *, renew: bool) -> None:
        """No signature, field, member or name changes unnoticed: the record has to change with it."""
        found = present()
        if renew:
            RECORDED.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", "utf-8")
        differing = changes(read(RECORDED), found)
        assert found == read(RECORDED), (
            f"{differing}: if that is meant, record it: `{COMMAND}`; then CHANGELOG.md has to name it, and "
            "dh2urdf.hookspecs.INTERFACE_VERSION to be a higher one than the released"
        )

    def test_every_change_is_in_the_changelog(self) -> None:
        """The newest section of CHANGELOG.md has the name of everything public that is new, other or gone."""
        missing = unmentioned(
            changes(released(), read(RECORDED)), newest_section((ROOT / "CHANGELOG.md").read_text("utf-8"))
        )
        assert missing == [], "the newest section of CHANGELOG.md has to say what became of these, as `code`"

    def test_its_version_goes_with_the_changes(self) -> None:
        """What is gone asks for another major version, what is new or other for another minor one."""
        assert wrong_version(released(), read(RECORDED)) == ""

    def test_its_modules_are_documented(self, *, renew: bool) -> None:
        """The page lists every public module and what it is for."""
        table = "| module | what it has |\n|---|---|\n" + "".join(
            f"| `{name}` | {text} |\n" for name, text in PUBLIC.items()
        )
        if renew:
            PAGE.write_text(TABLE.sub(lambda found: found["remark"] + table, PAGE.read_text("utf-8")), "utf-8")
        found = TABLE.search(PAGE.read_text("utf-8"))
        assert found
        assert found["table"] == table, f"`{COMMAND}` writes the table"

    @pytest.mark.parametrize("folder", ["plugins/dh2urdf_plugins", "examples"])
    def test_it_is_enough(self, folder: str) -> None:
        """The built-in stages and the examples use public modules of the host only, and of them public names."""
        wrong = []
        for path in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.ImportFrom) and str(node.module).partition(".")[0] == "dh2urdf":
                    offered = public_names(importlib.import_module(str(node.module)))
                    names = [name.name for name in node.names]
                    inner = [name for name in names if f"{node.module}.{name}" not in PUBLIC and name not in offered]
                    wrong += [f"{path.name}: {node.module}.{name}" for name in inner]
                    wrong += [] if node.module in PUBLIC else [f"{path.name}: {node.module}"]
        assert wrong == []
