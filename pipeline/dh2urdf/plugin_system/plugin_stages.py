"""What each plugin provides, asked when it is needed: a plugin that fails here is broken, and only that one."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any, get_args

import pluggy

from dh2urdf import hookspecs
from dh2urdf.errors import BrokenPluginError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.plugin_system.at_work import AtWork
from dh2urdf.plugin_system.discovery import Plugin, reason_of, traceback_of
from dh2urdf.stages import Edit, Emitter, Executor, Kind, Loader, Reader, Stage, Transform

if TYPE_CHECKING:
    from collections.abc import Iterator

RECORDS: dict[Kind, type[Any]] = {
    "reader": Reader,
    "transform": Transform,
    "edit": Edit,
    "emitter": Emitter,
    "loader": Loader,
    "executor": Executor,
}
KINDS: tuple[Kind, ...] = get_args(Kind)
_HOOKS = f"the hooks are {', '.join(f'dh2urdf_{kind}s' for kind in KINDS)}"


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
    """Kind and name of a plugin's only stage, where its entry point is called so, such as ``emitter.usd``."""
    kind, _, name = plugin.entry.partition(".")
    return (kind, name) if kind in KINDS and name.split() == [name] else None


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
        self._found: dict[tuple[Kind, Plugin], tuple[Provided, ...]] = {}

    def of(self, kind: Kind, plugin: Plugin) -> tuple[Provided, ...]:
        """What a plugin provides of a kind; it is imported, unless its entry point says that it has none."""
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
            item.stage.name == name for item in self._found.get((kind, plugin), ())
        )

    def plugin_of(self, stage: Stage) -> Plugin:
        """The plugin that gave a stage.

        Raises:
            LookupError: none did.
        """
        for items in self._found.values():
            for item in items:
                if item.stage is stage:
                    return item.plugin
        raise LookupError(stage.name)

    def _call(self, kind: Kind, plugin: Plugin, only: str | None) -> Iterator[Provided]:
        key = self._registered(plugin)
        name = f"dh2urdf_{kind}s"
        found: list[str] = []
        for implementation in getattr(self._manager.hook, name).get_hookimpls():
            if implementation.plugin_name != key:
                continue
            with AtWork(f"the hook {name}", plugin):
                stages = implementation.function()
                if not isinstance(stages, Iterable):
                    given = None if stages is None else type(stages).__name__
                    raise TypeError(
                        f"the hook {name} gave {given}, not a list of dh2urdf.stages.{RECORDS[kind].__name__}"
                    )
                stages = list(stages)
            for stage in stages:
                check_record(kind, stage)
                found.append(stage.name)
                if only in (None, stage.name):
                    yield Provided(kind=kind, stage=stage, plugin=plugin)
        if only is not None and only not in found:
            raise LookupError(
                f"its entry point {plugin.entry!r} names the {kind} {only!r}, and the hook {name} gives "
                f"{', '.join(map(repr, found)) or 'none'}"
            )

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
                        f"it has no hook of dh2urdf with the decorator dh2urdf.hookspecs.hookimpl; {_HOOKS}"
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
    """Raises a ValueError where fields of a record do not go together."""
    if isinstance(stage, Executor) and (stage.map is None) is (stage.pool is None):
        raise ValueError(f"the executor {stage.name!r} has to give either map or pool")
    if isinstance(stage, Loader) and (stage.load is None) is (stage.open is None):
        raise ValueError(f"the loader {stage.name!r} has to give either open or load")
    if isinstance(stage, Edit) and stage.edit_table is None and stage.edit_robot is None:
        raise ValueError(f"the edit {stage.name!r} has to give edit_table, edit_robot, or both")
    if isinstance(stage, Reader) and not {*stage.not_written} <= {*stage.suffixes[1:]}:
        raise ValueError(f"not_written of the reader {stage.name!r} is not among its suffixes behind the first")
    compared = getattr(stage, "compared", None)
    if compared is not None and compared not in {each.name for each in fields(stage.options)}:
        raise ValueError(f"the {kind} {stage.name!r} compares {compared!r:.60}, which is none of its options")


def _is_word(text: str, others: str) -> bool:
    """Whether a text is one word, without some other characters."""
    return text.split() == [text] and not set(text).intersection(others)


def check_record(kind: Kind, stage: Any) -> None:  # noqa: ANN401 - whatever a hook gave
    """Raises a TypeError or ValueError where it is no record of the kind that could be asked for by its name."""
    record = RECORDS[kind]
    if not isinstance(stage, record):
        given = f"{type(stage).__name__} {stage!r:.60}"
        raise TypeError(f"the hook dh2urdf_{kind}s gave {given}, not a dh2urdf.stages.{record.__name__}")
    if not isinstance(stage.name, str) or not _is_word(stage.name, ":") or not stage.name.isprintable():
        raise ValueError(f"the {kind} {stage.name!r:.60} has no name that a run file could say: a word without a colon")
    if not isinstance(stage.summary, str) or not stage.summary.isprintable():
        raise TypeError(f"the summary of the {kind} {stage.name!r} is {stage.summary!r:.60}, not a line of text")
    if not (isinstance(stage.options, type) and is_dataclass(stage.options)):
        raise TypeError(f"the options of the {kind} {stage.name!r} are {stage.options!r:.60}, not a dataclass")
    for what in ("suffixes", "formats", "not_written", "other_endings"):
        words = getattr(stage, what, ())
        if not isinstance(words, tuple) or not all(isinstance(word, str) for word in words):
            raise TypeError(f"the {what} of the {kind} {stage.name!r} are {words!r:.60}, not a tuple of texts")
    for suffix in getattr(stage, "suffixes", ()):
        if suffix[:1] != "." or not _is_word(suffix[1:], "/\\") or suffix != suffix.lower():
            raise ValueError(
                f"the {kind} {stage.name!r} has the suffix {suffix!r:.60}; accepted: lower case, with the dot before it"
            )
    _check_choices(kind, stage)
