"""The columns of a Parquet file: what their types hold, and their numbers as they were written."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.words.cells import text_of
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS, IGNORED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.readers.words.cells import Value

INDEX = "__index_level_0__"
"""The column that pandas writes for an index without a name."""
_UNIT_KEYS = ("unit", "units")
"""Keys under which the metadata of a column have its unit."""


def with_unit(field: Any, mark: Mark) -> str:  # noqa: ANN401 - a field of pyarrow
    """The header of a column: its name, and the unit that its metadata say.

    Raises:
        TableError: the name says another unit.
    """
    metadata = {key.decode(errors="replace").casefold(): text for key, text in (field.metadata or {}).items()}
    units = {metadata[key].decode(errors="replace").strip() for key in _UNIT_KEYS if key in metadata} - {""}
    name = str(field.name)
    if not units:
        return name
    said = read_header(name).unit
    if len(units) > 1 or (said and said != min(units).casefold()):
        others = " and ".join(map(shown, sorted(units)))
        besides = f", and its name says {said}" if said else ""
        message = f"the metadata of the column {shown(name)} say {others}{besides}"
        raise TableError(Problem(message=message, mark=mark, found=others, accepted="one unit for a column"))
    return name if said else f"{name} [{min(units)}]"


def is_text(kind: Any) -> bool:  # noqa: ANN401 - a type of pyarrow
    """Whether a column holds texts."""
    return str(kind) in ("string", "large_string", "string_view")


def _is_number(kind: Any) -> bool:  # noqa: ANN401 - a type of pyarrow
    from pyarrow import types

    if types.is_dictionary(kind):
        kind = kind.value_type
    return bool(types.is_integer(kind) or types.is_floating(kind))


def holds_numbers(field: str | None, kind: Any) -> bool:  # noqa: ANN401 - a type of pyarrow
    """Whether a column holds the numbers of a field that has a dimension."""
    return bool(field and FIELDS[field].dimension) and _is_number(kind)


def is_accepted(kind: Any, field: str | None) -> bool:  # noqa: ANN401 - a type of pyarrow
    """Whether a field can be read from a column of a type."""
    from pyarrow import types

    while field in GROUPS and (types.is_list(kind) or types.is_large_list(kind) or types.is_fixed_size_list(kind)):
        kind = kind.value_type
    if types.is_dictionary(kind):
        kind = kind.value_type
    return bool(
        is_text(kind) or _is_number(kind) or types.is_decimal(kind) or types.is_boolean(kind) or types.is_null(kind)
    )


def is_readable(field: Any) -> bool:  # noqa: ANN401 - a field of pyarrow
    """Whether cells of a column are read whatever it is called: others are of types that no field has, or left out."""
    is_left_out = field.name.startswith(IGNORED) and field.name != INDEX
    return not is_left_out and is_accepted(field.type, next(iter(GROUPS)))


def numbers_of(array: Any) -> Sequence[Value]:  # noqa: ANN401 - an array of pyarrow
    """The numbers of a column, as they were written."""
    import pyarrow as pa

    if pa.types.is_dictionary(array.type):
        array = array.dictionary_decode()

    # A whole number that no double can hold becomes the nearest one, as it does when it is read as text.
    numbers: list[float | None] = array.cast(pa.float64(), safe=False).to_pylist()
    return ["" if number is None else number for number in numbers]


def unread(_array: Any) -> list[str]:  # noqa: ANN401 - an array of pyarrow
    """What stands for the cells of a column that is not read."""
    return []


def texts_of(array: Any) -> list[str]:  # noqa: ANN401 - an array of pyarrow
    """The cells of a column as texts."""
    values = array.to_pylist()
    return [value if type(value) is str else _word(value) for value in values]


def _word(value: Any) -> str:  # noqa: ANN401 - whatever a cell holds
    """What a cell of a column of words says: ``1`` for 1.0, which a column of whole numbers with gaps holds."""
    if value is None or value != value:  # noqa: PLR0124 - not a number
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return text_of(value) if isinstance(value, float) else str(value)
