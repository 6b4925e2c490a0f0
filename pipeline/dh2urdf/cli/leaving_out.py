"""`--without NAME`, before a command or after it: which plugins a command does without."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli.answers import keep_apart

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import TypeVar

    from dh2urdf.plugin_system.catalog import Catalog

    F = TypeVar("F", bound=Callable[..., Any])

_OPTION = "--without"
_NAMES = f"{__name__}.names"
_LOADED = f"{__name__}.loaded"


def _remember(context: click.Context, _parameter: click.Parameter, names: tuple[str, ...]) -> None:
    context.meta.setdefault(_NAMES, []).extend(names)


def without_option(function: F) -> F:
    """Gives a command the option; `catalog` heeds it."""
    return click.option(
        _OPTION,
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
    context = click.get_current_context()
    keep_apart(context)
    return loaded(context)


def loaded(context: click.Context, words: Sequence[str] = ()) -> Catalog:
    """What is installed, without what the command line has left out so far.

    Args:
        context: the call of the command.
        words: its command line, where it has not been read yet.

    Raises:
        ConfigError: what it leaves out is not there.
    """
    from dh2urdf.plugin_system.catalog import load

    unread = [value for word, value in pairwise((*words, "")) if word == _OPTION]
    unread += [word.partition("=")[2] for word in words if word.startswith(f"{_OPTION}=")]
    without = tuple(dict.fromkeys((*context.meta.get(_NAMES, ()), *unread)))
    found: dict[tuple[str, ...], Catalog] = context.meta.setdefault(_LOADED, {})
    if without not in found:
        found[without] = load(without)
    return found[without]
