"""What each plugin provides, asked when it is needed: a plugin that fails here is broken, and only that one."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from itertools import count, islice
from threading import RLock
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import pluggy

from dh2urdf import hookspecs, stages
from dh2urdf.errors import BrokenPluginError
from dh2urdf.isolation.attribution import Attribution, Plugin, reason_of, traceback_of
from dh2urdf.stages import Compares, Edit, Executor, Kind, Stage, Subcommand

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

KINDS: tuple[Kind, ...] = get_args(Kind)
RECORDS: dict[Kind, type[Any]] = {kind: getattr(stages, kind.capitalize()) for kind in KINDS}
CAPABILITIES: dict[Kind, tuple[type[Any], ...]] = {
    kind: get_args(getattr(stages, f"{kind.capitalize()}Capability")) for kind in KINDS
}
COMMAND = "command"
"""What the entry point of a command begins with, such as ``command.check``."""
_GIVEN: dict[str, type[Any]] = {**{str(kind): record for kind, record in RECORDS.items()}, COMMAND: Subcommand}
_HOOKS = f"the hooks are {', '.join(f'dh2urdf_{kind}s' for kind in _GIVEN)}"
_NAMES = {COMMAND: r"[^\s:=-][^\s:=]*"}  # of anything else: a word without a colon


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
    return (kind, name) if kind in _GIVEN and name.split() == [name] else None


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
        with self._lock:
            if (kind, plugin) not in self._found:
                self._found[kind, plugin] = Remembered(self._asked(kind, plugin), self._lock)
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

    def _asked(self, kind: str, plugin: Plugin) -> Iterator[Any]:
        """Return the records of a kind that a plugin gives; none where its entry point names another, or it fails."""
        only = declared(plugin)
        if only is not None and only[0] != kind:
            return iter(())
        records = self._records(kind, plugin, only[1] if only else None)
        try:
            return records if plugin.is_builtin and not only else iter(list(records))
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
            is_record = isinstance(plugin.module, tuple(_GIVEN.values()))
            self._hooks[plugin] = {} if is_record else self._registered(plugin)
        hooks, hook = self._hooks[plugin], f"dh2urdf_{kind}s"
        if hooks is None:
            return
        source = f"the hook {hook}" if hooks else f"the entry point {plugin.entry!r}"
        if hooks and plugin.is_builtin:
            yield from hooks[hook]() if hook in hooks else ()
            return
        if hooks:
            given = _called(hooks[hook], kind, plugin) if hook in hooks else []
        else:
            given = [plugin.module] if only or isinstance(plugin.module, _GIVEN[kind]) else []
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
            raise pluggy.PluginValidationError(module, f"{error}; {_HOOKS}") from error
        callers = self._manager.get_hookcallers(module) or []
        if not callers:
            raise TypeError(
                "it is no record of dh2urdf.stages, and has no hook of dh2urdf with the decorator "
                f"dh2urdf.hookspecs.hookimpl; {_HOOKS}"
            )
        hooks = [(caller.name, hook) for caller in callers for hook in caller.get_hookimpls()]
        return {name: hook.function for name, hook in hooks if hook.plugin is module}


def _called(hook: Callable[[], Any], kind: str, plugin: Plugin) -> list[Any]:
    """Return what a hook gives."""
    name = f"dh2urdf_{kind}s"
    with Attribution(f"the hook {name}", plugin):
        given = hook()
        if not isinstance(given, Iterable):
            what = None if given is None else type(given).__name__
            raise TypeError(f"the hook {name} gave {what}, not a list of dh2urdf.stages.{_GIVEN[kind].__name__}")
        return list(given)


# --- What a record has to be ------------------------------------------------------------------------------------------


def check_record(kind: str, record: Any, source: str) -> None:  # noqa: ANN401 - whatever a plugin gave
    """Raise a TypeError or ValueError where it is no record of the kind that could be asked for by its name."""
    if not isinstance(record, _GIVEN[kind]):
        given = f"{type(record).__name__} {record!r:.60}"
        raise TypeError(f"{source} gave {given}, not a dh2urdf.stages.{_GIVEN[kind].__name__}")
    name, whose = record.name, f"of the {kind} {record.name!r:.60}"
    if not isinstance(name, str) or not name.isprintable() or not re.fullmatch(_NAMES.get(kind, r"[^\s:]+"), name):
        raise ValueError(f"the {kind} {name!r:.60} has no name that could be asked for: one word without a colon")
    for what in ("summary", "function", "behind"):
        text = getattr(record, what, "")
        if not isinstance(text, str) or not text.isprintable():
            raise TypeError(f"the {what} {whose} is {text!r:.60}, not a line of text")
    if isinstance(record, Subcommand):
        if not re.fullmatch(r"[\w.]+:\w+", record.function):
            raise ValueError(f"the function {whose} is {record.function!r:.60}; accepted: module:name")
        return
    _check_fields(record, whose)
    _check_capabilities(record, CAPABILITIES[kind], whose)  # type: ignore[index] # it is a kind of stage


def _check_fields(stage: Any, whose: str) -> None:  # noqa: ANN401 - a record
    """Raise a TypeError or ValueError where options, suffixes or formats are not what they should be."""
    if not (isinstance(stage.options, type) and is_dataclass(stage.options)):
        raise TypeError(f"the options {whose} are {stage.options!r:.60}, not a dataclass")
    for what in ("suffixes", "formats"):
        words = getattr(stage, what, ())
        if not isinstance(words, tuple) or not all(isinstance(word, str) for word in words):
            raise TypeError(f"the {what} {whose} are {words!r:.60}, not a tuple of texts")
    for suffix in getattr(stage, "suffixes", ()):
        if not re.fullmatch(r"\.[^\s/\\]+", suffix) or suffix != suffix.lower():
            raise ValueError(f"a suffix {whose} is {suffix!r:.60}; accepted: lower case, with the dot before it")


def _check_capabilities(stage: Any, known: tuple[type[Any], ...], whose: str) -> None:  # noqa: ANN401 - a record
    """Raise a TypeError or ValueError where fields or capabilities of a record do not go together."""
    given = stage.capabilities
    if not isinstance(given, tuple) or not all(isinstance(each, known) for each in given):
        accepted = ", ".join(each.__name__ for each in known)
        raise TypeError(f"the capabilities {whose} are {given!r:.60}, not a tuple of {accepted}")
    if len({type(each) for each in given}) < len(given):
        raise ValueError(f"the capabilities {whose} have one twice: {given!r:.200}")
    if isinstance(stage, Executor) and (stage.map is None) is (stage.pool is None):
        raise ValueError(f"the executor {stage.name!r} has to give either map or pool")
    if isinstance(stage, Edit) and stage.edit_table is None and stage.edit_robot is None:
        raise ValueError(f"the edit {stage.name!r} has to give edit_table, edit_robot, or both")
    compares = stage.can(Compares)
    if compares and compares.option not in {each.name for each in fields(stage.options)}:
        raise ValueError(f"what is compared {whose} is {compares.option!r:.60}, which is none of its options")
