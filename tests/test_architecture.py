"""The house rules, held by tests: what is shipped, who imports whom, and what a start costs."""

import ast
import importlib
import json
import pkgutil
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pluggy
import pytest

import dh2urdf
import dh2urdf_check
import dh2urdf_plugins
import dh2urdf_studio
from dh2urdf import hookspecs
from dh2urdf.columns import COM, INERTIA, LIMITS, NUMBERS, ROW_FIELDS
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import KINDS, RECORDS, load
from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Subcommand

ROOT = Path(__file__).parents[1]
HOST = ROOT / "pipeline" / "dh2urdf"
PLUGINS = tuple(ROOT / "plugins" / f"dh2urdf_{name}" for name in ("check", "plugins", "studio"))
EXAMPLES = tuple(sorted((ROOT / "examples").iterdir()))
HOOKS = {**{f"dh2urdf_{kind}s": record for kind, record in RECORDS.items()}, "dh2urdf_commands": Subcommand}
"""The hooks, and the record that each gives."""

SIMULATORS = {"pybullet", "mujoco", "pinocchio", "pydrake", "zmq"}
HEAVY = SIMULATORS | {
    *("dask", "distributed", "fastapi", "fsspec", "nicegui", "s3fs", "jinja2", "matplotlib", "numpy", "openpyxl"),
    *("pandas", "pyarrow", "scipy", "pydantic", "xacro", "rich", "uvicorn", "PIL"),
}

TABLE = "# convention: standard\na, alpha, d\n0.4, pi/2, 0.1\n0.3, 0, 0\n"


def modules(folder: Path) -> list[Path]:
    found = sorted(folder.rglob("*.py"))
    assert found
    return found


def plugin_modules() -> list[Path]:
    return [path for plugin in PLUGINS for path in modules(plugin)]


