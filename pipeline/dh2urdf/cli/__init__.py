"""The command line: the module of a command is imported when the command is called."""

from __future__ import annotations

import atexit
import gc
import io
import os
import signal
import sys
import warnings
from importlib import import_module
from itertools import pairwise, takewhile
from typing import IO, Any

import click

from dh2urdf._version import __version__
from dh2urdf.cli.shared_options import loaded, option, without_option
from dh2urdf.errors import Dh2UrdfError
from dh2urdf.isolation.process import claim

INTERRUPTED, INTERNAL_ERROR = 130, 1
SETTLED = f"{__name__}.settled"
"""The key in a context for an exit status that is sure before all is printed: no reader who leaves early changes it."""
LAST_STREAM = 2

EXIT_STATUS = (
    "Exit status: 0 all done; 1 some manipulators failed, the others are written; 2 nothing could start: the command "
    "line, run file or table is wrong; 3 a plugin that is needed is broken or not installed; 130 interrupted."
)

COMMANDS = {
    "run": "Do a whole run that a YAML file describes.",
    "convert": "Turn one table into a robot description.",
    "info": "Print what is understood of a table, cell by cell.",
    "extract": "Print or write the DH table of a robot description.",
    "collisions": "Find the pairs of links that MoveIt need not check.",
    "plugins": "List every installed stage and its options.",
    "init": "Write the beginning of a table, with comments.",
    "example": "Print the table of a known arm.",
    "schema": "Print the JSON Schema of run files or tables.",
    "new-plugin": "Write the beginning of a plugin.",
}
"""The commands of dh2urdf itself; plugins add others."""
_TOGETHER = {
    **dict.fromkeys(("plugins", "schema"), "listings"),
    **dict.fromkeys(("extract", "collisions"), "descriptions"),
    **dict.fromkeys(("init", "example", "new-plugin"), "beginnings"),
}
"""The modules of several commands."""


class _Interrupted(BaseException):
    """Ctrl-C or SIGTERM came while a command was at work."""


class _LazyGroup(click.Group):
    """A group that imports a command's module when the command is called: help and version cost nothing."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        from dh2urdf.cli.added_commands import with_added

        return list(with_added(COMMANDS, ctx))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in COMMANDS:
            module = import_module(f"{__name__}.{_TOGETHER.get(cmd_name, cmd_name)}")
            command: click.Command = getattr(module, cmd_name.replace("-", "_") if cmd_name in _TOGETHER else "command")
            return command
        from dh2urdf.cli.added_commands import imported

        added = loaded(ctx).command(cmd_name)
        return imported(added) if added else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        from dh2urdf.cli.added_commands import with_added

        with formatter.section("Commands"):
            formatter.write_dl(list(with_added(COMMANDS, ctx).items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            from dh2urdf.cli.added_commands import check_known

            check_known(COMMANDS, ctx, args)
        for before, word in pairwise(takewhile("--".__ne__, args)):
            if not word.strip() or (word.startswith("--") and word.endswith("=") and "=" not in word[:-1]):
                name = word[:-1] or before
                ctx.fail(f"the word behind {name} is empty; is a variable of the shell not set?")
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401 - click's signature
        """Where the reader of a pipe has left (`dh2urdf convert … | head`), that is no error, as it is for click."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as error:
            raise _Interrupted from error  # click would print an empty line
        except (BrokenPipeError, SystemExit) as error:
            if isinstance(error, SystemExit) and not isinstance(error.__context__, BrokenPipeError):
                raise
            _let_go(sys.stdout)
            return ctx.meta.get(SETTLED, 0)


