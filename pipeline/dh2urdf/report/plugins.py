"""What is installed, as plain data: what `dh2urdf plugins --json` prints. `dh2urdf.report.schema` has its schema."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, cast

from dh2urdf._version import __version__
from dh2urdf.errors import BrokenPluginError, IncompatiblePluginError
from dh2urdf.hookspecs import INTERFACE_VERSION
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.plugin_system.options import describe_options
from dh2urdf.stage_calls.calls import Call, depending_on

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog, Provided
    from dh2urdf.results import KindName, OptionEntry, PluginsReport, RefusedPluginEntry, StageEntry
    from dh2urdf.stages import Kind

SCHEMA: Final = "dh2urdf-plugins/1"


def plugins_report(catalog: Catalog) -> PluginsReport:
    """Every stage with its options, and every plugin that gives none: broken, incompatible, or left out."""
    failed: list[BrokenPluginError] = []
    stages = [_stage(item, kind, failed) for kind in KINDS for item in catalog.provided(kind)]
    failed = [*catalog.broken, *failed]
    return {
        "schema": SCHEMA,
        "version": __version__,
        "interface": INTERFACE_VERSION,
        "stages": stages,
        "clashes": [
            {
                "kind": cast("KindName", clash.kind),
                "name": clash.name,
                "distributions": list(clash.distributions),
                "choices": list(clash.choices),
            }
            for clash in catalog.clashes()
        ],
        "shadowed": [
            {
                "kind": each.loser.kind,
                "name": each.loser.stage.name,
                "plugin": each.loser.plugin.name,
                "distribution": each.loser.plugin.distribution,
                "winner": each.winner.plugin.distribution,
                "choice": each.loser.full_name,
            }
            for each in catalog.shadowed()
        ],
        "broken": [
            {**_refused(error), "traceback": error.traceback}
            for error in failed
            if not isinstance(error, IncompatiblePluginError)
        ],
        "incompatible": [_refused(error) for error in failed if isinstance(error, IncompatiblePluginError)],
        "left_out": [{"plugin": plugin.name, "distribution": plugin.distribution} for plugin in catalog.left_out],
    }


def _stage(item: Provided, kind: Kind, failed: list[BrokenPluginError]) -> StageEntry:
    options: list[OptionEntry] = []
    try:
        with depending_on(Call(stage=item.stage, options=None, plugin=item.plugin), "options"):
            options = [
                {"name": name, "type": type_text, "default": default, "help": text}
                for name, type_text, default, text in describe_options(item.stage.options)
            ]
    except BrokenPluginError as error:  # A default describes itself by code of the plugin.
        failed.append(error)
    return {
        "kind": kind,
        "name": item.stage.name,
        "summary": item.stage.summary,
        "plugin": item.plugin.name,
        "distribution": item.plugin.distribution,
        "options": options,
    }


def _refused(error: BrokenPluginError) -> RefusedPluginEntry:
    return {"plugin": error.plugin, "distribution": error.distribution, "reason": error.reason}
