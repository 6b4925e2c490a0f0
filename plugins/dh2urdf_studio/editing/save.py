"""What the studio hands over: tables, robot descriptions, a run file, all of it in a zip.

Everything goes through the functions of the command line, so that what is handed over is byte by byte what
`dh2urdf convert` and `dh2urdf run` make of the saved table.
"""

from __future__ import annotations

import io
import json
import re
import tempfile
import zipfile
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dh2urdf.commands.convert import POSES, as_named, carry_out, in_one_file
from dh2urdf.conversion.one_manipulator import Recipe, in_format
from dh2urdf.errors import EmitterError, ProofError
from dh2urdf.meshes.files import FILE, FOLDER, RELATIVE, prefix_of
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.plugin_system.calls import default_call
from dh2urdf.plugin_system.options import plain
from dh2urdf.stages import Compares, Edit, Emitter, OtherFiles, WritesFolders, WritesTables
from dh2urdf.table_text import NAMES
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_studio.editing.reading import STUDIO, transform_call

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.kinematics.proof import Proof
    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText

    Changes: TypeAlias = Sequence[Call[Edit[Any]]]
    """Edits of the arm, read already: the file of an attachment may have changed since it was drawn."""

_COMMA = re.compile(r"^([-+−]?[0-9]*),(?=[0-9]+(?:[eE][-+]?[0-9]+)?[^0-9,]*$)")
"""The comma of a cell that is a number with a decimal comma, with or without a unit."""


class Saved(NamedTuple):
    """A file to hand over."""

    name: str
    content: bytes
    proof: Proof | None = None  # how far it is from the DH product, where it is a robot description
    missing: tuple[str, ...] = ()  # the suffixes of files that are not in a zip of everything that can be made


def savings(catalog: Catalog) -> Iterator[tuple[str, str, str]]:
    """What can be saved: its kind, the format, and what the menu calls it."""
    yield from (("table", name, f"Table as {name}") for name in table_formats(catalog))
    yield from (("other", suffix, f"Table as {suffix}") for suffix in other_suffixes(catalog))
    yield from (("robot", name, f"Robot as {name}") for name in robot_formats(catalog))
    yield "run", "", "Run file"
    yield "all", "", "Everything, as a zip"


def saved(  # noqa: PLR0917 - of what, in which form
    table: TableText, kind: str, name: str, variant: str, catalog: Catalog, changes: Changes = ()
) -> Saved:
    """One of the `savings` of a table, or of its arm with some edits.

    Raises:
        InputError: the table or an edit is not right, or the stage is not installed or cannot do so.
        ManipulatorError: the format cannot hold the table, or what was made is not its arm.
    """
    match kind:
        case "table":
            return table_file(table, name, catalog)
        case "other":
            return other_file(table, name, variant, catalog, changes)
        case "robot":
            # The bytes of `dh2urdf convert TABLE --to FORMAT` on standard output.
            call = in_one_file(default_call(catalog, catalog.get("emitter", name)))
            return _make(table, [call], variant, catalog, changes)[0]
        case "run":
            return run_file(table, variant, catalog, changes)
    files = all_files(table, variant, catalog, changes)
    there = {Path(file.name).suffix for file in files}
    missing = tuple(suffix for suffix in other_suffixes(catalog) if suffix not in there)
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            entry = zipfile.ZipInfo(file.name)  # dated 1980, as nothing else is always the same
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, file.content)
    return Saved(f"{Path(files[0].name).stem}.zip", written.getvalue(), missing=missing)


def table_file(table: TableText, format_name: str, catalog: Catalog) -> Saved:
    """A table in the format of a reader, which is installed and does not only read."""
    reader = catalog.get("reader", format_name)
    if reader.name != catalog.cell_reader().name:  # which alone takes decimal commas
        rows = (
            {field: text if field in NAMES else _COMMA.sub(r"\1.", text) for field, text in row.items()}
            for row in table.rows
        )
        table = replace(table, rows=tuple(rows))
    written = in_format([table], default_call(catalog, reader))
    return Saved(f"{safe_stem(table.name or 'arm')}{reader.suffixes[0]}", written.content)


def table_formats(catalog: Catalog) -> tuple[str, ...]:
    """The formats in which tables can be saved, by the names of their readers."""
    return tuple(item.stage.name for item in catalog.provided("reader") if item.stage.can(WritesTables))


def robot_formats(catalog: Catalog) -> tuple[str, ...]:
    """The formats in which a robot can be saved as a file, by the names of their emitters."""
    emitters = _emitters_of_files(catalog)
    return tuple(stage.name for stage in emitters if (others := stage.can(OtherFiles)) is None or not others.for_suffix)