def _print_version(ctx: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value:
        from dh2urdf.hookspecs import INTERFACE_VERSION
        from dh2urdf.isolation.fence import walls

        python = ".".join(str(part) for part in sys.version_info[:3])
        click.echo(f"dh2urdf {__version__} (Python {python}, plugin interface {INTERFACE_VERSION})")
        click.echo(f"fence around files of unknown origin: {walls()}")
        ctx.exit()


@click.group(
    cls=_LazyGroup,
    name="dh2urdf",
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog=EXIT_STATUS,
)
@option("--version", is_flag=True, is_eager=True, expose_value=False, callback=_print_version, help="Print versions.")
@option("--debug", is_flag=True, help="Show the traceback of an error.")
@without_option
@click.pass_obj
def dh2urdf(invocation: dict[str, bool], debug: bool) -> None:  # noqa: FBT001 - click hands flags over so
    """Turn tables of Denavit-Hartenberg parameters into robot descriptions that are provably the same arm.

    \b
    dh2urdf convert ur5.csv -o ur5.urdf      one table
    dh2urdf run ur5.yaml                     a whole run: URDF, xacro, simulator, proof
    dh2urdf check robot.urdf                 what each simulator will do with it
    dh2urdf convert --help                   what a command takes
    """
    invocation["debug"] |= debug


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and end the process with its exit status."""
    gc.set_threshold(100_000)  # Python's 700 search for garbage some eighty times during the imports.
    atexit.register(gc.freeze)  # Its search at the end of the process takes a sixth of a cold conversion.
    _fill_closed_streams()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    claim()
    if isinstance(sys.stdout, io.TextIOWrapper):  # What a terminal's encoding lacks is escaped, in the help too.
        sys.stdout.reconfigure(errors="backslashreplace")
    # The threads that numpy's BLAS starts for large matrices burn the processors' time before they sleep.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if sys.__stderr__ is not None:
        import faulthandler

        faulthandler.enable(sys.__stderr__)  # A crash in C says in which file of Python it was.
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # what libraries warn their callers of is not for the user of a command
    sys.exit(exit_status_of(sys.argv[1:] if arguments is None else arguments))


def _fill_closed_streams() -> None:
    """Has the numbers of standard streams that a shell has closed lead nowhere: the next file would get them."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= LAST_STREAM:
        os.set_inheritable(number, True)
    os.close(number)
    if sys.stderr is None:
        sys.stderr = os.fdopen(os.dup(LAST_STREAM), "w")


def exit_status_of(words: list[str], *, debug: bool = False) -> int:
    """Call a command; the exit status that it, or what ends it, means."""
    invocation = {"debug": debug}
    try:
        result: Any = dh2urdf.main(words, prog_name="dh2urdf", standalone_mode=False, obj=invocation)
    except click.ClickException as error:
        usage = io.StringIO()
        error.show(usage)
        return _failed(words, error, error.exit_code, usage.getvalue().rstrip("\n"), "usage")
    except (KeyboardInterrupt, click.Abort, _Interrupted) as error:
        advice = getattr(error.__cause__, "__notes__", ())
        text = "; ".join(["dh2urdf: interrupted; nothing half-written is left", *advice])
        return _failed(words, error, INTERRUPTED, text, "interrupted")
    except Exception as error:  # noqa: BLE001 - the last one that may say what happened
        return _ended_by(error, words, debug=invocation["debug"])
    return result if isinstance(result, int) else 0


def _ended_by(error: Exception, words: list[str], *, debug: bool) -> int:
    """Say what an error that ends a command is about; the exit status that it means."""
    if isinstance(error, OSError) and not debug:
        from dh2urdf.output.whole_files import is_of_the_disk, refused

        if is_of_the_disk(error):
            error = refused(error.filename or "a file", error, "write or read")
    if isinstance(error, Dh2UrdfError):
        from dh2urdf.source import printable

        text = "\n".join(map(printable, str(error).splitlines()))
        if debug:
            import traceback

            trace = "".join(traceback.format_exception(error)) + getattr(error, "traceback", "")
            text = f"{trace}\n{text}"
        return _failed(words, error, error.exit_status, text)
    if debug:
        raise error
    text = (
        f"dh2urdf: internal error: {type(error).__name__}: {error}\n"
        "    this is a fault of dh2urdf, not of your table; `dh2urdf --debug …` shows where"
    )
    return _failed(words, error, INTERNAL_ERROR, text, "internal")


def _failed(words: list[str], error: BaseException, status: int, text: str, kind: str | None = None) -> int:
    """Say what ends a command on standard error and, with ``--json``, on standard output as data; the exit status."""
    try:
        click.echo(text, err=True)
        if "--json" in words or "--format=json" in words or ("--format", "json") in pairwise(words):
            from dh2urdf.conversion.outcome import kind_of, to_text
            from dh2urdf.report.conversions import error_report

            message = error.format_message() if isinstance(error, click.ClickException) else text
            name = kind_of(error) if kind is None and isinstance(error, Exception) else kind or ""
            click.echo(to_text(error_report(name, status, error, message)), nl=False)
    except OSError:  # Nobody is there to read it, or the disk is full: it changes nothing about what has happened.
        _let_go(sys.stdout, sys.stderr)
    return status


def _let_go(*streams: IO[str] | None) -> None:
    """Send what is still written to some streams nowhere: the flush at exit must not fail either."""
    for stream in filter(None, streams):  # A shell may have closed one.
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
