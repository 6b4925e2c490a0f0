"""Texts that look like numbers and are none, or that two people would read in two ways: what to write in their place.

Spreadsheets turn numbers into dates and put negative ones into brackets; people write percentages, prices and mixed
fractions. None of these is read. `misreading` names those that the grammar of expressions would otherwise accept with
another meaning, and `advice` says what to write where the grammar refuses a text anyhow.
"""

from __future__ import annotations

import re
import unicodedata
from functools import cache
from pathlib import Path

DEGREE_SIGNS = "°º˚◦∘"
"""What is written for the degree sign: keyboards have ordinals beside it, and LaTeX makes it of a ring or a bullet."""
# What typesetting and PDF copies make of the signs. The raised dot is missing: it is a decimal point to some.
SIGNS = {
    **str.maketrans(dict.fromkeys("−–‒‐‑﹣－", "-")),
    **str.maketrans({"＋": "+", "×": "*", "∗": "*", "÷": "/", "⁄": "/", "∕": "/"}),
    **str.maketrans(dict.fromkeys(DEGREE_SIGNS, "°")),
}
"""The signs of numbers, by the code points of the characters that are written in their place."""

_MONTHS = (
    r"jan|jän|janv|ene|gen|feb|fév|févr|mar|mär|mrz|mars|apr|avr|abr|may|mai|mag|jun|juin|giu|jul|juil|lug|aug|août|aou|"
    r"ago|sep|sept|set|oct|okt|ott|nov|dec|dez|déc|dic"
)
_TIME = r"(?:[T ]+\d{1,2}:\d{2}(?::\d{2}(?:\.\d+)?)?Z?)?"
_DATES = tuple(
    rf"(?ai)\s*(?:{pattern})\s*"
    for pattern in (
        rf"\d{{4}}([-/.])\d{{1,2}}\1\d{{1,2}}{_TIME}",
        rf"\d{{1,2}}([-/])\d{{1,2}}\1(?:\d{{4}}|\d{{1,2}}){_TIME}",
        rf"\d{{1,2}}\.\d{{1,2}}\.(?:\d{{4}}|\d{{2}}){_TIME}",
        r"\d{1,2}-\d{1,2}|\d{1,2}-\d{4}|\d{4}-\d{1,2}",
        r"\d{1,2}\.\d{1,2}\.",
        r"\d{1,2}:\d{2}(?::\d{2}(?:\.\d+)?)?(?: *[ap]m)?",
        rf"\d{{1,4}}[-/. ]*(?:{_MONTHS})[a-zé]*\.?(?:[-/., ]*\d{{1,4}})?",
        rf"(?:{_MONTHS})[a-zé]*\.?[-/., ]*\d{{1,4}}(?:[-/., ]+\d{{1,4}})?",
    )
)
_FIRST_OF_DATES = frozenset("0123456789").union(month[0] for month in _MONTHS.split("|"))
_DATE_ADVICE = (
    "a spreadsheet makes dates of fractions: format the column as text; for a difference or a quotient, put spaces "
    "around its signs"
)
_WORD = r"[^\W\d_]{1,3}|°"
_IN_BRACKETS = rf"(?i)\s*\(\s*([0-9.,]+(?:e[+-]?[0-9]+)?)\s*({_WORD})?\s*\)\s*({_WORD})?\s*"
_NO_DIGIT_BUT_0 = r"(?i)[0.,]+(?:e[+-]?[0-9]+)?"
_PLAIN = r"[0-9]*[.,]?[0-9]+"
_POWER = rf"(?s)\s*([+-]?{_PLAIN})\s*\*\s*10(?:([+-])\s*|\s+([+-]))([0-9]{{1,2}})\s*((?:[^\W\d]|°).*)?"
"""A power of ten whose exponent is no longer raised: ``3×10-3``."""
_UNIT = r"(?:\s*(?:[cmµ]?m|in|ft|deg|rad|°))?"
_TWO_NUMBERS = rf"\s*([+-]?)({_PLAIN}){_UNIT}(\s*)([-−–‐‑/⁄∕])(\s*)([+-]?)({_PLAIN}){_UNIT}\s*"
"""What may be a difference or a quotient, or two numbers: ``0.3–0.5``, ``90/-90``, ``0/90``, ``0.3/0.4``."""
_OF_SCALES = ("100", "180", "360", "1000")
_OF_INCHES = 127
"""The digits of 25.4 mm, 2540, 3048 and of other lengths made of inches are a multiple of this prime."""
_DIGITS = 2
"""A number with more of them, or with a decimal sign, hardly is a divisor of one of its size."""


