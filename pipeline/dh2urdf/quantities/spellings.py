"""Texts that look like numbers and are none, or that two people would read in two ways: what to write in their place.

Spreadsheets turn numbers into dates and put negative ones into brackets; people write percentages, prices and mixed
fractions. None of these is read. `misreading` names those that the grammar of expressions would otherwise accept with
another meaning, and `advice` says what to write where the grammar refuses a text anyhow.
"""

from __future__ import annotations

import re
import unicodedata

from dh2urdf.patterns import late_pattern

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
    late_pattern(rf"\s*(?:{pattern})\s*", re.IGNORECASE | re.ASCII)
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
_IN_BRACKETS = late_pattern(rf"\s*\(\s*([0-9.,]+(?:e[+-]?[0-9]+)?)\s*({_WORD})?\s*\)\s*({_WORD})?\s*", re.IGNORECASE)
_NO_DIGIT_BUT_0 = late_pattern(r"[0.,]+(?:e[+-]?[0-9]+)?", re.IGNORECASE)
_PLAIN = r"[0-9]*[.,]?[0-9]+"
_POWER = late_pattern(
    rf"\s*([+-]?{_PLAIN})\s*\*\s*10(?:([+-])\s*|\s+([+-]))([0-9]{{1,2}})\s*((?:[^\W\d]|°).*)?", re.DOTALL
)
"""A power of ten whose exponent is no longer raised: ``3×10-3``."""
_UNIT = r"(?:\s*(?:[cmµ]?m|in|ft|deg|rad|°))?"
_TWO_NUMBERS = late_pattern(rf"\s*([+-]?)({_PLAIN}){_UNIT}(\s*)([-−–‐‑/⁄∕])(\s*)([+-]?)({_PLAIN}){_UNIT}\s*")
"""What may be a difference or a quotient, or two numbers: ``0.3–0.5``, ``90/-90``, ``0/90``, ``0.3/0.4``."""
_OF_SCALES = ("100", "180", "360", "1000")
_OF_INCHES = 127
"""The digits of 25.4 mm, 2540, 3048 and of other lengths made of inches are a multiple of this prime."""
_DIGITS = 2
"""A number with more of them, or with a decimal sign, hardly is a divisor of one of its size."""

