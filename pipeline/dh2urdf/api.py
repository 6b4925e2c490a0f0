"""The commands as functions: `import dh2urdf` gives all that is here.

What goes wrong is raised as one of `dh2urdf.errors`, with the text that the command line would print.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.conversion import read_items
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.registry import load
from dh2urdf.single_table import Asker, Conversion, Setting, chosen_reader, convert_table, read_manipulator, stage_calls
from dh2urdf.source import Mark
from dh2urdf.textfiles import check_file

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from dh2urdf.attribution import Call
    from dh2urdf.stages import Reader, Rejected

StrPath: TypeAlias = "str | os.PathLike[str]"


def read(table: StrPath, *, robot: str | None = None, **options: object) -> Manipulator:
    """The manipulator of a table.

    ::

        arm = dh2urdf.read("panda.csv", convention="modified", angle_unit="deg")

    Args:
        table: the table's file; its suffix chooses the reader.
        robot: which manipulator is meant, where the table holds several.
        options: options of the reader, such as what the table does not say itself.

    Raises:
        TableError: the manipulator cannot be read, there is none, or which of several is not said.
        ConfigError: an option is unknown or its value wrong, or the file is a run file.
        InputError: no installed reader takes the file.
        PluginError: the reader's plugin is broken, or something it needs is not installed.
    """
    path, asker = Path(table), _asker("read")
    return read_manipulator(_reader(path, asker, options), path, robot, asker)


def read_all(table: StrPath, **options: object) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a table one by one, none of them held: there may be a million.

    One that cannot be read is a `Rejected` in its place, with its problems, and the others go on.

    Args:
        table: the table's file; its suffix chooses the reader.
        options: options of the reader.

    Raises:
        TableError: the file as a whole cannot be read, which may show only on the way.
        ConfigError: an option is unknown or its value wrong.
        InputError: no installed reader takes the file.
        PluginError: the reader's plugin is broken, or something it needs is not installed.
    """
    path = Path(table)
    call = _reader(path, _asker("read_all"), options)
    return read_items(call.stage, path, call.options, call.plugin)


def convert(
    table: StrPath | Manipulator,
    out: StrPath | None = None,
    *,
    formats: str | Iterable[str] = (),
    robot: str | None = None,
    meshes: str | None = None,
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
    return convert_table(
        table if isinstance(table, Manipulator) else Path(table),
        None if out is None else Path(out),
        _asker("convert"),
        load(),
        formats=(formats,) if isinstance(formats, str) else tuple(formats),
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
    plan = load_plan(Path(config), overrides, None if out is None else os.fspath(out))
    _, report = execute(plan, resume=resume, dry_run=dry_run)
    return report


def _asker(function: str) -> Asker:
    """A program that calls one of these functions."""
    return Asker(
        mark=Mark(file=f"dh2urdf.{function}()"),
        reader="a run file chooses one by `stage: NAME` beside the path",
        robot="robot=",
        out="out=",
        meshes="meshes=",
        setting="",
        nowhere="none is written",
        every="`dh2urdf.read_all` gives all of them, one by one",
        run="dh2urdf.run({!r})",
    )


def _reader(table: Path, asker: Asker, options: Mapping[str, object]) -> Call[Reader[Any]]:
    """The reader of a table, with its options."""
    check_file(table, TableError)
    catalog = load()
    reader = chosen_reader(catalog, table, None, asker)
    given = {"reader": {name: _word(value) for name, value in options.items()}}
    return stage_calls(catalog, {"reader": [reader]}, asker, given)["reader"][0]


def _settings(options: Mapping[str, object]) -> list[Setting]:
    return [Setting(f"{key}={_word(value)}", key, _word(value)) for key, value in options.items()]


def _word(value: object) -> str:
    """A value as a word of the command line: JSON is YAML."""
    return value if isinstance(value, str) else json.dumps(value, default=str)
