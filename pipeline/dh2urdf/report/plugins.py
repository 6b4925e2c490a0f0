"""What is installed, as plain data: what `dh2urdf plugins --json` prints. `dh2urdf.report.schema` has its schema."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from dh2urdf._version import __version__
from dh2urdf.errors import BrokenPluginError, IncompatiblePluginError
from dh2urdf.hookspecs import INTERFACE_VERSION
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.plugin_system.option_types import describe_options
from dh2urdf.stage_calls.calls import Call, depending_on

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog, Plugin
    from dh2urdf.results import PluginEntry, PluginsReport, StageEntry

SCHEMA: Final = "dh2urdf-plugins/1"


def plugins_report(catalog: Catalog) -> PluginsReport:
    """Every stage with its options, and every plugin that gives none: broken, incompatible, or left out."""
    failed: list[BrokenPluginError] = []
    stages: list[StageEntry] = []
    words = ("name", "type", "default", "help")
    for item in [item for kind in KINDS for item in catalog.provided(kind)]:
        options: list[Any] = []
        try:
            with depending_on(Call(stage=item.stage, options=None, plugin=item.plugin), "options"):
                options = [dict(zip(words, each, strict=True)) for each in describe_options(item.stage.options)]
        except BrokenPluginError as error:  # A default describes itself by code of the plugin.
            failed.append(error)
        its: Any = {"kind": item.kind, "name": item.stage.name, "summary": item.stage.summary, **_whose(item.plugin)}
        stages.append(its | {"options": options})
    # Plugins are asked for their stages above, and are known as broken since.
    refused: list[tuple[BrokenPluginError, Any]] = [
        (error, {"plugin": error.plugin, "distribution": error.distribution, "reason": error.reason})
        for error in (*catalog.broken, *failed)
    ]
    clashes: list[Any] = [
        {"kind": each.kind, "name": each.name, "distributions": [*each.distributions], "choices": [*each.choices]}
        for each in catalog.clashes()
    ]
    shadowed: list[Any] = [
        {
            "kind": loser.kind,
            "name": loser.stage.name,
            **_whose(loser.plugin),
            "winner": winner.plugin.distribution,
            "choice": loser.full_name,
        }
        for loser, winner in ((each.loser, each.winner) for each in catalog.shadowed())
    ]
    return {
        "schema": SCHEMA,
        "version": __version__,
        "interface": INTERFACE_VERSION,
        "stages": stages,
        "clashes": clashes,
        "shadowed": shadowed,
        "broken": [
            entry | {"traceback": error.traceback}
            for error, entry in refused
            if not isinstance(error, IncompatiblePluginError)
        ],
        "incompatible": [entry for error, entry in refused if isinstance(error, IncompatiblePluginError)],
        "left_out": [_whose(plugin) for plugin in catalog.left_out],
    }


def _whose(plugin: Plugin) -> PluginEntry:
    return {"plugin": plugin.name, "distribution": plugin.distribution}