def imports(path: Path) -> Iterator[str]:
    """Every name that a module imports, anywhere in it: ``package.module`` and ``package.module.name``."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            yield str(node.module)
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def importing(paths: Iterable[Path], wrong: Callable[[str], object]) -> list[str]:
    """Who imports what is wrong."""
    return [f"{relative(path)} imports {name}" for path in paths for name in imports(path) if wrong(name)]


def relative(path: Path) -> str:
    return str(path.relative_to(ROOT))


class TestImportDirection:
    def test_the_host_knows_no_plugin(self) -> None:
        """No module of the host imports a built-in plugin, a simulator, or the writer of a format; one parses XML."""
        foreign = {*(plugin.name for plugin in PLUGINS), "lxml", "xacro", "csv"} | SIMULATORS
        others = [path for path in modules(HOST) if path.name != "xml_elements.py"]
        assert importing(others, lambda name: name.split(".")[0] in foreign) == []

    def test_examples_have_what_a_third_party_has(self) -> None:
        """No example imports a built-in stage, but the grammar of tables, which is for readers of other containers."""
        theirs = [path for example in EXAMPLES for path in modules(example / "src")]
        inner = re.compile(r"dh2urdf_(check|studio|plugins(?!\.readers\.table(\.|$)))")
        assert importing(theirs, inner.match) == []

    def test_the_contract(self) -> None:
        """What pyproject.toml declares about imports holds: layers, no circles, kinds of stages apart, independent proofs."""
        linter = shutil.which("lint-imports", path=Path(sys.executable).parent)
        if linter is None:
            pytest.skip("import-linter is not installed")
        checked = subprocess.run(
            [linter, "--no-cache", "--no-logo"], cwd=ROOT, capture_output=True, text=True, check=False
        )
        assert checked.returncode == 0, checked.stdout

    def test_every_import_is_of_something_that_is_installed_with_it(self) -> None:
        """What the project imports is in the standard library, among its dependencies, or in an extra that a stage asks for."""
        project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
        extras = project["optional-dependencies"]
        asked = (
            *(
                "coppeliasim",
                "dask",
                "drake",
                "meshes",
                "mujoco",
                "parquet",
                "pinocchio",
                "pybullet",
                "remote",
                "report",
            ),
            *("sampling", "studio", "testing", "xlsx"),
        )
        requirements = [*project["dependencies"], *(package for extra in asked for package in extras[extra])]
        names = {re.split(r"[^\w-]", requirement)[0] for requirement in requirements}
        modules_of = {"drake": "pydrake", "pillow": "PIL", "pin": "pinocchio", "pyyaml": "yaml", "pyzmq": "zmq"}
        packages = {modules_of.get(name, name) for name in names}
        allowed = packages | {"dh2urdf", *(plugin.name for plugin in PLUGINS)} | set(sys.stdlib_module_names)
        assert importing([*modules(HOST), *plugin_modules()], lambda name: name.split(".")[0] not in allowed) == []


def modules_after(code: str, folder: Path) -> set[str]:
    """The modules that a fresh interpreter has imported at the end of a piece of code."""
    script = (
        "import atexit, json, sys\n"
        "def report():\n"
        "    with open('loaded.json', 'w') as file:\n"
        "        json.dump(sorted(sys.modules), file)\n"
        "atexit.register(report)\n"
    )
    subprocess.run([sys.executable, "-c", script + code], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return set(json.loads((folder / "loaded.json").read_text()))


def loaded_after(code: str, folder: Path) -> set[str]:
    """The packages of these modules."""
    return {name.partition(".")[0] for name in modules_after(code, folder)}


class TestQuickStart:
    def test_importing_the_package(self, tmp_path: Path) -> None:
        """`import dh2urdf` imports nothing heavy, and no dependency at all."""
        assert (
            loaded_after("import dh2urdf", tmp_path) & (HEAVY | {"click", "pluggy", "lxml", "yaml", "orjson"}) == set()
        )

    @pytest.mark.parametrize("words", [["--version"], ["--help"], ["plugins"]], ids=" ".join)
    def test_asking(self, tmp_path: Path, words: list[str]) -> None:
        """Help, version and the list of plugins import no simulator, no numpy and no pydantic."""
        assert loaded_after(f"from dh2urdf.cli import main; main({words})", tmp_path) & HEAVY == set()

    @pytest.mark.parametrize("words", [[], ["--frames", "dh"], ["--variant", "exact"]], ids=" ".join)
    def test_converting(self, tmp_path: Path, words: list[str]) -> None:
        """One conversion to URDF, its proof included, imports no simulator and no numpy, and pydantic for options only."""
        (tmp_path / "arm.csv").write_text(TABLE)
        code = f"from dh2urdf.cli import main; main(['convert', 'arm.csv', '-o', 'arm.urdf', *{words}])"
        assert loaded_after(code, tmp_path) & HEAVY == ({"pydantic"} if words else set())
        assert (tmp_path / "arm.urdf").is_file()

    @pytest.mark.parametrize(
        ("words", "bound"),
        [(["plugins"], 75), (["convert", "arm.csv", "-o", "arm.urdf"], 125)],
        ids=["plugins", "convert"],
    )
    def test_it_imports_what_it_uses(self, tmp_path: Path, words: list[str], bound: int) -> None:
        """A list of stages needs their records alone, and a conversion the functions of its own stages."""
        (tmp_path / "arm.csv").write_text(TABLE)
        modules = modules_after(f"from dh2urdf.cli import main; main({words})", tmp_path)
        assert len([name for name in modules if name.startswith("dh2urdf")]) <= bound
        # Of the standard library, what takes as long as several modules of the house.
        assert modules & {"decimal", "fractions"} == set()
        host = {
            "dh2urdf.stages.inspections",
            "dh2urdf.stages.load_records",
            "dh2urdf.cells.cell",
            "dh2urdf.meshes.conversion",
        }
        host |= {"dh2urdf.plugin_system.column_calls", "dh2urdf.isolation.fence", "orjson"}
        work = {
            "calibrations.calibration",
            "formats.mjcf.writer",
            "formats.sdf.writer",
            "formats.xacro.writer",
            "transforms.meshes",
            "transforms.paper",
            "xacro_fence",
        }
        others = {"sources.documents", "sources.parquet", "sources.workbook"}
        foreign = {f"dh2urdf_plugins.readers.{name}" for name in others} | {f"dh2urdf_plugins.{w}" for w in work}
        if words == ["plugins"]:
            host |= {"dh2urdf.columns", "dh2urdf.manipulator", "dh2urdf.quantities.units", "lxml", "yaml"}
            foreign |= {"dh2urdf_plugins.readers.table", "dh2urdf_plugins.transforms.robots"}
        assert modules & (host | foreign) == set()

    def test_converting_in_a_program(self, tmp_path: Path) -> None:
        """Neither does the function, with the table read before."""
        (tmp_path / "arm.csv").write_text(TABLE)
        code = "import dh2urdf; arm = dh2urdf.read('arm.csv'); dh2urdf.convert(arm, 'arm.urdf')"
        assert loaded_after(code, tmp_path) & (HEAVY | {"click"}) == set()
        assert (tmp_path / "arm.urdf").is_file()

    def test_converting_to_xacro(self, tmp_path: Path) -> None:
        """One conversion to xacro imports the real xacro, which proves it, and nothing else that is heavy."""
        (tmp_path / "arm.csv").write_text(TABLE)
        code = "from dh2urdf.cli import main; main(['convert', 'arm.csv', '-o', 'arm.urdf.xacro'])"
        assert loaded_after(code, tmp_path) & HEAVY == {"xacro"}


class TestHooks:
    def test_there_is_one_for_each_kind_of_stage(self) -> None:
        """Every kind of stage has a record, and a hook that gives such records; so have commands."""
        specified = [name for name, value in vars(hookspecs).items() if hasattr(value, f"{hookspecs.PROJECT}_spec")]
        assert specified == list(HOOKS)
        assert tuple(RECORDS) == KINDS

    @pytest.mark.parametrize("hook", HOOKS)
    def test_each_is_documented(self, hook: str) -> None:
        """An author finds every hook in the README or in docs/, and what it is for in its docstring."""
        pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
        assert any(f"`{hook}`" in page.read_text("utf-8") for page in pages)
        assert getattr(hookspecs, hook).__doc__

    def test_the_built_in_plugins_use_every_one(self) -> None:
        """Every hook is tried by the built-in stages and commands, which have no other way in."""
        manager = pluggy.PluginManager(hookspecs.PROJECT)
        manager.add_hookspecs(hookspecs)
        used = {}
        for plugin in (dh2urdf_plugins, dh2urdf_check, dh2urdf_studio):
            manager.register(plugin)
            used[plugin] = {caller.name for caller in manager.get_hookcallers(plugin) or ()}
        assert used[dh2urdf_plugins] == HOOKS.keys() - {"dh2urdf_commands"}
        assert used[dh2urdf_check] == used[dh2urdf_studio] == {"dh2urdf_commands"}

    @pytest.mark.parametrize(("hook", "record"), HOOKS.items())
    def test_each_gives_records_of_its_kind(self, hook: str, record: type[Any]) -> None:
        """Called through pluggy, with two plugins: a list of what each gives, the records of that kind of stage alone."""
        manager = pluggy.PluginManager(hookspecs.PROJECT)
        manager.add_hookspecs(hookspecs)
        manager.register(dh2urdf_check if record is Subcommand else dh2urdf_plugins)
        given = [next(iter(getattr(manager.hook, hook)()[0]))]
        manager.register(SimpleNamespace(**{hook: hookspecs.hookimpl(lambda: given)}))
        theirs, built_in = getattr(manager.hook, hook)()
        built_in = list(built_in)
        assert theirs is given
        assert built_in
        assert all(isinstance(stage, record) for stage in built_in)


def record_types() -> list[type]:
    """Every dataclass of the host that a plugin is given or gives."""
    found = []
    modules_of_records = (
        *("source", "manipulator", "robot", "stages", "plugin_system.discovery", "plugin_system.calls"),
        *("kinematics.proof", "conversion.one_manipulator", "commands.convert", "run_file.plan", "running.run"),
    )
    for name in modules_of_records:
        module = importlib.import_module(f"dh2urdf.{name}")
        found += [kind for kind in vars(module).values() if isinstance(kind, type) and is_dataclass(kind)]
    return sorted(set(found), key=lambda kind: kind.__qualname__)


class TestRecords:
    def test_they_are_frozen(self) -> None:
        """No stage can change what another one was given: records are frozen, slotted and keyword-only."""
        every = set(record_types())
        frozen = {
            kind
            for kind in every
            if kind.__dataclass_params__.frozen  # type: ignore[attr-defined]
            and "__slots__" in vars(kind)
            and all(field.kw_only for field in fields(kind))
        }
        assert every - frozen == set()
        assert set(RECORDS.values()) | {Manipulator, Robot, Mark, Problem} <= frozen


def test_every_number_of_a_row_is_in_the_table_of_fields() -> None:
    """What is added to a row is in no list of names by itself: the lists come from the records and this table."""
    assert {*ROW_FIELDS} == {*NUMBERS, *LIMITS, *COM, *INERTIA}


class TestWhatIsShipped:
    def test_the_wheel_holds_the_packages(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """The wheel installs the host and the built-in plugins, all of each with their type markers, and nothing else."""
        build = pytest.importorskip("hatchling.build", reason="hatchling is not installed")
        monkeypatch.chdir(ROOT)
        wheel = tmp_path / build.build_wheel(str(tmp_path))
        with zipfile.ZipFile(wheel) as archive:
            shipped = {name for name in archive.namelist() if ".dist-info/" not in name}
            entry_points = next(name for name in archive.namelist() if name.endswith("entry_points.txt"))
            points = archive.read(entry_points).decode()
        expected = {
            str(path.relative_to(wing.parent))
            for wing in (HOST, *PLUGINS)
            for path in wing.rglob("*")
            if path.is_file() and "__pycache__" not in path.parts
        }
        expected |= {f"dh2urdf/tables/{path.name}" for path in (ROOT / "configs" / "tables").iterdir()}
        assert shipped == expected
        assert {f"{wing.name}/py.typed" for wing in (HOST, *PLUGINS)} <= shipped
        assert "builtin = dh2urdf_plugins" in points
        assert "dh2urdf = dh2urdf.cli:main" in points

    @pytest.mark.parametrize(
        "package", [dh2urdf, dh2urdf_check, dh2urdf_plugins, dh2urdf_studio], ids=lambda package: package.__name__
    )
    def test_every_module_can_be_imported(self, package: ModuleType) -> None:
        """No module needs an extra to be imported: what is optional is imported where it is used."""
        code = "import importlib, sys\nfor name in sys.argv[1:]: importlib.import_module(name)\n"
        code += f"assert not set(sys.modules) & {SIMULATORS}, 'a simulator was imported'"
        names = [module.name for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")]  # type: ignore[attr-defined]
        assert len(names) > 10
        subprocess.run([sys.executable, "-c", code, *names], check=True)


def tracked_files() -> list[Path]:
    listed = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "-z"],  # noqa: S607 - the git that the clone was made with
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode != 0:
        pytest.skip("this is no git clone")
    return [ROOT / name for name in listed.stdout.split("\0") if name]


def test_no_file_names_a_folder_of_one_machine() -> None:
    """Nothing that is checked in holds an absolute path of the machine it was written on."""
    somebody_s = re.compile(rb"(?<![\w.])/(?:root|work|home/\w+|Users/\w+)/")
    found = [
        f"{relative(path)}:{number}: {line[:100]!r}"
        for path in tracked_files()
        if path.is_file() and path.suffix not in {".png", ".gz"}
        for number, line in enumerate(path.read_bytes().splitlines(), start=1)
        if somebody_s.search(line)
    ]
    assert found == []


def test_modules_say_what_they_are() -> None:
    """Every module begins with a docstring."""
    paths = (*modules(HOST), *plugin_modules())
    assert [relative(path) for path in paths if not ast.get_docstring(ast.parse(path.read_text("utf-8")))] == []


BUDGETS = {
    "pipeline/dh2urdf": 4310,
    "pipeline/dh2urdf/cells": 1180,
    "pipeline/dh2urdf/cli": 1760,
    "pipeline/dh2urdf/commands": 1450,
    "pipeline/dh2urdf/conversion": 1530,
    "pipeline/dh2urdf/documents": 1070,
    "pipeline/dh2urdf/isolation": 1390,
    "pipeline/dh2urdf/kinematics": 3020,
    "pipeline/dh2urdf/measuring": 310,
    "pipeline/dh2urdf/meshes": 1180,
    "pipeline/dh2urdf/output": 1510,
    "pipeline/dh2urdf/plugin_system": 1910,
    "pipeline/dh2urdf/quantities": 1320,
    "pipeline/dh2urdf/report": 2060,
    "pipeline/dh2urdf/robot_check": 540,
    "pipeline/dh2urdf/run_file": 1860,
    "pipeline/dh2urdf/running": 1050,
    "pipeline/dh2urdf/scaffold": 210,
    "pipeline/dh2urdf/stages": 1050,
    "pipeline/dh2urdf/table_text": 420,
    "pipeline/dh2urdf/tasks": 690,
    "pipeline/dh2urdf/testing": 1640,
    "pipeline/dh2urdf/variations": 1060,
    "plugins/dh2urdf_check": 3440,
    "plugins/dh2urdf_plugins": 340,
    "plugins/dh2urdf_plugins/calibrations": 230,
    "plugins/dh2urdf_plugins/collision_pairs": 420,
    "plugins/dh2urdf_plugins/descriptions": 1260,
    "plugins/dh2urdf_plugins/edits": 860,
    "plugins/dh2urdf_plugins/executors": 480,
    "plugins/dh2urdf_plugins/extraction": 1000,
    "plugins/dh2urdf_plugins/formats": 4590,
    "plugins/dh2urdf_plugins/loaders": 2670,
    "plugins/dh2urdf_plugins/packages": 2250,
    "plugins/dh2urdf_plugins/readers": 7000,
    "plugins/dh2urdf_plugins/transforms": 2190,
    "plugins/dh2urdf_plugins/xacro_fence": 720,
    "plugins/dh2urdf_studio": 6750,
}
"""Lines that a room may have at most, with all below it. A change that needs more lowers another budget, or says why not."""


def test_rooms_keep_to_their_budgets() -> None:
    """No package has more lines than its budget, and no budget is for a package that is gone."""
    sizes = dict.fromkeys(BUDGETS, 0)
    for path in (*modules(HOST), *plugin_modules()):
        parts = Path(relative(path)).parts[:-1]
        room = "/".join(parts[:3] if parts[1] in ("dh2urdf", "dh2urdf_plugins") else parts[:2])
        sizes[room] = sizes.get(room, 0) + len(path.read_text("utf-8").splitlines())
    assert {room: size for room, size in sizes.items() if not 0 < size <= BUDGETS.get(room, 0)} == {}


def test_the_guide_has_the_budgets() -> None:
    """CONTRIBUTING.md shows the way of a table through nine rooms, each with its budget."""
    rooms = re.findall(r"^ +[1-9] +(\w+) +([0-9,]+) ", (ROOT / "CONTRIBUTING.md").read_text("utf-8"), re.MULTILINE)
    budgets = {path.rpartition("/")[2]: lines for path, lines in BUDGETS.items()}
    assert {room: int(lines.replace(",", "")) for room, lines in rooms} == {room: budgets[room] for room, _ in rooms}
    assert len(rooms) == len(set(rooms)) == 9


def test_the_host_has_twelve_floors() -> None:
    """The longest way down, by the layers of pyproject.toml; and twelve modules stand beside the packages."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    (floors,) = (contract["layers"] for contract in contracts if contract["name"] == "layers of the host")
    assert len(floors) <= 12
    assert len([path for path in HOST.glob("*.py") if not path.name.startswith("__")]) <= 12


