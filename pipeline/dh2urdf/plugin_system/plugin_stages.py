"""What each plugin provides, asked when it is needed: a plugin that fails here is broken, and only that one."""

from __future__ import annotations

import re
from collections.abc import Iterable
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from typing import TYPE_CHECKING, Any, get_args

import pluggy

from dh2urdf import hookspecs, stages
from dh2urdf.errors import BrokenPluginError
from dh2urdf.plugin_system.at_work import AtWork
from dh2urdf.plugin_system.discovery import Plugin, reason_of, traceback_of
from dh2urdf.stages import Compares, Edit, Executor, Kind, Stage, Subcommand

if TYPE_CHECKING:
    from collections.abc import Iterator

KINDS: tuple[Kind, ...] = get_args(Kind)
RECORDS: dict[Kind, type[Any]] = {kind: getattr(stages, kind.capitalize()) for kind in KINDS}
CAPABILITIES: dict[Kind, tuple[type[Any], ...]] = {
    kind: get_args(getattr(stages, f"{kind.capitalize()}Capability")) for kind in KINDS
}
COMMAND = "command"
"""What the entry point of a command begins with, such as ``command.check``."""
_GIVEN: dict[str, type[Any]] = {**{str(kind): record for kind, record in RECORDS.items()}, COMMAND: Subcommand}
_COMMAND, _PLACE = re.compile(r"[^\s:=-][^\s:=]*"), re.compile(r"[\w.]+:\w+")
_WORD, _SUFFIX = re.compile(r"[^\s:]+"), re.compile(r"\.[^\s/\\]+")
_HOOKS = f"the hooks are {', '.join(f'dh2urdf_{kind}s' for kind in _GIVEN)}"


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


def declared(plugin: Plugin) -> tuple[str, str] | None:
    """Kind and name of a plugin's only stage or command, where its entry point is called so, as ``emitter.usd``."""
    kind, _, name = plugin.entry.partition(".")
    return (kind, name) if kind in _GIVEN and name.split() == [name] else None


class PluginStages:
    """Imports plugins, calls their hooks, and keeps what they give and how they fail.

    Attributes:
        broken: the plugins that failed or do not fit, with their reasons, as far as they have been used.
    """

    def __init__(self, broken: Iterable[BrokenPluginError] = ()) -> None:
        self.broken = list(broken)
        self._manager = pluggy.PluginManager(hookspecs.PROJECT)
        self._manager.add_hookspecs(hookspecs)
        self._keys: dict[Plugin, str | None] = {}
        self._not_imported: set[Plugin] = set()
        self._found: dict[tuple[str, Plugin], tuple[Any, ...]] = {}

    def of(self, kind: Kind, plugin: Plugin) -> tuple[Provided, ...]:
        """What a plugin provides of a kind; it is imported, unless its entry point says that it has none."""
        return tuple(Provided(kind=kind, stage=stage, plugin=plugin) for stage in self._asked(kind, plugin))

    def commands(self, plugin: Plugin) -> tuple[Subcommand, ...]:
        """The commands that a plugin adds; it is imported, unless its entry point says that it has none."""
        return self._asked(COMMAND, plugin)

    def _asked(self, kind: str, plugin: Plugin) -> tuple[Any, ...]:
        if (kind, plugin) not in self._found:
            self._found[kind, plugin] = ()
            only = declared(plugin)
            if only is None or only[0] == kind:
                with self._blamed(plugin):
                    self._found[kind, plugin] = tuple(self._call(kind, plugin, only[1] if only else None))
        return self._found[kind, plugin]

    def known(self, kind: Kind, name: str, plugin: Plugin) -> bool:
        """Whether it is known that a plugin has a stage, without an import of it."""
        return declared(plugin) == (kind, name) or any(
            given.name == name for given in self._found.get((kind, plugin), ())
        )

    def plugin_of(self, stage: Stage) -> Plugin:
        """The plugin that gave a stage.

        Raises:
            LookupError: none did.
        """
        for (_, plugin), found in self._found.items():
            if any(given is stage for given in found):
                return plugin
        raise LookupError(stage.name)

    def _call(self, kind: str, plugin: Plugin, only: str | None) -> Iterator[Any]:
        """The records that a plugin gives: all of them, or the one that its entry point names."""
        if plugin in self._not_imported:  # It is imported once, and reported once.
            return
        try:
            module = plugin.module
        except BaseException:
            self._not_imported.add(plugin)
            raise
        if isinstance(module, tuple(_GIVEN.values())):
            source = f"the entry point {plugin.entry!r}"
            given: list[Any] = [module] if only or isinstance(module, _GIVEN[kind]) else []
        else:
            source = f"the hook dh2urdf_{kind}s"
            given = list(self._from_hooks(kind, plugin))
        for record in given:
            if kind == COMMAND:
                _check_command(record, source)
            else:
                check_record(kind, record, source)  # type: ignore[arg-type] # it is a kind of stage
            if only in (None, record.name):
                yield record
        names = [record.name for record in given]
        if only is not None and only not in names:
            found = ", ".join(map(repr, names)) or "none"
            raise LookupError(f"its entry point {plugin.entry!r} names the {kind} {only!r}, and {source} gives {found}")

    def _from_hooks(self, kind: str, plugin: Plugin) -> Iterator[Any]:
        key, name = self._registered(plugin), f"dh2urdf_{kind}s"
        for implementation in getattr(self._manager.hook, name).get_hookimpls():
            if implementation.plugin_name != key:
                continue
            with AtWork(f"the hook {name}", plugin):
                found = implementation.function()
                if not isinstance(found, Iterable):
                    what = None if found is None else type(found).__name__
                    raise TypeError(
                        f"the hook {name} gave {what}, not a list of dh2urdf.stages.{_GIVEN[kind].__name__}"
                    )
                found = list(found)
            yield from found

    def _registered(self, plugin: Plugin) -> str | None:
        """Import and register a plugin, once; its key, or None where that failed before."""
        if plugin not in self._keys:
            self._keys[plugin] = None
            module = plugin.module
            if declared(plugin) and (key := self._manager.get_name(module)):
                self._keys[plugin] = key  # One module may have an entry point for each of its stages.
                return key
            key = f"{len(self._keys)}: {plugin.name}"
            try:
                self._manager.register(module, key)
                try:
                    self._manager.check_pending()
                except pluggy.PluginValidationError as error:
                    raise pluggy.PluginValidationError(module, f"{error}; {_HOOKS}") from error
                if not self._manager.get_hookcallers(module):
                    raise TypeError(
                        "it is no record of dh2urdf.stages, and has no hook of dh2urdf with the decorator "
                        f"dh2urdf.hookspecs.hookimpl; {_HOOKS}"
                    )
            except BaseException:
                if self._manager.has_plugin(key):
                    self._manager.unregister(name=key)
                raise
            self._keys[plugin] = key
        return self._keys[plugin]

    @contextmanager
    def _blamed(self, plugin: Plugin) -> Iterator[None]:
        try:
            yield
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # noqa: BLE001 - an import runs anything, and may raise anything
            self.broken.append(
                BrokenPluginError(plugin.name, plugin.distribution, reason_of(error), traceback_of(error))
            )


