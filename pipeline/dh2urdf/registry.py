"""Which stages are installed: every plugin's records, by kind and name, broken plugins kept with their reason."""

from __future__ import annotations

import re
from contextlib import contextmanager
from dataclasses import dataclass, is_dataclass
from typing import TYPE_CHECKING, Any, get_args, overload

import pluggy

from dh2urdf import hookspecs
from dh2urdf.discovery import Plugin, installed, same_name
from dh2urdf.errors import BrokenPluginError, InputError, StageConflictError, UnknownStageError
from dh2urdf.faults import INTERRUPTS, reason_of, traceback_of
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf.stages import Emitter, Executor, Kind, Loader, Reader, Stage, Transform

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path
    from typing import Literal

__all__ = ["KINDS", "RECORDS", "Catalog", "Plugin", "Provided", "load", "load_plugin"]

RECORDS: dict[Kind, type[Any]] = {
    "reader": Reader,
    "transform": Transform,
    "emitter": Emitter,
    "loader": Loader,
    "executor": Executor,
}
KINDS: tuple[Kind, ...] = get_args(Kind)

_SPREADSHEETS = frozenset({".xls", ".xlsb", ".ods", ".fods", ".numbers"})
_SAVE_AS = "save the sheet as .xlsx, or as CSV (UTF-8)"


@dataclass(frozen=True, slots=True, kw_only=True)
class Provided:
    """A stage and the plugin that provides it."""

    kind: Kind
    stage: Stage
    plugin: Plugin

    @property
    def full_name(self) -> str:
        """The name that is nobody else's: ``distribution:name``."""
        return f"{self.plugin.distribution_name}:{self.stage.name}"


