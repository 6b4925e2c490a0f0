"""The command line: one small file per command, imported when the command is called."""

from __future__ import annotations

import os
import signal
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

import click

from dh2urdf import __version__
from dh2urdf.cli.leaving_out import without_option
from dh2urdf.errors import Dh2UrdfError, OutputError

if TYPE_CHECKING:
    from types import FrameType

INTERRUPTED = 130
INTERNAL_ERROR = 1

EXIT_STATUS = (
    "Exit status: 0 all done; 1 some manipulators failed, the others are written; 2 nothing could start: the command "
    "line, run file or table is wrong; 3 a plugin that is needed is broken or not installed; 130 interrupted."
)

COMMANDS = {
    "run": "Do a whole run that a YAML file describes.",
    "convert": "Turn one table into a robot description.",
    "check": "Say what each simulator will do with a robot description.",
    "studio": "Type a table in the browser, see the arm move, press Generate.",
    "view": "Show robots of URDF, xacro, tables and cells in the browser.",
    "plugins": "List every installed stage and its options.",
    "schema": "Print the JSON Schema of run files or tables.",
    "new-plugin": "Write the beginning of a plugin.",
}


class _Interrupted(BaseException):
    """Ctrl-C or SIGTERM came while a command was at work."""


class _Invocation:
    """What the command line asks for, whatever the command.

    Attributes:
        debug: show the tracebacks of errors.
    """

    def __init__(self, *, debug: bool) -> None:
        self.debug = debug


class _LazyGroup(click.Group):
    """A group that imports a command's module when the command is called: help and version cost nothing."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002 - click's signature
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f"dh2urdf.cli.{cmd_name.replace('-', '_')}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002 - click's signature
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            from dh2urdf.source import did_you_mean, shown

            near = did_you_mean(args[0], COMMANDS)
            advice = f"; {near}" if near else ""
            ctx.fail(f"no command {shown(args[0])}; the commands are {', '.join(COMMANDS)}{advice}")
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
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the flush at exit must not fail either
            return 0


def _print_version(ctx: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value:
        from dh2urdf.hookspecs import INTERFACE_VERSION

        python = ".".join(str(part) for part in sys.version_info[:3])
        click.echo(f"dh2urdf {__version__} (Python {python}, plugin interface {INTERFACE_VERSION})")
        ctx.exit()


@click.group(
    cls=_LazyGroup,
    name="dh2urdf",
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog=EXIT_STATUS,
)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_print_version, help="Print versions."
)
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
@without_option
@click.pass_obj
def dh2urdf(invocation: _Invocation, debug: bool) -> None:  # noqa: FBT001 - click hands flags over so
    """Turn tables of Denavit-Hartenberg parameters into robot descriptions that are provably the same arm.

    \b
    dh2urdf convert ur5.csv -o ur5.urdf      one table
    dh2urdf run ur5.yaml                     a whole run: URDF, xacro, simulator, proof
    dh2urdf check robot.urdf                 what each simulator will do with it
    dh2urdf convert --help                   what a command takes
    """
    invocation.debug = invocation.debug or debug


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and end the process with its exit status."""
    signal.signal(signal.SIGTERM, _on_terminate)
    words = sys.argv[1:] if arguments is None else arguments
    sys.exit(_status(words))


def _on_terminate(_number: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def _status(words: list[str], *, debug: bool = False) -> int:
    invocation = _Invocation(debug=debug)
    try:
        result: Any = dh2urdf.main(words, prog_name="dh2urdf", standalone_mode=False, obj=invocation)
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except (KeyboardInterrupt, click.Abort, _Interrupted) as error:
        advice = getattr(error.__cause__, "__notes__", ())
        click.echo("; ".join(["dh2urdf: interrupted; nothing half-written is left", *advice]), err=True)
        return INTERRUPTED
    except Dh2UrdfError as error:
        from dh2urdf.source import printable

        if invocation.debug:
            import traceback

            click.echo("".join(traceback.format_exception(error)) + getattr(error, "traceback", ""), err=True)
        click.echo("\n".join(map(printable, str(error).splitlines())), err=True)
        return error.exit_status
    except Exception as error:
        if isinstance(error, OSError) and error.filename is None:  # what has a name was reported where it was met
            click.echo(f"error: cannot write to standard output: {error.strerror}", err=True)
            return OutputError.exit_status
        if invocation.debug:
            raise
        click.echo(
            f"dh2urdf: internal error: {type(error).__name__}: {error}\n"
            "    this is a fault of dh2urdf, not of your table; `dh2urdf --debug …` shows where",
            err=True,
        )
        return INTERNAL_ERROR
    return result if isinstance(result, int) else 0