def other_suffixes(catalog: Catalog) -> tuple[str, ...]:
    """The suffixes of files in which tables are saved for people and other programs, by emitters of many formats."""
    readable = {suffix for name in table_formats(catalog) for suffix in catalog.get("reader", name).suffixes[:1]}
    found: list[str] = []
    for stage in _emitters_of_files(catalog):
        others = stage.can(OtherFiles)
        if others is None or others.for_suffix is None:
            continue
        given = stage.options()
        seen = [others.for_suffix(given, suffix) for suffix in stage.suffixes if suffix in readable]
        for suffix in stage.suffixes:
            if (options := others.for_suffix(given, suffix)) not in seen:
                seen.append(options)
                found.append(suffix)
    return tuple(found)


def _emitters_of_files(catalog: Catalog) -> list[Emitter[Any]]:
    stages = [item.stage for item in catalog.provided("emitter")]
    return [stage for stage in stages if isinstance(stage, Emitter) and not stage.can(WritesFolders)]


def other_file(table: TableText, suffix: str, variant: str, catalog: Catalog, changes: Changes = ()) -> Saved:
    """A table for people or other programs: the bytes of `dh2urdf convert TABLE -o FILE` with this suffix."""
    call = as_named(default_call(catalog, catalog.emitter_for(Path(f"arm{suffix}"))), Path(f"arm{suffix}"))
    return _make(table, [call], variant, catalog, changes)[0]


def all_files(table: TableText, variant: str, catalog: Catalog, changes: Changes = ()) -> tuple[Saved, ...]:
    """The table in every format that can hold it, the run file, and what `dh2urdf run` makes of it."""
    emitters = [catalog.get("emitter", name) for name in robot_formats(catalog)]
    tables = [table_file(table, name, catalog) for name in table_formats(catalog)]
    made = _make(table, [default_call(catalog, emitter) for emitter in emitters], variant, catalog, changes)
    others: list[Saved] = []
    for suffix in other_suffixes(catalog):
        with suppress(EmitterError, ProofError):  # a table has no place for what is attached
            others.append(other_file(table, suffix, variant, catalog, changes))
    return (*tables, *others, run_file(table, variant, catalog, changes), *made)


def run_file(table: TableText, variant: str, catalog: Catalog, changes: Changes = ()) -> Saved:
    """A run file that does with the saved table what the studio does."""
    name = table_file(table, catalog.cell_reader().name, catalog).name
    transform = catalog.usual("transform")
    compares = transform.can(Compares)
    options = f"{compares.option}: {variant}" if compares else ""
    lines_of_edits = []
    for call in changes:
        usual, given = plain(call.stage.options()), plain(call.options)
        given = {key: value for key, value in given.items() if key not in usual or value != usual[key]}
        lines_of_edits.append(f"  - {{stage: {call.stage.name}, options: {json.dumps(given, ensure_ascii=False)}}}")
    lines = [
        f"inputs: {yaml_word(name)}",
        f"transform: {{stage: {transform.name}, options: {{{options}}}}}",
        *(["edits:", *lines_of_edits] if changes else ()),
        "emitters:",
        *(f"  - {{stage: {emitter}}}" for emitter in robot_formats(catalog)),
        f"output: {{directory: {yaml_word('build/' + Path(name).stem)}}}",
        "",
    ]
    return Saved(f"{Path(name).stem}_run.yaml", "\n".join(lines).encode())


def _make(
    table: TableText, emitters: Sequence[Call[Emitter[Any]]], variant: str, catalog: Catalog, changes: Changes
) -> list[Saved]:
    """The files of some emitters, made as `dh2urdf convert` makes them of the saved table.

    A single file names meshes where they are; several come with copies.
    """
    reader, is_alone = default_call(catalog, catalog.cell_reader()), len(emitters) == 1
    recipe = Recipe(
        transform=transform_call(catalog, variant),
        emitters=tuple(emitters),
        edits=tuple(changes),
        poses=POSES,
        mesh_prefix=prefix_of(FILE if is_alone else RELATIVE),
    )
    with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
        file = table_file(table, reader.stage.name, catalog)
        path, output = Path(folder) / file.name, Path(folder) / "output"
        path.write_bytes(file.content)
        made = carry_out(path, None if is_alone else output, reader, recipe, STUDIO)
        copies = [Saved(f"{FOLDER}/{mesh.name}", mesh.read_bytes()) for mesh in sorted((output / FOLDER).glob("*"))]
    files = [
        Saved(file.name, file.content, emitted.proof if file is emitted.files[0] else None)
        for emitted in made.written
        for file in emitted.files
    ]
    return [*files, *copies]
