"""Tables of robot descriptions: read by the reader of the format, shown to people, written and read back."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.commands.choices import chosen_reader, stage_calls
from dh2urdf.commands.written import left_out
from dh2urdf.conversion.file_endings import table_writer
from dh2urdf.conversion.one_manipulator import in_format, read_items
from dh2urdf.documents.text_files import encoded
from dh2urdf.errors import ConfigError, TableError
from dh2urdf.fields import replace_unchecked
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.whole_files import refuse_inputs, write_whole
from dh2urdf.plugin_system.calls import a_record, blaming, default_call
from dh2urdf.source import Mark, Messages, Problem, listed
from dh2urdf.stages import Reader, ReadsDescriptions, Rejected
from dh2urdf.table_text.texts import table_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.plugin_system.catalog import Catalog

say = Messages(__file__)


REWRITES = "in_convention"
"""The option of readers of tables that gives the same arm in a convention, with other rows."""


def description_reader(
    catalog: Catalog,
    path: Path,
    mark: Mark,
    *,
    reader: str | None = None,
    given: Mapping[str, str | None] | None = None,
    settings: Iterable[str] = (),
) -> Call[Reader[Any]]:
    """The reader of a robot description, with its options; the arguments are those of `choices.reader_call`."""
    stage = chosen_reader(catalog, path, reader, mark)
    is_table = stage.can(ReadsDescriptions) is None
    if is_table and REWRITES in stage.options.__dataclass_fields__:
        given = {REWRITES if key == "convention" else key: word for key, word in (given or {}).items()}
    elif is_table:
        names = [item.stage.name for item in catalog.provided("reader") if item.stage.can(ReadsDescriptions)]
        raise ConfigError(say("reader-extracts-nothing", mark, found=str(path), reader=stage.name, formats=names))
    if given and "arguments" in given and "arguments" not in stage.options.__dataclass_fields__:
        raise ConfigError(say("format-without-macros", Mark(file=str(path)), format=stage.name))
    (call,) = stage_calls(catalog, {"reader": [stage]}, mark, {"reader": dict(given or {})}, settings)["reader"]
    return call


def leaves_of(call: Call[Reader[Any]], path: Path) -> Mapping[str, int]:
    """The links at the ends of a description's chains, each with the number of moving joints before it."""
    describes = call.stage.can(ReadsDescriptions)
    if describes is None:
        raise TypeError(call.stage.name)
    with blaming(call, "leaves"):
        return a_record(describes.leaves(path, call.options), dict)


class Chains(NamedTuple):
    """The manipulators of a description's chains, one at least, and the chains that have no table, with the reasons."""

    arms: list[Manipulator]
    refused: list[Rejected]


def chains_of(call: Call[Reader[Any]], path: Path) -> Chains:
    """The chains that are meant, as manipulators; a TableError where there is none, or none of them has a table."""
    items = list(read_items(call, path))
    arms = [item for item in items if isinstance(item, Manipulator)]
    refused = [item for item in items if isinstance(item, Rejected)]
    if arms:
        return Chains(arms, refused)
    problems = [problem.about(robot=item.name) for item in refused for problem in item.problems]
    notices = [notice for item in refused for notice in item.notices]
    raise TableError(problems or say("no-chain", Mark(file=str(path))), notices)


def the_one(call: Call[Reader[Any]], path: Path) -> Manipulator:
    """The manipulator of the one chain that is meant; a TableError where there are several."""
    arms, refused = chains_of(call, path)
    if len(arms) == 1 and not refused:
        return arms[0]
    raise TableError(say("several-chains", Mark(file=str(path)), field="tip_link", count=len(arms) + len(refused)))


def write_extracted(
    arms: Sequence[Manipulator],
    out: Path,
    catalog: Catalog,
    *,
    inputs: Iterable[Path],
    length_unit: str = "m",
    angle_unit: str = "rad",
) -> tuple[Problem, ...]:
    """Write the tables of descriptions, with what is known of them in comments above, once they read back as the same.

    The suffix of `out` chooses the format; none of the inputs is overwritten. What the format has no place for, and
    names that are others there, are returned as notices.
    """
    call = default_call(catalog, table_writer(catalog, out, Mark(file=str(out))))
    renamed: list[Problem] = []
    arms = [_without_numbers(arm, renamed) for arm in arms]
    texts = [table_text(arm, length_unit, angle_unit, folder=out.parent) for arm in arms]
    lines: list[str] = []
    for arm in arms:  # What is known of a table, with names of the description: no reader reads such comments.
        source = f"of {Path(arm.mark.file).name}" if arm.mark else ""
        lines += [f"{arm.name} {source}".strip(), *(notice.message for notice in arm.notices)]
    # No part of a comment is a cell that a spreadsheet computes.
    plain = (re.sub("([,;])(?=[=+@-])", r"\1 ", " ".join(line.split())) for line in lines)
    content = encoded("".join(f"#> {line}\n" for line in plain)) + in_format(texts, call).content
    lost = left_out(arms, content, call, str(out))
    refuse_inputs([out], inputs)
    write_whole(out, content)
    return (*renamed, *lost)


def _without_numbers(arm: Manipulator, notices: list[Problem]) -> Manipulator:
    """A manipulator whose joints and links have no numbers for names: a table takes 1, 2, 3 for those of its rows."""
    for field in ("joint", "link"):
        names = [getattr(row, field) for row in arm.rows]
        if not names or not all(name.isascii() and name.isdecimal() for name in names):
            continue
        others = [f"{field}_{name}" for name in names]
        about = {"robot": arm.name, "field": field, "names": listed(names), "others": listed(others)}
        notices.append(notice := say("names-are-numbers", arm.mark, **about))
        rows = tuple(replace_unchecked(row, **{field: name}) for row, name in zip(arm.rows, others, strict=True))
        arm = replace_unchecked(arm, rows=rows, notices=(*arm.notices, notice))
    return arm
