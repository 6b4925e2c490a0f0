"""What the bytes of a manipulator's files depend on, as a hash: whether an earlier run's files are still right.

A key covers the manipulator as its table says it, the stages with their options and the versions of their
distributions, what the proof and the sample ask of it, and where its files go. Two runs that give one manipulator the
same key give it the same files and the same row of the manifest.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from hashlib import file_digest, sha256
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from dh2urdf._version import __version__
from dh2urdf.row_fields import COMMON, INERTIA, LIMITS, NUMBERS, WORDS

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.columns import ManipulatorColumns
    from dh2urdf.conversion.one_manipulator import Recipe

DIGITS = 32
"""Hexadecimal digits of a key: 128 bits, so that no two of a million manipulators share one by chance."""


def recipe_key(recipe: Recipe) -> str:
    """The key of all that is done with every manipulator."""
    stages = [
        (call.kind, call.stage.name, call.plugin.distribution if call.plugin else "", whole(call.options))
        for call in recipe.calls
    ]
    files = [(str(path), _hash_of(path)) for call in recipe.calls for path in call.files]
    python = sys.version_info[:2]
    told = (sorted(recipe.optional), sorted(recipe.missing.items()))
    return key_of((python, stages, recipe.poses, recipe.mesh_prefix, recipe.mesh_conversion, told, files), __version__)


def _hash_of(path: Path) -> str | None:
    """The hash of a file that an option names; None where the stage will say that it cannot be read."""
    try:
        with path.open("rb") as file:
            return file_digest(file, "sha256").hexdigest()
    except OSError:
        return None


def column_keys(columns: ManipulatorColumns, recipe: str, contexts: Sequence[object]) -> list[str]:
    """The keys of manipulators that differ in numbers only; where their rows are in a file does not matter.

    Args:
        columns: the manipulators.
        recipe: the key of the recipe.
        contexts: what besides its table counts for each: where it goes, where it comes from, how it is looked at.
    """
    table = columns.table
    numbers: list[Any] = []
    forms: list[Any] = []
    for row in table.rows:
        inertia = [getattr(row.inertia, name) for name in INERTIA] if row.inertia else []
        entries = [*_numbers_of(row), *(row.com or ()), *inertia]
        numbers += [entry for entry in entries if entry is not None]
        given = tuple([entry is not None for entry in entries])
        words = [word.value if isinstance(word, Enum) else word for word in _words_of(row)]
        forms.append((*words, given))
    common = key_of((table.convention.value, _others_of(table), forms, table.notices), recipe)
    rows = zip(columns.names, contexts, _bytes_of(numbers, len(columns)), strict=True)
    return [key_of((name, context), common, row) for name, context, row in rows]


def whole(what: object) -> object:
    """Anything with all that is in it: the text of a record may leave out most, as that of a Manipulator does."""
    if is_dataclass(what) and not isinstance(what, type):
        return type(what).__qualname__, [(field.name, whole(getattr(what, field.name))) for field in fields(what)]
    if isinstance(what, Mapping):
        return [(whole(key), whole(value)) for key, value in what.items()]
    if isinstance(what, (set, frozenset)):
        return sorted(repr(whole(entry)) for entry in what)  # their order is another one in every process
    if isinstance(what, (tuple, list)):
        return [whole(entry) for entry in what]
    return what


def key_of(what: object, recipe: str, numbers: bytes = b"") -> str:
    """The key of anything, by its text, and of numbers by their bytes; `whole` is for records."""
    text = f"{recipe} {what!r}".encode(errors="surrogatepass")
    return sha256(b"%b\0%b" % (text, numbers) if numbers else text).hexdigest()[:DIGITS]


_others_of = attrgetter(*(name for name in COMMON if name not in {"convention", "notices"}))
_words_of = attrgetter(*WORDS)
_numbers_of = attrgetter(*NUMBERS, *(f"limits.{name}" for name in LIMITS))


def _bytes_of(numbers: Sequence[Any], count: int) -> list[bytes]:
    """The numbers of each member."""
    import numpy as np

    table = np.zeros((count, len(numbers)))
    for index, column in enumerate(numbers):
        table[:, index] += column  # added to 0: the sign of a zero tells nothing
    return [row.tobytes() for row in table]
