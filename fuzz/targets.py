"""What is fuzzed, and what must hold of every input: the oracles, which need no fuzzer.

A target takes bytes. It returns where the input was refused with an error of dh2urdf, or accepted and found to be what
it claims to be; it raises anything else, which is a bug. `fuzz.py` calls the targets with atheris, and
`tests/test_fuzz.py` with everything that fuzzing ever found.
"""

from __future__ import annotations

import math
import re
import signal
import sys
import tempfile
from collections.abc import Iterator, MappingView
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from unittest.mock import patch

from dh2urdf.conversion.robots import make_robot
from dh2urdf.errors import (
    ConfigError,
    EmitterError,
    ManipulatorError,
    PluginError,
    ProofError,
    TableError,
)
from dh2urdf.kinematics.chain import forward_kinematics, link_poses
from dh2urdf.kinematics.expected_poses import ExpectedPoses, proof_vectors
from dh2urdf.kinematics.proof import prove
from dh2urdf.plugin_system.calls import Call
from dh2urdf.plugin_system.catalog import load
from dh2urdf.quantities import Dimension, QuantityError, evaluate, find_unit
from dh2urdf.robot_check import check_robot
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.stages import Rejected
from dh2urdf_plugins.formats.mjcf.reader import parse_mjcf
from dh2urdf_plugins.formats.sdf.reader import parse_sdf
from dh2urdf_plugins.formats.urdf import EMITTER as URDF
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.options import TableOptions
from dh2urdf_plugins.readers.plain.rows import PlainRows
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM
from dh2urdf_plugins.xacro_fence.interpreter import Function, Namespace, Work, evaluate as evaluate_xacro

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Problem
    from dh2urdf.stages import Reader

CONVERTED = 3
"""Manipulators of one input that are converted; all of them are read."""
CONVERTED_JOINTS = 60
"""Joints of a manipulator that is converted: more of them tell nothing new."""


class Broken(Exception):  # noqa: N818 - what libFuzzer prints as the finding
    """Something that must hold of every input does not."""


class _Reading(NamedTuple):
    """What a reader gave before it ended, and what it ended with."""

    items: list[Manipulator | Rejected]
    refusal: TableError | None


def _hold(fact: bool, message: str) -> None:  # noqa: FBT001 - it is the fact
    if not fact:
        raise Broken(message)


# --- Tables -----------------------------------------------------------------------------------------------------------


def csv_table(content: bytes) -> None:
    """The CSV reader, and everything behind it; its fast way through plain rows reads what its careful one reads."""
    items, refusal = _read(content, stages.CSV, "arm.csv")
    _check_table(items, refusal)
    with patch.object(PlainRows, "read", return_value=None):
        again, refusal_again = _read(content, stages.CSV, "arm.csv")
    _hold(repr(items) == repr(again), f"the two ways of reading differ: {items} and {again}")
    _hold(str(refusal) == str(refusal_again), f"the two ways of reading differ: {refusal} and {refusal_again}")


def yaml_table(content: bytes) -> None:
    """The YAML reader, and everything behind it."""
    _check_table(*_read(content, stages.YAML, "arm.yaml"))


def _read(content: bytes, reader: Reader[TableOptions], name: str) -> _Reading:
    """What a reader makes of a table.

    A table that speaks of no convention is read as a standard one: that it is not said would be all there is to say.
    """
    path = _folder() / name
    path.write_bytes(content)
    options = TableOptions(convention=None if b"onvention" in content else "standard")
    items: list[Manipulator | Rejected] = []
    try:
        items.extend(reader.read(path, options))
    except TableError as error:
        return _Reading(items, error)
    return _Reading(items, None)


def _check_table(items: Sequence[Manipulator | Rejected], refusal: TableError | None) -> None:
    """A table is refused with errors that can be read, or gives arms that can be built."""
    if refusal:
        _check_problems(refusal.problems, "error")
    converted = 0
    for item in items:
        if isinstance(item, Rejected):
            _check_problems(item.problems, "error")
            continue
        _check_problems(item.notices, "notice")
        if converted < CONVERTED and len(item.rows) <= CONVERTED_JOINTS:
            _check_arm(item)
            converted += 1


def _check_problems(problems: Iterable[Problem], severity: str) -> None:
    """Problems have a text that a terminal can show, and no error hides among notices."""
    problems = tuple(problems)
    _hold(severity == "notice" or bool(problems), "refused without a reason")
    for problem in problems:
        _hold(problem.severity == severity, f"{problem.severity} where {severity}s stand: {problem}")
        text = str(problem)
        _hold(text.replace("\n", "").isprintable(), f"a message that a terminal may act on: {text!r}")
        _hold(len(text) < 2500, f"a message of {len(text)} characters")  # a screenful


