"""`dh2urdf info`: what it declares about a table is in the table, at the place that it says, and true."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from jsonschema import Draft202012Validator
from terminal import on_a_terminal

import dh2urdf
from dh2urdf.manipulator import JointType
from dh2urdf.report.schema import info_schema

TABLES = sorted((Path(__file__).parents[3] / "configs" / "tables").iterdir())
ARM = """\
# convention: standard
# units: {length: mm, angle: deg}
# tool: {xyz: [0, 0, 60]}
joint,    type,      a,   alpha, d,         theta,       lower, upper, mass
waist,    revolute,  0,   90,    300,       0,           -170,  170,   4
shoulder, ,          250, 0,     0,         q2 + 90,     -1 rad, 90,
slide,    prismatic, 0,   0,     20 - q3,   0,           0,     200,
hand,     fixed,     30,  0,     40,        15,          ,      ,
"""
ARMS = "# convention: standard\nrobot,a,alpha,d\nleft,0.4,0,0.1\nright,0.4,0,0.1\nbad,0.4,ninety,0.1\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.csv").write_text(ARM)
    (tmp_path / "arms.csv").write_text(ARMS)
    return tmp_path


def report(text: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(text)
    assert [error.message for error in Draft202012Validator(info_schema()).iter_errors(data)] == []
    return data


def fields(detail: dict[str, Any], joint: str) -> dict[str, dict[str, Any]]:
    (found,) = [each for each in detail["joints"] if each["name"] == joint]
    return {field["field"]: field for field in found["fields"]}


@pytest.mark.usefixtures("folder")
class TestFields:
    def test_a_number_has_its_value_its_text_its_unit_and_its_cell(self, cli: Cli) -> None:
        """In SI units to the last bit, as it was typed, the unit it was read in, file:line:column."""
        found = fields(report(cli("info", "arm.csv", "--json").stdout)["detail"], "waist")
        assert found["alpha"] == {
            "field": "alpha",
            "value": math.pi / 2,
            "unit": "rad",
            "from": "cell",
            "typed": "90",
            "read_in": "deg",
            "place": "arm.csv:5:27",
        }
        assert (found["d"]["value"], found["d"]["read_in"], found["mass"]["read_in"]) == (0.3, "mm", "kg")

    def test_what_is_not_said_is_marked(self, cli: Cli) -> None:
        """A default, and what the transform computes, have no cell."""
        found = fields(report(cli("info", "arm.csv", "--json").stdout)["detail"], "shoulder")
        origins = {name: found[name]["from"] for name in ("type", "link", "sign", "velocity", "effort", "mass")}
        assert origins == {
            **dict.fromkeys(("type", "link", "sign"), "default"),
            **dict.fromkeys(("velocity", "effort", "mass"), "computed"),
        }
        assert {found[name]["place"] for name in origins} == {None}

    @pytest.mark.parametrize("path", TABLES, ids=lambda path: path.name)
    def test_every_field_of_every_table_of_the_project(self, cli: Cli, path: Path) -> None:
        """Each typed text is at its place; each value of the manipulator is printed."""
        detail = report(cli("info", path, "--json").stdout)["detail"]
        arm, lines = dh2urdf.read(path), path.read_text("utf-8").splitlines()
        for row, joint in zip(arm.rows, detail["joints"], strict=True):
            told = {field["field"]: field["value"] for field in joint["fields"]}
            assert (told["a"], told["alpha"], told["d"], told["theta"]) == (row.a, row.alpha, row.d, row.theta)
            assert told["type"] == row.type
            if row.type is not JointType.FIXED:
                assert (told["offset"], told["sign"]) == (row.offset, row.sign)
            for field in joint["fields"]:
                if field["place"] is not None:
                    _, line, column = field["place"].rsplit(":", 2)
                    assert lines[int(line) - 1][int(column) - 1 :].lstrip().startswith(field["typed"])


@pytest.mark.usefixtures("folder")
class TestTheArm:
    def test_where_convention_base_and_tool_are_said(self, cli: Cli) -> None:
        """The line of each; a base that is not said is a default."""
        detail = report(cli("info", "arm.csv", "--json").stdout)["detail"]
        assert detail["convention"] == {"value": "standard", "place": "arm.csv:1:15"}
        assert (detail["tool"]["xyz"], detail["tool"]["place"]) == ([0, 0, 0.06], "arm.csv:3:9")
        assert (detail["base"]["from"], detail["base"]["place"]) == ("default", None)
        units = {unit["of"]: (unit["unit"], unit["place"]) for unit in detail["units"]}
        assert units == {"length": ("mm", "arm.csv:2:19"), "angle": ("deg", "arm.csv:2:30")}

    @pytest.mark.parametrize("path", TABLES, ids=lambda path: path.name)
    def test_the_pose_and_the_bound(self, cli: Cli, path: Path) -> None:
        """T(q=0) is the DH product, and no pose within the limits is beyond the bound; some come near to it."""
        detail = report(cli("info", path, "--json").stdout)["detail"]
        arm = dh2urdf.read(path)
        robot = dh2urdf.convert(path).robot
        zero = np.zeros(len(arm.moving_rows))
        assert np.allclose(detail["pose_at_zero"], arm.fk(zero), rtol=0, atol=1e-12)
        limits = [(joint.limits.lower, joint.limits.upper) for joint in robot.moving_joints]
        q = np.random.default_rng(1).uniform(*np.array(limits, dtype=float).T, size=(20_000, len(limits)))
        q = np.concatenate([q, np.array(limits, dtype=float).T])
        origin = np.array(arm.base.translation)
        distance = np.linalg.norm(arm.fk(q)[:, :3, 3] - origin, axis=1).max()
        bound = detail["largest_distance"]["bound"]
        assert 0.6 * bound < distance <= bound + 1e-12

    def test_the_mass_and_what_of_it_is_computed(self, cli: Cli) -> None:
        """The robot's mass; the links without one in the table, and the base."""
        mass = report(cli("info", "arm.csv", "--json").stdout)["detail"]["mass"]
        assert mass["total"] == dh2urdf.convert("arm.csv").robot.mass
        assert mass["computed"] == ["link_2", "link_3", "link_4", "base"]


