"""`--without NAME`, before a command or after it: which plugins a command does without."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli.answers import keep_apart

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeVar

    from dh2urdf.plugin_system.catalog import Catalog

    F = TypeVar("F", bound=Callable[..., Any])

_NAMES = f"{__name__}.names"


def _remember(context: click.Context, _parameter: click.Parameter, names: tuple[str, ...]) -> None:
    context.meta.setdefault(_NAMES, []).extend(names)


def without_option(function: F) -> F:
    """Gives a command the option; `catalog` heeds it."""
    return click.option(
        "--without",
        multiple=True,
        metavar="NAME",
        callback=_remember,
        expose_value=False,
        help="Leave out a plugin, or all of a distribution; repeatable.",
    )(function)


def catalog() -> Catalog:
    """What is installed, without what the command line leaves out; whatever it prints is not the command's answer.

    Raises:
        ConfigError: what it leaves out is not there.
    """
    from dh2urdf.plugin_system.catalog import load

    context = click.get_current_context()
    keep_apart(context)
    return load(context.meta.get(_NAMES, ()))
