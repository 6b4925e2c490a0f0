"""The tables of many variants at once, as columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.columns import ManipulatorColumns, in_columns, row_places
from dh2urdf.errors import ManipulatorError
from dh2urdf.record_fields import replace_unchecked
from dh2urdf.variations.variation import FIELDS, Variation, changed, drawn_notices

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.variations.laws import DrawnValue
    from dh2urdf.variations.variation import Variants


class MadeVariants(NamedTuple):
    """The tables of some variants.

    Attributes:
        groups: those that differ in numbers only, each group with the places of its members.
        errors: why there is none, by the place of the variant: no arm has these values.
    """

    groups: list[tuple[list[int], ManipulatorColumns]]
    errors: dict[int, ManipulatorError]


def made_variants(variants: Variants, drawn: Sequence[dict[str, DrawnValue]]) -> MadeVariants:
    """The tables of variants, for which this was drawn."""
    made = MadeVariants([], {})
    if not drawn:
        return made
    found = variant_columns(variants.variation, variants.names, drawn)
    if found and found[0]:
        made.groups.append(found)
    places, tables = [], []
    for place in sorted(set(range(len(variants))).difference(found[0] if found else ())):
        try:
            tables.append(variants[place].manipulator(drawn[place]))
            places.append(place)
        except ManipulatorError as error:
            made.errors[place] = error
    for members, columns in in_columns(tables):
        made.groups.append(([places[member] for member in members], columns))
    return made


def variant_columns(
    variation: Variation, names: Sequence[str], drawn: Sequence[dict[str, DrawnValue]]
) -> tuple[list[int], ManipulatorColumns] | None:
    """The tables of variants that are arms beyond doubt, and which of them these are.

    Args:
        variation: what they are variants of.
        names: their names.
        drawn: what was drawn for each.

    Returns:
        The places of the variants whose tables they are, and the tables; None where types or numbers of axes are drawn,
        so that the tables differ in more than their numbers.
    """
    import numpy as np

    if variation.has_many_forms:
        return None
    nominal = variation.nominal
    rows = list(nominal.rows)
    changes = variation.changes(drawn[0])
    sure = np.ones(len(drawn), dtype=bool)
    for index, factors in changes.items():
        values = {name: np.array([own[factor.key] for own in drawn], dtype=float) for name, factor in factors.items()}
        rows[index] = changed(rows[index], values)
        sure &= _is_possible(rows[index], values)
    table = replace_unchecked(
        nominal, name="", rows=tuple(rows), mark=None, notices=(*nominal.notices, *drawn_notices(changes, rows))
    )
    columns = ManipulatorColumns(
        table=table,
        names=tuple(names),
        marks=(nominal.mark,) * len(drawn),
        lines=(row_places(nominal),) * len(drawn),
    )
    places: list[int] = np.flatnonzero(sure).tolist()
    return places, columns.take(places)


def _is_possible(row: DHRow, values: dict[str, Any]) -> Any:  # noqa: ANN401 - an array of booleans
    """Which values of a row an arm can have; `dh2urdf.variations.variation` says what is wrong with the others."""
    import numpy as np

    possible: Any = True
    for name, numbers in values.items():
        possible &= np.isfinite(numbers)
        possible &= FIELDS[name].takes(numbers)
    if {"lower", "upper"} & values.keys() and row.limits.lower is not None and row.limits.upper is not None:
        possible &= np.less_equal(row.limits.lower, row.limits.upper)
    return possible