def _check_arm(arm: Manipulator) -> None:
    """An arm's DH product is finite, and its description has the same kinematics, or it is refused with a reason."""
    home = forward_kinematics(arm, [0.0] * len(arm.actuated_rows))
    _check_rigid(home)
    try:
        robot = make_robot(arm, Call(stage=TRANSFORM, options=TRANSFORM.options()))
        (file,) = URDF.emit(robot, "arm", URDF.options())
    except ManipulatorError as error:
        _check_problems([problem for problem in error.problems if problem.severity == "error"], "error")
        return
    _check_problems(robot.notices, "notice")
    expected = ExpectedPoses.of(arm)
    poses = proof_vectors(expected, robot, 2)
    written = parse_urdf(file.content, "arm.urdf")
    proof = prove(expected, written, poses)
    _hold(proof.holds, f"the description is another arm: {proof}")


def _check_rigid(transform: RigidTransform) -> None:
    _hold(all(map(math.isfinite, (*transform.rotation, *transform.translation))), f"not finite: {transform}")
    rows = [transform.rotation[k : k + 3] for k in (0, 3, 6)]
    for i, row in enumerate(rows):
        for j, other in enumerate(rows):
            product = sum(x * y for x, y in zip(row, other, strict=True))
            _hold(abs(product - (i == j)) < 1e-9, f"not rigid: {transform}")  # far above rounding


# --- Expressions ------------------------------------------------------------------------------------------------------

_PLAIN = re.compile(r"[0-9.+\-*/() \t]*")
_NUMBER = re.compile(r"[0-9]+\.?[0-9]*|\.[0-9]+")
_READINGS = (
    (Dimension.NUMBER, None, False),
    (Dimension.ANGLE, None, True),
    (Dimension.ANGLE, "deg", False),
    (Dimension.LENGTH, "mm", True),
    (Dimension.EFFORT, None, False),
)


def expression(content: bytes) -> None:
    """The grammar of numbers: a text is refused with a reason, or is a finite number, the one that arithmetic gives."""
    text = content.decode("utf-8", "surrogateescape")
    for dimension, unit, comma in _READINGS:
        try:
            quantity = evaluate(text, dimension, find_unit(unit, dimension) if unit else None, decimal_comma=comma)
        except QuantityError as error:
            _hold(bool(error.message and error.accepted), f"refused without a reason: {text!r}")
            _hold(error.message.isprintable(), f"a message that a terminal may act on: {error.message!r}")
            continue
        _hold(math.isfinite(quantity.value), f"{text!r} is {quantity}")
        _hold(quantity.sign in (1, -1) and (quantity.variable is not None or quantity.sign == 1), f"{text!r}")
        _hold(math.copysign(1.0, quantity.value) == 1 or quantity.value < 0, f"{text!r} is -0.0")
        if dimension is Dimension.NUMBER and _PLAIN.fullmatch(text):
            # Numbers, brackets and the four signs mean in Python what they mean here.
            expected = eval(_NUMBER.sub(lambda match: repr(float(match[0])), text).strip(), {"__builtins__": {}})  # noqa: S307 - nothing but digits and signs
            _hold(quantity.value == expected, f"{text!r} is {quantity.value!r}, and Python says {expected!r}")


# --- Robot descriptions -----------------------------------------------------------------------------------------------


def _sound_robot(parse: Callable[[bytes, str], Robot], content: bytes, name: str) -> Robot | None:
    """The robot that a reader finds; None where it or the checks refuse it, with messages as they should be."""
    try:
        robot = parse(content, name)
    except ProofError as error:
        _check_problems(error.problems, "error")
        return None
    problems = check_robot(robot)
    for severity in ("error", "notice"):
        if some := [problem for problem in problems if problem.severity == severity]:
            _check_problems(some, severity)
    return None if any(problem.severity == "error" for problem in problems) else robot


def sdf(content: bytes) -> None:
    """The SDF reader: what it accepts and the checks pass is a tree whose links are somewhere."""
    _somewhere(_sound_robot(parse_sdf, content, "arm.sdf"))


def mjcf(content: bytes) -> None:
    """The MJCF reader, as that of SDF."""
    _somewhere(_sound_robot(parse_mjcf, content, "arm.xml"))


def _somewhere(robot: Robot | None) -> None:
    if robot is not None:
        poses = link_poses(robot, {joint.name: 0.0 for joint in robot.moving_joints})
        _hold(poses.keys() == {link.name for link in robot.links}, "some links are nowhere")


def urdf(content: bytes) -> None:
    """The URDF reader: what it accepts and the checks pass is written, and read back as the same robot."""
    robot = _sound_robot(parse_urdf, content, "arm.urdf")
    if robot is None:
        return
    try:
        (file,) = URDF.emit(robot, "arm", URDF.options())
    except EmitterError:
        return
    _hold(parse_urdf(file.content, "again.urdf") == robot, "written and read again, it is another robot")


