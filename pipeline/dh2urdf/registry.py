"""Which stages are installed: every plugin's records, by kind and name, broken plugins kept with their reason."""

from __future__ import annotations

import traceback
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, get_args, overload

import pluggy

from dh2urdf import hookspecs
from dh2urdf.errors import BrokenPluginError, InputError, StageConflictError, UnknownStageError
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf.stages import Emitter, Executor, Kind, Loader, Reader, Stage, Transform

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from importlib.metadata import Distribution
    from pathlib import Path
    from typing import Literal

RECORDS: dict[Kind, type[Any]] = {
    "reader": Reader,
    "transform": Transform,
    "emitter": Emitter,
    "loader": Loader,
    "executor": Executor,
}
KINDS: tuple[Kind, ...] = get_args(Kind)


class Plugin:
    """An installed plugin.

    Attributes:
        name: its entry point, such as ``my_lab = my_lab.dh2urdf``.
        module: what the entry point gave.
        distribution: name and version of the distribution that provides it; read when it is asked for, since the
            metadata of a distribution take as long to read as a table.
    """

    def __init__(self, *, name: str, module: Any, distribution: Distribution | str | None) -> None:  # noqa: ANN401 - anything
        self.name = name
        self.module = module
        self._distribution = distribution

    @cached_property
    def distribution(self) -> str:  # noqa: D102 - documented with the class
        return _named(self._distribution)


@dataclass(frozen=True, slots=True, kw_only=True)
class Provided:
    """A stage and the plugin that provides it."""

    kind: Kind
    stage: Stage
    plugin: Plugin


class Catalog:
    """Every installed stage by kind and name.

    A kind's hooks are called when the first stage of that kind is asked for: a conversion pays for no simulator.
    """

    def __init__(self, plugins: Iterable[Plugin], broken: Iterable[BrokenPluginError] = ()) -> None:
        self._manager = pluggy.PluginManager(hookspecs.PROJECT)
        self._manager.add_hookspecs(hookspecs)
        self._broken = list(broken)
        self._provided: dict[Kind, tuple[Provided, ...]] = {}
        self._plugins: dict[str, Plugin] = {}
        for number, plugin in enumerate(plugins):
            key = f"{number}: {plugin.name}"
            try:
                self._manager.register(plugin.module, key)
                self._manager.check_pending()
                if not self._manager.get_hookcallers(plugin.module):
                    raise TypeError("it has no hook of dh2urdf: each needs the decorator dh2urdf.hookspecs.hookimpl")
            except Exception as error:  # noqa: BLE001 - whatever a plugin does wrong is its own fault, and named
                if key not in self._plugins and self._manager.has_plugin(key):
                    self._manager.unregister(name=key)
                self._broken.append(_broken(plugin.name, plugin.distribution, error))
            else:
                self._plugins[key] = plugin

    @property
    def broken(self) -> tuple[BrokenPluginError, ...]:
        """The plugins that failed, with their reasons, as far as they have been used."""
        return tuple(self._broken)

    def provided(self, kind: Kind) -> tuple[Provided, ...]:
        """The stages of a kind with the plugins that provide them, by name."""
        if kind not in self._provided:
            found = [item for key, plugin in self._plugins.items() for item in self._ask(kind, key, plugin)]
            self._provided[kind] = tuple(sorted(found, key=lambda item: item.stage.name))
        return self._provided[kind]

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

        Raises:
            UnknownStageError: no installed stage has the name.
            BrokenPluginError: none has, and a plugin that may provide it is broken.
            StageConflictError: two plugins claim the name.
        """
        found = [item for item in self.provided(kind) if item.stage.name == name]
        if not found:
            installed = [item.stage.name for item in self.provided(kind)]
            near = did_you_mean(name, installed)
            self._blame_broken(f"no other plugin provides the {kind} {name!r}{f'; {near}' if near else ''}")
            raise UnknownStageError(kind, name, installed)
        return self._only(kind, name, found).stage

    def distribution(self, kind: Kind, name: str) -> str:
        """Name and version of the distribution that provides a stage.

        Raises:
            UnknownStageError: no installed stage has the name.
        """
        stage = self.get(kind, name)
        return next(item.plugin.distribution for item in self.provided(kind) if item.stage is stage)

    def reader_for(self, path: Path) -> Reader[Any]:
        """The reader whose suffixes a path has.

        Raises:
            InputError: no installed reader takes the suffix, or several do.
            BrokenPluginError: none does, and a plugin that may provide one is broken.
            StageConflictError: two plugins claim the reader's name.
        """
        reader: Reader[Any] = self._by_suffix(
            "reader", path, "`stage: NAME` beside the path in a run file chooses a reader"
        )
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
            self._blame_broken(f"no other plugin takes the file {shown(path.name)}; accepted: {accepted}")
            raise InputError(
                Problem(
                    message=f"no {kind} is known for the file {shown(path.name)}",
                    found=path.suffix or path.name,
                    accepted=accepted,
                    suggestion=advice,
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

    def _blame_broken(self, missing: str) -> None:
        """Where something is missing, and a plugin that may have it is broken, the plugin is what to mend."""
        for broken in self._broken:
            reason = f"{broken.reason}; {missing}"
            raise BrokenPluginError(broken.plugin, broken.distribution, reason, broken.traceback)

    @staticmethod
    def _only(kind: Kind, name: str, claims: Sequence[Provided]) -> Provided:
        if len(claims) > 1:
            raise StageConflictError(kind, name, [claim.plugin.distribution for claim in claims])
        return claims[0]

    def _ask(self, kind: Kind, key: str, plugin: Plugin) -> Iterator[Provided]:
        """What one plugin provides of a kind; a plugin that fails here is broken, and only that one."""
        hook = getattr(self._manager.hook, f"dh2urdf_{kind}s")
        found: list[Provided] = []
        try:
            for implementation in hook.get_hookimpls():
                if implementation.plugin_name != key:
                    continue
                for stage in implementation.function():
                    if not isinstance(stage, RECORDS[kind]):
                        raise TypeError(
                            f"the hook dh2urdf_{kind}s gave {type(stage).__name__} {stage!r:.60}, "
                            f"not a dh2urdf.stages.{RECORDS[kind].__name__}"
                        )
                    found.append(Provided(kind=kind, stage=stage, plugin=plugin))
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever a plugin does is its own fault, and named
            self._broken.append(_broken(plugin.name, plugin.distribution, error))
            return
        yield from found


def load() -> Catalog:
    """The catalog of what is installed: the entry points of the group ``dh2urdf``.

    pluggy's own loader would let one broken plugin stop the host, and skip a name that is taken in silence.
    """
    from importlib.metadata import entry_points

    plugins: list[Plugin] = []
    broken: list[BrokenPluginError] = []
    for point in sorted(entry_points(group=hookspecs.PROJECT), key=lambda point: (point.value, point.name)):
        name = f"{point.name} = {point.value}"
        try:
            plugins.append(Plugin(name=name, module=point.load(), distribution=point.dist))
        except (Exception, SystemExit) as error:  # noqa: BLE001 - an import runs anything, and may raise anything
            broken.append(_broken(name, _named(point.dist), error))
    return Catalog(plugins, broken)


def _named(distribution: Distribution | str | None) -> str:
    if distribution is None:
        return "an unknown distribution"
    return distribution if isinstance(distribution, str) else f"{distribution.name} {distribution.version}"


def _broken(name: str, distribution: str, error: BaseException) -> BrokenPluginError:
    return BrokenPluginError(
        name, distribution, f"{type(error).__name__}: {error}", "".join(traceback.format_exception(error))
    )
