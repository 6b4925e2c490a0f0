"""`dh2urdf extract` and `dh2urdf.extract()`: tables of descriptions, printed and written."""

import io
import math
import re
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from command_line import Cli

import dh2urdf
from dh2urdf.errors import InputError, OutputError
from dh2urdf.kinematics import dh_frames
from dh2urdf.rotations import add, rotate

UR5 = """# convention: standard
joint, a,        alpha, d,        lower, upper, velocity, effort
pan,   0,        pi/2,  0.089159, -6,    6,     3.15,     150
lift,  -0.425,   0,     0,        -6,    6,     3.15,     150
elbow, -0.39225, 0,     0,        -3,    3,     3.15,     150
w1,    0,        pi/2,  0.10915,  -6,    6,     3.2,      28
w2,    0,        -pi/2, 0.09465,  -6,    6,     3.2,      28
w3,    0,        0,     0.0823,   -6,    6,     3.2,      28
"""
TREE = """<robot name="tree">
  <link name="foot"/> <link name="a"/> <link name="b"/> <link name="c"/>
  <joint name="j1" type="continuous"><parent link="foot"/><child link="a"/><axis xyz="0 0 1"/></joint>
  <joint name="j2" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint>
  <joint name="j3" type="continuous"><parent link="a"/><child link="c"/><axis xyz="1 0 0"/></joint>
</robot>
"""


WELDED = '<link name="d"/><joint name="j4" type="fixed"><parent link="foot"/><child link="d"/></joint>'


@pytest.fixture
def ur5(tmp_path: Path) -> Path:
    """The description of a table."""
    table = tmp_path / "ur5.csv"
    table.write_text(UR5)
    path = tmp_path / "ur5.urdf"
    dh2urdf.convert(table, path)
    return path


class TestPrinted:
    def test_both_conventions_and_the_facts(self, cli: Cli, ur5: Path) -> None:
        answer = cli("extract", str(ur5))
        standard, modified, facts = answer.stdout.strip().split("\n\n")
        assert standard.splitlines()[3].split() == ["lift", "revolute", "-0.425", "0", "0", "0"]
        assert modified.splitlines()[5].split() == ["w1", "revolute", "-0.39225", "0", "0.10915", "0"]
        assert "lift, elbow, w1" in facts

    def test_tips(self, cli: Cli, tmp_path: Path) -> None:
        path = tmp_path / "tree.urdf"
        path.write_text(TREE)
        assert cli("extract", str(path), "--tips").stdout == "b: 2 moving joints\nc: 2 moving joints\n"
        cli("extract", str(path), "--tips", "-o", "tips.csv", status=2)
        cli("extract", str(path), status=2)
        assert "j3" in cli("extract", str(path), "--tip-link", "c").stdout

    def test_every_tip(self, cli: Cli, tmp_path: Path) -> None:
        """Each chain under its name; a leaf that no joint moves is no arm. A program asks for one of them."""
        path = tmp_path / "tree.urdf"
        path.write_text(TREE.replace("</robot>", WELDED + "</robot>"))
        blocks = cli("extract", str(path), "--tip-link", "*", "--convention", "standard").stdout.strip().split("\n\n")
        heads = [block for block in blocks if "\n" not in block and "axes" not in block]
        assert heads == ["tree_b", "tree_c"]
        table = tmp_path / "chains.yaml"
        cli("extract", str(path), "--tip-link", "*", "-o", str(table))
        arms = list(dh2urdf.read_all(table))
        assert [(arm.name, len(arm.rows)) for arm in arms if isinstance(arm, dh2urdf.Manipulator)] == [
            ("tree_b", 2),
            ("tree_c", 2),
        ]
        with pytest.raises(InputError):
            dh2urdf.extract(path, tip_link="*")

    def test_a_chain_that_has_no_table_costs_no_other(self, cli: Cli, tmp_path: Path) -> None:
        """The others are printed and written; it is named with the reason, and the exit status tells."""
        path, table = tmp_path / "tree.urdf", tmp_path / "chains.yaml"
        head, mimic = '<joint name="{}" type="continuous">', '<mimic joint="elsewhere"/>'
        path.write_text(TREE.replace(third := head.format("j3"), third + mimic))
        for words in ((), ("--convention", "modified"), ("-o", str(table))):
            answer = cli("extract", str(path), "--tip-link", "*", *words, status=1)
            assert answer.stderr.count(f"{path}:5: error: joint 'j3'") == 1
            assert words[:1] == ("-o",) or answer.stdout.startswith("tree_b\n")
        assert [arm.name for arm in dh2urdf.read_all(table)] == ["tree_b"]
        table.unlink()
        path.write_text(path.read_text().replace(second := head.format("j2"), second + mimic))
        cli("extract", str(path), "--tip-link", "*", "-o", str(table), status=2)
        assert not table.exists()
        with pytest.raises(InputError) as caught:
            dh2urdf.extract(path, tip_link="c")
        assert caught.value.problems[0].joint == "j3"

    def test_standard_input(self, cli: Cli, ur5: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """A description that comes through a pipe has the tables of the file."""

        def piped(*words: str, status: int = 0) -> Any:
            monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(ur5.read_bytes())))
            return cli("extract", "-", *words, status=status)

        assert piped("--from", "urdf").stdout == cli("extract", str(ur5)).stdout
        table = tmp_path / "piped.yaml"
        piped("--from", "urdf", "-o", str(table))
        assert table.read_text().startswith("#> ur5 of standard input\n")
        piped(status=2)