class Catalog:
    """Every installed stage by kind and name.

    A plugin is imported when the first stage is asked for that may be its own, and a kind's hooks are called when the
    first stage of that kind is: a conversion pays for no simulator.
    """

    def __init__(
        self, plugins: Iterable[Plugin], broken: Iterable[BrokenPluginError] = (), left_out: Iterable[Plugin] = ()
    ) -> None:
        self._manager = pluggy.PluginManager(hookspecs.PROJECT)
        self._manager.add_hookspecs(hookspecs)
        self._plugins = tuple(plugins)
        self._broken = list(broken)
        self._works: dict[Plugin, bool] = {}
        self._found: dict[tuple[Kind, Plugin], tuple[Provided, ...]] = {}
        self.left_out = tuple(left_out)

    @property
    def broken(self) -> tuple[BrokenPluginError, ...]:
        """The plugins that failed or do not fit, with their reasons, as far as they have been used."""
        return tuple(self._broken)

    def provided(self, kind: Kind) -> tuple[Provided, ...]:
        """The stages of a kind with the plugins that provide them, by name."""
        return self._provided(kind, self._plugins)

    def clashes(self) -> tuple[StageConflictError, ...]:
        """The names that several plugins claim; an error only for who uses one of them."""
        found: list[StageConflictError] = []
        for kind in KINDS:
            claims: dict[str, list[str]] = {}
            for item in self.provided(kind):
                claims.setdefault(item.stage.name, []).append(item.plugin.distribution)
            found += [StageConflictError(kind, name, whose) for name, whose in claims.items() if len(whose) > 1]
        return tuple(found)

    @overload
    def get(self, kind: Literal["reader"], name: str) -> Reader[Any]: ...
    @overload
    def get(self, kind: Literal["transform"], name: str) -> Transform[Any]: ...
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
        provided = self._provided(kind, asked)
        found = [item for item in provided if item.stage.name == own_name]
        if not found:
            others = provided or self.provided(kind)
            names = [item.full_name if distribution else item.stage.name for item in others]
            near = did_you_mean(name, names)
            missing = f"no other plugin provides the {kind} {own_name!r}{f'; {near}' if near else ''}"
            self._blame_broken(missing, distribution)
            raise UnknownStageError(kind, name, names)
        return self._only(kind, own_name, found).stage

    def cell_reader(self) -> Reader[Any]:
        """The reader of rows of cells that come from no file: the one whose `read_cells` is not None.

        dh2urdf's own reader is taken where plugins have others.

        Raises:
            UnknownStageError: no installed reader has it.
        """
        provided = self.provided("reader")
        own_first = sorted(provided, key=lambda item: not item.plugin.is_of(hookspecs.PROJECT))
        for item in own_first:
            if isinstance(item.stage, Reader) and item.stage.read_cells:
                return item.stage
        raise UnknownStageError("reader", "of rows of cells", [item.stage.name for item in provided])

    def plugin_of(self, stage: Stage) -> Plugin:
        """The plugin that provides a stage of this catalog.

        Raises:
            LookupError: it is not of this catalog.
        """
        for items in self._found.values():
            for item in items:
                if item.stage is stage:
                    return item.plugin
        raise LookupError(stage.name)

    def reader_for(
        self, path: Path, advice: str = "`stage: NAME` beside the path in a run file chooses a reader"
    ) -> Reader[Any]:
        """The reader whose suffixes a path has.

        Args:
            path: the path.
            advice: how a person says which is meant.

        Raises:
            InputError: no installed reader takes the suffix, or several do.
            BrokenPluginError: none does, and a plugin that may provide one is broken.
            StageConflictError: two plugins claim the reader's name.
        """
        reader: Reader[Any] = self._by_suffix("reader", path, advice)
        return reader

    def emitter_for(self, path: Path, advice: str = "`--to NAME` chooses an emitter") -> Emitter[Any]:
        """The emitter whose suffixes a path has; the longest suffix wins (`.urdf.xacro` is xacro).

        Args:
            path: the path.
            advice: how a person says which is meant.

        Raises:
            InputError: no installed emitter writes the suffix, or several do.
            BrokenPluginError: none does, and a plugin that may provide one is broken.
            StageConflictError: two plugins claim the emitter's name.
        """
        emitter: Emitter[Any] = self._by_suffix("emitter", path, advice)
        return emitter

    def _by_suffix(self, kind: Kind, path: Path, advice: str) -> Any:  # noqa: ANN401 - a record of the kind
        name = path.name.lower()
        claims = [
            (len(suffix), item)
            for item in self.provided(kind)
            for suffix in getattr(item.stage, "suffixes", ())
            if name.endswith(suffix) and name != suffix
        ]
        if not claims:
            suffixes = sorted({s for item in self.provided(kind) for s in getattr(item.stage, "suffixes", ())})
            accepted = f"a file name that ends in {', '.join(suffixes)}"
            is_sheet = kind == "reader" and path.suffix.lower() in _SPREADSHEETS
            self._blame_broken(f"no other plugin takes the file {shown(path.name)}; accepted: {accepted}")
            raise InputError(
                Problem(
                    message=f"no {kind} is known for the file {shown(path.name)}",
                    found=path.suffix or path.name,
                    accepted=accepted,
                    suggestion=f"{_SAVE_AS}; or {advice}" if is_sheet else advice,
                )
            )
        longest = max(length for length, _ in claims)
        best = [item for length, item in claims if length == longest]
        if len({item.stage.name for item in best}) > 1:
            stages = " and ".join(f"{item.stage.name!r} of {item.plugin.distribution}" for item in best)
            raise InputError(
                Problem(
                    message=f"several {kind}s take the file {shown(path.name)}: {stages}",
                    found=path.name[-longest:],
                    suggestion=advice,
                )
            )
        return self._only(kind, best[0].stage.name, best).stage

    def _blame_broken(self, missing: str, distribution: str = "") -> None:
        """Where something is missing, and a plugin that may have it is broken, the plugin is what to mend."""
        for broken in self._broken:
            if not distribution or same_name(broken.distribution.partition(" ")[0], distribution):
                reason = f"{broken.reason}; {missing}"
                raise type(broken)(broken.plugin, broken.distribution, reason, broken.traceback)

    @staticmethod
    def _only(kind: Kind, name: str, claims: Sequence[Provided]) -> Provided:
        if len(claims) > 1:
            raise StageConflictError(kind, name, [claim.plugin.distribution for claim in claims])
        return claims[0]

    # --- What plugins do

    def _provided(self, kind: Kind, plugins: Iterable[Plugin]) -> tuple[Provided, ...]:
        found = [item for plugin in plugins for item in self._ask(kind, plugin)]
        return tuple(sorted(found, key=lambda item: item.stage.name))

    def _ask(self, kind: Kind, plugin: Plugin) -> tuple[Provided, ...]:
        """What one plugin provides of a kind; a plugin that fails here is broken, and only that one."""
        if (kind, plugin) not in self._found:
            self._found[kind, plugin] = ()
            with self._blamed(plugin):
                if self._is_registered(plugin):
                    self._found[kind, plugin] = tuple(self._call(kind, plugin))
        return self._found[kind, plugin]

    def _is_registered(self, plugin: Plugin) -> bool:
        """Import and register a plugin, once; whether it could be."""
        if plugin not in self._works:
            self._works[plugin] = False
            module, key = plugin.module, self._key(plugin)
            try:
                self._manager.register(module, key)
                self._manager.check_pending()
                if not self._manager.get_hookcallers(module):
                    raise TypeError("it has no hook of dh2urdf: each needs the decorator dh2urdf.hookspecs.hookimpl")
            except BaseException:
                if self._manager.has_plugin(key):
                    self._manager.unregister(name=key)
                raise
            self._works[plugin] = True
        return self._works[plugin]

    def _call(self, kind: Kind, plugin: Plugin) -> Iterator[Provided]:
        hook = getattr(self._manager.hook, f"dh2urdf_{kind}s")
        for implementation in hook.get_hookimpls():
            if implementation.plugin_name != self._key(plugin):
                continue
            for stage in implementation.function():
                _check_record(kind, stage)
                yield Provided(kind=kind, stage=stage, plugin=plugin)

    def _key(self, plugin: Plugin) -> str:
        return f"{self._plugins.index(plugin)}: {plugin.name}"

    @contextmanager
    def _blamed(self, plugin: Plugin) -> Iterator[None]:
        try:
            yield
        except INTERRUPTS:
            raise
        except BaseException as error:  # noqa: BLE001 - an import runs anything, and may raise anything
            fault = BrokenPluginError(plugin.name, plugin.distribution, reason_of(error), traceback_of(error))
            self._broken.append(fault)


