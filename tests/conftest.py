"""What all tests share: facts of tests/reference, the command, an oracle of URDF, and the rule about skips."""

import atexit
import importlib.metadata
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
import urllib.request
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import asdict, fields, is_dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

import hypothesis
import numpy as np
import pytest
import yaml
from child_python import python
from command_line import Answer, Cli
from lxml import etree
from plain_frames import rpy, shift, turn

from dh2urdf.cli import exit_status_of
from dh2urdf.errors import PluginError
from dh2urdf.fields import replace_unchecked
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.robot import Material
from dh2urdf.rotations import IDENTITY
from dh2urdf.table_text.texts import law_text
from reference_arms import ReferenceRobot, load_reference_robots

R = TypeVar("R", pytest.TestReport, pytest.CollectReport)

REFERENCE = Path(__file__).with_name("reference")

# A shell starts jobs in the background with Ctrl-C ignored, and so would be the commands that the tests interrupt.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# With this variable, each of the many processes of the tests, and pytest itself, would compile all sources again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# The same examples on every machine and in every run; a failure prints how to repeat it.
hypothesis.settings.register_profile(
    "dh2urdf", derandomize=True, deadline=None, database=None, print_blob=True, max_examples=60
)
hypothesis.settings.load_profile("dh2urdf")


HIDDEN = os.environ.get("DH2URDF_HIDDEN", "").split()
"""Packages of built-in plugins that these tests do without: test_plugin_commands.py."""
for package in HIDDEN:
    sys.modules[package] = None  # type: ignore[assignment] - so Python has a module that must not be imported


def _entry_points_of_the_source() -> str:
    """The folder with metadata of dh2urdf for these tests; empty where its entry points are those of pyproject.toml.

    `pip install -e .` copies entry points when it is called. Where pyproject.toml has got others since, the tests and
    the processes that they start find a copy of the metadata with those.
    """
    if not (source := Path(__file__).parents[1] / "pyproject.toml").exists():
        return ""  # A test has copied this file.
    project = tomllib.loads(source.read_text("utf-8"))["project"]
    groups = {"console_scripts": project["scripts"], **project["entry-points"]}
    groups["dh2urdf"] = {name: value for name, value in groups["dh2urdf"].items() if value not in HIDDEN}
    installed = importlib.metadata.distribution("dh2urdf")
    if {(p.group, p.name, p.value) for p in installed.entry_points} == {
        (group, name, value) for group, points in groups.items() for name, value in points.items()
    }:
        return ""
    folder = Path(tempfile.mkdtemp(prefix="dh2urdf-metadata-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    copy = folder / f"dh2urdf-{installed.version}.dist-info"
    copy.mkdir()
    (copy / "METADATA").write_text(installed.read_text("METADATA") or "", "utf-8")
    lines = [
        [f"[{group}]", *(f"{name} = {value}" for name, value in points.items())] for group, points in groups.items()
    ]
    (copy / "entry_points.txt").write_text("\n".join(line for group in lines for line in group), "utf-8")
    return str(folder)


if STALE := _entry_points_of_the_source():
    sys.path.insert(0, STALE)
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (STALE, os.environ.get("PYTHONPATH"))))

WITH_LIBRARIES = ("pydrake",)
"""Packages that cannot be imported where some libraries of the system are missing."""
_UNUSABLE = "DH2URDF_UNUSABLE"


def pytest_configure(config: pytest.Config) -> None:
    """A package that lacks a library of the system counts as not installed, so that its tests are skipped."""
    if config.option.markexpr in KINDS:
        config.option.markexpr += " and not long"  # As in addopts, in whose place it is.
    if config.getoption("--other-words"):
        import other_words

        other_words.change()
    if not hasattr(config, "workerinput"):
        os.environ[_UNUSABLE] = ",".join([name for name in WITH_LIBRARIES if find_spec(name) and _why_not(name)])
    for name in filter(None, os.environ.get(_UNUSABLE, "").split(",")):
        sys.modules[name] = None  # type: ignore[assignment] - so Python has a module that must not be imported