_SPACES = "'’ʼ \u00a0\u2007\u2009\u202f"
_ADVICE = (
    (late_pattern(r"\s*[+-]?(nan|inf|infinity|∞)\s*", re.IGNORECASE), "write a finite number"),
    (
        late_pattern(r"\s*\$[^$]+\$\s*$|.*\\(?:[dt]?frac|over|circ|degree|textdegree|ang|SI|qty)(?![a-z])"),
        "write the number without LaTeX: -pi/2, -90 deg",
    ),
    (
        late_pattern(r"\s*[+-]?[0-9]*,[0-9]+\s*$"),
        "write a decimal point, and no separators of thousands: 0.425, 1234.5",
    ),
    (late_pattern(r".*[½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅐⅛⅜⅝⅞⅑⅒]"), "write the fraction with its signs: 1/2, 1 + 1/2"),
    (late_pattern(r"\s*[+-]?[0-9]+\s+[0-9]+\s*/\s*[0-9]+"), "write a mixed number as a sum: 1 + 1/2"),
    (
        late_pattern(rf"\s*[+-]?(?!0+[.,])[0-9]{{1,3}}(?:[.,{_SPACES}][0-9]{{3}})+"),
        "write the number without separators of thousands: 1234.5",
    ),
    (late_pattern(r".*[0-9]_[0-9]"), "write the number without underscores"),
    (late_pattern(r".*\b0[xXbBoO]"), "write a decimal number"),
    (
        late_pattern(r"\s*[+-]?(?:[0-9.,]+\s*[oO⁰]|(?:deg|rad)\s*\([^()]*\))\s*$"),
        "write the unit behind the number: 90° or 90 deg, 1.57 rad",
    ),
    (
        late_pattern(
            r"\s*[+-]?\s*(?:var(?:iable)?\b|[jmtφϕ]_?[0-9]+|[θqd]\w*\s*\((?:t|var\w*)\)|theta\w*\s*\()", re.IGNORECASE
        ),
        "write the joint variable as q1, and what is added to it behind: q1 + pi/2",
    ),
    (
        late_pattern(r"\s*\\?(?:[qθ]|th(?:eta)?)_?\{?[0-9]+\}?\s*[(\[∈]", re.IGNORECASE),
        "write the joint variable alone, with an offset behind it, as q1 - 90 deg; its bounds go to a column limits",
    ),
    (
        late_pattern(
            r"\s*(?:[^\W\d]\w*(?:\s*[=:]|\s+\()|[adlr]_?[0-9]+\s*\()\s*[+-]?[0-9.,]+\s*(?:[^\W\d]{1,4}|°)?\s*\)?\s*$",
            re.IGNORECASE,
        ),
        "write the number alone, without its symbol: 290 mm",
    ),
    (
        late_pattern(r".*(?:[0-9]|pi|π)\s*(?:\[\s*[^\W\d]{1,4}\s*\]|\(\s*(?:mm|cm|m|°|deg|rad)\s*\)|\[\s*°\s*\])\s*$"),
        "write the unit behind the number, without brackets: 290 mm, 90 deg",
    ),
    (
        late_pattern(r"\s*[+-]?[0-9.,]+\s*(?:[^\W\d]{1,4}|°)?\s*\([^()0-9]*\)\s*$"),
        "write the number alone, without the words behind it: 290 mm",
    ),
    (
        late_pattern(r"[-+−–0-9.,/*\s°πa-z]*[0-9π]\s*[a-z]{0,3}\s*\([A-Za-z]_?[0-9]{1,2}\)\s*$"),
        "write the number alone, without the symbol behind it: 290 mm",
    ),
    (
        late_pattern(
            r"(?:[-+−–0-9.,/*\s°π]|pi|deg|rad)+(?:\((?=.*[0-9π])[^()]*\)|=[-+−–0-9.,/*\s°π]*(?:pi|deg|rad)?[/0-9]*)\s*$"
        ),
        "write one of the two numbers: pi/2, or 90 deg",
    ),
    (
        late_pattern(r"\s*(\*\*?|__?|`)[^*_`]+\1\s*$"),
        "write the number without the marks that make it bold or code: -90 deg",
    ),
    (late_pattern(r".*(\*\*|\^|[²³¹⁰⁴-⁹⁺⁻])"), "powers are not accepted: write the product, or the number, as in 1e-3"),
    (late_pattern(r".*[%‰]"), "percentages and remainders are not accepted: write the number"),
    (late_pattern(r".*([$€£¥]|\b(eur|usd|gbp|chf)\b)", re.IGNORECASE), "write the number without a currency"),
    (late_pattern(r"\s*[+-]?[0-9.]+[dD][+-]?[0-9]+\s*"), "write the exponent with e: 1e-3"),
    (late_pattern(r"\s*[-+−–]?\s*(?:pi|π)\s*[0-9]+\s*$"), "write the fraction with its sign: pi/2"),
    (late_pattern(r".*[0-9]\s*(pi|π)"), "write the product with its sign: 2*pi"),
    (late_pattern(r"\s*[0-9][0-9.,]*\s*[^\W\d]{0,3}\s*-\s*$"), "write the minus before the number: -5"),
    (late_pattern(r"\s*([-–—−]+|/|n\.?/?a\.?|none|null)\s*$", re.IGNORECASE), "write 0 if that is meant"),
    (
        late_pattern(r"\s*[^*†‡]*[0-9°a-zπ]\s*[*†‡]+\s*$", re.IGNORECASE),
        "take out the mark at the end, of a footnote or of a product that is cut off",
    ),
    (late_pattern(r"\s*[-+−–]?\s*[0-9.]*\s*(?:n|п|[Il]{2}|[TТтr]{2})\s*/\s*[0-9]+\s*$"), "write π as pi: pi/2"),
    (late_pattern(r".*(?:θ|th|theta|q)_?[0-9]+\*?\s+[0-9]"), "write the sign that is missing: q1 - 90 deg"),
    (late_pattern(r"\s*[-+−–]?[0-9.]+\s*(?:''|[\"″”])\s*$"), "write inches as in: 11.8 in"),
    (late_pattern(r"\s*[*†‡•]+\s*$"), "write the joint variable as q1, or the number of the row"),
    (late_pattern(r"\s*[—―]\s*[0-9.pπ]"), "write the minus as a hyphen: -pi/2"),
    (late_pattern(r"\s*(?:[≈~∼≃≅]|ca?\.)\s*[-+−–]?\s*[0-9.]"), "write the number alone: 290 mm"),
    (late_pattern(r".*[0-9]\s*(?:±|\+/-)\s*[0-9.]"), "write the number alone, without its tolerance"),
    (late_pattern(r".*[0-9π]\s*(?:deg|rad|mm|cm|m)\.\s*$"), "take out the point at its end"),
    (
        late_pattern(r"\s*[-+−–]?\s*[0-9]*(?:[.,]\s+|\s+[.,]\s*|\s+(?=[0-9]{3}(?![0-9])))[0-9]"),
        "take out the space in it",
    ),
    (
        late_pattern(r"\s*[-+−–]?\s*[a-zA-Z][\s_]*\{?[0-9₀-₉]{1,2}\}?\s*$"),
        "write the number that it stands for: 290 mm",
    ),
    (
        late_pattern(r"\s*[-+−–]?(?=[0-9.,]*[OoIl|])[0-9OoIl|]*[.,]?[0-9OoIl|]+\s*(?:mm|cm|m|°|deg|rad)?\s*$"),
        "write the number with digits alone: 0 for the letter O, 1 for l or I",
    ),
    (late_pattern(r"\s*(±|\+/-|\+-|-\+)"), "write the two numbers, lower and upper, each with its own sign"),
    (late_pattern(rf".*[0-9]\s*[{DEGREE_SIGNS}]\s*[0-9]"), "write decimal degrees: 12.5° for 12°30'"),
    (late_pattern(r"\s*(#[A-Z]|=|')"), "write the number itself, without what the spreadsheet puts before it"),
)


