"""The commands that plugins add: looked for when the help lists all, or when none of dh2urdf's own has the name."""

from __future__ import annotations

from copy import copy
from importlib import import_module
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli.answers import kept_apart
from dh2urdf.cli.shared_options import loaded
from dh2urdf.errors import BrokenPluginError, Dh2UrdfError
from dh2urdf.isolation.attribution import Attribution, reason_of, traceback_of
from dh2urdf.source import did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.plugin_system.catalog import Provided


def with_added(own: Mapping[str, str], context: click.Context) -> dict[str, str]:
    """The summaries of all commands, by name, in the order of the help."""
    with kept_apart():
        added = loaded(context).commands()
    names = list(own)
    for name, command in added.items():
        if name not in own:
            names.insert(names.index(command.behind) + 1 if command.behind in names else len(names), name)
    return {name: own.get(name) or added[name].summary for name in names}


def check_known(own: Mapping[str, str], context: click.Context, words: Sequence[str]) -> None:
    """Refuse a command line, from the command on, whose command neither dh2urdf nor a plugin has."""
    catalog = loaded(context, words)
    with kept_apart():
        if catalog.command(words[0]) is not None:
            return
    known = with_added(own, context)
    near = did_you_mean(words[0], known)
    advice = f"; {near}" if near else ""
    for broken in catalog.broken:
        advice += f"; the plugin {broken.plugin!r} of {broken.distribution} is broken, and may have added it"
    context.fail(f"no command {shown(words[0])}; the commands are {', '.join(known)}{advice}")


def imported(added: Provided) -> click.Command:
    """The command that a plugin adds; what its code raises, but for errors of dh2urdf and click, is its fault."""
    place: str = added.stage.function  # type: ignore[union-attr] # it is a command
    module, _, name = place.partition(":")
    try:
        with kept_apart(), Attribution(f"the import of {module}", added.plugin):
            command = getattr(import_module(module), name)
        if not isinstance(command, click.Command):
            raise TypeError(f"{place} is {type(command).__name__}, not a click.Command")
    except Exception as error:
        raise _broken(added, error) from error
    if added.plugin.is_builtin:
        return command
    command, invoke = copy(command), command.invoke

    def blamed(context: click.Context) -> Any:  # noqa: ANN401 - click's
        try:
            with Attribution(f"the command {added.stage.name!r}", added.plugin):
                return invoke(context)
        except (Dh2UrdfError, OSError, click.ClickException, click.Abort, click.exceptions.Exit):
            raise
        except Exception as error:
            raise _broken(added, error) from error

    command.invoke = blamed  # type: ignore[assignment, method-assign]
    return command


def _broken(added: Provided, error: Exception) -> BrokenPluginError:
    reason = f"the command {added.stage.name!r}: {reason_of(error)}"
    return BrokenPluginError(added.plugin.name, added.plugin.distribution, reason, traceback_of(error))
