"""What commands share: options that several have, flags for options of stages, what is installed, standard input."""

from __future__ import annotations

import os
import sys
from contextlib import nullcontext, suppress
from dataclasses import fields, is_dataclass
from functools import reduce
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli.answers import keep_apart, kept_apart
from dh2urdf.documents.text_files import MAX_BYTES, is_there
from dh2urdf.errors import ConfigError, TableError
from dh2urdf.output.spooled import spooled
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Mark, Messages

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from typing import TypeVar

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Kind

    F = TypeVar("F", bound=Callable[..., Any])

say = Messages(__file__)

DASH, NAME = "-", "standard input"
"""What stands for standard input on the command line, and what messages call it."""
_STDIN = Path("/dev/stdin")
"""The file that standard input comes from, where the shell has redirected one and the system has such a name."""
PATH = click.Path(path_type=Path, readable=False)
"""A path, wherever it leads: whatever opens it reports what is wrong with it."""
_WITHOUT = "--without"
_NAMES, _LOADED, _FLAGS = (f"{__name__}.{key}" for key in ("names", "loaded", "flags"))
_BETWEEN = "__"


# --- Options ----------------------------------------------------------------------------------------------------------


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


option = click.option
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
quiet_option = option("-q", "--quiet", is_flag=True, help="Say only what fails.")


def json_option(text: str) -> Callable[[F], F]:
    """The option for an answer as data."""
    return option("--json", "as_json", is_flag=True, help=text)


def set_option(text: str) -> Callable[[F], F]:
    """The option for options of stages, or values of a run file, by name."""
    return option("--set", "settings", multiple=True, metavar="KEY=VALUE", help=text)


def one_file_and_arguments(words: Iterable[str]) -> tuple[Path, dict[str, str]]:
    """A robot description and arguments of a xacro; a ConfigError where there is no file, or there are several."""
    files, arguments = files_and_arguments(words)
    if len(files) != 1:
        raise ConfigError(say("one-file-only", COMMAND_LINE, count=len(files)))
    return files[0], arguments


def files_and_arguments(words: Iterable[str]) -> tuple[list[Path], dict[str, str]]:
    """Files, and arguments of a xacro among them as ROS writes them, ``NAME:=VALUE``."""
    files: list[Path] = []
    arguments: dict[str, str] = {}
    for word in words:
        name, sign, value = word.partition(":=")
        name = name.strip()
        if not sign or is_there(Path(word)):
            files.append(Path(word))
        elif not name or name in arguments:
            raise ConfigError(say("argument-twice" if name else "not-an-argument", COMMAND_LINE, found=word))
        else:
            arguments[name] = value
    return files, arguments


# --- What is installed ------------------------------------------------------------------------------------------------


