"""What the studio hands over: tables, robot descriptions, a run file, all of it in a zip.

Everything goes through the functions of the command line, so that what is handed over is byte by byte what
`dh2urdf convert` and `dh2urdf run` make of the saved table.
"""

from __future__ import annotations

import io
import re
import tempfile
import zipfile
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.commands.convert import POSES, Planned, as_named, in_one_file
from dh2urdf.commands.written_tables import in_format
from dh2urdf.conversion.one_manipulator import Recipe
from dh2urdf.errors import EmitterError
from dh2urdf.kinematics.proof import Proof
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.source import Mark
from dh2urdf.stage_calls.calls import Call, default_call
from dh2urdf.stages import Emitter, OtherFiles, WritesFolders, WritesTables
from dh2urdf.table_text import NAMES, yaml_word
from dh2urdf_studio.editing.reading import transform_call, variant_options

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText

_COMMA = re.compile(r"^([-+−]?[0-9]*),(?=[0-9]+(?:[eE][-+]?[0-9]+)?[^0-9,]*$)")
"""The comma of a cell that is a number with a decimal comma, with or without a unit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Saved:
    """A file to hand over.

    Attributes:
        name: its name.
        content: what is in it.
        proof: how far it is from the DH product, where it is a robot description.
    """

    name: str
    content: bytes
    proof: Proof | None = None


def table_file(table: TableText, format_name: str, catalog: Catalog) -> Saved:
    """A table in the format of a reader.

    Raises:
        InputError: no such reader is installed, or it only reads.
    """
    reader = catalog.get("reader", format_name)
    if reader.name != catalog.cell_reader().name:
        table = _with_points(table)
    written = in_format([table], default_call(catalog, reader))
    return Saved(name=f"{safe_stem(table.name or 'arm')}{reader.suffixes[0]}", content=written.content)


def _with_points(table: TableText) -> TableText:
    """A table without decimal commas, which only the reader of cells takes."""
    rows = (
        {field: text if field in NAMES else _COMMA.sub(r"\1.", text) for field, text in row.items()}
        for row in table.rows
    )
    return replace(table, rows=tuple(rows))


def table_formats(catalog: Catalog) -> tuple[str, ...]:
    """The formats in which tables can be saved, by the names of their readers."""
    return tuple(item.stage.name for item in catalog.provided("reader") if item.stage.can(WritesTables))


def robot_formats(catalog: Catalog) -> tuple[str, ...]:
    """The formats in which a robot can be saved as a file, by the names of their emitters."""
    return tuple(stage.name for stage in _emitters_of_files(catalog) if not _for_suffix(stage))


def other_suffixes(catalog: Catalog) -> tuple[str, ...]:
    """The suffixes of files in which tables are saved for people and other programs, by emitters of many formats."""
    readable = {suffix for name in table_formats(catalog) for suffix in catalog.get("reader", name).suffixes[:1]}
    found: list[str] = []
    for stage in _emitters_of_files(catalog):
        if for_suffix := _for_suffix(stage):
            given = stage.options()
            seen = [for_suffix(given, suffix) for suffix in stage.suffixes if suffix in readable]
            for suffix in stage.suffixes:
                if (options := for_suffix(given, suffix)) not in seen:
                    seen.append(options)
                    found.append(suffix)
    return tuple(found)


def _emitters_of_files(catalog: Catalog) -> list[Emitter[Any]]:
    stages = [item.stage for item in catalog.provided("emitter")]
    return [stage for stage in stages if isinstance(stage, Emitter) and not stage.can(WritesFolders)]


def _for_suffix(stage: Emitter[Any]) -> Callable[[Any, str], Any] | None:
    others = stage.can(OtherFiles)
    return others.for_suffix if others else None


def robot_file(table: TableText, format_name: str, variant: str, catalog: Catalog) -> Saved:
    """The robot of a table as one file: the bytes of `dh2urdf convert TABLE --to FORMAT` on standard output.

    Raises:
        InputError: the table is not right, or no such emitter is installed.
        ManipulatorError: no file could be made, or it is not the arm of the table.
    """
    call = in_one_file(default_call(catalog, catalog.get("emitter", format_name)))
    (saved, *_) = _make(table, [call], variant, catalog)
    return saved


def other_file(table: TableText, suffix: str, variant: str, catalog: Catalog) -> Saved:
    """A table for people or other programs: the bytes of `dh2urdf convert TABLE -o FILE` with this suffix.

    Raises:
        InputError: the table is not right, or no emitter has the suffix.
        ManipulatorError: the format cannot hold the table.
    """
    call = as_named(default_call(catalog, catalog.emitter_for(Path(f"arm{suffix}"))), Path(f"arm{suffix}"))
    (saved, *_) = _make(table, [call], variant, catalog)
    return saved


def all_files(table: TableText, variant: str, catalog: Catalog) -> tuple[Saved, ...]:
    """The table in every format, the run file, and what `dh2urdf run` makes of it.

    A format that cannot hold the table is left out.

    Raises:
        InputError: the table is not right.
        ManipulatorError: no robot description could be made, or it is not the arm of the table.
    """
    emitters = [catalog.get("emitter", name) for name in robot_formats(catalog)]
    tables = [table_file(table, name, catalog) for name in table_formats(catalog)]
    made = _make(table, [default_call(catalog, emitter) for emitter in emitters], variant, catalog)
    others: list[Saved] = []
    for suffix in other_suffixes(catalog):
        with suppress(EmitterError):
            others.append(other_file(table, suffix, variant, catalog))
    return (*tables, *others, run_file(table, variant, catalog), *made)


def run_file(table: TableText, variant: str, catalog: Catalog) -> Saved:
    """A run file that does with the saved table what the studio does."""
    saved = table_file(table, catalog.cell_reader().name, catalog)
    transform = catalog.usual("transform")
    options = ", ".join(f"{name}: {word}" for name, word in variant_options(transform, variant).items())
    lines = [
        f"inputs: {yaml_word(saved.name)}",
        f"transform: {{stage: {transform.name}, options: {{{options}}}}}",
        "emitters:",
        *(f"  - {{stage: {name}}}" for name in robot_formats(catalog)),
        f"output: {{directory: {yaml_word('build/' + Path(saved.name).stem)}}}",
        "",
    ]
    return Saved(name=f"{Path(saved.name).stem}_run.yaml", content="\n".join(lines).encode())


def zipped(files: Sequence[Saved]) -> bytes:
    """Files in a zip, the same bytes for the same files."""
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            entry = zipfile.ZipInfo(file.name)  # dated 1980, as nothing else is always the same
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, file.content)
    return written.getvalue()


def _make(table: TableText, emitters: Sequence[Call[Emitter[Any]]], variant: str, catalog: Catalog) -> list[Saved]:
    """The files of some emitters, made as `dh2urdf convert` makes them of the saved table."""
    reader = default_call(catalog, catalog.cell_reader())
    recipe = Recipe(transform=transform_call(catalog, variant), emitters=tuple(emitters), poses=POSES)
    with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
        saved = table_file(table, reader.stage.name, catalog)
        path = Path(folder) / saved.name
        path.write_bytes(saved.content)
        made = Planned(
            table=path, target=None, reader=reader, recipe=recipe, mark=Mark(file="dh2urdf studio")
        ).carry_out()
    return [
        Saved(name=file.name, content=file.content, proof=emitted.proof if file is emitted.files[0] else None)
        for emitted in made.written
        for file in emitted.files
    ]
