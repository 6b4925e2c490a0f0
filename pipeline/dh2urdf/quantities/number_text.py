"""Numbers as every written file has them: the one float formatter.

A number is written as the shortest decimal digits that read back to the same double, without ``.0`` on whole numbers
and without a sign on zero: ``0.089159``, ``-1``, ``0``, ``0.00001``, ``1e-7``, ``1e16``. Where exponents begin is
orjson's choice: it formats a whole list in one call, in a fraction of the time that `repr` takes. The text is a Python
float and an ``xsd:double`` alike.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import orjson

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def format_number(number: float) -> str:
    """The text of one number.

    Raises:
        ValueError: the number is not finite.
    """
    return format_numbers((number,))[0]


def format_numbers(numbers: Iterable[float]) -> list[str]:
    """The texts of several numbers, formatted in one call.

    Raises:
        ValueError: one of the numbers is not finite.
    """
    # Adding 0.0 drops the sign of a zero and leaves every other number as it is.
    doubles = [float(number) + 0.0 for number in numbers]
    text = orjson.dumps(doubles).decode("ascii")
    if "null" in text:  # JSON has no other word for what is not finite.
        culprit = next(double for double, word in zip(doubles, text[1:-1].split(","), strict=True) if word == "null")
        raise ValueError(f"{culprit} is not a finite number and cannot be written")
    return _words(text[1:-1]) if doubles else []


def format_columns(columns: Sequence[Any]) -> list[list[str] | str]:
    """The texts of many columns of numbers: a list for each, or one text where all its numbers are the same.

    Equal columns share a list: robots hold most of their numbers twice.

    Args:
        columns: arrays of shape (N,), N > 0.

    Raises:
        ValueError: one of the numbers is not finite.
    """
    if not columns:
        return []
    import numpy as np

    table = np.array(columns, dtype=float) + 0.0  # without -0.0, as above
    if not np.isfinite(table).all():
        raise ValueError(f"{table[~np.isfinite(table)][0]} is not a finite number and cannot be written")
    is_constant = (table == table[:, :1]).all(axis=1).tolist()
    # Only the texts of whole numbers end in .0 or have an exponent that is not negative.
    has_whole = (table == np.rint(table)).any(axis=1).tolist()
    texts: dict[bytes, list[str] | str] = {}
    found = []
    for row, constant, whole in zip(table, is_constant, has_whole, strict=True):
        numbers = row.tobytes()
        if numbers not in texts:
            if constant:
                texts[numbers] = format_number(row[0])
            else:
                text = orjson.dumps(row, option=orjson.OPT_SERIALIZE_NUMPY).decode("ascii")[1:-1]
                texts[numbers] = _words(text) if whole else text.split(",")
        found.append(texts[numbers])
    return found


def _words(numbers: str) -> list[str]:
    """The project's texts of orjson's numbers, given with commas between them.

    Versions of orjson differ in 1e16 and 1e+16; the shorter form is the project's.
    """
    return f"{numbers},".replace("e+", "e").replace(".0,", ",")[:-1].split(",")
