"""What every dialect of a known table is made of: files, numbers, and values of YAML in one line."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from known_tables import Table

WORDS = ("index", "joint", "link", "type", "sign", "flip", "limits", "com", "inertia")
"""Fields whose cells are no single quantities; of these, index, sign and flip are written the same in every dialect."""
NUMBER = re.compile(r"-?(0|[1-9][0-9]*)(\.[0-9]+)?(e-?[0-9]+)?")
_SAFE = re.compile(r"[-+.(]?[^\W_][\w .°·²*/()+−-]*(?<! )")
_WORD_OF_YAML = re.compile(r"(?i)true|false|yes|no|on|off|null|~|[-+]?\.?(inf|nan)|[yn]")


@dataclass(frozen=True)
class File:
    """A file, and what describes its dialect in figures."""

    suffix: str
    content: bytes
    dialect: str


def flow(value: Any) -> str:
    """A value of YAML in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{flow(key)}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(flow, value)) + "]"
    if value is None:
        return "null"
    return value if _SAFE.fullmatch(value) and not _WORD_OF_YAML.fullmatch(value) else json.dumps(value)


def statements(table: Table, *, bulk: bool) -> dict[str, Any]:
    """What a file of rows says above them."""
    return table.said if bulk else {"name": table.arms[0].known.name, **table.said}
