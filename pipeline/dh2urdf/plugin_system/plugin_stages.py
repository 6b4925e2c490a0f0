"""What each plugin provides, asked when it is needed: a plugin that fails here is broken, and only that one."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import count, islice
from threading import RLock
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import pluggy

from dh2urdf import hookspecs
from dh2urdf.errors import BrokenPluginError
from dh2urdf.isolation.attribution import Attribution, Plugin, reason_of, traceback_of
from dh2urdf.stages import Kind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf.stages import Stage

KINDS: tuple[Kind, ...] = get_args(Kind)
COMMAND = "command"
"""What the entry point of a command begins with, such as ``command.check``."""


class Provided(NamedTuple):
    """A stage and the plugin that provides it."""

    kind: Kind
    stage: Stage
    plugin: Plugin

    @property
    def full_name(self) -> str:
        """The name that is nobody else's: ``distribution:name``."""
        return f"{self.plugin.distribution_name}:{self.stage.name}"


def declared(plugin: Plugin) -> tuple[str, str] | None:
    """Return kind and name of a plugin's only stage or command, where its entry point names it: ``emitter.usd``."""
    kind, _, name = plugin.entry.partition(".")
    return (kind, name) if kind in (*KINDS, COMMAND) and name.split() == [name] else None


class Remembered:
    """What an iterator gives: it is asked no further than somebody wants, and for each item once.

    Attributes:
        kept: what it has given so far.
    """

    def __init__(self, source: Iterator[Any], lock: RLock) -> None:
        self.kept: list[Any] = []
        self._source, self._lock = source, lock

    def __iter__(self) -> Iterator[Any]:
        for place in count():
            with self._lock:
                if place == len(self.kept):
                    self.kept += islice(self._source, 1)
            if place == len(self.kept):
                return
            yield self.kept[place]


class PluginStages:
    """Imports plugins, calls their hooks, and keeps what they give and, as `broken`, how they fail."""

    def __init__(self, broken: Iterable[BrokenPluginError] = ()) -> None:
        self.broken = list(broken)
        self._manager = pluggy.PluginManager(hookspecs.PROJECT)
        self._manager.add_hookspecs(hookspecs)
        self._hooks: dict[Plugin, dict[str, Callable[[], Any]] | None] = {}
        self._found: dict[tuple[str, Plugin], Remembered] = {}
        self._lock = RLock()  # One thread at a time imports plugins and asks them: the others wait for what it finds.

    def of(self, kind: str, plugin: Plugin) -> Iterable[Any]:
        """The records of a kind that a plugin gives; it is imported unless its entry point names another one.

        Those of dh2urdf itself are made one after the other, as far as somebody looks.
        """
        only = declared(plugin)
        if only is not None and only[0] != kind:
            return ()
        with self._lock:
            if (kind, plugin) not in self._found:
                records = self._records(kind, plugin, only[1] if only else None)
                if only or not plugin.is_builtin:
                    records = self._tried(records, plugin)
                self._found[kind, plugin] = Remembered(records, self._lock)
            return self._found[kind, plugin]

    def known(self, kind: Kind, name: str, plugin: Plugin) -> bool:
        """Whether it is known that a plugin has a stage, without an import of it."""
        found = self._found.get((kind, plugin))
        return declared(plugin) == (kind, name) or any(given.name == name for given in (found.kept if found else ()))

    def plugin_of(self, stage: Stage) -> Plugin:
        """Return the plugin that gave a stage.

        Raises:
            LookupError: none did.
        """
        with self._lock:
            for (_, plugin), found in self._found.items():
                if any(given is stage for given in found.kept):
                    return plugin
        raise LookupError(stage.name)

    def _tried(self, records: Iterator[Any], plugin: Plugin) -> Iterator[Any]:
        """Return all records that a plugin gives; none where it fails."""
        try:
            return iter(list(records))
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # noqa: BLE001 - an import runs anything, and may raise anything
            told = reason_of(error), traceback_of(error)
            self.broken.append(BrokenPluginError(plugin.name, plugin.distribution, *told))
            return iter(())

    def _records(self, kind: str, plugin: Plugin, only: str | None) -> Iterator[Any]:
        """Yield the records that a plugin gives: all of them, or the one that its entry point names."""
        if plugin not in self._hooks:
            self._hooks[plugin] = None  # An import that fails is reported once.
            self._hooks[plugin] = {} if _is_record(plugin.module) else self._registered(plugin)
        hooks, hook = self._hooks[plugin], f"dh2urdf_{kind}s"
        if hooks is None:
            return
        source = f"the hook {hook}" if hooks else f"the entry point {plugin.entry!r}"
        if hooks and plugin.is_builtin:
            yield from hooks[hook]() if hook in hooks else ()
            return
        from dh2urdf.plugin_system.records import check_record, type_of

        if hooks:
            given = _called(hooks[hook], kind, plugin) if hook in hooks else []
        else:
            given = [plugin.module] if only or isinstance(plugin.module, type_of(kind)) else []
        for record in given:
            check_record(kind, record, source)
            if only in (None, record.name):
                yield record
        names = [record.name for record in given]
        if only is not None and only not in names:
            found = ", ".join(map(repr, names)) or "none"
            raise LookupError(f"its entry point {plugin.entry!r} names the {kind} {only!r}, and {source} gives {found}")

    def _registered(self, plugin: Plugin) -> dict[str, Callable[[], Any]]:
        """Register a plugin, unless another entry point has registered its module; return its hooks by their names.

        Raises:
            PluginValidationError: there is no such hook, or it has parameters.
            TypeError: there is none at all.
        """
        module = plugin.module
        try:
            if not self._manager.is_registered(module):
                self._manager.register(module, f"{len(self._hooks)}: {plugin.name}")
            self._manager.check_pending()
        except pluggy.PluginValidationError as error:
            if self._manager.is_registered(module):
                self._manager.unregister(module)
            raise pluggy.PluginValidationError(module, f"{error}; {_hooks_there()}") from error
        callers = self._manager.get_hookcallers(module) or []
        if not callers:
            raise TypeError(
                "it is no record of dh2urdf.stages, and has no hook of dh2urdf with the decorator "
                f"dh2urdf.hookspecs.hookimpl; {_hooks_there()}"
            )
        hooks: dict[str, Callable[[], Any]] = {}
        for caller in callers:
            for hook in caller.get_hookimpls():
                if hook.plugin is module:
                    hooks[caller.name] = hook.function
        return hooks


def _hooks_there() -> str:
    return f"the hooks are {', '.join(f'dh2urdf_{kind}s' for kind in (*KINDS, COMMAND))}"


def _is_record(given: object) -> bool:
    """Whether an entry point names a record, and no module with hooks."""
    if isinstance(given, ModuleType):
        return False
    from dh2urdf.plugin_system.records import type_of

    return any(isinstance(given, type_of(kind)) for kind in (*KINDS, COMMAND))


def _called(hook: Callable[[], Any], kind: str, plugin: Plugin) -> list[Any]:
    """Return what a hook gives."""
    from dh2urdf.plugin_system.records import type_of

    name = f"dh2urdf_{kind}s"
    with Attribution(f"the hook {name}", plugin):
        given = hook()
        if not isinstance(given, Iterable):
            what = None if given is None else type(given).__name__
            raise TypeError(f"the hook {name} gave {what}, not a list of dh2urdf.stages.{type_of(kind).__name__}")
        return list(given)
