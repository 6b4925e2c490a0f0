"""The commands as functions: `import dh2urdf` gives all that is here.

What goes wrong is raised as one of `dh2urdf.errors`, with the text that the command line would print.
"""

from __future__ import annotations

import json
import os
from dataclasses import replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.conversion import read_items
from dh2urdf.errors import ConfigError, TableError
from dh2urdf.manipulator import Convention, JointType, Manipulator
from dh2urdf.registry import load
from dh2urdf.single_table import (
    DEFAULT_TRANSFORM,
    Asker,
    Conversion,
    Setting,
    chosen_reader,
    convert_table,
    read_manipulator,
    stage_calls,
)
from dh2urdf.source import Mark, Problem
from dh2urdf.textfiles import check_file

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from dh2urdf.attribution import Call
    from dh2urdf.registry import Catalog
    from dh2urdf.stages import Reader, Rejected

StrPath: TypeAlias = "str | os.PathLike[str]"


def read(table: StrPath, *, robot: str | None = None, reader: str | None = None, **options: object) -> Manipulator:
    """The manipulator of a table.

    ::

        arm = dh2urdf.read("panda.csv", convention="modified", angle_unit="deg")

    Args:
        table: the table's file.
        robot: which manipulator is meant, where the table holds several.
        reader: name of the reader; without it the file's suffix says it.
        options: options of the reader, such as what the table does not say itself.

    Raises:
        TableError: the manipulator cannot be read, there is none, or which of several is not said.
        ConfigError: an option is unknown or its value wrong, or the file is a run file.
        InputError: no installed reader takes the file.
        PluginError: the reader's plugin is broken, or something it needs is not installed.
    """
    path, asker = Path(table), _asker("read")
    return read_manipulator(_reading(path, reader, asker, options), path, robot, asker)


