"""What is to be said of a robot description of any origin: the work of `dh2urdf check`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.attribution import Call, depending_on
from dh2urdf.errors import ConfigError
from dh2urdf.source import Mark, Problem
from dh2urdf.stage_answers import a_whole_record
from dh2urdf.stages import Inspection

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.registry import Catalog
    from dh2urdf.stages import Emitter


def inspect(catalog: Catalog, file: Path, format_name: str | None, choice: str) -> Inspection:
    """What the emitter of a file's format says of it.

    Args:
        catalog: the emitters that there are.
        file: a robot description.
        format_name: the name of its format; by the suffix of the file where it is None.
        choice: how a format is named, for messages.

    Raises:
        ConfigError: files of the format cannot be checked.
        BrokenPluginError: the emitter is at fault.
    """
    emitter: Emitter[Any] = (
        catalog.get("emitter", format_name) if format_name else catalog.emitter_for(file, f"{choice} says what it is")
    )
    if emitter.check is None:
        able = [item.stage.name for item in catalog.provided("emitter") if getattr(item.stage, "check", None)]
        raise ConfigError(
            Problem(
                message=f"files of the format {emitter.name!r} cannot be checked",
                mark=Mark(file=str(file)),
                accepted=", ".join(able),
                suggestion=f"{choice} says what the file is, where its suffix does not",
            )
        )
    with depending_on(Call(stage=emitter, options=None, plugin=catalog.plugin_of(emitter)), "check"):
        return a_whole_record(emitter.check(file), Inspection)
