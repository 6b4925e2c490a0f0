"""Manipulators as tables and robots as descriptions, which are read back before anybody gets them: the same arms."""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import columns_of
from dh2urdf.commands.arguments import path_or_none, words_of
from dh2urdf.commands.choices import stage_calls
from dh2urdf.conversion.file_endings import refuse_other_ending
from dh2urdf.conversion.one_manipulator import in_format, read_items
from dh2urdf.errors import ProofError, RecordValueError, RobotError
from dh2urdf.kinematics.chain import KinematicChain, angle_error, position_error
from dh2urdf.kinematics.proof import TOLERANCE
from dh2urdf.meshes.files import FILE, located, prefix_of
from dh2urdf.output.spooled import spooled
from dh2urdf.output.whole_files import safe_stem, write_whole
from dh2urdf.plugin_system.calls import Call, a_record, blaming, default_call, emitted_files
from dh2urdf.plugin_system.catalog import load
from dh2urdf.robot import Robot
from dh2urdf.robot_check import check_robot
from dh2urdf.source import Mark, Messages, Problem
from dh2urdf.stages import ReadsBack, Rejected
from dh2urdf.table_text.texts import table_text

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Reader

say = Messages(__file__)

_SAME = 1e-12
"""How far numbers of a table that was written in other units than m and rad may be from those of the arm."""


def table_content(
    format_name: str, manipulators: Sequence[Manipulator], *, length_unit: str = "m", angle_unit: str = "rad"
) -> bytes:
    """The tables of some manipulators in the format of an installed reader; `left_out_of` reads them back."""
    texts = [table_text(manipulator, length_unit, angle_unit) for manipulator in manipulators]
    return in_format(texts, _reader(format_name)).content


def left_out_of(format_name: str, manipulators: Sequence[Manipulator], content: bytes) -> tuple[Problem, ...]:
    """What a file of tables, in the format of an installed reader, does not hold; see `left_out`."""
    call = _reader(format_name)
    return left_out(manipulators, content, call, call.stage.name)


def left_out(
    manipulators: Sequence[Manipulator], content: bytes, call: Call[Reader[Any]], place: str
) -> tuple[Problem, ...]:
    """What a written table file does not hold of its manipulators, as notices; a RecordValueError for other arms."""
    rows_without: dict[str, int] = {}
    for given, again in zip(manipulators, _read_back(manipulators, content, call, place), strict=True):
        for inner, value, found in _different(given, again, ""):
            if found is None:
                owner, _, field = inner.rpartition(".")
                rows_without[field] = rows_without.get(field, 0) + owner.rpartition(".")[2].startswith("rows[")
            elif not _close(value, found):
                raise RecordValueError(_other(given, (inner, value, found), call, place))
    notices = []
    for field, rows in rows_without.items():
        what = f"{field!r} of {rows} row{'' if rows == 1 else 's'}" if rows else repr(field)
        notices.append(say("no-place-for-field", Mark(file=place), format=call.stage.name, what=what))
    return tuple(notices)


def write_table(manipulator: Manipulator, suffix: str, out: str | os.PathLike[str] | None, function: str) -> str:
    """The table of a manipulator in the format of the files with a suffix, which must have a place for all of it."""
    target = path_or_none("out", out, Mark(file=function))
    catalog = load()
    call = default_call(catalog, catalog.reader_for(Path(f"table{suffix}")))
    if target is not None:
        refuse_other_ending(catalog, Path(target), call.stage, Mark(file=function))
    content = in_format([table_text(manipulator)], call).content
    (again,) = _read_back([manipulator], content, call, function)
    if found := list(_different(manipulator, again, "")):
        raise RecordValueError(_other(manipulator, each, call, function) for each in found)
    if target is not None:
        write_whole(Path(target), content)
    return content.decode()


def _reader(format_name: str) -> Call[Reader[Any]]:
    catalog = load()
    return default_call(catalog, catalog.get("reader", format_name))


def _read_back(
    manipulators: Sequence[Manipulator], content: bytes, call: Call[Reader[Any]], place: str
) -> list[Manipulator]:
    """The manipulators of a file that was written of some."""
    with spooled(content, place, (*call.stage.suffixes, "")[0]) as path:
        items = list(read_items(call, path))
    if refused := [problem for item in items if isinstance(item, Rejected) for problem in item.problems]:
        raise RecordValueError(refused)
    read = [item for item in items if not isinstance(item, Rejected)]
    if len(read) != len(manipulators):
        raise RecordValueError(say("tables-lost", Mark(file=place), written=len(manipulators), read=len(read)))
    return read