def misreading(text: str) -> tuple[str, str] | None:
    """What a text is that the grammar would take for another number, and what to write; None for any other text."""
    plain = text.translate(SIGNS)
    # No date has a `*`; a table has many such cells.
    may_be_date = "*" not in plain and plain.strip()[:1].lower() in _FIRST_OF_DATES
    if may_be_date and any(date.fullmatch(plain) for date in _DATES):
        return "it is a date", _DATE_ADVICE
    number = _IN_BRACKETS.fullmatch(plain) if "(" in plain else None
    if number and not _NO_DIGIT_BUT_0.fullmatch(number[1]):
        unit = f" {number[2] or number[3]}" if number[2] or number[3] else ""
        reason = (
            f"a number in brackets is negative to a spreadsheet and positive to a person: -{number[1]}, or {number[1]}"
        )
        return reason, f"write -{number[1]}{unit} or {number[1]}{unit}, without the brackets"
    if "10" in plain and (power := _POWER.fullmatch(plain)):
        sign = power[2] or power[3]
        factor, exponent, unit = power[1], f"{sign}{power[4]}", f" {power[5]}" if power[5] else ""
        reason = f"it may be {factor} times a power of ten, whose exponent {exponent} is no longer raised"
        return reason, f"write {factor}e{exponent}{unit}, or {factor}*10 {sign} {power[4]}{unit} with spaces"
    two = None if "pi" in text else _TWO_NUMBERS.fullmatch(text)
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


def advice(text: str) -> str | None:
    """What to write in place of a text that cannot be read, where its kind is known."""
    return next((suggestion for pattern, suggestion in _ADVICE if pattern.match(text)), None)


_DEGREE = str.maketrans(dict.fromkeys(DEGREE_SIGNS, "°"))
_OTHER_SCRIPTS = {
    "m": "м 米 メートル 미터",
    "cm": "см 厘米 公分 センチ センチメートル 센티미터",
    "mm": "мм 毫米 公厘 ミリ ミリメートル 밀리미터",
    "rad": "рад 弧度 ラジアン 라디안",
    "deg": "градус градуса градусы градусов градусах 度 도",
    "s": "с сек 秒 초",
    "min": "мин 分 분",
    "kg": "кг 千克 公斤 キログラム 킬로그램",
    "n": "н 牛 牛顿",
    "nm": "нм 牛米",
}
"""The units that are written in other letters than those of Europe's west, by their words."""
_LATIN = {word: unit for unit, words in _OTHER_SCRIPTS.items() for word in words.split()}
_FIRST_OF_OTHERS = "\u0400"
_IN_OTHERS = late_pattern(rf"[{_FIRST_OF_OTHERS}-\uffff]+")


def in_latin_letters(word: str) -> str:
    """A unit without case in Latin letters: ``мм/с`` is mm/s, ``кг·м²`` is kg·m²."""
    if max(word, default="") < _FIRST_OF_OTHERS:
        return word
    return _IN_OTHERS.sub(lambda match: _LATIN.get(match[0], match[0]), word)


def composed(text: str) -> str:
    """A text in Unicode's form NFKC, with one sign for the degree."""
    return unicodedata.normalize("NFKC", text.translate(_DEGREE))