def _check_record(kind: Kind, stage: Any) -> None:  # noqa: ANN401 - whatever a hook gave
    """Raises a TypeError or ValueError where it is no record of the kind that could be asked for by its name."""
    record = RECORDS[kind]
    if not isinstance(stage, record):
        given = f"{type(stage).__name__} {stage!r:.60}"
        raise TypeError(f"the hook dh2urdf_{kind}s gave {given}, not a dh2urdf.stages.{record.__name__}")
    if not isinstance(stage.name, str) or not re.fullmatch(r"[^\s:]+", stage.name) or not stage.name.isprintable():
        raise ValueError(f"the {kind} {stage.name!r:.60} has no name that a run file could say: a word without a colon")
    if not isinstance(stage.summary, str) or not stage.summary.isprintable():
        raise TypeError(f"the summary of the {kind} {stage.name!r} is {stage.summary!r:.60}, not a line of text")
    if not (isinstance(stage.options, type) and is_dataclass(stage.options)):
        raise TypeError(f"the options of the {kind} {stage.name!r} are {stage.options!r:.60}, not a dataclass")
    for what in ("suffixes", "formats"):
        words = getattr(stage, what, ())
        if not isinstance(words, tuple) or not all(isinstance(word, str) for word in words):
            raise TypeError(f"the {what} of the {kind} {stage.name!r} are {words!r:.60}, not a tuple of texts")


def load(without: Sequence[str] = ()) -> Catalog:
    """The catalog of what is installed.

    pluggy's own loader would let one broken plugin stop the host, and skip a name that is taken in silence.

    Args:
        without: names of plugins or of distributions to leave out.

    Raises:
        ConfigError: one of the names is nobody's.
    """
    found = installed(without)
    return Catalog(found.plugins, found.incompatible, found.left_out)


def load_plugin(name: str, distribution: str) -> Catalog:
    """The catalog of one installed plugin alone: what a worker needs of all plugins, as the run has chosen.

    Args:
        name: its entry point.
        distribution: the name of its distribution.
    """
    return Catalog(plugin for plugin in installed().plugins if plugin.name == name and plugin.is_of(distribution))
