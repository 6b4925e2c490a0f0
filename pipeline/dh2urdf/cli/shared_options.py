"""What commands share: options that several have, flags for options of stages, and what is installed."""

from __future__ import annotations

import os
import sys
from contextlib import nullcontext
from dataclasses import fields, is_dataclass
from functools import reduce
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli.answers import keep_apart, kept_apart
from dh2urdf.commands.options_of_stages import Setting
from dh2urdf.documents.text_files import is_there
from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Problem, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from typing import TypeVar

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Kind

    F = TypeVar("F", bound=Callable[..., Any])

option = click.option
PATH = click.Path(path_type=Path, readable=False)
"""A path, wherever it leads: whatever opens it reports what is wrong with it."""
_WITHOUT = "--without"
_NAMES, _LOADED, _FLAGS = (f"{__name__}.{key}" for key in ("names", "loaded", "flags"))
_BETWEEN = "__"


def _all(*options: Callable[[F], F]) -> Callable[[F], F]:
    """Gives a command several options, in this order."""
    return lambda function: reduce(lambda given, give: give(given), reversed(options), function)


def _leave_out(context: click.Context, _parameter: click.Parameter, names: tuple[str, ...]) -> None:
    context.meta.setdefault(_NAMES, []).extend(names)


def _trust(context: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value:
        from dh2urdf.isolation.fence import TRUST

        if TRUST not in os.environ:
            os.environ[TRUST] = "1"  # for child processes and workers, too
            context.call_on_close(lambda: os.environ.pop(TRUST, None))


_LEAVE_OUT = "Leave out a plugin, or all of a distribution; repeatable."
_TRUST = "Read meshes though this system's kernel offers no wall around their readers."
without_option: Callable[[Any], Any] = _all(
    option(_WITHOUT, multiple=True, metavar="NAME", callback=_leave_out, expose_value=False, help=_LEAVE_OUT),
    option("--trust", is_flag=True, callback=_trust, expose_value=False, help=_TRUST),
)
"""The options that all commands have, before the command's name and after it."""
table_options: Callable[[Any], Any] = _all(
    option("--from", "reader_name", metavar="NAME", help="Reader of TABLE; by its suffix."),
    option("--robot", metavar="NAME", help="Which manipulator of a table that holds several."),
)
package_paths_option = option(
    "--package-path",
    "package_paths",
    type=PATH,
    multiple=True,
    metavar="DIR",
    help="A ROS package, or a folder of packages, whose files a xacro may include or meshes are in; repeatable.",
)


def settings_of(words: Iterable[str]) -> list[Setting]:
    """What `--set key=value` says."""
    parts = [(word, *word.partition("=")) for word in words]
    return [Setting(word, key.strip(), value.strip() if equals else None) for word, key, equals, value in parts]


def files_and_arguments(words: Iterable[str]) -> tuple[list[Path], dict[str, str]]:
    """Files, and arguments of a xacro among them as ROS writes them, ``NAME:=VALUE``.

    Raises:
        ConfigError: a word is no such argument, or one is given twice.
    """
    files: list[Path] = []
    arguments: dict[str, str] = {}
    for word in words:
        name, sign, value = word.partition(":=")
        name = name.strip()
        if not sign or is_there(Path(word)):
            files.append(Path(word))
        elif not name or name in arguments:
            message = f"{shown(word)} {'is given twice' if name else 'is no argument'}"
            raise ConfigError(Problem(message=message, mark=COMMAND_LINE, accepted="NAME:=VALUE, each name once"))
        else:
            arguments[name] = value
    return files, arguments


def catalog() -> Catalog:
    """What is installed, without what the command line leaves out; whatever it prints is not the command's answer.

    Raises:
        ConfigError: what it leaves out is not there.
    """
    context = click.get_current_context()
    keep_apart(context)
    return loaded(context)


def loaded(context: click.Context, words: Sequence[str] = ()) -> Catalog:
    """What is installed, without what was left out so far, and in words of the command line that are not read yet."""
    from dh2urdf.plugin_system.catalog import load

    unread = [value for word, value in pairwise((*words, "")) if word == _WITHOUT]
    unread += [word.partition("=")[2] for word in words if word.startswith(f"{_WITHOUT}=")]
    without = tuple(dict.fromkeys((*context.meta.get(_NAMES, ()), *unread)))
    found: dict[tuple[str, ...], Catalog] = context.meta.setdefault(_LOADED, {})
    if without not in found:
        found[without] = load(without)
    return found[without]


class StageCommand(click.Command):
    """A command that has flags for options of the stages of some kinds.

    An option becomes a flag where its metadata have ``flag``, the word for its value in the help, and ``commands``, if
    they have that, name the command. The stages are asked for theirs where the command line has a flag that is not the
    command's own: first the built-in stages, then those of plugins. The help has the flags of the built-in stages,
    since it imports no plugin.

    Args:
        kinds: the kinds of stages. Of an option that several have, the flag is that of the first.
        which: the stages of these kinds that the command may call.
    """

    def __init__(
        self,
        *args: Any,  # noqa: ANN401 - click's
        kinds: Sequence[Kind],
        which: Callable[[Any], object] = bool,
        **others: Any,  # noqa: ANN401
    ) -> None:
        super().__init__(*args, **others)
        self.kinds, self.which = tuple(kinds), which

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """The command's own parameters, with the flags of stages before `--set`."""
        own = super().get_params(ctx)
        flags = ctx.meta[_FLAGS] if _FLAGS in ctx.meta else self._flags(ctx, (), everybody=False)
        known = {word for parameter in own for word in parameter.opts}
        at = next((index for index, parameter in enumerate(own) if parameter.name == "settings"), len(own))
        return [*own[:at], *(flag for flag in flags if known.isdisjoint(flag.opts)), *own[at:]]

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the command line; where it has a flag that is not known yet, again with those of more stages."""
        asks_help = not set(ctx.help_option_names).isdisjoint(args)
        for everybody in (False,) if asks_help else (None, False, True):
            ctx.meta[_FLAGS] = [] if everybody is None else self._flags(ctx, args, everybody=everybody)
            try:
                return super().parse_args(ctx, list(args))
            except click.NoSuchOption as error:
                refused = error
        raise refused

    def _flags(self, ctx: click.Context, words: Sequence[str], *, everybody: bool) -> list[click.Option]:
        """The flags of the built-in stages, or of all, each once; what plugins print meanwhile is no answer."""
        flags = dict[str, click.Option]()
        with kept_apart() if everybody and None not in (sys.stdout, sys.stderr) else nullcontext():
            for kind, field in self._options(ctx, words, everybody=everybody):
                data = field.metadata
                if field.name in flags or "flag" not in data or self.name not in data.get("commands", (self.name,)):
                    continue
                text = str(data.get("help", ""))
                first = text[:1] if text[1:2] == " " else text[:1].upper()  # d is no D
                flags[field.name] = click.Option(
                    [f"--{field.name.replace('_', '-')}", f"{kind}{_BETWEEN}{field.name}"],
                    metavar=str(data["flag"]),
                    help=f"{first}{text[1:]}.",
                )
        return list(flags.values())

    def _options(self, ctx: click.Context, words: Sequence[str], *, everybody: bool) -> Iterator[tuple[Kind, Any]]:
        """The options of the stages that the command may call, each with the kind of its stage."""
        installed = loaded(ctx, words)
        for kind in self.kinds:
            for item in installed.provided(kind) if everybody else installed.builtin(kind):
                if is_dataclass(item.stage.options) and self.which(item.stage):
                    for field in fields(item.stage.options):
                        yield kind, field


def given_options(flags: Mapping[str, Any]) -> dict[str, dict[str, str | None]]:
    """The options that flags of stages have given, by kind of stage."""
    given: dict[str, dict[str, str | None]] = {}
    for key, value in flags.items():
        kind, between, name = key.partition(_BETWEEN)
        if between:
            given.setdefault(kind, {})[name] = value
    return given