def pytest_report_header() -> list[str]:
    """Names these packages, and what they lack."""
    names = filter(None, os.environ.get(_UNUSABLE, "").split(","))
    stale = "dh2urdf is installed with other entry points than pyproject.toml has now: `pip install -e .` renews them"
    notes = [f"without {', '.join(HIDDEN)}"] if HIDDEN else [stale] if STALE else []
    return notes + [
        f"{name} is installed and cannot be imported, so its tests are skipped: {_why_not(name)}" for name in names
    ]


def _why_not(name: str) -> str:
    """The last line of what an import prints that fails; empty where it does not fail."""
    tried = subprocess.run([sys.executable, "-c", f"import {name}"], capture_output=True, text=True, check=False)
    return tried.stderr.strip().rpartition("\n")[2] if tried.returncode else ""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--renew", action="store_true", help="write generated files instead of comparing them")
    parser.addoption(
        "--other-words", action="store_true", help="change the words of every message: tests of kind `arm` still pass"
    )


# What each test is about, by tests/kinds.yaml: the entry of the test, of its file or of the nearest folder, in this order. A
# mark in the file takes the place of that. A test that has no kind, or two, is in every lane, and fails there. What is `long`
# is there besides.

KINDS = frozenset(["arm", "words", "speed"])


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    kinds = yaml.safe_load(Path(__file__).with_name("kinds.yaml").read_text("utf-8"))
    long = frozenset(kinds.pop("long", []))
    of = {place: kind for kind, places in kinds.items() for place in places}
    for item in items:
        test = item.nodeid.partition("[")[0]
        path = Path(test.partition("::")[0])
        places = (item.nodeid, test, *map(str, (path, *path.parents)))
        found = kinds_of(item) or {next((of[place] for place in places if place in of), "none")}
        for kind in found if len(found) == 1 and found <= KINDS else KINDS:
            item.add_marker(kind)
        if long.intersection(places):
            item.add_marker("long")


def pytest_runtest_setup(item: pytest.Item) -> None:
    if len(kinds_of(item)) != 1:
        pytest.fail("arm, words or speed? Mark it, or name it in tests/kinds.yaml", pytrace=False)


def kinds_of(item: pytest.Item) -> frozenset[str]:
    return KINDS.intersection(mark.name for mark in item.iter_markers())


@pytest.fixture
def renew(request: pytest.FixtureRequest) -> bool:
    """Whether a generated file is to be written again."""
    return bool(request.config.getoption("--renew"))


# A test that needs what is not installed is skipped, with `pytest.importorskip` or `pytest.skip`, or because it failed
# with the error that names the missing package. Where everything has to be there, DH2URDF_REQUIRE_ALL=1 turns every skip
# into a failure, so that nothing goes untested in silence.
_MISSING = re.compile(r"(?:[^\n]* needs [^\n]*-m pip install 'dh2urdf\[[^\n]*|No module named '(\w+)[^\n]*)")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.failed and call.excinfo is not None and os.environ.get("DH2URDF_REQUIRE_ALL") != "1":
        missing = _MISSING.search(str(call.excinfo.value))
        if missing and (missing[1] is None or find_spec(missing[1]) is None):
            report.outcome, report.longrepr = "skipped", (str(item.path), 0, missing[0].strip())
    return _no_skip(report)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    return _no_skip((yield))


