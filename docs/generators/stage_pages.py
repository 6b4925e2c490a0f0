"""The reference of the stages, from the stages themselves: the records that the installed plugins give."""

from __future__ import annotations

from itertools import starmap
from typing import TYPE_CHECKING, Any

from dh2urdf.plugin_system import KINDS, Catalog, Provided, describe_options, load
from dh2urdf.stages import Checks, ReadsBack, WritesTables
from pieces import code, prose, table

if TYPE_CHECKING:
    from collections.abc import Iterator

SECTIONS = {"reader": "inputs", "transform": "transform", "edit": "edits", "emitter": "emitters", "loader": "loaders"}
"""The section of a run file that names stages of a kind; that of executors is `execution`."""


def stages() -> str:
    """A section for each kind of stage, and in it one for each built-in stage with its options."""
    return "\n\n".join(_lines(built_in()))


def built_in() -> Catalog:
    """What the built-in plugin provides: what else is installed on this machine is not of this project's pages."""
    catalog = load()
    own = {
        id(item.plugin): item.plugin
        for kind in KINDS
        for item in catalog.provided(kind)
        if item.plugin.distribution.startswith("dh2urdf ")
    }
    return Catalog(own.values())


def _lines(catalog: Catalog) -> Iterator[str]:
    for kind in KINDS:
        yield f"## {kind.capitalize()}s"
        yield f"Named in the section `{SECTIONS.get(kind, 'execution')}` of a run file."
        for item in catalog.provided(kind):
            yield f"### {item.stage.name} {{ #{kind}-{item.stage.name} }}"
            yield f"{item.stage.summary[0].upper()}{item.stage.summary[1:]}."
            if facts := "; ".join(starmap("{}: {}".format, _facts(item))):
                yield f"{facts[0].upper()}{facts[1:]}."
            yield _options(item.stage.options)


def _facts(item: Provided) -> Iterator[tuple[str, str]]:
    """What the record of a stage says besides its name, its summary and its options."""
    stage: Any = item.stage
    if item.kind == "reader":
        yield "chosen by the suffixes", ", ".join(map(code, stage.suffixes))
        if writes := stage.can(WritesTables):
            yield "written with", ", ".join(code(each) for each in stage.suffixes if each not in writes.not_written)
    elif item.kind == "emitter":
        yield "suffixes of the main file", ", ".join(map(code, stage.suffixes))
        yield "read back and proved", "yes" if stage.can(ReadsBack) else "no"
        yield "`dh2urdf check`", "yes" if stage.can(Checks) else "no"
    elif item.kind == "loader":
        yield "loads files of", ", ".join(map(code, stage.formats))


def _options(options: type[Any]) -> str:
    described = describe_options(options)
    if not described:
        return "It has no options."
    return table(
        ("option", "takes", "default", "what for"),
        ((code(name), takes, code(default), prose(text)) for name, takes, default, text in described),
    )
