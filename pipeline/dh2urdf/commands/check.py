"""Findings about a robot description of any origin: the work of `dh2urdf check`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.calls import Call, a_record, depending_on
from dh2urdf.source import Mark, Messages
from dh2urdf.stages import Checks, Expansion, Inspection, ReadsForeign

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Emitter, Stage

say = Messages(__file__)


def inspect(
    catalog: Catalog,
    file: Path,
    name: str | None,
    choice: str,
    expansion: Expansion | None = None,
    *,
    ask: bool = False,
) -> Inspection:
    """The findings of the emitter of a file's format, which its suffix names where nothing else does, by a `choice`."""
    emitter = emitter_of(catalog, file, name, choice)
    checks = emitter.can(Checks)
    if checks is None:
        able = [item.stage.name for item in catalog.provided("emitter") if item.stage.can(Checks)]
        mark = Mark(file=str(file))
        raise ConfigError(say("format-unchecked", mark, format=emitter.name, formats=able, option=choice))
    with depending_on(Call(stage=emitter, options=None, plugin=catalog.plugin_of(emitter)), "check"):
        expansion = expansion or Expansion()
        unused = expansion.arguments if checks.finds_packages else expansion != Expansion()
        if unused and not has_macros(emitter):
            raise ConfigError(say("format-without-macros", Mark(file=str(file)), format=emitter.name))
        found = a_record(checks.check(file, expansion), Inspection)
        if ask and checks.ask is not None:
            found = a_record(checks.ask(catalog, emitter, file, expansion, found), Inspection)
        return found


def emitter_of(catalog: Catalog, file: Path, name: str | None, choice: str) -> Emitter[Any]:
    """The emitter of a format, or that of a file's suffix."""
    return catalog.get("emitter", name) if name else catalog.emitter_for(file, f"{choice} says what it is")


def has_macros(emitter: Stage) -> bool:
    """Whether files of an emitter hold macros."""
    reads = emitter.can(ReadsForeign)
    return reads is not None and reads.has_macros
