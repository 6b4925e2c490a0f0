"""What the ending of a file's name promises, where the file is to be written."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ConfigError, InputError, PluginError, TableError
from dh2urdf.source import Problem, shown
from dh2urdf.stages import WritesTables

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.source import Mark
    from dh2urdf.stages import Emitter, Reader


def table_suffixes(catalog: Catalog) -> list[str]:
    """The suffixes of tables that readers write."""
    stages: list[Any] = [provided.stage for provided in catalog.provided("reader")]
    return [suffix for stage in stages if stage.can(WritesTables) for suffix in _written(stage)]


def table_writer(catalog: Catalog, file: Path, mark: Mark) -> Reader[Any]:
    """The reader that writes tables like a file.

    Raises:
        TableError: no reader writes such tables.
    """
    suffixes = table_suffixes(catalog)
    if not _ends(file, suffixes):
        message = f"no reader writes tables like {shown(file.name)}"
        accepted = f"a file name that ends in {', '.join(suffixes)}"
        raise TableError(Problem(message=message, mark=mark, found=str(file), accepted=accepted))
    return catalog.reader_for(file)


def names_no_format(file: Path, emitter: Emitter[Any]) -> ConfigError:
    """The error that the suffix of a file says none of the several formats that an emitter writes."""
    message = f"{shown(file.name)} names none of the formats that the emitter {emitter.name!r} writes"
    accepted = f"a name that ends in {', '.join(emitter.suffixes)}"
    return ConfigError(Problem(message=message, found=str(file), accepted=accepted))


def notices_of_ending(catalog: Catalog, file: Path, chosen: Emitter[Any], option: str, mark: Mark) -> list[Problem]:
    """A notice of a file whose name is that of another format than an option asks for."""
    try:
        named = catalog.emitter_for(file)
    except (InputError, PluginError):  # the suffix says no format, or not which
        return []
    if named is chosen:
        return []
    message = f"{shown(file.name)} is the name of a file in the format {named.name}, and it holds {chosen.name}"
    suggestion = f"leave out {option}, or choose a name that ends in {chosen.suffixes[0]}"
    return [Problem(message=message, severity="notice", mark=mark, field="out", suggestion=suggestion)]


def refuse_other_ending(catalog: Catalog, file: Path, stage: Reader[Any] | Emitter[Any], mark: Mark) -> None:
    """Refuses a file whose name is that of another format than what it would hold; names of no format pass.

    Raises:
        ConfigError: it is.
    """
    suffixes = _written(stage)
    if not _ends(file, suffixes) and any(_known(catalog, kind, file) for kind in ("reader", "emitter")):
        message = f"{shown(file.name)} is the name of a file in another format than {stage.name}, which is written"
        accepted = f"a name that ends in {' or '.join(suffixes)}"
        raise ConfigError(Problem(message=message, mark=mark, field="out", found=str(file), accepted=accepted))


def _written(stage: Reader[Any] | Emitter[Any]) -> tuple[str, ...]:
    writes = stage.can(WritesTables)
    return tuple([suffix for suffix in stage.suffixes if writes is None or suffix not in writes.not_written])


def _ends(file: Path, suffixes: Iterable[str]) -> bool:
    return file.name.lower().endswith(tuple(suffixes))


def _known(catalog: Catalog, kind: str, file: Path) -> bool:
    """Whether a stage of a kind has the suffix of a file."""
    find = catalog.reader_for if kind == "reader" else catalog.emitter_for
    try:
        find(file)
    except (InputError, PluginError):  # several have it, or none
        return False
    return True