def _no_skip(report: R) -> R:
    expected_failure = hasattr(report, "wasxfail")  # pytest counts it as skipped too
    if report.outcome == "skipped" and not expected_failure and os.environ.get("DH2URDF_REQUIRE_ALL") == "1":
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"DH2URDF_REQUIRE_ALL=1 allows no skipped test: {reason}"
    return report


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test that takes `reference_robot` runs once for every published robot."""
    if "reference_robot" in metafunc.fixturenames:
        robots = load_reference_robots()
        metafunc.parametrize("reference_robot", robots, ids=[robot.id for robot in robots])


@pytest.fixture(scope="session")
def require_loaders() -> Callable[..., None]:
    """Skips a test where one of the loaders that it names lacks what it needs, with the loader's own words."""

    def require(*names: str) -> None:
        for stage in (load().get("loader", name) for name in names):
            try:
                stage.require(stage.options())
            except PluginError as error:
                pytest.skip(str(error))

    return require


@pytest.fixture(scope="session")
def reference_robots() -> list[ReferenceRobot]:
    """All published robots."""
    return load_reference_robots()


@pytest.fixture(scope="session")
def with_numbers() -> Callable[[Any, Callable[[float], Any]], Any]:
    """A record with something else in place of each of its floats, the colours of materials excepted."""

    def changed(value: Any, change: Callable[[float], Any]) -> Any:
        if isinstance(value, float):
            return change(value)
        if type(value) is tuple:
            return tuple(changed(item, change) for item in value)
        if is_dataclass(value) and not isinstance(value, Material):
            return replace_unchecked(
                value, **{field.name: changed(getattr(value, field.name), change) for field in fields(value)}
            )
        return value

    return changed


@pytest.fixture
def dh2urdf(tmp_path: Path, undrawn: str) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the project's command in the test's folder.

    `path` holds folders of further distributions, that are seen before the installed ones. The report.html of a run has
    no drawings.
    """

    def run(*words: str | Path, path: Sequence[Path] = (), status: int = 0) -> subprocess.CompletedProcess[str]:
        begin = undrawn if "run" in words else ""
        result = python("-c", f"{begin}from dh2urdf.cli import main; main()", *words, folder=tmp_path, path=tuple(path))
        assert result.returncode == status, f"exit status {result.returncode}\n{result.stdout}\n{result.stderr}"
        return result

    return run


@pytest.fixture(scope="session")
def install() -> Callable[..., None]:
    """Put a distribution of one plugin into a folder, as pip would: its module, and its metadata beside it."""

    def into(
        folder: Path,
        distribution: str,
        source: str,
        *,
        plugin: str = "lab",
        group: str = "dh2urdf",
        version: str = "1.0",
    ) -> None:
        stem = distribution.replace("-", "_")
        metadata = folder / f"{stem}-{version}.dist-info"
        metadata.mkdir(parents=True, exist_ok=True)
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n")
        module = f"{stem}_{plugin}".replace(".", "_").replace("-", "_")
        with (metadata / "entry_points.txt").open("a") as points:
            points.write(f"[{group}]\n{plugin} = {module}\n")
        (folder / f"{module}.py").write_text(source)

    return into


# --- An object store: a real server in a process of its own ----------------------------------------------------------


@pytest.fixture(scope="session")
def s3_server() -> Iterator[str]:
    """The address of a server of S3 on this machine; the environment leads every client of S3 to it."""
    pytest.importorskip("s3fs")
    pytest.importorskip("moto.server")
    command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", "0"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        try:
            address = next(found[0] for line in server.stderr if (found := re.search(r"http://127\.0\.0\.1:\d+", line)))
            threading.Thread(target=server.stderr.read, daemon=True).start()  # What nobody reads would fill the pipe.
            with pytest.MonkeyPatch.context() as environment:
                environment.setenv("AWS_ENDPOINT_URL", address)
                environment.setenv("AWS_ACCESS_KEY_ID", "key")
                environment.setenv("AWS_SECRET_ACCESS_KEY", "secret")
                environment.setenv("AWS_DEFAULT_REGION", "us-east-1")
                yield address
        finally:
            server.kill()


@pytest.fixture
def bucket(s3_server: str) -> str:
    """The address of a new bucket in an object store: ``s3://name``."""
    name = f"bucket-{os.urandom(6).hex()}"
    with urllib.request.urlopen(urllib.request.Request(f"{s3_server}/{name}", method="PUT")):  # noqa: S310
        return f"s3://{name}"