class TestWritten:
    @pytest.mark.parametrize("name", ["arm.yaml", "arm.csv"])
    @pytest.mark.parametrize("units", [(), ("--length-unit", "mm", "--angle-unit", "deg")])
    def test_convert_reads_it(self, cli: Cli, ur5: Path, tmp_path: Path, name: str, units: tuple[str, ...]) -> None:
        table = tmp_path / name
        cli("extract", str(ur5), "-o", str(table), *units)
        assert table.read_text().startswith("#> ur5 of ur5.urdf\n#> ")
        again = dh2urdf.read(table)
        assert [row.a for row in again.rows] == pytest.approx([0, -0.425, -0.39225, 0, 0, 0], abs=1e-15)
        assert [row.alpha for row in again.rows] == [math.pi / 2, 0, 0, math.pi / 2, -math.pi / 2, 0]
        assert again.rows[0].limits.velocity == pytest.approx(3.15, abs=1e-12)
        cli("convert", str(table), "-o", str(tmp_path / "back.urdf"))

    @pytest.mark.parametrize("suffix", [".yaml", ".csv"])
    @pytest.mark.parametrize(
        ("robot", "file"), [("ur5", "lengths in mm.urdf"), ("name: base, 12 mm", "scara arm.urdf")]
    )
    def test_nothing_is_read_from_its_comments(
        self, ur5: Path, tmp_path: Path, robot: str, file: str, suffix: str
    ) -> None:
        """Comments repeat names of the description, whatever these are, and what it has in other namespaces."""
        head = f'<robot name="{robot}" xmlns:d="http://drake.mit.edu"><frame/><d:filter>3</d:filter>'
        text = re.sub(r"<robot [^>]*>", head, ur5.read_text()).replace("<limit ", '<limit d:acceleration="3" ')
        (tmp_path / file).write_text(text.replace("base_link", "base, 5 mm"))
        table = tmp_path / f"table{suffix}"
        arm = dh2urdf.extract(tmp_path / file, table)
        again = dh2urdf.read(table)
        assert again.name == robot
        assert [row.a for row in again.rows] == [row.a for row in arm.rows]
        assert not [notice for notice in again.notices if notice.mark and (notice.mark.line or 99) < 9]
        assert all(name in table.read_text() for name in ("d:acceleration", "d:filter"))

    @pytest.mark.parametrize("suffix", [".yaml", ".csv"])
    @pytest.mark.parametrize("numbers", [(1, 2, 3, 4, 5, 6), (8, 0, 1, 2, 3, 4)])
    def test_names_that_are_numbers(
        self, cli: Cli, ur5: Path, tmp_path: Path, numbers: tuple[int, ...], suffix: str
    ) -> None:
        """A column of numbers counts the rows of a table: such joints get names, which a notice and the file tell."""
        text = ur5.read_text()
        for name, number in zip(("pan", "lift", "elbow", "w1", "w2", "w3"), numbers, strict=True):
            text = text.replace(f'joint name="{name}"', f'joint name="{number}"')
        (tmp_path / "numbers.urdf").write_text(text)
        table = tmp_path / f"table{suffix}"
        cli("extract", str(tmp_path / "numbers.urdf"), "-o", str(table))
        assert f"{numbers[0]}, {numbers[1]}, {numbers[2]}, " in table.read_text()
        again = dh2urdf.read(table)
        assert [row.joint for row in again.rows] == [f"joint_{number}" for number in numbers]
        assert dh2urdf.extract(tmp_path / "numbers.urdf").fk([0.3] * 6) == pytest.approx(again.fk([0.3] * 6), abs=1e-9)

    @pytest.mark.parametrize("name", ["%x", "#> 1"])
    def test_a_name_like_a_comment(self, ur5: Path, tmp_path: Path, name: str) -> None:
        """The first cell of a CSV's row is in quotes where it begins as a comment does."""
        (tmp_path / "arm.urdf").write_text(ur5.read_text().replace('name="lift"', f'name="{name}"'))
        dh2urdf.extract(tmp_path / "arm.urdf", tmp_path / "arm.csv")
        assert [row.joint for row in dh2urdf.read(tmp_path / "arm.csv").rows][:3] == ["pan", name, "elbow"]

    def test_meshes_of_other_formats(self, ur5: Path, tmp_path: Path) -> None:
        """Drake's descriptions have glTF files, for which no table has a place: they are left out, and the arm is not."""
        (tmp_path / "part.gltf").write_text("{}")
        seen = '<visual><geometry><mesh filename="part.gltf"/></geometry></visual>'
        text = re.sub(r"<visual>.*?</visual>", "", ur5.read_text(), flags=re.DOTALL)
        (tmp_path / "arm.urdf").write_text(text.replace("</inertial>", f"</inertial>{seen}"))
        arm = dh2urdf.extract(tmp_path / "arm.urdf", tmp_path / "arm.yaml")
        assert any("part.gltf" in notice.message for notice in arm.notices)
        assert dh2urdf.convert(tmp_path / "arm.yaml", tmp_path / "back.urdf").proofs
        assert dh2urdf.convert(tmp_path / "arm.urdf").text

    @pytest.mark.parametrize("where", ["arm.yaml", "tables/arm.yaml"])
    def test_paths_of_meshes_lead_from_the_table(self, ur5: Path, tmp_path: Path, where: str) -> None:
        """The folder of both may be moved: the table had the path that the mesh had before."""
        (tmp_path / "a" / "tables").mkdir(parents=True)
        (tmp_path / "a" / "part.stl").write_bytes(bytes(84))
        text = re.sub(r"<visual>.*?</visual>", "", ur5.read_text(), flags=re.DOTALL)
        seen = '<visual><geometry><mesh filename="part.stl"/></geometry></visual>'
        (tmp_path / "a" / "arm.urdf").write_text(text.replace("</inertial>", f"</inertial>{seen}"))
        dh2urdf.extract(tmp_path / "a" / "arm.urdf", tmp_path / "a" / where)
        (tmp_path / "a").rename(tmp_path / "b")
        meshes = [row.visual for row in dh2urdf.read(tmp_path / "b" / where).rows]
        assert {mesh.file.path for mesh in meshes if mesh} == {str(tmp_path / "b" / "part.stl")}

    def test_the_description_stays(self, ur5: Path) -> None:
        with pytest.raises((OutputError, InputError)):
            dh2urdf.extract(ur5, ur5)


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize(
    "rows",
    [
        "q1,0.4,0.3,0\n-q2 + pi/3,0,0.2,pi\n0,d3 + 0.1,0.05,0\n",  # a SCARA
        "q1 - pi/2,0.333,0.0825,-pi/2\npi/4 - q2,0.1,-0.2,pi/3\nq3,0,0,pi/2\nq4,0.2,0.1,0.3\n",
        "q1,0.1,0,pi/2\n0.2,0.3,0.1,0.4\nq3,0.1,0,0\n",  # a fixed row between
    ],
)
def test_a_table_in_the_other_convention_is_the_same_arm(cli: Cli, tmp_path: Path, rows: str, convention: str) -> None:
    """Bodies, limits and joint values mean the same."""
    other = "modified" if convention == "standard" else "standard"
    table, out = tmp_path / "arm.csv", tmp_path / "out.yaml"
    count = rows.count("\n")
    types = ["P" if "d3" in row else "R" if "q" in row else "F" for row in rows.splitlines()]
    text = "".join(f"{kind},{row},0.5,0.01,0.02,0.03\n" for kind, row in zip(types, rows.splitlines(), strict=True))
    table.write_text(
        f"# convention: {convention}\n# tool: {{xyz: [0.1, 0, 0.2]}}\ntype,theta,d,a,alpha,mass,com_x,com_y,com_z\n{text}"
    )
    cli("extract", str(table), "--convention", other, "-o", str(out))
    given, found = dh2urdf.read(table), dh2urdf.read(out)
    assert found.convention == other
    assert len(found.rows) == count
    for value in (0.0, 0.7, -1.3):
        q = [value * (1 + 0.1 * k) for k in range(len(given.moving_rows))]
        assert np.abs(given.fk(q) - found.fk(q)).max() < 1e-9
        for one, two, row, same in zip(
            dh_frames(given, q)[1:], dh_frames(found, q)[1:], given.rows, found.rows, strict=True
        ):
            np.testing.assert_allclose(
                add(one.translation, rotate(one.rotation, row.com)),
                add(two.translation, rotate(two.rotation, same.com)),
                atol=1e-9,
            )


class TestPython:
    def test_a_text(self) -> None:
        assert len(dh2urdf.extract(TREE, reader="urdf", tip_link="b").rows) == 2