class TestOtherTables:
    def test_a_workbook_names_its_cells(self, cli: Cli, tmp_path: Path) -> None:
        """Sheet and cell, in values, notices and errors; by standard input too."""
        openpyxl = pytest.importorskip("openpyxl")
        book = openpyxl.Workbook()
        book.active.title = "Sheet2"
        for row in (
            ["# convention: standard"],
            ["joint", "a [mm]", "alpha [rad]", "d [m]"],
            ["one", 100, 1.5708, 0.02],
        ):
            book.active.append(row)
        book.save(tmp_path / "arm.xlsx")
        text = cli("info", "arm.xlsx", "--cells").stdout
        assert re.search(r"^one +a +0\.1 m +'100' +mm +arm\.xlsx:Sheet2!B3$", text, re.MULTILINE)
        assert re.search(r"^notice: arm\.xlsx:Sheet2!C3: ", text, re.MULTILINE)
        assert "convention: standard (said at arm.xlsx:Sheet2!A1)" in text

    def test_a_payload_is_told(self, cli: Cli, tmp_path: Path) -> None:
        """What the arm carries is part of what was understood."""
        (tmp_path / "arm.yaml").write_text(
            "convention: standard\npayload: {mass: 2, com: [0, 0, 0.1], inertia: {ixx: 0.1, iyy: 0.1, izz: 0.1}}\n"
            "joints: [{a: 0.4, alpha: 0, d: 0.1}]\n"
        )
        stated = report(cli("info", "arm.yaml", "--json").stdout)["detail"]["stated"]
        payload = stated["payload"]["value"]
        assert (payload["mass"], payload["com"]) == (2, [0, 0, 0.1])
        assert stated["payload"]["place"] == "arm.yaml:2:10"


