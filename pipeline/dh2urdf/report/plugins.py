"""What is installed, as plain data: what `dh2urdf plugins --json` prints. `dh2urdf.report.schema` has its schema."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from dh2urdf._version import __version__
from dh2urdf.errors import BrokenPluginError, IncompatiblePluginError
from dh2urdf.hookspecs import INTERFACE_VERSION
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.plugin_system.options import describe_options
from dh2urdf.stage_calls.calls import Call, depending_on

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.results import PluginsReport, StageEntry

SCHEMA: Final = "dh2urdf-plugins/1"


def plugins_report(catalog: Catalog) -> PluginsReport:
    """Every stage with its options, and every plugin that gives none: broken, incompatible, or left out."""
    failed: list[BrokenPluginError] = []
    stages: list[StageEntry] = []
    for kind in KINDS:
        for item in catalog.provided(kind):
            options: list[Any] = []
            try:
                with depending_on(Call(stage=item.stage, options=None, plugin=item.plugin), "options"):
                    words = ("name", "type", "default", "help")
                    options = [dict(zip(words, each, strict=True)) for each in describe_options(item.stage.options)]
            except BrokenPluginError as error:  # A default describes itself by code of the plugin.
                failed.append(error)
            stages.append(
                {
                    "kind": kind,
                    "name": item.stage.name,
                    "summary": item.stage.summary,
                    "plugin": item.plugin.name,
                    "distribution": item.plugin.distribution,
                    "options": options,
                }
            )
    failed = [*catalog.broken, *failed]  # Plugins are asked for their stages above, and are known as broken since.
    told: list[tuple[BrokenPluginError, Any]] = [
        (error, {"plugin": error.plugin, "distribution": error.distribution, "reason": error.reason})
        for error in failed
    ]
    clashes: list[Any] = [
        {"kind": each.kind, "name": each.name, "distributions": [*each.distributions], "choices": [*each.choices]}
        for each in catalog.clashes()
    ]
    return {
        "schema": SCHEMA,
        "version": __version__,
        "interface": INTERFACE_VERSION,
        "stages": stages,
        "clashes": clashes,
        "shadowed": [
            {
                "kind": loser.kind,
                "name": loser.stage.name,
                "plugin": loser.plugin.name,
                "distribution": loser.plugin.distribution,
                "winner": winner.plugin.distribution,
                "choice": loser.full_name,
            }
            for loser, winner in catalog.shadowed()
        ],
        "broken": [
            entry | {"traceback": error.traceback}
            for error, entry in told
            if not isinstance(error, IncompatiblePluginError)
        ],
        "incompatible": [entry for error, entry in told if isinstance(error, IncompatiblePluginError)],
        "left_out": [{"plugin": plugin.name, "distribution": plugin.distribution} for plugin in catalog.left_out],
    }
