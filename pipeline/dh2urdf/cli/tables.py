"""What the commands that take one table share: its options, and which manipulator is meant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from dh2urdf.attribution import Call
from dh2urdf.conversion import read_items
from dh2urdf.errors import ConfigError, TableError
from dh2urdf.options import make_options
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path
    from typing import TypeVar

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.registry import Catalog
    from dh2urdf.stages import Reader

    F = TypeVar("F", bound=Callable[..., Any])

COMMAND_LINE = Mark(file="command line")
READER_OPTIONS = ("convention", "length_unit", "angle_unit", "base", "tool")
"""The options of readers that have a flag of their own."""


def table_options(function: F) -> F:
    """Gives a command the flags that say what a table leaves out."""
    for option in reversed(
        (
            click.option("--from", "reader_name", metavar="NAME", help="Reader of TABLE; by its suffix."),
            click.option("--robot", metavar="NAME", help="Which manipulator of a table that holds several."),
            click.option("--convention", metavar="C", help="standard or modified, where the table does not say it."),
            click.option("--length-unit", metavar="UNIT", help="Unit of lengths without one: m, cm or mm."),
            click.option("--angle-unit", metavar="UNIT", help="Unit of angles without one: rad or deg."),
            click.option(
                "--base",
                metavar="YAML",
                help='base_link to the first DH frame: "{xyz: [0, 0, 0.3], rpy: [0, 0, pi]}".',
            ),
            click.option("--tool", metavar="YAML", help="Last DH frame to tool0, like --base."),
        )
    ):
        function = option(function)
    return function


def chosen_reader(catalog: Catalog, table: Path, name: str | None) -> Reader[Any]:
    """The reader that is named, or the one by the table's suffix.

    Raises:
        InputError: there is none, or several are.
        PluginError: it is broken, or two plugins claim its name.
    """
    return catalog.get("reader", name) if name else catalog.reader_for(table, "`--from NAME` chooses a reader")


def read_manipulator(call: Call[Reader[Any]], table: Path, robot: str | None) -> Manipulator:
    """The manipulator of a table that is meant.

    Raises:
        TableError: it cannot be read, there is none, or which of several is not said.
        ConfigError: the file is a run file.
    """
    try:
        return _choose(read_items(call.stage, table, call.options, call.plugin), robot, table)
    except TableError:
        from dh2urdf.config import is_run_file  # Reading run files takes modules that a conversion does not need.

        if not is_run_file(table):
            raise
        raise ConfigError(
            Problem(
                message="this is a run file, not a table",
                mark=Mark(file=str(table)),
                suggestion=f"`dh2urdf run {table}` does what it says",
            )
        ) from None


def _choose(items: Iterator[Manipulator | Rejected], robot: str | None, table: Path) -> Manipulator:
    """The manipulator that is meant.

    Raises:
        TableError: it cannot be read, there is none, or which of several is not said.
    """
    others: list[str] = []
    chosen: Manipulator | Rejected | None = None
    for item in items:
        if robot is None and chosen is not None:
            raise TableError(
                Problem(
                    message="the table holds several manipulators, and one conversion makes one",
                    mark=Mark(file=str(table)),
                    accepted=f"--robot NAME, such as --robot {shown(chosen.name)} or --robot {shown(item.name)}",
                    suggestion="`dh2urdf run` with a run file makes all of them",
                )
            )
        if robot in (None, item.name):
            chosen = item
            if robot is not None:
                break
        others.append(item.name)
    if isinstance(chosen, Rejected):
        raise TableError(chosen.problems)
    if chosen is None:
        raise TableError(
            Problem(
                message=f"the table holds no manipulator {shown(robot)}" if robot else "the table holds no manipulator",
                mark=Mark(file=str(table)),
                found=robot,
                accepted=", ".join(others[:20]) or None,
                suggestion=did_you_mean(robot or "", others),
            )
        )
    return chosen


def stage_calls(
    catalog: Catalog,
    stages: Mapping[str, Any],
    given: Mapping[str, Mapping[str, str | None]],
    settings: tuple[str, ...] = (),
) -> dict[str, Call[Any]]:
    """The calls of stages of a catalog, with their options from the flags and from --set.

    `--set key=value` goes to the stage that has the option; `--set transform.key=value` says which.

    Raises:
        ConfigError: an option is unknown or its value wrong; all of it is said at once.
    """
    words: dict[str, dict[str, Any]] = {
        kind: {name: value for name, value in flags.items() if value is not None} for kind, flags in given.items()
    }
    known = {kind: stage.options.__dataclass_fields__ for kind, stage in stages.items()}
    problems: list[Problem] = []
    for setting in settings:
        path, equals, value = setting.partition("=")
        kind, _, key = path.strip().rpartition(".")
        kinds = [kind] if kind in known else [] if kind else [k for k in known if key in known[k]]
        if not equals or len(kinds) != 1 or key not in known[kinds[0]]:
            keys = [f"{k}.{name}" for k in known for name in known[k]]
            wrong = "names no option" if equals else "has no value"
            near = did_you_mean(path, [*keys, *(key.partition(".")[2] for key in keys)]) if equals else None
            problems.append(
                Problem(
                    message=f"--set {shown(setting)} {wrong}",
                    mark=COMMAND_LINE,
                    found=setting,
                    accepted=f"KEY=VALUE, where KEY is one of {', '.join(keys)}",
                    suggestion=near,
                )
            )
            continue
        words[kinds[0]][key] = value.strip()
    calls: dict[str, Call[Any]] = {}
    for kind, stage in stages.items():
        plugin, where = catalog.plugin_of(stage), f"{kind} {stage.name!r}"
        try:
            options = make_options(stage.options, words[kind], mark=COMMAND_LINE, where=where, plugin=plugin)
            calls[kind] = Call(stage=stage, options=options, plugin=plugin)
        except ConfigError as error:
            problems.extend(error.problems)
    if problems:
        raise ConfigError(problems)
    return calls