def catalog() -> Catalog:
    """What is installed, without what the command line leaves out; whatever it prints is not the command's answer."""
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
    command's own: first the built-in stages, then those of plugins. The help has the flags of the built-in stages.

    Args:
        kinds: the kinds of stages. Of an option that several have, the flag is that of the first.
        which: the stages of these kinds that the command may call.
    """

    def __init__(self, *, kinds: Sequence[Kind], which: Callable[[Any], object] = bool, **others: Any) -> None:  # noqa: ANN401 - click's
        super().__init__(**others)
        self.kinds, self.which = tuple(kinds), which

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """The command's own parameters, with the flags of stages before `--set`."""
        own = super().get_params(ctx)
        flags = ctx.meta[_FLAGS] if _FLAGS in ctx.meta else self._flags(ctx, (), everybody=False)
        if not flags:
            return own
        known = {word for parameter in own for word in parameter.opts}
        at = next((index for index, parameter in enumerate(own) if parameter.name == "settings"), len(own))
        return [*own[:at], *(flag for flag in flags if known.isdisjoint(flag.opts)), *own[at:]]

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the command line; where it has a flag that is not known yet, again with those of more stages."""
        for everybody in (False,) if not {"-h", "--help"}.isdisjoint(args) else (None, False, True):
            ctx.meta[_FLAGS] = [] if everybody is None else self._flags(ctx, args, everybody=everybody)
            try:
                return super().parse_args(ctx, list(args))
            except click.NoSuchOption as error:
                refused = error
        raise refused

    def _flags(self, ctx: click.Context, words: Sequence[str], *, everybody: bool) -> list[click.Option]:
        """The flags of the built-in stages, or of all, each once; what plugins print meanwhile is no answer."""
        flags = dict[str, click.Option]()
        with kept_apart() if everybody else nullcontext():
            installed = loaded(ctx, words)
            of_kind = installed.provided if everybody else installed.builtin
            records = [(kind, item.stage) for kind in self.kinds for item in of_kind(kind)]
            options = [(kind, stage.options) for kind, stage in records if self.which(stage)]
            known = [(kind, each) for kind, given in options if is_dataclass(given) for each in fields(given)]
            for kind, field in known:
                data = field.metadata
                if field.name in flags or "flag" not in data or self.name not in data.get("commands", (self.name,)):
                    continue
                text = str(data.get("help", ""))
                first = text[:1] if text[1:2] == " " else text[:1].upper()  # d is no D
                names = [f"--{field.name.replace('_', '-')}", f"{kind}{_BETWEEN}{field.name}"]
                several: dict[str, Any] = {"multiple": True, "callback": _as_list} if data.get("repeatable") else {}
                given_help = f"{first}{text[1:]}."
                flags[field.name] = click.Option(names, metavar=str(data["flag"]), help=given_help, **several)
        return list(flags.values())


def _as_list(_context: click.Context, _parameter: click.Parameter, words: Sequence[str]) -> str | None:
    """The words of a repeatable option, as a list in one word."""
    import json

    return json.dumps(list(words), ensure_ascii=False) if words else None


def given_options(flags: Mapping[str, Any]) -> dict[str, dict[str, str | None]]:
    """The options that flags of stages have given, by kind of stage."""
    given: dict[str, dict[str, str | None]] = {}
    for key, value in flags.items():
        kind, between, name = key.partition(_BETWEEN)
        if between:
            given.setdefault(kind, {})[name] = value
    return given


# --- Standard input ---------------------------------------------------------------------------------------------------


def given_table(table: Path, reader: str | None, catalog: Catalog) -> tuple[Path, str | None]:
    """A table of the command line, and the name of its reader; a dash is standard input, kept in a file."""
    if str(table) != DASH:
        return table, reader
    content = _standard_input()
    if reader is None and (suffix := catalog.any_text()) and not content.lstrip().startswith(b"<"):
        return _kept(content, (suffix,)), catalog.cell_reader().name
    reader = reader or _format_of(content, catalog)
    return _kept(content, catalog.get("reader", reader).suffixes), reader


def given_description(file: Path, emitter: str | None, catalog: Catalog) -> Path:
    """A robot description of the command line; standard input where the file is a dash."""
    if str(file) != DASH:
        return file
    if emitter is None:  # Of a URDF, which a xacro may be too, nobody can be sure.
        raise ConfigError(say("stdin-format-missing", COMMAND_LINE))
    return _kept(_standard_input(), catalog.get("emitter", emitter).suffixes)


def files_behind(tables: Iterable[Path]) -> list[Path]:
    """The files that the tables of a command line are read from."""
    return [_STDIN if str(table) == DASH else table for table in tables]


def _kept(content: bytes, suffixes: tuple[str, ...]) -> Path:
    """A file with some content, until the command ends."""
    return click.get_current_context().with_resource(spooled(content, NAME, (*suffixes, "")[0]))


def _standard_input() -> bytes:
    mark = Mark(file=NAME)
    try:
        content = sys.stdin.buffer.read(MAX_BYTES + 1)
    except (AttributeError, OSError, ValueError) as error:  # closed by the program that started the command
        reason = getattr(error, "strerror", None) or "it is closed"
        raise TableError(say("stdin-unreadable", mark, reason=reason)) from None
    if len(content) > MAX_BYTES:
        raise TableError(say("stdin-too-large", mark, most=MAX_BYTES / 2**20))
    if not content.strip():
        raise TableError(say("stdin-empty", mark))
    return content


def _format_of(content: bytes, catalog: Catalog) -> str:
    """The reader of some content: the one that reads it as a table, where no other does."""
    names: list[str] = []
    readers: list[Any] = [provided.stage for provided in catalog.provided("reader")]
    for reader in readers:
        with spooled(content, NAME, (*reader.suffixes, "")[0]) as path, suppress(Exception):
            # A reader may raise anything of what is not its own format.
            if next(iter(reader.read(path, reader.options())), None) is not None:
                names.append(reader.name)
    if len(names) == 1:
        return names[0]
    code = "stdin-format-ambiguous" if names else "stdin-format-unknown"
    choices = names or [reader.name for reader in readers]
    raise TableError(say(code, Mark(file=NAME), names=" and ".join(names), choices=choices))
