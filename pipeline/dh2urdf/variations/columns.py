"""The tables of many variants at once, as columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.columns import ManipulatorColumns, in_columns, row_places
from dh2urdf.errors import ManipulatorError
from dh2urdf.fields import replace_unchecked
from dh2urdf.variations.variation import FIELDS, Variation, changed, drawn_notices

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.variations.laws import DrawnValue
    from dh2urdf.variations.variation import Variants


def made_variants(
    variants: Variants, drawn: Sequence[dict[str, DrawnValue]]
) -> tuple[list[tuple[list[int], ManipulatorColumns]], dict[int, ManipulatorError]]:
    """The tables of variants, for which this was drawn.

    Returns:
        Those that differ in numbers only, each group with the places of its members; and by the place of a variant why
        there is no table: no arm has these values.
    """
    found = variant_columns(variants.variation, variants.names, drawn) if drawn else None
    groups, errors = [found] if found and found[0] else [], {}
    places, tables = [], []
    for place in sorted(set(range(len(drawn))).difference(found[0] if found else ())):
        try:
            tables.append(variants[place].manipulator(drawn[place]))
            places.append(place)
        except ManipulatorError as error:
            errors[place] = error
    groups += [([places[member] for member in members], columns) for members, columns in in_columns(tables)]
    return groups, errors


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
    nominal, rows, sure = variation.nominal, list(variation.nominal.rows), np.ones(len(drawn), dtype=bool)
    changes = variation.changes(drawn[0])
    for index, factors in changes.items():
        values = {name: np.array([own[factor.key] for own in drawn], dtype=float) for name, factor in factors.items()}
        row = rows[index] = changed(rows[index], values)
        # `dh2urdf.variations.variation` reports what is wrong with a value that no arm has.
        for name, numbers in values.items():
            sure &= np.isfinite(numbers) & FIELDS[name].takes(numbers)
        lower, upper = row.limits.lower, row.limits.upper
        if {"lower", "upper"} & values.keys() and lower is not None and upper is not None:
            sure &= np.less_equal(lower, upper)
    notices = (*nominal.notices, *drawn_notices(changes, rows))
    columns = ManipulatorColumns(
        table=replace_unchecked(nominal, name="", rows=tuple(rows), mark=None, notices=notices),
        names=tuple(names),
        marks=(nominal.mark,) * len(drawn),
        lines=(row_places(nominal),) * len(drawn),
    )
    places: list[int] = np.flatnonzero(sure).tolist()
    return places, columns.take(places)