@pytest.fixture(scope="session")
def types_cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What mypy keeps of dh2urdf, and of all that it imports: one folder for all processes that run tests."""
    pytest.importorskip("mypy")
    folder = tmp_path_factory.getbasetemp()
    return (folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder) / "mypy"


@pytest.fixture(scope="session")
def reports() -> frozenset[str]:
    """The files that tell of a run, beside those of its manipulators."""
    table = ["manifest.parquet"] if find_spec("pyarrow") else []
    page = ["report.html"] if find_spec("jinja2") and find_spec("matplotlib") else []
    return frozenset(["manifest.jsonl", "index.json", "report.json", "timing.json", *table, *page])


@pytest.fixture(scope="session")
def undrawn() -> str:
    """How a script begins whose runs write no drawings into report.html: most of a short run is matplotlib."""
    return (
        "from dh2urdf.report import html\n"
        "html._figures = lambda _manipulator: None\n"
        "html._distributions = lambda _overview: {'errors': None, 'drawn': None}\n"
    )


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that does not say how many workers it has works in this process: each worker takes half a second to start."""
    from dh2urdf_plugins.executors.local import LocalOptions

    monkeypatch.setitem(LocalOptions.__init__.__kwdefaults__, "workers", 1)


@pytest.fixture
def cli(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    in_this_process: None,  # noqa: ARG001 - it is asked for its effect
) -> Cli:
    """Call the command line in the test's folder, in this process: as good as the command, and started at once.

    So does a run of several manipulators, unless it asks for workers. Its report.html has no drawings, which take half
    a second for each manipulator: `tests/pipeline/report` looks at them.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("dh2urdf.report.html._figures", lambda _manipulator: None)
    monkeypatch.setattr("dh2urdf.report.html.bars_figure", lambda *_: "")

    def call(*words: str | Path, status: int = 0) -> Answer:
        capfd.readouterr()
        found = exit_status_of([str(word) for word in words], debug=False)
        answer = Answer(*capfd.readouterr())
        assert found == status, f"exit status {found}\n{answer.stdout}\n{answer.stderr}"
        return answer

    return call


# --- An oracle of URDF that shares nothing with the project -----------------------------------------------------------


@pytest.fixture(scope="session")
def tool0_of() -> Callable[[Path], Callable[[Sequence[float]], np.ndarray]]:
    """T(base_link → tool0) of a written URDF as a function of the values of joints that move by themselves."""
    return _tool0_of


def _tool0_of(path: Path) -> Callable[[Sequence[float]], np.ndarray]:
    joints = {joint.find("child").get("link"): joint for joint in etree.parse(path).findall("joint")}
    chain: list[Any] = []
    link = "tool0"
    while link != "base_link":
        chain.insert(0, joints[link])
        link = joints[link].find("parent").get("link")

    moving = {joint.get("name"): joint for joint in chain if joint.get("type") != "fixed"}

    def pose(q: Sequence[float]) -> np.ndarray:
        free = [name for name, joint in moving.items() if joint.find("mimic") is None]
        values, T = dict(zip(free, q, strict=True)), np.eye(4)

        def value(name: str) -> float:
            if (mimic := moving[name].find("mimic")) is None:
                return float(values[name])
            return float(mimic.get("multiplier")) * value(mimic.get("joint")) + float(mimic.get("offset"))

        for joint in chain:
            origin = joint.find("origin")
            T = T @ shift(*_numbers(origin, "xyz")) @ rpy(*_numbers(origin, "rpy"))
            if joint.get("type") != "fixed":
                axis, by = _numbers(joint.find("axis"), "xyz"), value(joint.get("name"))
                T = T @ (shift(*by * axis) if joint.get("type") == "prismatic" else turn(axis, by))
        return T

    return pose


def _numbers(element: Any, name: str) -> np.ndarray:
    return np.array([float(word) for word in element.get(name).split()])


# --- Tables as files --------------------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def as_table() -> Callable[..., str]:
    """The text of a manipulator's table: `as_table(manipulator, "csv")` or `"yaml"`."""
    return _as_table


