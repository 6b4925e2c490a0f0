"""Options of stages as flags of a command: what the metadata of an options dataclass call a flag."""

from __future__ import annotations

import sys
from contextlib import nullcontext, suppress
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli.answers import kept_apart
from dh2urdf.cli.shared_options import Command, OneValueOption, loaded
from dh2urdf.late_tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from dataclasses import Field

    from dh2urdf.stages import Kind

_BETWEEN = "__"
_WHOSE = f"{__name__}.whose"
"""The key in a context for whose flags are known: those of no stage, of the built-in stages, or of all stages."""
_NOBODY, _BUILTIN, _EVERYBODY = range(3)
_WORDS = f"{__name__}.words"
_LAST = "settings"
"""The parameter of `--set`: flags of stages stand before it, as it is what all other options take."""


class _Flag(NamedTuple):
    kind: Kind
    name: str
    metavar: str
    help: str

    def option(self) -> click.Option:
        words = [f"--{self.name.replace('_', '-')}", f"{self.kind}{_BETWEEN}{self.name}"]
        first = self.help[:1] if self.help[1:2] == " " else self.help[:1].upper()  # d is no D
        text = f"{first}{self.help[1:]}."
        return OneValueOption(words, metavar=self.metavar, help=text)


class StageCommand(Command):
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
        which: Callable[[Any], bool] = bool,
        **others: Any,  # noqa: ANN401
    ) -> None:
        super().__init__(*args, **others)
        self.kinds, self.which = tuple(kinds), which

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """The command's own parameters, with the flags of stages before the other options."""
        own = super().get_params(ctx)
        known = {word for parameter in own for word in parameter.opts}
        options = [flag.option() for flag in self._flags(ctx)]
        new = [option for option in options if not known.intersection(option.opts)]
        at = next((index for index, parameter in enumerate(own) if parameter.name == _LAST), len(own))
        return [*own[:at], *new, *own[at:]]

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the command line; where it has a flag that is not known yet, again with those of more stages."""
        ctx.meta[_WORDS] = tuple(args)
        asks_help = not set(ctx.help_option_names).isdisjoint(args)
        for ctx.meta[_WHOSE] in (_BUILTIN,) if asks_help else (_NOBODY, _BUILTIN):
            with suppress(click.NoSuchOption):
                return super().parse_args(ctx, list(args))
        ctx.meta[_WHOSE] = _EVERYBODY
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            name = error.option_name.lstrip("-").replace("-", "_")
            whose = (
                f"{kind} {stage!r}" for kind, stage, field in self._options(ctx, everybody=True) if field.name == name
            )
            stage = next(whose, "") if any(parameter.name == _LAST for parameter in self.params) else ""
            if stage:
                told = f"No such option {error.option_name!r}; `--set {name}=VALUE` gives the {stage} its option."
                raise click.NoSuchOption(error.option_name, told, ctx=ctx) from error
            raise

    def _flags(self, ctx: click.Context) -> list[_Flag]:
        """The flags, each once."""
        whose = ctx.meta.get(_WHOSE, _BUILTIN)
        if whose == _NOBODY:
            return []
        flags = dict[str, _Flag]()
        with kept_apart() if whose == _EVERYBODY and None not in (sys.stdout, sys.stderr) else nullcontext():
            for kind, _, field in self._options(ctx, everybody=whose == _EVERYBODY):
                data = field.metadata
                if "flag" in data and self.name in data.get("commands", (self.name,)):
                    flag = _Flag(kind, field.name, str(data["flag"]), str(data.get("help", "")))
                    flags.setdefault(field.name, flag)
        return list(flags.values())

    def _options(self, ctx: click.Context, *, everybody: bool) -> Iterator[tuple[Kind, str, Field[Any]]]:
        """The options of the stages that the command may call, each with the kind and the name of its stage."""
        installed = loaded(ctx, ctx.meta.get(_WORDS, ()))
        for kind in self.kinds:
            for item in installed.provided(kind) if everybody else installed.builtin(kind):
                is_asked = is_dataclass(item.stage.options) and self.which(item.stage)
                for field in fields(item.stage.options) if is_asked else ():
                    yield kind, item.stage.name, field


def given_options(flags: Mapping[str, Any]) -> dict[str, dict[str, str | None]]:
    """The options that flags of stages have given, by kind of stage."""
    given: dict[str, dict[str, str | None]] = {}
    for key, value in flags.items():
        kind, between, name = key.partition(_BETWEEN)
        if between:
            given.setdefault(kind, {})[name] = value
    return given
