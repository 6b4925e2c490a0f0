"""What is to be said of a robot description of any origin: the work of `dh2urdf check`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.attribution import Call, a_record, depending_on
from dh2urdf.errors import ConfigError
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.stages import Expansion, Inspection

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from dh2urdf.registry import Catalog
    from dh2urdf.stages import Emitter


def inspect(
    catalog: Catalog, file: Path, format_name: str | None, choice: str, expansion: Expansion | None = None
) -> Inspection:
    """What the emitter of a file's format says of it.

    Args:
        catalog: the emitters that there are.
        file: a robot description.
        format_name: the name of its format; by the suffix of the file where it is None.
        choice: how a format is named, for messages.
        expansion: how it is expanded, where it holds macros.

    Raises:
        ConfigError: files of the format cannot be checked, or hold no macros that could be expanded.
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
        return a_record(emitter.check(file, *expanded_with(emitter, expansion, file)), Inspection)


def expanded_with(emitter: Emitter[Any], expansion: Expansion | None, file: Path) -> tuple[Expansion, ...]:
    """What an emitter's functions that read a file of any origin are given beside the file.

    Raises:
        ConfigError: the format knows no macros, and something was said of their expansion.
    """
    if emitter.expandable:
        return (expansion or Expansion(),)
    if expansion in (None, Expansion()):
        return ()
    raise ConfigError(
        Problem(
            message=f"files of the format {emitter.name!r} have no macros: they take no arguments and no package paths",
            mark=Mark(file=str(file)),
            accepted="NAME:=VALUE and package paths with a xacro",
        )
    )


def given_arguments(words: Iterable[str], mark: Mark) -> dict[str, str]:
    """Arguments of a description as ROS writes them, ``NAME:=VALUE``.

    Raises:
        ConfigError: a word is no such argument, or one is given twice.
    """
    found: dict[str, str] = {}
    problems: list[Problem] = []
    for word in words:
        name, sign, value = word.partition(":=")
        if not sign or not name.strip() or name in found:
            message = "is given twice" if sign and name in found else "is no argument"
            problems.append(
                Problem(message=f"{shown(word)} {message}", mark=mark, accepted="NAME:=VALUE, each name once")
            )
        found[name.strip()] = value
    if problems:
        raise ConfigError(problems)
    return found
