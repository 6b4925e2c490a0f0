"""What an SDF may contain, beside sdformat and Drake: values of each kind, attributes that are needed, and frames."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from lxml import etree

from dh2urdf_check.models.sdf import inspect_sdf

VALUES = Path(inspect_sdf.__code__.co_filename).with_name("sdf_values.txt")
KINDS = {
    **dict.fromkeys(("double", "float"), "number"),
    "int": "whole",
    "unsigned int": "count",
    "bool": "truth",
    "vector3": "3",
    "vector2d": "2",
    "pose": "pose",
    "color": "colour",
}


def test_the_values_are_those_of_sdformat() -> None:
    """Every element with a number, vector, colour, pose or truth value, its bounds, and whether it may be blank."""
    program = shutil.which("ign") or shutil.which("gz")
    if program is None:
        pytest.skip("ign or gz is not installed")
    printed = subprocess.run([program, "sdf", "--describe", "1.9"], capture_output=True, text=True, check=True).stdout
    root = etree.fromstring(printed[printed.index("<element") :].encode(), etree.XMLParser(huge_tree=True))
    theirs: dict[str, list[tuple[str | None, ...]]] = {}
    for element in root.iter("element"):
        above = element.getparent()
        if above is not None and element.get("type") in KINDS:
            key = f"{above.get('name')}/{element.get('name')}"
            theirs.setdefault(key, []).append(tuple(map(element.get, ("type", "min", "max", "required"))))
    ours: dict[str, str] = {}
    for line in VALUES.read_text("utf-8").splitlines():
        kind, _, elements = line.partition(": ")
        ours |= dict.fromkeys(elements.split(), kind)
    assert ours.keys() == theirs.keys()
    for key, found in theirs.items():
        words = {KINDS[kind or ""] for kind, *_ in found}
        bounds = {each[1:3] for each in found}
        expected = min(words)
        if len(bounds) == 1 and bounds != {(None, None)} and expected != "2":
            ((least, most),) = bounds
            expected += f" {float(least or 0):.7g}-{'' if most is None else f'{float(most):.7g}'}"
        assert ours[key] == expected + ("!" if any(each[3] == "1" for each in found) else ""), key