@pytest.mark.usefixtures("folder")
class TestSeveral:
    def test_there_is_a_line_for_each(self, cli: Cli) -> None:
        """Those that cannot be read too; the status is 1 then."""
        data = report(cli("info", "arms.csv", "--json", status=1).stdout)
        assert [arm["name"] for arm in data["manipulators"]] == ["left", "right", "bad"]
        assert data["detail"] is None
        assert data["manipulators"][2]["errors"][0]["found"] == "ninety"
        text = cli("info", "arms.csv", status=1).stdout
        assert "3 manipulators" in text
        assert "bad: cannot be read: " in text

    def test_one_of_them(self, cli: Cli) -> None:
        """--robot shows one, with the cells of its own rows."""
        data = report(cli("info", "arms.csv", "--robot", "right", "--json").stdout)
        assert [arm["name"] for arm in data["manipulators"]] == ["right"]
        assert fields(data["detail"], "joint_1")["a"]["place"] == "arms.csv:4:7"
        for robot in ("rihgt", "bad"):
            cli("info", "arms.csv", "--robot", robot, status=2)


@pytest.mark.usefixtures("folder")
class TestForms:
    @pytest.mark.parametrize("form", [(), ("--markdown",)])
    def test_the_table_is_as_a_paper_prints_it(self, cli: Cli, folder: Path, form: tuple[str, ...]) -> None:
        """A row for each joint, units in the header, a star behind what the table does not say, and then the facts."""
        (folder / "scara.csv").write_text(
            "# convention: standard\ntheta,d [mm],a [mm],alpha\nq1 + pi/2,410,-0.5,pi/2\n-q2,0,440,pi\n0,d3,0,0\n"
        )
        text = cli("info", "scara.csv", *form).stdout
        assert form or "\\" not in text
        lines = [re.split(r" {2,}|(?<!\\)\|", line.strip("| ").replace("\\", "")) for line in text.splitlines()]
        rows = [[cell.strip() for cell in line] for line in lines if line[0].strip().startswith("joint")]
        assert rows[:4] == [
            ["joint", "type", "theta [rad]", "d [m]", "a [m]", "alpha [rad]"],
            ["joint_1", "revolute*", "q1 + pi/2", "0.41", "-0.0005", "pi/2"],
            ["joint_2", "revolute*", "-q2", "0", "0.44", "pi"],
            ["joint_3", "prismatic*", "0", "q3", "0", "0"],
        ]
        assert text.index("filled in: the table does not say it") < text.index("convention: standard (said at")

    def test_a_terminal_gets_a_table_that_fits(self, folder: Path) -> None:
        """No line is longer than 100 characters, and each cell is there."""
        _, _, printed = on_a_terminal(folder, "info", "arm.csv", "--cells", columns=200)
        lines = re.sub(r"\x1b\[[0-9;]*m", "", printed).splitlines()
        table = lines[next(number for number, line in enumerate(lines) if line.startswith("joint ")) :]
        assert max(map(len, table)) <= 100
        assert any("arm.csv:5:27" in line for line in table)

    def test_markdown(self, cli: Cli, folder: Path) -> None:
        """A table with a row for each field; what would be markup is escaped."""
        text = cli("info", "arm.csv", "--markdown", "--cells").stdout
        assert text.startswith("# arm\n")
        assert "| joint | field | value | as typed | read in | place |\n|---|---|---|---|---|---|\n" in text
        assert "| waist | alpha | 1.57079633 rad (90°) | '90' | deg | arm.csv:5:27 |" in text
        (folder / "a|b.csv").write_text(ARM)
        assert "a&#124;b.csv:5:27 |" in cli("info", "a|b.csv", "--markdown", "--cells").stdout
