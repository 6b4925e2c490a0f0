"""Which plugins are installed, before anything of them is imported.

A plugin is an entry point. The group of the entry point names the major version of the plugin interface: ``dh2urdf``
for 1, ``dh2urdf.v2`` for 2. So it is known of every plugin whether it fits before a line of it runs, and a distribution
with a plugin for each of two versions works with both.
"""

from __future__ import annotations

import os
import sys
from functools import lru_cache
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf._version import __version__
from dh2urdf.errors import ConfigError, IncompatiblePluginError
from dh2urdf.hookspecs import INTERFACE_VERSION, PROJECT
from dh2urdf.isolation.attribution import Plugin
from dh2urdf.source import Mark, Messages, did_you_mean

if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.metadata import EntryPoint

say = Messages(__file__)


class Installed(NamedTuple):
    """The plugins that can be used, those for other versions of the interface, and those that the user leaves out."""

    plugins: tuple[Plugin, ...]
    incompatible: tuple[IncompatiblePluginError, ...] = ()
    left_out: tuple[Plugin, ...] = ()


def installed(without: Sequence[str] = ()) -> Installed:
    """Return the plugins that are installed, by their entry points, `without` some plugins or distributions.

    Raises:
        ConfigError: one of the names is nobody's.
    """
    own = max(1, int(INTERFACE_VERSION.partition(".")[0]))  # what is made for 0.x is in the group of 1
    found = [
        (major, Plugin(name=f"{point.name} = {point.value}", distribution=point.dist, point=point))
        for major, point in _entry_points(_search_path())
    ]
    left_out: dict[Plugin, None] = {}
    unknown = []
    for name in without:
        named = [each for _, each in found if name in (each.entry, each.name) or each.is_of(name)]
        left_out |= dict.fromkeys(named)
        unknown += [] if named else [name]
    if unknown:
        names = [(plugin.distribution_name, plugin.entry) for _, plugin in found]
        place, known = Mark(file="command line"), [*chain(*names)]
        there = sorted({f"{distribution} (plugin {entry})" for distribution, entry in names})
        near = {name: did_you_mean(name, known) for name in unknown}
        raise ConfigError(
            say("plugin-unknown", place, field="--without", found=name, names=there, suggestion=near[name])
            for name in unknown
        )
    everybody = [plugin for major, plugin in found if major == own]
    fitting = [plugin for plugin in everybody if plugin not in left_out]
    foreign = [
        IncompatiblePluginError(
            plugin.name,
            plugin.distribution,
            f"it is made for version {major} of the plugin interface, and dh2urdf {__version__} has "
            f"{INTERFACE_VERSION}; install a version of {plugin.distribution_name} for this one, or another version of "
            "dh2urdf",
        )
        for major, plugin in found
        if major != own
        and plugin not in left_out
        and not any(each.is_of(plugin.distribution_name) for each in everybody)
    ]
    return Installed(plugins=tuple(fitting), incompatible=tuple(foreign), left_out=tuple(left_out))


def _search_path() -> tuple[tuple[str, int], ...]:
    """Return where distributions are looked for, with what changes as soon as one is installed or removed there."""
    found = []
    for place in sys.path:
        try:
            found.append((place, os.stat(place or ".").st_mtime_ns))  # noqa: PTH116 - asked at every call
        except OSError:
            found.append((place, 0))
    return tuple(found)


@lru_cache(maxsize=8)
def _entry_points(_places: tuple[tuple[str, int], ...]) -> list[tuple[int, EntryPoint]]:
    """Return the entry points of plugins, each with the major version of the interface that it is made for."""
    from importlib.metadata import entry_points

    found, every = [], entry_points()
    for group in every.groups:
        name, dot, version = group.partition(".v")
        if name == PROJECT and (version.isdecimal() or not dot):
            found += [(int(version or 1), point) for point in every.select(group=group)]
    return sorted(found, key=lambda each: (each[0], each[1].value, each[1].name))
