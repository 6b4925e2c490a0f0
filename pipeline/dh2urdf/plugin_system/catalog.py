"""Which stages are installed: every plugin's records, by kind and name, broken plugins kept with their reason."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple, overload

from dh2urdf.errors import BrokenPluginError, InputError, StageConflictError, UnknownStageError
from dh2urdf.isolation.attribution import Plugin, same_name
from dh2urdf.plugin_system.discovery import installed
from dh2urdf.plugin_system.plugin_stages import COMMAND, KINDS, PluginStages, Provided, declared
from dh2urdf.source import Messages, did_you_mean, shown
from dh2urdf.stages import Reader, ReadsCells, ReadsDescriptions, Usual

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path
    from typing import Literal

    from dh2urdf.stages import Edit, Emitter, Executor, Kind, Loader, Stage, Subcommand, Transform

say = Messages(__file__)

__all__ = ["KINDS", "Catalog", "Plugin", "Provided", "Shadowed", "load", "load_plugin"]


class Shadowed(NamedTuple):
    """A stage that only its full name chooses, and the stage that the short name chooses."""

    loser: Provided
    winner: Provided


class Catalog:
    """Every installed stage by kind and name.

    A plugin is imported when a stage is asked for that only it may have. A name means the built-in stage; else that of
    the plugin whose entry point is called so, such as ``emitter.usd``; else that of one of the other plugins. A kind's
    hooks are called when the first stage of that kind is asked for.
    """

    def __init__(
        self, plugins: Iterable[Plugin], broken: Iterable[BrokenPluginError] = (), left_out: Iterable[Plugin] = ()
    ) -> None:
        self._plugins = tuple(plugins)
        self._stages = PluginStages(broken)
        self._warned: set[str] = set()
        self.left_out = tuple(left_out)

    @property
    def broken(self) -> tuple[BrokenPluginError, ...]:
        """The plugins that failed or do not fit, with their reasons, as far as they have been used."""
        return tuple(self._stages.broken)

    def provided(self, kind: Kind) -> tuple[Provided, ...]:
        """The stages of a kind with the plugins that provide them, by name; every plugin that may have one is asked."""
        return self._provided(kind, self._plugins)

    def builtin(self, kind: Kind) -> tuple[Provided, ...]:
        """The stages of a kind that dh2urdf brings itself, by name; no other plugin is asked."""
        return self._provided(kind, _by_right(self._plugins, kind)[0])

    def clashes(self) -> tuple[StageConflictError, ...]:
        """Return the names that several plugins claim with equal right; an error only for who uses one of them."""
        claimed = [(kind, best) for kind in KINDS for best, _ in self._claims(kind) if len(best) > 1]
        return tuple(_conflict(kind, best[0].stage.name, best) for kind, best in claimed)

    def shadowed(self) -> tuple[Shadowed, ...]:
        """Return the stages whose short names mean the stages of other plugins."""
        claims = [claim for kind in KINDS for claim in self._claims(kind)]
        return tuple([Shadowed(loser, best[0]) for best, others in claims if len(best) == 1 for loser in others])

    def by_name(self, kind: Kind) -> dict[str, Provided]:
        """Return the stages of a kind that their short names choose."""
        return {best[0].stage.name: best[0] for best, _ in self._claims(kind) if len(best) == 1}

    def _claims(self, kind: Kind) -> Iterator[tuple[list[Provided], list[Provided]]]:
        """Yield, by name, the stages with the best right to it, and those with less."""
        for _, items in groupby(self.provided(kind), lambda item: item.stage.name):
            claims = sorted(items, key=lambda item: _right(item.plugin))
            best = [item for item in claims if _right(item.plugin) == _right(claims[0].plugin)]
            yield best, claims[len(best) :]

    @overload
    def get(self, kind: Literal["reader"], name: str) -> Reader[Any]: ...
    @overload
    def get(self, kind: Literal["transform"], name: str) -> Transform[Any]: ...
    @overload
    def get(self, kind: Literal["edit"], name: str) -> Edit[Any]: ...
    @overload
    def get(self, kind: Literal["emitter"], name: str) -> Emitter[Any]: ...
    @overload
    def get(self, kind: Literal["loader"], name: str) -> Loader[Any]: ...
    @overload
    def get(self, kind: Literal["executor"], name: str) -> Executor[Any]: ...
    def get(self, kind: Kind, name: str) -> Stage:
        """The stage of a kind with a name.

        Args:
            kind: the kind.
            name: the stage's name, or ``distribution:name``, which says whose it is where several have the name; then
                no other distribution's plugin is imported.

        Raises:
            UnknownStageError: no installed stage has the name.
            BrokenPluginError: none has, and a plugin that may provide it is broken.
            StageConflictError: two plugins claim the name.
        """
        distribution, _, own_name = name.rpartition(":")
        asked = [plugin for plugin in self._plugins if not distribution or plugin.is_of(distribution)]
        if own := self._builtin(kind, asked, lambda stage: stage.name == own_name):
            return self._only(kind, own_name, [own], warn=not distribution)  # type: ignore[no-any-return]
        for plugins in _by_right(asked, kind, own_name):
            if found := [item for item in self._provided(kind, plugins) if item.stage.name == own_name]:
                return self._only(kind, own_name, found, warn=not distribution)  # type: ignore[no-any-return]
        others = self._provided(kind, asked) or self.provided(kind)
        names = [item.full_name if distribution else item.stage.name for item in others]
        near = did_you_mean(name, names)
        missing = f"no other plugin provides the {kind} {own_name!r}{f'; {near}' if near else ''}"
        self._blame_broken(missing, distribution)
        raise UnknownStageError(kind, name, names)

    def commands(self) -> dict[str, Subcommand]:
        """Return the commands that plugins add, by name: of each name, the one with the best right to it."""
        found: dict[str, Subcommand] = {}
        for plugin in sorted(self._plugins, key=lambda plugin: not plugin.is_builtin):
            found = {command.name: command for command in self._stages.of(COMMAND, plugin)} | found
        return found

    def command(self, name: str) -> Provided | None:
        """Return the command of a name that a plugin adds; plugins whose entry points name others are not imported.

        Raises:
            StageConflictError: two plugins claim the name.
        """
        for plugins in _by_right(self._plugins, COMMAND, name):
            asked = [plugin for plugin in plugins if declared(plugin) in (None, (COMMAND, name))]
            if claims := [item for item in self._provided(COMMAND, asked) if item.stage.name == name]:
                if len(claims) > 1:
                    raise _conflict(COMMAND, name, claims)
                return claims[0]
        return None

    def cell_reader(self) -> Reader[Any]:
        """The reader of rows of cells that come from no file, dh2urdf's own where plugins have others.

        Raises:
            UnknownStageError: no installed reader has it.
        """
        return self._first("reader", ReadsCells, "of rows of cells")  # type: ignore[no-any-return]

    def any_text(self) -> str:
        """The suffix of files whose reader finds out the form of their text itself; empty where no reader does."""
        return str(getattr(self.cell_reader().can(ReadsCells), "any_text", ""))

    @overload
    def usual(self, kind: Literal["transform"]) -> Transform[Any]: ...
    @overload
    def usual(self, kind: Literal["emitter"]) -> Emitter[Any]: ...
    @overload
    def usual(self, kind: Literal["executor"]) -> Executor[Any]: ...
    @overload
    def usual(self, kind: Kind) -> Stage: ...
    def usual(self, kind: Kind) -> Stage:
        """The stage that is taken where nobody names one of its kind: it has the capability `Usual`.

        dh2urdf's own stage is taken where plugins have others.

        Raises:
            UnknownStageError: no installed stage of the kind is one.
        """
        return self._first(kind, Usual, "that is taken where none is named")  # type: ignore[no-any-return]

    def _first(self, kind: Kind, capability: type, wanted: str) -> Any:  # noqa: ANN401 - a record of the kind
        """Return the stage with the best right of those that have a capability."""
        if own := self._builtin(kind, self._plugins, lambda stage: stage.can(capability)):
            return own.stage
        for plugins in _by_right(self._plugins, kind)[1:]:
            for item in self._provided(kind, plugins):
                if item.stage.can(capability):
                    return item.stage
        raise UnknownStageError(kind, wanted, [item.stage.name for item in self.provided(kind)])

    def plugin_of(self, stage: Stage) -> Plugin:
        """Return the plugin that provides a stage of this catalog.

        Raises:
            LookupError: it is not of this catalog.
        """
        return self._stages.plugin_of(stage)

    def reader_for(
        self, path: Path, advice: str = "`stage: NAME` beside the path in a run file chooses a reader"
    ) -> Reader[Any]:
        """Return the reader whose suffixes a path has; `advice` says how a person chooses one.

        Raises:
            InputError: no installed reader takes the suffix, or several do.
            BrokenPluginError: none does, and a plugin that may provide one is broken.
            StageConflictError: two plugins claim the reader's name.
        """
        return self._by_suffix("reader", path, advice)  # type: ignore[no-any-return]

    def emitter_for(self, path: Path, advice: str = "`--to NAME` chooses an emitter") -> Emitter[Any]:
        """Return the emitter whose suffixes a path has; the longest suffix wins (`.urdf.xacro` is xacro).

        Raises:
            InputError: no installed emitter writes the suffix, or several do.
            BrokenPluginError: none does, and a plugin that may provide one is broken.
            StageConflictError: two plugins claim the emitter's name.
        """
        return self._by_suffix("emitter", path, advice)  # type: ignore[no-any-return]

    def is_table(self, path: Path) -> bool:
        """Whether the suffix of a file is that of a reader of tables; of a built-in stage, without asking plugins."""
        for plugins in (_by_right(self._plugins, "reader")[0], self._plugins):
            for kind in ("reader", "emitter"):
                if found := self._with_suffix(kind, path.name, plugins):
                    stages = [item.stage for _, item in found]
                    return any(isinstance(stage, Reader) and stage.can(ReadsDescriptions) is None for stage in stages)
        return False

    def _by_suffix(self, kind: Kind, path: Path, advice: str) -> Any:  # noqa: ANN401 - a record of the kind
        suffix = path.suffix.lower()
        own = self._builtin(kind, self._plugins, lambda stage: suffix in getattr(stage, "suffixes", ()))
        if own and "." not in path.name[1 : -len(suffix)]:
            return self._only(kind, own.stage.name, [own])
        best = [] if own else self._with_suffix(kind, path.name, _by_right(self._plugins, kind)[0])
        if not best or "." in path.name[1 : -len(best[0][0])]:  # A plugin may have a longer suffix, or the only one.
            best = self._with_suffix(kind, path.name, self._plugins)
        if not best:
            raise self._no_stage_for(kind, path, advice)
        suffix = best[0][0]
        items = [item for _, item in best if item.plugin.is_builtin] or [item for _, item in best]
        name = items[0].stage.name
        if any(item.stage.name != name for item in items):
            stages = " and ".join(f"{item.stage.name!r} of {item.plugin.distribution}" for item in items)
            code = "several-stages-for-file"
            raise InputError(say(code, found=suffix, kind=kind, name=path.name, stages=stages, suggestion=advice))
        for _, other in best:
            if items[0].plugin.is_builtin and other.stage.name != name:
                self._warn(items[0], f" for files {suffix}", [other.plugin], other.stage.name)
        return self._only(kind, name, items)

    def _with_suffix(self, kind: Kind, name: str, plugins: Iterable[Plugin]) -> list[tuple[str, Provided]]:
        """Return the stages of some plugins that take a file, by the longest suffix that the file's name has."""
        name = name.lower()
        claims = [
            (suffix, item)
            for item in self._provided(kind, plugins)
            for suffix in getattr(item.stage, "suffixes", ())
            if name.endswith(suffix) and name != suffix
        ]
        longest = max((len(suffix) for suffix, _ in claims), default=0)
        return [claim for claim in claims if len(claim[0]) == longest]

    def _no_stage_for(self, kind: Kind, path: Path, advice: str) -> InputError:
        suffixes = sorted({s for item in self.provided(kind) for s in getattr(item.stage, "suffixes", ())})
        accepted = f"a file name that ends in {', '.join(suffixes)}" if suffixes else f"no file: there is no {kind}"
        self._blame_broken(f"no other plugin takes the file {shown(path.name)}; accepted: {accepted}")
        found = path.suffix or path.name
        code, name = "no-stage-for-file", path.name
        return InputError(say(code, found=found, kind=kind, name=name, accepted=accepted, suggestion=advice))

    def _blame_broken(self, missing: str, distribution: str = "") -> None:
        """Where something is missing, and a plugin that may have it is broken, the plugin is what to fix."""
        for broken in self._stages.broken:
            if not distribution or same_name(broken.distribution.partition(" ")[0], distribution):
                reason = f"{broken.reason}; {missing}"
                raise type(broken)(broken.plugin, broken.distribution, reason, broken.traceback)

    def _only(self, kind: Kind, name: str, claims: Sequence[Provided], *, warn: bool = True) -> Any:  # noqa: ANN401 - a record
        """Return the one stage that claims a name, and warn once that other plugins claim it with less right.

        Raises:
            StageConflictError: there are several.
        """
        if len(claims) > 1:
            raise _conflict(kind, name, claims)
        (winner,) = claims
        if warn:
            others = [plugin for plugin in self._plugins if plugin is not winner.plugin]
            if claiming := [each for each in others if self._stages.known(kind, name, each)]:
                self._warn(winner, "", claiming, name)
        return winner.stage

    def _warn(self, winner: Provided, use: str, others: Iterable[Plugin], name: str) -> None:
        for plugin in others:
            if (choice := f"{plugin.distribution_name}:{name}") not in self._warned:
                import logging

                self._warned.add(choice)
                logging.getLogger("dh2urdf").warning(
                    "warning: the %s %r of %s is used%s; `%s` chooses the one of %s",
                    *(winner.kind, winner.stage.name, winner.plugin.distribution, use, choice, plugin.distribution),
                )

    def _builtin(self, kind: Kind, plugins: Iterable[Plugin], is_wanted: Callable[[Any], bool]) -> Provided | None:
        """Return the first stage of dh2urdf's own that is wanted; the hook is asked no further than that."""
        for plugin in plugins:
            for stage in self._stages.of(kind, plugin) if plugin.is_builtin else ():
                if is_wanted(stage):
                    return Provided(kind=kind, stage=stage, plugin=plugin)
        return None

    def _provided(self, kind: str, plugins: Iterable[Plugin]) -> tuple[Provided, ...]:
        found = [(plugin, stage) for plugin in plugins for stage in self._stages.of(kind, plugin)]
        found.sort(key=lambda item: item[1].name)
        return tuple([Provided(kind, stage, plugin) for plugin, stage in found])  # type: ignore[arg-type] # or a command


