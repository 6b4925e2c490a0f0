"""The edit `values`: cells get a value, a factor or a summand, in the units of tables, and everything follows."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from command_line import Cli
from jsonschema import Draft202012Validator

import dh2urdf
from dh2urdf.errors import ConfigError, EditError
from dh2urdf.manipulator import DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.testing import reference_manipulators
from dh2urdf_plugins.edits.values import ValuesOptions, edit_table

UR5 = reference_manipulators()[0]
TABLE = "# convention: standard\n# name: arm\njoint, type, a [mm], alpha [deg], d [mm], lower, upper\n"
HIP = "hip, revolute, {a}, {alpha}, 100, -90, 90\n"
SLIDE = "slide, prismatic, 0, 0, 50, {lower}, 300\n"


def arm(**cells: Any) -> Manipulator:
    row = replace(UR5.rows[0], joint="hip", a=0.4, alpha=1.0, limits=Limits(lower=-1.0, upper=3.0, effort=50.0))
    return replace(UR5, rows=(replace(row, **cells), replace(UR5.rows[1], joint="knee")))


def edited(text: str, cell: str, **cells: Any) -> DHRow:
    return edit_table(arm(**cells), ValuesOptions(joints={"hip": {cell: text}})).rows[0]


@pytest.mark.parametrize(
    ("text", "a"),
    [
        ("0.6", 0.6),
        ("-0.6", -0.6),
        ("250 mm", 0.25),
        ("-250 mm", -0.25),
        ("0.2 + 0.05", 0.25),
        ("*1.5", 0.4 * 1.5),
        ("* -2", -0.8),
        ("*1/4", 0.1),
        ("+0.1", 0.4 + 0.1),
        ("+20 mm", 0.4 + 0.02),
        ("+-20 mm", 0.4 - 0.02),
        ("+ -20 mm", 0.4 - 0.02),
    ],
)
def test_the_first_character_decides(text: str, a: float) -> None:
    """Of a cell of 0.4 m: `*` is a factor, `+` a summand, anything else a value; a minus is a sign."""
    assert edited(text, "a").a == a
    assert edit_table(arm(), ValuesOptions(joints={"hip": {"a": text}})).rows[1] == arm().rows[1]


def test_units_are_those_of_the_joint() -> None:
    """Angles for joints that turn, lengths for those that slide; bare numbers are rad and m, as in run files."""
    assert edited("-90 deg", "alpha").alpha == -math.pi / 2
    assert edited("+5 deg", "lower").limits.lower == pytest.approx(-1.0 + math.radians(5), abs=1e-15)
    assert edited("2.5*pi", "upper").limits.upper == pytest.approx(2.5 * math.pi)
    slide = {"type": JointType.PRISMATIC, "theta": 0.0}
    assert edited("250 mm", "upper", **slide).limits.upper == 0.25
    for text in ("250 mm", "+1 kg", "*2 mm", "q1", "400"):
        with pytest.raises(EditError):
            edited(text, "upper")


def test_an_inertia_goes_with_its_mass() -> None:
    """As where masses are drawn: twice the mass of the same shape is twice the inertia."""
    body = {"mass": 2.0, "com": (0.0, 0.0, 0.1), "inertia": Inertia(ixx=1.0, iyy=2.0, izz=2.5, ixy=0.1)}
    row = edited("*2", "mass", **body)
    assert (row.mass, row.com, row.inertia) == (4.0, (0.0, 0.0, 0.1), Inertia(ixx=2.0, iyy=4.0, izz=5.0, ixy=0.2))


@pytest.mark.parametrize(
    ("joint", "cell", "text"),
    [
        ("hipp", "a", "1"),
        ("hip", "a", "1 kg"),
        ("hip", "effort", "-3"),
        ("hip", "effort", "*-1"),
        ("hip", "velocity", "*2"),
        ("hip", "mass", "+1"),
        ("hip", "lower", "4"),
        ("hip", "a", "*1e308 * 1e308"),
        ("fixed", "lower", "1"),
        ("fixed", "damping", "1"),
    ],
)
def test_what_cannot_be_is_refused(joint: str, cell: str, text: str) -> None:
    """Unknown joints, other units, numbers that no arm has, and changes of what the table leaves out."""
    table = arm(limits=Limits(lower=-1.0, upper=3.0, effort=50.0))
    fixed = replace(UR5.rows[2], joint="fixed", type=JointType.FIXED, offset=0.0, sign=1, limits=Limits())
    with pytest.raises(EditError) as refused:
        edit_table(replace(table, rows=(*table.rows, fixed)), ValuesOptions(joints={joint: {cell: text}}))
    (problem,) = refused.value.problems
    assert problem.robot == UR5.name
    if joint == "hipp":
        assert "hip" in str(problem.suggestion)
    else:
        assert (problem.joint, problem.field) == (joint, cell)


def test_an_unknown_cell_is_found_before_anything_is_made(tmp_path: Path) -> None:
    """At its place in the run file, with the nearest name."""
    (tmp_path / "run.yaml").write_text(
        "inputs: missing.csv\nedits:\n  - stage: values\n    options:\n      hip: {a: 1}\n      knee: {alfa: 1}\n"
    )
    with pytest.raises(ConfigError) as refused:
        dh2urdf.run(tmp_path / "run.yaml")
    found = {problem.field: problem for problem in refused.value.problems}["knee.alfa"]
    assert found.mark is not None
    assert found.mark.line == 6
    assert "alpha" in str(found.suggestion)


def test_files_are_those_of_a_table_with_these_cells(cli: Cli, tmp_path: Path) -> None:
    """Byte by byte but for the comment, by the command line, by Python and by a run; and proved against these cells."""
    before = tmp_path / "arm.csv"
    before.write_text(TABLE + HIP.format(a=400, alpha=90) + SLIDE.format(lower=-100))
    after = TABLE + HIP.format(a=500, alpha=-90) + SLIDE.format(lower=-50)
    values = {"hip": {"a": "+100 mm", "alpha": "-90 deg"}, "slide": {"lower": "*0.5"}}
    expected = dh2urdf.convert(after).text.splitlines()[3:]
    assert dh2urdf.convert(before, edits=[{"values": values}]).text.splitlines()[3:] == expected
    cli("convert", "arm.csv", "--edit", f"values: {json.dumps(values)}", "-o", "cli.urdf")
    assert (tmp_path / "cli.urdf").read_text().splitlines()[3:] == expected
    run = {"inputs": "arm.csv", "edits": [{"stage": "values", "options": values}], "output": "out"}
    (tmp_path / "run.yaml").write_text(yaml.safe_dump(run))
    (made,) = dh2urdf.run(tmp_path / "run.yaml")["manipulators"]
    assert (tmp_path / "out" / "arm.urdf").read_text().splitlines()[3:] == expected
    assert made["proof"]["urdf"]["position_error"] < 1e-12
    # What the report says of the edit is what a run file says.
    report = json.loads((tmp_path / "out" / "report.json").read_bytes())
    assert report["reproduction"]["stages"][1] == {"kind": "edit", "stage": "values", "options": values}


def test_variants_are_changed_after_they_are_drawn(tmp_path: Path) -> None:
    """Side by side, each cell from the value that was drawn for it."""
    (tmp_path / "arm.csv").write_text(TABLE + HIP.format(a=400, alpha=90) + SLIDE.format(lower=-100))
    (tmp_path / "run.yaml").write_text(
        "inputs: arm.csv\nedits: [{stage: values, options: {hip: {a: '*2', d: 0.3}}}]\noutput: out\n"
        "variations: {of: arm, count: 40, vary: {joints: hip, field: a, uniform: [0.2, 0.6]}}\n"
        "emitters: [table]\nreport: {html: false}\n"
    )
    for row in dh2urdf.run(tmp_path / "run.yaml")["manipulators"][1:]:
        made = dh2urdf.read(tmp_path / "out" / row["files"][0]["path"]).rows[0]
        assert made.a == pytest.approx(2 * row["drawn"]["a_1"], rel=1e-12)
        assert made.d == 0.3


def test_the_schema_of_run_files_knows_the_cells(cli: Cli) -> None:
    """Joints have any names, cells are numbers or texts; options of `masses` by name have masses in units."""
    check = Draft202012Validator(json.loads(cli("schema", "run").stdout))

    def takes(stage: str, options: Any) -> bool:
        return check.is_valid({"inputs": "arm.csv", "edits": [{"stage": stage, "options": options}]})

    assert takes("values", {"hip": {"a": -0.6, "alpha": "*1.4"}, "knee": {}})
    assert takes("masses", {"total": "20.6 kg", "links": {"forearm": 2.3, "hand": "300 g"}})
    assert not takes("values", {"hip": 0.6})
    assert not takes("values", {"hip": {"a": [1]}})
    assert not takes("masses", {"links": {"forearm": True}})
    assert not takes("masses", {"hand": 2})


@pytest.mark.parametrize("wrong", [{"hip": 1}, {"hip": {"a": [1]}}, {"hip": {"a": None}}])
def test_cells_are_numbers_or_texts(wrong: Any) -> None:
    """The message names the joint and the cell as the user wrote them."""
    with pytest.raises(ConfigError) as refused:
        dh2urdf.convert(TABLE + HIP.format(a=400, alpha=90), edits=[{"values": wrong}])
    assert refused.value.problems[0].field in {"hip", "hip.a"}
