"""What all commands share: an option has one value, `--without NAME` leaves out plugins, `--trust` trusts meshes.

Both are accepted before a command or after it. Of two values that differ, click would take the last one.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise, takewhile
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli.answers import answer, keep_apart

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from typing import TypeVar

    from click.core import ParameterSource
    from click.shell_completion import CompletionItem

    from dh2urdf.plugin_system.catalog import Catalog

    F = TypeVar("F", bound=Callable[..., Any])

_OPTION = "--without"
_NAMES = f"{__name__}.names"
_LOADED = f"{__name__}.loaded"


class Command(click.Command):
    """A command that needs less of click: neither what translates its own text, nor the search for similar options."""

    def get_help_option(self, ctx: click.Context) -> click.Option | None:
        """The option for help, whose text is not looked up in catalogues of translations."""
        names = self.get_help_option_names(ctx)
        return _help_option(tuple(names)) if names and self.add_help_option else None

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the command line; click would look for names like each short one, ``-o``, before it finds that."""
        long = {word: max(parameter.opts, key=len) for parameter in self.params for word in parameter.opts}
        words = list(takewhile("--".__ne__, args))
        for place, (before, word) in enumerate(
            pairwise(words[:-1]), 1
        ):  # An error quotes the last one: it lacks a value.
            if not before.startswith("-"):  # Else it may be the value of an option.
                words[place] = long.get(word, word)
        return super().parse_args(ctx, words + args[len(words) :])


@lru_cache
def _help_option(names: tuple[str, ...]) -> click.Option:
    """The option for help; a parser compares options by identity."""
    text = "Show this message and exit."
    return click.Option(names, is_flag=True, is_eager=True, expose_value=False, callback=_show_help, help=text)


def _show_help(context: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's
    if value and not context.resilient_parsing:
        answer(context.get_help())
        context.exit()


class _PathType(click.ParamType):  # type: ignore[type-arg] # generic only in newer versions
    """A path, wherever it leads: whatever opens it reports what is wrong with it.

    (`click.Path` looks up its own name in catalogues of translations.)
    """

    name = "path"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:  # noqa: ANN401, ARG002 - click's
        """The path that a text is."""
        from pathlib import Path

        return Path(value)

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:  # noqa: ARG002 - click's
        """Has the shell complete it as a file."""
        from click.shell_completion import CompletionItem

        return [CompletionItem(incomplete, type="file")]


PATH = _PathType()


class OneValueOption(click.Option):
    """An option that refuses a second value which differs from the first; flags and repeatable options are click's."""

    @property
    def _has_one_value(self) -> bool:
        return not (self.multiple or self.is_flag or self.count)

    def add_to_parser(self, parser: Any, ctx: click.Context) -> None:  # noqa: ANN401 - its class depends on click's version
        """Has the parser collect all values."""
        if self._has_one_value:
            parser.add_option(obj=self, opts=self.opts, dest=self.name, action="append", nargs=self.nargs)
        else:
            super().add_to_parser(parser, ctx)

    def consume_value(self, ctx: click.Context, opts: Mapping[str, Any]) -> tuple[Any, ParameterSource]:
        """The value that the command line, or else the default, gives.

        Raises:
            click.UsageError: the command line gives two that differ.
        """
        given = opts.get(self.name or "")
        if self._has_one_value and isinstance(given, list):
            first = given[0]
            for other in given[1:]:
                if other != first:
                    from dh2urdf.source import shown

                    word = max(self.opts, key=len)
                    ctx.fail(
                        f"{word} {shown(str(other))} contradicts {word} {shown(str(first))}; {word} accepts one value"
                    )
            opts = {**opts, str(self.name): first}
        return super().consume_value(ctx, opts)


def option(*words: str, **attributes: Any) -> Callable[[F], F]:  # noqa: ANN401 - click's
    """Gives a command an option, as `click.option` does."""
    return click.option(*words, cls=OneValueOption, **attributes)


def _remember(context: click.Context, _parameter: click.Parameter, names: tuple[str, ...]) -> None:
    context.meta.setdefault(_NAMES, []).extend(names)


def _trust(context: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value:
        import os

        from dh2urdf.isolation.fence import TRUST

        if TRUST not in os.environ:
            os.environ[TRUST] = "1"  # for child processes and workers, too
            context.call_on_close(lambda: os.environ.pop(TRUST, None))


def without_option(function: F) -> F:
    """Gives a command the options that all have; `catalog` heeds `--without`."""
    function = option(
        "--trust",
        is_flag=True,
        callback=_trust,
        expose_value=False,
        help="Read meshes though this system's kernel offers no wall around their readers.",
    )(function)
    return option(
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
