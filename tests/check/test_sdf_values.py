"""What an SDF may contain, beside sdformat and Drake: values of each kind, attributes that are needed, and frames."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from foretelling import wrong_models
from lxml import etree

from dh2urdf_check.models.sdf import inspect_sdf

if TYPE_CHECKING:
    from collections.abc import Iterator

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


INERTIAL = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
BALL = "<geometry><sphere><radius>1</radius></sphere></geometry>"


def _model(parts: str = "", link: str = "", shape: str = "", visual: str = "", attributes: str = "") -> str:
    return (
        f'<sdf version="1.9"><model name="m"{attributes}>{parts}<link name="a">{link}{INERTIAL}<collision name="c">{BALL}'
        f'{shape}</collision><visual name="v">{BALL}{visual}</visual></link></model></sdf>'
    )


def _joint(axis: str, kind: str = "revolute") -> str:
    ends = f'<link name="b"/><joint name="j" type="{kind}"><parent>a</parent><child>b</child>'
    return _model(f"{ends}<axis><xyz>1 0 0</xyz>{axis}</axis></joint>")


def _held(ends: str) -> str:
    parent, child = ends.split()
    return _model(f'<joint name="j" type="fixed"><parent>{parent}</parent><child>{child}</child></joint>')


NUMBERS = ("1", "-1", "x", "", "1x", "0x1", "nan", "inf", "1e400", "1e-400", "1,5", "true", "99999999999999999999")
VECTORS = ("1 0 0", "1 0", "1 0 0 0", "1,0,0", "1 0 x", "nan 0 0", "inf 0 0", "0x1 0 0", "1e400 0 0", "")


Case = tuple[str, str]
"""What is odd, and the file."""


def _values() -> Iterator[Case]:
    for text in NUMBERS:
        yield f"laser_retro {text}", _model(shape=f"<laser_retro>{text}</laser_retro>")
        yield f"max_contacts {text}", _model(shape=f"<max_contacts>{text}</max_contacts>")
        yield f"flags {text}", _model(visual=f"<visibility_flags>{text}</visibility_flags>")
        yield f"mu {text}", _model(shape=f"<surface><friction><ode><mu>{text}</mu></ode></friction></surface>")
        yield f"radius {text}", _model().replace("<radius>1", f"<radius>{text}", 1)
    for text in VECTORS:
        yield f"fdir1 {text}", _model(shape=f"<surface><friction><ode><fdir1>{text}</fdir1></ode></friction></surface>")
        yield f"xyz {text}", _joint("").replace("1 0 0", text)
        for more in ("", " 0 0 0", " 0 0 0 1"):
            yield f"pose {text}{more}", _model(link=f"<pose>{text}{more}</pose>")
            yield f"quat {text}{more}", _model(link=f'<pose rotation_format="quat_xyzw">{text}{more}</pose>')
    for text in (
        "1 1 1 1",
        "1 1 1",
        "1 1",
        "1 1 1 x",
        "2 0 0 1",
        "-1 0 0 1",
        "1 1 1 1 1",
        "nan 0 0 1",
        "",
        "0x1 0 0 1",
    ):
        yield f"diffuse {text}", _model(visual=f"<material><diffuse>{text}</diffuse></material>")
    for text in ("true", "0", "True", "yes", "", " true ", "2", "true x"):
        yield f"static {text}", _model(f"<static>{text}</static>")


def _frames() -> Iterator[Case]:
    for attribute in ("canonical_link", "placement_frame"):
        for name in ("a", "b", "", "c"):
            yield f"{attribute} {name}", _model(attributes=f' {attribute}="{name}"')
    for ends in ("a a", "world __model__", "j a", "world a", "f a", "world f", "b a"):
        yield f"joint {ends}", _held(ends)
        yield f"with a frame {ends}", _held(ends).replace("<joint", '<frame name="f" attached_to="a"/><joint')
    for text in (
        *('<frame name="f" attached_to="g"/><frame name="g" attached_to="f"/>', '<frame name="f" attached_to="f"/>'),
        '<frame name="f"><pose relative_to="g"/></frame><frame name="g"><pose relative_to="f"/></frame>',
        *('<frame name="f" attached_to="world"/>', '<frame name="f" attached_to=""/>', '<frame name="f::g"/>'),
        *("<include/>", '<pose relative_to="a">0 0 0 0 0 0</pose>', '<pose relative_to="">0 0 0 0 0 0</pose>'),
        '<model name="n"><link name="b"/></model><frame name="f" attached_to="b"/>',
        '<model name="n"><link name="b"/></model><frame name="f" attached_to="n::b"/>',
    ):
        yield text, _model(text)
    for name in ("a", "world", "nowhere", "__model__"):
        yield f"link relative_to {name}", _model(link=f'<pose relative_to="{name}">0 0 0 0 0 0</pose>')
        yield f"expressed_in {name}", _joint("").replace("<xyz>", f'<xyz expressed_in="{name}">')


@pytest.mark.long
@pytest.mark.parametrize("consumer", ["gazebo", "drake"])
def test_what_is_refused_is_foretold(tmp_path: Path, consumer: str) -> None:
    """A reader refuses a model where a finding says so, and loads it where none does: of a sample, since ign is slow."""
    wrong = wrong_models(tmp_path, consumer, dict([*_values()][::7] + [*_frames()][::3]), "sdf")
    assert wrong == [], "\n".join(wrong)
