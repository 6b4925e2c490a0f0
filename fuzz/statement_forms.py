"""What is above the header of a table of rows, in every form that the page lists."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from file_texts import flow

if TYPE_CHECKING:
    import random

MARKERS = ("# ", "# ", "#", "% ", "// ", "#   ")
NAME_KEYS = ("name", "name", "robot", "Manipulator", "model")


def forms(rng: random.Random, key: str, value: Any) -> list[str]:
    """A statement as one line or several: as a key with its value, or in words."""
    if rng.random() < 0.4:
        in_words = _in_words(key, value)
        if in_words:
            return rng.choice(in_words)
    if key == "name":
        key = rng.choice(NAME_KEYS)
    if key == "convention" and rng.random() < 0.2:
        key = "DH convention"
    return [f"{key}{rng.choice([': ', ': ', ' = '])}{flow(value)}"]


def _in_words(key: str, value: Any) -> list[list[str]]:
    """The phrases for a convention, and for units of lengths and angles."""
    if key == "convention" and re.fullmatch(r"[a-zA-Z]{4,}", value):
        return [[f"{value} DH convention"], [f"{value} convention"]]
    if key != "units" or not isinstance(value, dict) or value.keys() != {"length", "angle"}:
        return []
    length, angle = value["length"], value["angle"]
    length, angle = {"in": "inches"}.get(length, length), {"turn": "turns"}.get(angle, angle)  # `in` and `in turn`
    return [
        [f"lengths in {length}, angles in {angle}"],
        [f"units [{length}, {angle}]"],
        [f"units: {length}/{angle}"],
        [f"length_unit: {length}", f"angle_unit: {angle}"],
        [f"a and d in {length}, alpha in {angle}"],
        [f"{length}, {angle}"],
    ]


def commented(rng: random.Random, key: str, value: Any, delimiter: str) -> list[str]:
    """A statement as comment lines of a CSV file, as they are typed or as a spreadsheet has written them back."""
    lines = [rng.choice(MARKERS) + form for form in forms(rng, key, value)]
    form = rng.random()
    if form < 0.1:  # filled up with delimiters
        return [f"{line}{delimiter * 3}" if '"' not in line else line for line in lines]
    if form < 0.2:  # in quotes, as one cell
        return ['"' + line.replace('"', '""') + '"' + delimiter * 2 for line in lines]
    # Without a marker a line says it, too; its quotes are those of cells.
    if form < 0.25 and not any('"' in line for line in lines):
        return [re.sub("^(#|%|//) *", "", line) for line in lines]
    return lines


def as_cells(rng: random.Random, key: str, value: Any, *, beside: bool) -> list[list[str]]:
    """A statement as cells of a workbook: the key and the value side by side, or a line in one cell."""
    if beside:
        return [[key, flow(value)]]
    return [[f"{rng.choice([*MARKERS, ''])}{form}"] for form in forms(rng, key, value)]
