"""The reference of run files and reports, from their JSON Schemas: a table of keys for each kind of mapping."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dh2urdf.report.schema import manifest_schema, report_schema
from dh2urdf.run_file.schema import run_schema
from pieces import code, prose, table
from stage_pages import built_in

if TYPE_CHECKING:
    from collections.abc import Iterator

Schema = dict[str, Any]
NULL = {"type": "null"}
WORDS = {
    "array": "a list",
    "boolean": "true or false",
    "integer": "a whole number",
    "null": "null",
    "number": "a number",
    "object": "a mapping",
    "string": "a text",
}


def run_file() -> str:
    """The sections of a run file, and the keys of each."""
    return Tables(run_schema(built_in()), written_by_people=True).text()


def report() -> str:
    """The keys of `report.json`; its rows are those of the manifest."""
    return Tables({**report_schema(), "$defs": {"row": {"type": "object"}}}).text()


def manifest() -> str:
    """The keys of a row of the manifest, and of what is in it."""
    return Tables(manifest_schema()).text()


@dataclass(frozen=True)
class Tables:
    """A schema as tables.

    Attributes:
        root: the schema.
        written_by_people: whether people write such files: they want to know which keys they need, and a null there
            is only an empty line. Readers of files that this program writes want to know which keys may be missing.
    """

    root: Schema
    written_by_people: bool = False

    def text(self) -> str:
        """A table of the outermost mapping, then a heading and a table for every mapping in it."""
        return "\n\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        found: list[tuple[str, Schema]] = [("", self.root)]
        for path, mapping in found:  # It grows while it is gone through.
            if path:
                yield f"### {code(path)}"
            yield table(("key", "takes" if self.written_by_people else "holds", "says"), self._rows(mapping))
            for key, value in mapping["properties"].items():
                for inner in self._mappings(value):
                    if all(inner is not known and inner != known for _, known in found):
                        found.append((f"{path}.{key}".strip("."), inner))

    def _rows(self, mapping: Schema) -> Iterator[tuple[str, str, str]]:
        for key, value in mapping["properties"].items():
            needed = key in mapping.get("required", ())
            remark = (" (required)" if needed else "") if self.written_by_people else ("" if needed else " (optional)")
            resolved = self._resolved(value)
            says = prose(value.get("description") or resolved.get("description", ""))
            if "default" in resolved:
                says += f"; {code(json.dumps(resolved['default'], ensure_ascii=False))} by default"
            takes = "a mapping: the [options](stages.md) of the stage" if key == "options" else self._takes(value)
            yield code(key) + remark, takes, says

    def _resolved(self, schema: Schema) -> Schema:
        """What a reference leads to; where a value is of one kind or null, that kind."""
        if "$ref" in schema:
            return self._resolved(self.root["$defs"][schema["$ref"].removeprefix("#/$defs/")])
        kinds = [each for each in schema.get("anyOf", ()) if each != NULL]
        return self._resolved(kinds[0]) if len(kinds) == 1 else schema

    def _mappings(self, schema: Schema) -> Iterator[Schema]:
        """The mappings with keys of their own that a value may be or hold."""
        schema = self._resolved(schema)
        if "properties" in schema:
            yield schema
        entries = [schema.get("items"), schema.get("additionalProperties")]
        for inner in (*schema.get("anyOf", ()), *(entry for entry in entries if isinstance(entry, dict))):
            yield from self._mappings(inner)

    def _takes(self, schema: Schema) -> str:
        """What a value may be, in words."""
        kinds = [each for each in schema.get("anyOf", ()) if each != NULL]
        words = list(dict.fromkeys(map(self._takes, kinds))) if kinds else [self._plain(schema)]
        if len(words) > 1 and words[-1] == f"a list, each {' or '.join(words[:-1])}":
            words[-1] = "a list of these"
        if NULL in schema.get("anyOf", ()) and not self.written_by_people:
            words.append("null")
        return " or ".join(words)

    def _plain(self, schema: Schema) -> str:
        """What a value of one kind may be."""
        schema = self._resolved(schema)
        if "const" in schema or "enum" in schema:
            # Every stage has a second name, with its distribution: the page explains that once.
            values = [value for value in schema.get("enum", [schema.get("const")]) if ":" not in str(value)]
            return " or ".join(map(code, values))
        kinds = schema.get("type", "object")
        if kinds == "array":
            return f"a list, each {self._takes(schema['items'])}"
        if isinstance(more := schema.get("additionalProperties"), dict):
            return f"a mapping of names, each to {self._takes(more)}"
        return " or ".join(WORDS[kind] for kind in ([kinds] if isinstance(kinds, str) else kinds))