def read_all(table: StrPath, *, reader: str | None = None, **options: object) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a table one by one, none of them held: there may be a million.

    One that cannot be read is a `Rejected` in its place, with its problems, and the others go on.

    Args:
        table: the table's file.
        reader: name of the reader; without it the file's suffix says it.
        options: options of the reader.

    Raises:
        TableError: the file as a whole cannot be read, which may show only on the way.
        ConfigError: an option is unknown or its value wrong.
        InputError: no installed reader takes the file.
        PluginError: the reader's plugin is broken, or something it needs is not installed.
    """
    path = Path(table)
    call = _reading(path, reader, _asker("read_all"), options)
    return read_items(call, path)


def convert(
    table: StrPath | Manipulator,
    out: StrPath | None = None,
    *,
    formats: str | Iterable[str] = (),
    robot: str | None = None,
    meshes: str | None = None,
    reader: str | None = None,
    transform: str = DEFAULT_TRANSFORM,
    without: Iterable[str] = (),
    **options: object,
) -> Conversion:
    """Turn one table into robot descriptions and prove that they are the same arm, as `dh2urdf convert` does.

    ::

        dh2urdf.convert("ur5.csv", "ur5.urdf")
        text = dh2urdf.convert("ur5.csv", frames="dh").text
        dh2urdf.convert(arm, "build/ur5", formats=["urdf", "xacro"])

    Args:
        table: the table's file, or a manipulator.
        out: the file to write; its suffix chooses the format where `formats` does not. With several formats it is
            the folder to write into. Without it nothing is written, and each format is a single file of the result.
        formats: the name of an emitter, or several; URDF without any.
        robot: which manipulator is meant, where the table holds several.
        meshes: ``relative`` (copies beside the file), ``file`` (file:// paths) or ``package://NAME``.
        reader: name of the reader; without it the table's suffix says it.
        transform: name of the transform.
        without: plugins or distributions to leave out.
        options: any options of the stages: each goes to the stage that has it, `frames` to the transform and
            `convention` to the reader. One that several kinds of stages have is named with its kind:
            ``**{"emitter.profile": "ros"}``.

    Returns:
        The manipulator, its robot, the files and the proofs.

    Raises:
        TableError: the table cannot be read, or no robot can be made of it.
        ConfigError: an argument is unknown or its value wrong.
        InputError: no installed reader or emitter takes a file's suffix, or none has the name.
        EmitterError: an emitter failed.
        ProofError: what was written is not the arm of the table; it is not put in place.
        OutputError: the files cannot be written.
        PluginError: a plugin that is needed is broken, or something it needs is not installed.
    """
    asker = _asker("convert")
    if isinstance(table, Manipulator) and (problems := list(_strange(table))):
        raise ConfigError(problem.about(robot=table.name, mark=asker.mark) for problem in problems)
    return convert_table(
        table if isinstance(table, Manipulator) else Path(table),
        None if out is None else Path(out),
        asker,
        _catalog(without, asker),
        reader=reader,
        transform=transform,
        formats=_names(formats),
        robot=robot,
        settings=_settings(options),
        meshes=meshes,
    )


def run(
    config: StrPath,
    out: StrPath | None = None,
    *,
    settings: Mapping[str, object] | None = None,
    resume: bool = False,
    dry_run: bool = False,
    without: Iterable[str] = (),
) -> dict[str, Any]:
    """Do the run that a run file describes, as `dh2urdf run` does.

    ::

        report = dh2urdf.run("ur5.yaml", settings={"execution.options.workers": 4})
        report["manipulators"][0]["proof"]["urdf"]["position_error"]

    Args:
        config: the run file.
        out: where to, not where the run file says: a folder or an address such as ``s3://bucket/prefix``.
        settings: changes of the run file, as ``--set`` takes them: ``{"transform.options.frames": "dh"}``.
        resume: keep what an earlier run has finished and what has not changed since.
        dry_run: read and check everything, write nothing.
        without: plugins or distributions to leave out.

    Returns:
        The report, as `report.json` has it. `exit_status` in it is 0 where all is done, and 1 where a manipulator
        failed: the others are written, and what to do about it is the caller's affair.

    Raises:
        ConfigError: something in the run file is wrong; all of it is said at once, before anything is written.
        TableError: nothing could be read at all.
        OutputError: nothing can be written where it should go.
        ExecutorError: nobody does the work.
        PluginError: the run needs a plugin that is broken, or something it needs is not installed.
    """
    from dh2urdf.runs import execute, load_plan

    overrides = [setting.text for setting in _settings(settings or {})]
    plan = load_plan(Path(config), _catalog(without, _asker("run")), overrides, None if out is None else os.fspath(out))
    _, report = execute(plan, resume=resume, dry_run=dry_run)
    return report


def _asker(function: str) -> Asker:
    """A program that calls one of these functions."""
    return Asker(
        mark=Mark(file=f"dh2urdf.{function}()"),
        reader="reader=",
        format="formats=",
        robot="robot=",
        out="out=",
        meshes="meshes=",
        setting="",
        nowhere="none is written",
        every="`dh2urdf.read_all` gives all of them, one by one",
        run="dh2urdf.run({!r})",
    )


def _catalog(without: Iterable[str], asker: Asker) -> Catalog:
    """What is installed, without what is to be left out."""
    try:
        return load(_names(without))
    except ConfigError as error:
        raise ConfigError(replace(problem, mark=asker.mark, field="without") for problem in error.problems) from None


def _reading(table: Path, reader: str | None, asker: Asker, options: Mapping[str, object]) -> Call[Reader[Any]]:
    """The reader of a table, with its options."""
    check_file(table, TableError)
    catalog = load()
    given = {"reader": {name: _word(value) for name, value in options.items()}}
    (call,) = stage_calls(catalog, {"reader": [chosen_reader(catalog, table, reader, asker)]}, asker, given)["reader"]
    return call


def _strange(table: Manipulator) -> Iterator[Problem]:
    """The values of a manipulator made in Python that are not of the types of its fields: readers see to theirs."""
    values: list[tuple[str | None, str, object, type, str]] = [
        (None, "convention", table.convention, Convention, "a dh2urdf.Convention, such as Convention.STANDARD")
    ]
    for row in table.rows:
        values.append((row.joint, "type", row.type, JointType, "a dh2urdf.JointType, such as JointType.REVOLUTE"))
        numbers = {"a": row.a, "alpha": row.alpha, "d": row.d, "theta": row.theta, "offset": row.offset}
        values += [(row.joint, name, value, Real, "a number, in m or rad") for name, value in numbers.items()]
    for joint, name, value, kind, accepted in values:
        if not isinstance(value, kind):
            message = f"{value!r} is a {type(value).__name__}"
            yield Problem(message=message, joint=joint, field=name, found=str(value), accepted=accepted)


def _names(names: str | Iterable[str]) -> tuple[str, ...]:
    """One name or several."""
    return (names,) if isinstance(names, str) else tuple(names)


def _settings(options: Mapping[str, object]) -> list[Setting]:
    return [Setting(f"{key}={_word(value)}", key, _word(value)) for key, value in options.items()]


def _word(value: object) -> str:
    """A value as a word of the command line: JSON is YAML."""
    return value if isinstance(value, str) else json.dumps(value, default=str)