def misreading(text: str) -> tuple[str, str] | None:
    """What a text is that the grammar would take for another number, and what to write; None for any other text."""
    plain = text.translate(SIGNS)
    # No date has a `*`; a table has many such cells.
    may_be_date = "*" not in plain and plain.strip()[:1].lower() in _FIRST_OF_DATES
    if may_be_date and any(re.fullmatch(date, plain) for date in _DATES):
        return "it is a date", _DATE_ADVICE
    number = re.fullmatch(_IN_BRACKETS, plain) if "(" in plain else None
    if number and not re.fullmatch(_NO_DIGIT_BUT_0, number[1]):
        unit = f" {number[2] or number[3]}" if number[2] or number[3] else ""
        reason = (
            f"a number in brackets is negative to a spreadsheet and positive to a person: -{number[1]}, or {number[1]}"
        )
        return reason, f"write -{number[1]}{unit} or {number[1]}{unit}, without the brackets"
    if "10" in plain and (power := re.fullmatch(_POWER, plain)):
        sign = power[2] or power[3]
        factor, exponent, unit = power[1], f"{sign}{power[4]}", f" {power[5]}" if power[5] else ""
        reason = f"it may be {factor} times a power of ten, whose exponent {exponent} is no longer raised"
        return reason, f"write {factor}e{exponent}{unit}, or {factor}*10 {sign} {power[4]}{unit} with spaces"
    two = None if "pi" in text else re.fullmatch(_TWO_NUMBERS, text)
    return _two_numbers(two) if two else None


def _two_numbers(match: re.Match[str]) -> tuple[str, str] | None:
    """What is wrong with a difference or a quotient that may be two numbers; None where it is none."""
    first, between, sign, last = match[2], match[4], match[6], match[7]
    smaller, larger = (float(number.replace(",", ".")) for number in (first, last))
    if match[3] and match[5] and between != "–":  # with spaces it is what its sign says
        return None
    if between in "/⁄∕":
        is_long = min(len(first), len(last)) > _DIGITS or all("." in each or "," in each for each in (first, last))
        is_scale = last in _OF_SCALES or int(re.sub("[.,]", "", last)) % _OF_INCHES == 0
        alike = is_long and not is_scale and larger < 3 * smaller and smaller < 3 * larger
        if not (sign and smaller == larger) and not smaller == 0 < larger and not alike:
            return None
        advised = "write the number that holds; for the quotient, put spaces around its sign"
        return "it may be two numbers, or a quotient", advised
    if match[1] or sign or smaller >= larger:
        return None
    reason = f"it may be a range from {first} to {last}, or a difference"
    return reason, "write bounds in a column limits; for the difference, put spaces around a hyphen"


@cache
def _advices() -> list[tuple[re.Pattern[str], str]]:
    import tomllib

    with (Path(__file__).parent / "advice.toml").open("rb") as file:
        return [(re.compile(pattern), advised) for pattern, advised in tomllib.load(file)["advice"]]


def advice(text: str) -> str | None:
    """What to write in place of a text that cannot be read, where its kind is known."""
    return next((advised for pattern, advised in _advices() if pattern.match(text)), None)


_DEGREE = str.maketrans(dict.fromkeys(DEGREE_SIGNS, "°"))


def composed(text: str) -> str:
    """A text in Unicode's form NFKC, with one sign for the degree."""
    return unicodedata.normalize("NFKC", text.translate(_DEGREE))
