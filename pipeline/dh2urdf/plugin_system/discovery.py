"""Which plugins are installed, before anything of them is imported.

A plugin is an entry point, and the group of the entry point says for which major version of the plugin interface it is
made: ``dh2urdf`` for 1, ``dh2urdf.v2`` for 2, and so on. So it is known of every plugin whether it fits before a line
of it runs, and a distribution that has a plugin for each of two versions works with both.
"""

from __future__ import annotations

import os
import re
import sys
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

from dh2urdf._version import __version__
from dh2urdf.errors import ConfigError, IncompatiblePluginError
from dh2urdf.hookspecs import INTERFACE_VERSION, PROJECT
from dh2urdf.plugin_system.at_work import AtWork
from dh2urdf.source import Mark, Problem, did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from importlib.metadata import Distribution, EntryPoint

UNKNOWN = "an unknown distribution"
_BUILT_IN = ("dh2urdf_plugins", "dh2urdf_check", "dh2urdf_studio")


class Plugin:
    """An installed plugin.

    Attributes:
        name: its entry point, such as ``my_lab = my_lab.dh2urdf``.
        module: what the entry point gives; imported when it is asked for.
        distribution: name and version of the distribution that provides it; read when it is asked for, since the
            metadata of a distribution take as long to read as a table.
    """

    def __init__(
        self,
        *,
        name: str,
        distribution: Distribution | str | None,
        module: Any = None,  # noqa: ANN401 - anything
        point: EntryPoint | None = None,
    ) -> None:
        self.name = name
        self._distribution = distribution
        self._module = module
        self._point = point

    @cached_property
    def module(self) -> Any:  # noqa: ANN401, D102 - anything; documented with the class
        if self._point is None:
            return self._module
        if self.is_builtin:
            return self._point.load()
        with AtWork(f"the import of the plugin {self.name!r}", self):
            return self._point.load()

    @property
    def is_builtin(self) -> bool:
        """Whether it is a plugin of dh2urdf itself."""
        return self.name.partition(" = ")[2] in _BUILT_IN

    @cached_property
    def distribution(self) -> str:  # noqa: D102 - documented with the class
        found = self._distribution
        if found is None or isinstance(found, str):
            return found or UNKNOWN
        return f"{found.name or UNKNOWN} {found.version}"

    @property
    def distribution_name(self) -> str:
        """The name of the distribution, without its version."""
        found = self._distribution
        if found is None:
            return UNKNOWN
        return found.partition(" ")[0] if isinstance(found, str) else found.name or UNKNOWN

    @property
    def is_installed(self) -> bool:
        """Whether it was found among what is installed, as every process of this environment finds it."""
        return self._point is not None

    @property
    def entry(self) -> str:
        """The name of the entry point: what stands before the ``=``."""
        return self.name.partition(" = ")[0]

    def is_of(self, distribution: str) -> bool:
        """Whether a distribution provides it; spellings of a name that pip takes for one are one here, too."""
        return same_name(self.distribution_name, distribution)

    def is_named(self, name: str) -> bool:
        """Whether a name is the plugin's or its distribution's."""
        return name in (self.entry, self.name) or self.is_of(name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Installed:
    """The plugins that are installed.

    Attributes:
        plugins: those that can be used.
        incompatible: those that are made for another version of the interface, and why that does not do.
        left_out: those that the user leaves out.
    """

    plugins: tuple[Plugin, ...]
    incompatible: tuple[IncompatiblePluginError, ...] = ()
    left_out: tuple[Plugin, ...] = ()


def installed(without: Sequence[str] = ()) -> Installed:
    """The plugins that are installed, by their entry points.

    Args:
        without: names of plugins or of distributions to leave out.

    Raises:
        ConfigError: one of the names is nobody's.
    """
    major = max(1, int(INTERFACE_VERSION.partition(".")[0]))  # what is made for 0.x is in the group of 1
    by_major: dict[int, list[Plugin]] = {major: []}
    for version, found in _entry_points(_search_path()):
        by_major.setdefault(version, []).extend(
            Plugin(name=f"{each.name} = {each.value}", distribution=each.dist, point=each) for each in found
        )
    everybody = [plugin for plugins in by_major.values() for plugin in plugins]
    _check_names(without, everybody)
    left_out = [plugin for plugin in everybody if any(plugin.is_named(name) for name in without)]
    fitting = by_major.pop(major)
    foreign = [
        (other, plugin)
        for other, plugins in sorted(by_major.items())
        for plugin in plugins
        if plugin not in left_out and not any(own.is_of(plugin.distribution_name) for own in fitting)
    ]
    return Installed(
        plugins=tuple(plugin for plugin in fitting if plugin not in left_out),
        incompatible=tuple(
            IncompatiblePluginError(
                plugin.name,
                plugin.distribution,
                f"it is made for version {other} of the plugin interface, and dh2urdf {__version__} has "
                f"{INTERFACE_VERSION}; install a version of {plugin.distribution_name} for this one, or another "
                "version of dh2urdf",
            )
            for other, plugin in foreign
        ),
        left_out=tuple(left_out),
    )


def _search_path() -> tuple[tuple[str, int], ...]:
    """Where distributions are looked for, with what changes as soon as one is installed or removed there."""
    found = []
    for place in sys.path:
        try:
            found.append((place, os.stat(place or ".").st_mtime_ns))  # noqa: PTH116 - asked at every call
        except OSError:
            found.append((place, 0))
    return tuple(found)


@lru_cache(maxsize=8)
def _entry_points(_place: tuple[tuple[str, int], ...]) -> tuple[tuple[int, tuple[EntryPoint, ...]], ...]:
    """The entry points of plugins by the interface's major version: folders are searched for them, so they are kept."""
    from importlib.metadata import entry_points

    found: dict[int, list[EntryPoint]] = {}
    every = entry_points()
    for group in every.groups:
        name, dot, version = group.partition(".v")
        if name == PROJECT and (version.isdecimal() or not dot):
            found.setdefault(int(version or 1), []).extend(every.select(group=group))
    return tuple(
        (major, tuple(sorted(each, key=lambda point: (point.value, point.name)))) for major, each in found.items()
    )


def _check_names(names: Iterable[str], plugins: Sequence[Plugin]) -> None:
    known = sorted({f"{plugin.distribution_name} (plugin {plugin.entry})" for plugin in plugins}) if names else []
    words = [word for plugin in plugins for word in (plugin.distribution_name, plugin.entry)] if names else []
    problems = [
        Problem(
            message=f"no plugin and no distribution of one is named {name!r}",
            mark=Mark(file="command line"),
            field="--without",
            found=name,
            accepted=", ".join(known),
            suggestion=did_you_mean(name, words),
        )
        for name in names
        if not any(plugin.is_named(name) for plugin in plugins)
    ]
    if problems:
        raise ConfigError(problems)


def same_name(one: str, other: str) -> bool:
    """Whether two names of a distribution are one name, as pip compares them."""
    return re.sub(r"[-_.]+", "-", one).lower() == re.sub(r"[-_.]+", "-", other).lower()


# --- What plugins raise: anything, and even the text of that may fail


def reason_of(error: BaseException) -> str:
    """The class of an exception and its message, in one line."""
    try:
        text = str(error)
    except Exception as failed:  # noqa: BLE001 - it is the exception's own code
        text = f"its text cannot be made: {type(failed).__name__}"
    text = "; ".join(filter(None, map(str.strip, text.removeprefix("error: ").splitlines())))
    return f"{type(error).__name__}: {text}" if text else f"{type(error).__name__}, without a message"


def traceback_of(error: BaseException) -> str:
    """Where an exception was raised, for `--debug`."""
    import traceback

    return "".join(traceback.format_exception(error))
