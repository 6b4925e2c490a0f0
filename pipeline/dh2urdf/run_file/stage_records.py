"""Stages and inputs as a run file has them: a name and its options, or a name alone.

Which names and options there are depends on what is installed: the JSON Schemas ask the catalog.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from dh2urdf.errors import ConfigError, UnknownStageError
from dh2urdf.run_file.records import InputCall, StageCall
from dh2urdf.run_file.validator import JsonSchema, Key, Record, mapping_node
from dh2urdf.run_file.value_types import INPUT_FILES, OPTIONS, PATH_NODE, TEXT, FoundFiles
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from dh2urdf.documents.document import Node
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Kind

NO_STAGE = ("it is not said which stage is meant", "`stage: NAME`")
NO_PATH = ("this input has no path", "`path: FILE`, where FILE may be a pattern")


class StageRecord(Record[StageCall]):
    """A stage of one kind with its options."""

    def __init__(self, kind: Kind, what: str, *, is_named: bool = False, **others: Key) -> None:
        """Declare a stage.

        Args:
            kind: its kind.
            what: what such a stage does.
            is_named: whether it must be named, for none is usual.
            others: keys besides its name and its options.
        """
        self.kind, self.is_named = kind, is_named
        keys = {
            "stage": Key(TEXT, what, missing=NO_STAGE if is_named else None),
            "options": Key(OPTIONS, is_vital=False),
            **others,
        }
        super().__init__(StageCall, keys, short="stage", marks={"mark": ("stage", "")})

    def schema(self, catalog: Catalog) -> JsonSchema:
        """A call or a name, for the stages of its kind."""
        names, call = super().schema(catalog)["anyOf"]
        named = stage_names(catalog, self.kind)
        usual = None if self.is_named else usual_name(catalog, self.kind)
        names = call["properties"]["stage"] = {"enum": all_of(named), "description": names["description"]}
        conditions = [
            _if_then({"properties": {"stage": {"enum": own}}}, f"{self.kind}.{own[0]}", named=usual not in own)
            for own in named.values()
        ]
        call |= {"allOf": conditions} if conditions else {}
        if usual is None and not self.is_named:
            call["required"] = ["stage"]
        return {"anyOf": [names, call]}


def _input(
    path: FoundFiles,
    stage: str | None = None,
    options: Node | None = None,
    calibration: Node | None = None,
    mark: Mark | None = None,
) -> InputCall:
    """An input, with its calibration among the options of its reader."""
    if calibration is not None:
        others = options.value if options and isinstance(options.value, dict) else {}
        if "calibration" in others:
            message = "the calibration is given twice, here and among the options"
            raise ConfigError(Problem(message=message, field="calibration"))
        options = mapping_node({**others, "calibration": calibration}, options or calibration)
    return InputCall(
        paths=path.paths, stage=stage, options=options, mark=mark, notices=path.notices, pattern=path.pattern
    )


class InputRecord(Record[InputCall]):
    """An input: its reader is named, or goes by the suffix of the path."""

    def __init__(self) -> None:
        keys = {
            "path": Key(INPUT_FILES, "a table, or a pattern such as tables/*.csv", missing=NO_PATH, is_vital=False),
            "stage": Key(TEXT, "the reader; by the path's suffix if absent", is_vital=False),
            "options": Key(OPTIONS, is_vital=False),
            "calibration": Key(
                PATH_NODE,
                "differences that are added to the rows: a calibration.conf, or a table of them",
                is_vital=False,
            ),
        }
        super().__init__(_input, keys, short="path", marks={"mark": ("stage", "path")})

    def schema(self, catalog: Catalog) -> JsonSchema:
        """An input or a path, for the readers that are installed."""
        path, call = super().schema(catalog)["anyOf"]
        named = stage_names(catalog, "reader")
        call["properties"]["stage"] = {"enum": all_of(named), "description": self.keys["stage"].help}
        call["allOf"] = []
        for item in catalog.provided("reader"):
            by_name = {"properties": {"stage": {"enum": named[item.full_name]}}, "required": ["stage"]}
            suffixes = "|".join(suffix.replace(".", r"\.") for suffix in getattr(item.stage, "suffixes", ()))
            by_suffix = {"properties": {"path": {"pattern": f"({suffixes})$"}}, "not": {"required": ["stage"]}}
            condition = {"anyOf": [by_name, by_suffix]} if suffixes else by_name
            call["allOf"].append(_if_then(condition, f"reader.{named[item.full_name][0]}", named=False))
        return {"anyOf": [path, call]}


def stage_names(catalog: Catalog, kind: Kind) -> dict[str, list[str]]:
    """How each stage of a kind may be named, by its full name: its own name does where that chooses it."""
    chosen = {name: item.full_name for name, item in catalog.by_name(kind).items()}
    names = {item.full_name: item.stage.name for item in catalog.provided(kind)}
    return {
        full_name: [name, full_name] if chosen.get(name) == full_name else [full_name]
        for full_name, name in names.items()
    }


def usual_name(catalog: Catalog, kind: Kind) -> str | None:
    """The name of the stage that is taken where none is named; None where every plugin that has one is left out."""
    with suppress(UnknownStageError):
        return catalog.usual(kind).name
    return None


def all_of(named: dict[str, list[str]]) -> list[str]:
    """All names, the short ones first: what an editor proposes."""
    return sorted({name for names in named.values() for name in names}, key=lambda name: (":" in name, name))


def _if_then(condition: JsonSchema, definition: str, *, named: bool) -> JsonSchema:
    if named:
        condition = {**condition, "required": ["stage"]}
    options = {"anyOf": [{"$ref": f"#/$defs/{definition}"}, {"type": "null"}]}
    return {"if": condition, "then": {"properties": {"options": options}}}