GROUPS = {"limits": ("lower", "upper"), "inertia": ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")}


def _as_table(manipulator: Manipulator, form: str, *, units: tuple[str, str] = ("m", "rad")) -> str:
    """A table that says all of a manipulator's rows, its base and its tool.

    Args:
        manipulator: the arm.
        form: ``csv`` or ``yaml``.
        units: of lengths and angles.
    """
    length, angle = {"m": 1.0, "mm": 1e3}[units[0]], {"rad": 1.0, "deg": 180 / math.pi}[units[1]]
    rows: list[dict[str, Any]] = []
    for row in manipulator.rows:
        variable = length if row.type is JointType.PRISMATIC else angle
        cells: dict[str, Any] = {"joint": row.joint, "link": row.link, "type": str(row.type)}
        cells |= {"a": row.a * length, "alpha": row.alpha * angle, "d": row.d * length, "theta": row.theta * angle}
        if row.type is not JointType.FIXED:
            cells |= {"offset": row.offset * variable, "sign": row.sign}
        cells |= {"follows": law_text(row.follows, repr(row.follows.offset * variable))} if row.follows else {}
        if row.limits.lower is not None and row.limits.upper is not None:
            cells |= {"lower": row.limits.lower * variable, "upper": row.limits.upper * variable}
        if row.mass is not None and row.com is not None and row.inertia is not None:
            com = {f"com_{axis}": value * length for axis, value in zip("xyz", row.com, strict=True)}
            cells |= {"mass": row.mass, **com, **asdict(row.inertia)}
        rows.append(cells)
    ends = {
        name: [*([*pose.rotation[3 * i : 3 * i + 3], pose.translation[i] * length] for i in range(3)), [0, 0, 0, 1]]
        for name, pose in (("base", manipulator.base), ("tool", manipulator.tool))
        if pose != IDENTITY
    }
    top = {"convention": str(manipulator.convention), "units": {"length": units[0], "angle": units[1]}, **ends}
    lines = [f"{key}: {json.dumps(value)}" for key, value in top.items()]
    if form == "yaml":
        for cells in rows:
            cells["name"] = cells.pop("joint")
            for key, parts in GROUPS.items():
                if parts[0] in cells:
                    cells[key] = {part: cells.pop(part) for part in parts}
            if "com_x" in cells:
                cells["com"] = [cells.pop(f"com_{axis}") for axis in "xyz"]
        return "\n".join([*lines, "joints:", *(f"  - {json.dumps(cells)}" for cells in rows), ""])
    header = list(dict.fromkeys(key for cells in rows for key in cells))
    body = [",".join(str(cells.get(key, "")) for key in header) for cells in rows]
    return "\n".join([*(f"# {line}" for line in lines), ",".join(header), *body, ""])


LONG_ENOUGH = 60.0
"""Seconds, for any machine."""


@pytest.fixture
def is_running() -> Callable[[int], bool]:
    """Whether a process runs; one that nobody has waited for yet does not."""

    def ask(pid: int) -> bool:
        try:
            if Path("/proc/self/stat").exists():
                return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
            os.kill(pid, 0)
        except (FileNotFoundError, ProcessLookupError):
            return False
        return True

    return ask


@pytest.fixture
def soon() -> Callable[[Callable[[], Any]], bool]:
    """Whether a condition comes true within a time that is long enough for any machine."""

    def wait(condition: Callable[[], Any]) -> bool:
        end = time.monotonic() + LONG_ENOUGH
        while not (true := condition()) and time.monotonic() < end:
            time.sleep(0.02)
        return bool(true)

    return wait