def _conflict(kind: str, name: str, claims: Iterable[Provided]) -> StageConflictError:
    return StageConflictError(kind, name, [claim.plugin.distribution for claim in claims])


def _right(plugin: Plugin) -> int:
    """Return the order in which a name is given away: built-in stages, stages that entry points name, all others."""
    return 0 if plugin.is_builtin else 1 if declared(plugin) else 2


def _by_right(plugins: Iterable[Plugin], kind: str, name: str | None = None) -> tuple[list[Plugin], ...]:
    """Return plugins that may have a stage, by their right to its name."""
    tiers: tuple[list[Plugin], ...] = ([], [], [])
    for plugin in plugins:
        only = None if plugin.is_builtin else declared(plugin)
        if only is None or (only[0] == kind and name in (None, only[1])):
            tiers[_right(plugin)].append(plugin)
    return tiers


def load(without: Sequence[str] = ()) -> Catalog:
    """Return the catalog of what is installed.

    Args:
        without: names of plugins or of distributions to leave out.

    Raises:
        ConfigError: one of the names is nobody's.
    """
    found = installed(without)
    return Catalog(found.plugins, found.incompatible, found.left_out)


def load_plugin(name: str, distribution: str) -> Catalog:
    """Return the catalog of one installed plugin alone: what a worker needs of all plugins, as the run has chosen."""
    return Catalog(plugin for plugin in installed().plugins if plugin.name == name and plugin.is_of(distribution))