STAGES_NAMED = {
    ("pipeline/dh2urdf/commands/given_tables.py", "screws"): "what `from_screws` is the function of",
    ("pipeline/dh2urdf/stages/loaders.py", "urdf"): "what a loader takes whose record does not mention it",
    ("pipeline/dh2urdf/testing/stage_contract.py", "yaml"): "a Python module",
}
"""Where the host has a word that is also the name of a built-in stage."""
MERE_WORDS = {"table", "local", "limits", "masses", "payload", "values"}
"""Names of stages that are words of every day."""


def test_the_host_names_no_stage() -> None:
    """What is taken where nobody names a stage, and what is a flag, the records of the stages say."""
    catalog = load()
    names = {item.stage.name for kind in KINDS for item in catalog.builtin(kind)} | {"exact", "paper"}
    found = set()
    for path in modules(HOST):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in names - MERE_WORDS:
                found.add((relative(path), node.value))
    assert found == STAGES_NAMED.keys()


@pytest.mark.long
def test_no_class_name_means_two_things() -> None:
    """A class or an alias of a type has a name in the host that no other has."""
    where: dict[str, set[str]] = {}
    for path in modules(HOST):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            is_alias = isinstance(node, ast.AnnAssign) and ast.unparse(node.annotation) == "TypeAlias"
            name = node.name if isinstance(node, ast.ClassDef) else ast.unparse(node.target) if is_alias else ""
            where.setdefault(name.lstrip("_"), set()).add(relative(path))
    assert {name: paths for name, paths in where.items() if name and len(paths) > 1} == {}


@pytest.mark.parametrize(
    "path", [path for path in modules(HOST) if "= late_names(" in path.read_text("utf-8")], ids=relative
)
def test_late_names_are_what_type_checkers_see(path: Path) -> None:
    """A package that imports its names late gives those, from those modules, that it imports for type checkers."""
    tree = ast.parse(path.read_text("utf-8"))
    package = ".".join(path.parent.relative_to(HOST.parent).parts)
    seen = {
        alias.name: node.module if node.module != package else f"{package}.{alias.name}"
        for block in tree.body
        if isinstance(block, ast.If)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.asname
    }
    module = importlib.import_module(package)
    own = {
        name.id
        for node in tree.body
        for name in getattr(node, "targets", [getattr(node, "target", node)])
        if isinstance(name, ast.Name)
    }
    own |= {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    assert {*seen} == {*module.__all__} - own - {"__version__"}
    for name, place in seen.items():
        source = importlib.import_module(str(place))
        assert getattr(module, name) is (source if place == f"{package}.{name}" else getattr(source, name))
