"""Numbers as people write them, with units: expressions, what they measure, and the shortest text of a number."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.quantities.grammar import MAX_CHARACTERS as MAX_CHARACTERS
    from dh2urdf.quantities.number_text import (
        format_number as format_number,
        format_numbers as format_numbers,
        format_rows as format_rows,
        number_in as number_in,
    )
    from dh2urdf.quantities.quantity import Quantity as Quantity, evaluate as evaluate, is_zero as is_zero
    from dh2urdf.quantities.spellings import (
        DEGREE_SIGNS as DEGREE_SIGNS,
        composed as composed,
        plain_text as plain_text,
        unwrapped as unwrapped,
    )
    from dh2urdf.quantities.symbols import Symbols as Symbols
    from dh2urdf.quantities.units import (
        RATES as RATES,
        UNITS as UNITS,
        Dimension as Dimension,
        QuantityError as QuantityError,
        Unit as Unit,
        accepted_forms as accepted_forms,
        accepted_units as accepted_units,
        find_unit as find_unit,
        is_unit as is_unit,
        unit_word as unit_word,
    )
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "number_text": "format_rows format_number format_numbers number_in",
            "grammar": "MAX_CHARACTERS",
            "quantity": "Quantity evaluate is_zero",
            "spellings": "DEGREE_SIGNS composed plain_text unwrapped",
            "symbols": "Symbols",
            "units": (
                "RATES UNITS Dimension QuantityError Unit accepted_forms accepted_units find_unit is_unit unit_word"
            ),
        },
    )