def _check_choices(kind: Kind, stage: Any) -> None:  # noqa: ANN401 - a record of the kind
    """Raise a TypeError or ValueError where fields or capabilities of a record do not go together."""
    given = stage.capabilities
    if not isinstance(given, tuple) or not all(isinstance(each, CAPABILITIES[kind]) for each in given):
        accepted = ", ".join(each.__name__ for each in CAPABILITIES[kind])
        raise TypeError(f"the capabilities of the {kind} {stage.name!r} are {given!r:.60}, not a tuple of {accepted}")
    if len({type(each) for each in given}) < len(given):
        raise ValueError(f"the {kind} {stage.name!r} has a capability twice: {given!r:.200}")
    if isinstance(stage, Executor) and (stage.map is None) is (stage.pool is None):
        raise ValueError(f"the executor {stage.name!r} has to give either map or pool")
    if isinstance(stage, Edit) and stage.edit_table is None and stage.edit_robot is None:
        raise ValueError(f"the edit {stage.name!r} has to give edit_table, edit_robot, or both")
    compares = stage.can(Compares)
    if compares and compares.option not in {each.name for each in fields(stage.options)}:
        raise ValueError(f"the {kind} {stage.name!r} compares {compares.option!r:.60}, which is none of its options")


def _check_texts(kind: Kind, stage: Stage, **texts: Any) -> None:  # noqa: ANN401 - whatever a plugin gave
    for what, words in texts.items():
        if not isinstance(words, tuple) or not all(isinstance(word, str) for word in words):
            raise TypeError(f"the {what} of the {kind} {stage.name!r} are {words!r:.60}, not a tuple of texts")


def _check_command(command: Any, source: str) -> None:  # noqa: ANN401 - whatever a plugin gave
    """Raises a TypeError or ValueError where it is no command that could be called."""
    if not isinstance(command, Subcommand):
        given = f"{type(command).__name__} {command!r:.60}"
        raise TypeError(f"{source} gave {given}, not a dh2urdf.stages.Subcommand")
    texts = (command.name, command.summary, command.function, command.behind)
    if not all(isinstance(text, str) and text.isprintable() for text in texts):
        raise TypeError(f"the fields of the command {command.name!r:.60} are not lines of text")
    if not _COMMAND.fullmatch(command.name):
        raise ValueError(f"the command {command.name!r:.60} has no name that a command line could have: one word")
    if not _PLACE.fullmatch(command.function):
        raise ValueError(
            f"the command {command.name!r} has the function {command.function!r:.60}; accepted: module:name"
        )


def check_record(kind: Kind, stage: Any, source: str) -> None:  # noqa: ANN401 - whatever a plugin gave
    """Raises a TypeError or ValueError where it is no record of the kind that could be asked for by its name."""
    record = RECORDS[kind]
    if not isinstance(stage, record):
        given = f"{type(stage).__name__} {stage!r:.60}"
        raise TypeError(f"{source} gave {given}, not a dh2urdf.stages.{record.__name__}")
    if not isinstance(stage.name, str) or not _WORD.fullmatch(stage.name) or not stage.name.isprintable():
        raise ValueError(f"the {kind} {stage.name!r:.60} has no name that a run file could say: a word without a colon")
    if not isinstance(stage.summary, str) or not stage.summary.isprintable():
        raise TypeError(f"the summary of the {kind} {stage.name!r} is {stage.summary!r:.60}, not a line of text")
    if not (isinstance(stage.options, type) and is_dataclass(stage.options)):
        raise TypeError(f"the options of the {kind} {stage.name!r} are {stage.options!r:.60}, not a dataclass")
    _check_texts(kind, stage, suffixes=getattr(stage, "suffixes", ()), formats=getattr(stage, "formats", ()))
    for suffix in getattr(stage, "suffixes", ()):
        if not _SUFFIX.fullmatch(suffix) or suffix != suffix.lower():
            raise ValueError(
                f"the {kind} {stage.name!r} has the suffix {suffix!r:.60}; accepted: lower case, with the dot before it"
            )
    _check_choices(kind, stage)