def _different(given: Any, again: Any, place: str) -> Iterator[tuple[str, Any, Any]]:  # noqa: ANN401 - records and their parts
    """The places in which two records differ, what the first has there, and what the second."""
    if given == again:
        return
    if is_dataclass(given) and type(given) is type(again):
        for field in fields(given):
            if field.compare:
                inner = f"{place}.{field.name}" if place else field.name
                yield from _different(getattr(given, field.name), getattr(again, field.name), inner)
    elif type(given) is tuple and type(again) is tuple and len(given) == len(again):
        for number, (left, right) in enumerate(zip(given, again, strict=True)):
            yield from _different(left, right, f"{place}[{number}]")
    else:
        yield place, given, again


def _other(arm: Manipulator, change: tuple[str, Any, Any], call: Call[Reader[Any]], place: str) -> Problem:
    field, given, found = change
    code = "text-changes-in-format" if isinstance(given, str) and isinstance(found, str) else "number-changes-in-format"
    about = {"robot": arm.name, "field": field, "found": str(given), "again": str(found)}
    return say(code, Mark(file=place), format=call.stage.name, **about)


def _close(given: Any, found: Any) -> bool:  # noqa: ANN401 - parts of records
    """Whether two numbers, or two tuples of numbers, differ by the rounding of a unit at most."""
    if isinstance(given, tuple) and isinstance(found, tuple) and len(given) == len(found):
        return all(map(_close, given, found))
    if isinstance(given, float) and isinstance(found, float):
        return abs(given - found) <= _SAME * max(1.0, abs(given))
    return bool(given == found)


# --- Robots -----------------------------------------------------------------------------------------------------------


def write_description(
    robot: Robot, suffix: str, out: str | os.PathLike[str] | None, options: Mapping[str, object], function: str
) -> str:
    """A robot in the format of the files with a suffix, for a function that is called so; see `Robot.to_urdf`."""
    mark = Mark(file=function)
    target = path_or_none("out", out, mark)
    problems = [problem for problem in check_robot(robot) if problem.severity == "error"]
    if columns_of(robot):
        problems.append(say("robot-of-arrays", robot=robot.name))
    if problems:
        raise RobotError(problem.about(mark=mark) for problem in problems)
    catalog = load()
    emitter: Any = catalog.emitter_for(Path(f"robot{suffix}"))
    if target is not None:
        refuse_other_ending(catalog, Path(target), emitter, mark)
    given = {"emitter": words_of(options)}
    (call,) = stage_calls(catalog, {"emitter": [emitter]}, mark, given)["emitter"]
    robot = located(robot, prefix_of(FILE))
    with blaming(call):
        stem = safe_stem(robot.name)
        content = emitted_files(emitter.emit(robot, stem, call.options), stem)[0].content
        with spooled(content, str(mark), emitter.suffixes[0]) as path:
            described: Robot = a_record(emitter.can(ReadsBack).read_back(path), Robot)
    _compare(robot, described, mark)
    if target is not None:
        write_whole(Path(target), content)
    return content.decode()


def _compare(robot: Robot, described: Robot, mark: Mark) -> None:
    """Compare every way from the root to an outermost link, at four joint vectors."""
    parents = {joint.parent for joint in robot.joints}
    for tip in (joint.child for joint in robot.joints if joint.child not in parents):
        given, found = (KinematicChain.between(each, robot.root, tip) for each in (robot, described))
        joints = {joint.name: joint for joint in robot.joints}
        limits = [joints[name].limits for name in given.actuated]
        for part in (0.0, 1.0, 0.3, 0.7):
            q = []
            for number, each in enumerate(limits):
                lower = -math.pi if each.lower is None else each.lower
                upper = math.pi if each.upper is None else each.upper
                q.append(lower + (part if number % 2 else 1.0 - part) * (upper - lower))
            left, right = given.forward_kinematics(q), found.forward_kinematics(q)
            position, angle = position_error(left, right), angle_error(left, right)
            if not (position <= TOLERANCE and angle <= TOLERANCE):
                about: dict[str, Any] = {"tip": tip, "position": position, "angle": angle, "q": q}
                raise ProofError(say("written-arm-differs", mark, robot=robot.name, **about))
