"""What the ending of a file's name promises, where the file is to be written."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ConfigError, InputError, PluginError, TableError
from dh2urdf.source import Messages, Problem
from dh2urdf.stages import WritesTables

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.source import Mark
    from dh2urdf.stages import Emitter, Reader

say = Messages(__file__)


def table_writer(catalog: Catalog, file: Path, mark: Mark) -> Reader[Any]:
    """Return the reader that writes tables like a file.

    Raises:
        TableError: no reader writes such tables.
    """
    stages: list[Any] = [provided.stage for provided in catalog.provided("reader")]
    suffixes = [suffix for stage in stages if stage.can(WritesTables) for suffix in _written(stage)]
    if not file.name.lower().endswith(tuple(suffixes)):
        raise TableError(say("no-writer-of-tables", mark, found=str(file), name=file.name, suffixes=suffixes))
    return catalog.reader_for(file)


def notices_of_ending(catalog: Catalog, file: Path, chosen: Emitter[Any], option: str, mark: Mark) -> list[Problem]:
    """Return a notice of a file whose name is that of another format than an option asks for."""
    named = _stage(catalog.emitter_for, file)
    if named in (None, chosen):
        return []
    about = {"name": file.name, "named": named.name, "chosen": chosen.name}
    return [say("name-of-other-emitter", mark, field="out", option=option, suffix=chosen.suffixes[0], **about)]


def refuse_other_ending(catalog: Catalog, file: Path, stage: Reader[Any] | Emitter[Any], mark: Mark) -> None:
    """Refuse a file whose name is that of another format than what it would hold; names of no format pass.

    Raises:
        ConfigError: it is.
    """
    suffixes = _written(stage)
    if file.name.lower().endswith(suffixes):
        return
    if _stage(catalog.reader_for, file) or _stage(catalog.emitter_for, file):
        about = {"name": file.name, "format": stage.name, "suffixes": " or ".join(suffixes)}
        raise ConfigError(say("name-of-other-format", mark, field="out", found=str(file), **about))


def _written(stage: Reader[Any] | Emitter[Any]) -> tuple[str, ...]:
    writes = stage.can(WritesTables)
    return tuple([suffix for suffix in stage.suffixes if writes is None or suffix not in writes.not_written])


def _stage(find: Callable[[Path], Any], file: Path) -> Any:  # noqa: ANN401 - a reader or an emitter
    """Return the stage that has the suffix of a file; None where none has it, or several."""
    try:
        return find(file)
    except (InputError, PluginError):
        return None
