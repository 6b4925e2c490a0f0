"""Numbers as every written file has them: the one float formatter.

A number is written as the shortest decimal digits that read back to the same double, without ``.0`` on whole numbers
and without a sign on zero: ``0.089159``, ``-1``, ``0``, ``0.00001``, ``1e-7``, ``1e16``. Where exponents begin is
orjson's choice: it formats a whole list in one call, in a fraction of the time that `repr` takes. The text is a Python
float and an ``xsd:double`` alike.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import orjson

if TYPE_CHECKING:
    from collections.abc import Iterable


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
    # Versions of orjson differ in 1e16 and 1e+16; the shorter form is the project's.
    words = text[1:-1].replace("e+", "e").split(",") if doubles else []
    return [word.removesuffix(".0") for word in words]
