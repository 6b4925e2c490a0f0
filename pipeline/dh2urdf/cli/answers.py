"""Standard output carries what was asked for, and nothing else, whatever plugins print."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager, redirect_stdout, suppress
from typing import IO, TYPE_CHECKING, Any

import click

from dh2urdf.errors import OutputError
from dh2urdf.isolation.attribution import NamedLines
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Iterator

say = Messages(__file__)

_OWN = f"{__name__}.own"
_STDOUT, _STDERR = 1, 2


def answer(what: str | bytes, *, nl: bool = True) -> None:
    """Print what was asked for, or a part of it; an OutputError where it cannot be printed."""
    try:
        click.echo(what, file=answers(), nl=nl, color=True)
    except BrokenPipeError:
        raise
    except OSError as error:
        raise OutputError(say("stdout-unwritable", reason=error.strerror)) from error


def answers() -> IO[Any]:
    """Where answers go; an OutputError where a shell has closed standard output."""
    context = click.get_current_context(silent=True)
    if sys.stdout is None:
        raise OutputError(say("stdout-closed"))
    return context.meta[_OWN] if context and _OWN in context.meta else sys.stdout


def keep_apart(context: click.Context) -> None:
    """From here to the end of a command, what libraries print, from C and in programs too, goes to standard error."""
    if _OWN not in context.meta and (own := context.with_resource(kept_apart())) is not None:
        context.meta[_OWN] = own
        context.call_on_close(lambda: context.meta.pop(_OWN))


@contextmanager
def kept_apart() -> Iterator[IO[str] | None]:
    """The standard output of this process, which is nobody else's as long; None where a shell has closed a stream."""
    if None in (sys.stdout, sys.stderr):
        yield None
        return
    sys.stdout.flush()
    # What a terminal's encoding lacks is escaped as JSON does it.
    own = os.fdopen(os.dup(_STDOUT), "w", encoding=sys.stdout.encoding, errors="backslashreplace")
    try:
        os.dup2(_STDERR, _STDOUT)
        lines = NamedLines(lambda named, _: sys.stderr.write(f"{named}\n"), sys.stderr)
        with redirect_stdout(lines.as_text()):
            yield own
            lines.finish()
    finally:
        os.dup2(own.fileno(), _STDOUT)
        with suppress(OSError):  # Each answer is flushed, and what cannot be written was reported there.
            own.close()