# --- Expressions of a stranger's xacro --------------------------------------------------------------------------------

_TRIED = (
    *("open", "import", "socket.", "subprocess.", "os.", "shutil.", "tempfile.", "ctypes.", "pty.", "mmap."),
    *("code.__new__", "function.__new__", "sys._getframe", "object.__setattr__", "object.__delattr__", "gc."),
)
"""Audit events (PEP 578) of what an expression must never do, or what their names begin with."""
_LONGEST_EXPRESSION = 1.0
"""What an expression may compute before it is ended, as behind the fence [s]."""


def xacro_expression(content: bytes) -> None:
    """An expression of a stranger is refused, fails, or is plain data; nothing else happens while it is evaluated."""
    text = content.decode("utf-8", "replace")
    tried: list[str] = []
    _watchers.append(tried)
    signal.setitimer(signal.ITIMER_REAL, _LONGEST_EXPRESSION)
    try:
        names = {**_xacro_names(), "size": 2, "name": "arm", "config": {"a": {"b": [1, 2]}}}
        found = evaluate_xacro(text, names, Work())
    except (TimeoutError, MemoryError, RecursionError):
        return
    except Exception:  # noqa: BLE001 - an expression may fail in any way
        found = None
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        _watchers.remove(tried)
        _hold(not tried, f"{text!r} did {tried}")
    _hold(_is_plain(found), f"{text!r} gave {type(found)}")


def _is_plain(value: object) -> bool:
    """Whether a value is data, or a function that was given."""
    if isinstance(value, (list, tuple, set, frozenset)):
        return all(map(_is_plain, value))
    if isinstance(value, dict):
        return all(map(_is_plain, (*value, *value.values())))
    plain = value is None or isinstance(value, (int, float, complex, str, bytes, range, slice, type(...)))
    lazy = isinstance(value, (Iterator, MappingView))
    return plain or lazy or isinstance(value, (Function, Namespace))


_watchers: list[list[str]] = []


def _watch(event: str, arguments: tuple[object, ...]) -> None:
    # Python looks for the text of a wrong line in a file of the name that the expression is parsed under.
    if _watchers and event.startswith(_TRIED) and arguments[:1] != ("<expression>",):
        _watchers[-1].append(event)


def _end(_number: int, _frame: object) -> None:
    raise TimeoutError


@cache
def _xacro_names() -> dict[str, Any]:
    """What xacro gives to expressions, watched from now on."""
    import xacro

    sys.addaudithook(_watch)
    signal.signal(signal.SIGALRM, _end)
    symbols: dict[str, Any] = xacro.create_global_symbols()
    for space in (symbols, symbols["xacro"]):
        dict.__setitem__(space, "load_yaml", _no_file)  # the fence's own way to files has tests of its own
    return symbols


def _no_file(name: str) -> None:
    raise FileNotFoundError(name)


# --- Run files --------------------------------------------------------------------------------------------------------

_SETTING = re.compile(rb"^# --set (.*)$", re.MULTILINE)


def run_file(content: bytes) -> None:
    """Run files, with the settings of the command line that are in their comments: `# --set KEY=VALUE`.

    Nothing is run. A pattern for files of other folders is passed over: it would be searched for on this machine.
    """
    if b"*" in content and (b"/" in content or b".." in content):
        return
    folder = _folder()
    path = folder / "run.yaml"
    path.write_bytes(content)
    (folder / "ur5.csv").write_bytes(b"a,alpha,d\n0,pi/2,0.1\n")
    settings = [found.decode("utf-8", "replace").rstrip("\r") for found in _SETTING.findall(content)]
    try:
        make_plan(load_config(path, settings[:4]), _catalog())
    except ConfigError as error:
        _check_problems(error.problems, "error")
    except PluginError as error:
        _hold(bool(str(error)), "an error without a text")


# --- All of them ------------------------------------------------------------------------------------------------------

TARGETS: dict[str, Callable[[bytes], None]] = {
    "csv": csv_table,
    "yaml": yaml_table,
    "expression": expression,
    "urdf": urdf,
    "sdf": sdf,
    "mjcf": mjcf,
    "xacro": xacro_expression,
    "run_file": run_file,
}


@cache
def _folder() -> Path:
    """A folder for the files of this process, gone at its end."""
    folder = tempfile.TemporaryDirectory(prefix="dh2urdf-fuzz-")
    _kept.append(folder)
    return Path(folder.name)


_kept: list[tempfile.TemporaryDirectory[str]] = []


@cache
def _catalog() -> Catalog:
    return load()
