import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from command_line import Cli

import dh2urdf
from dh2urdf.errors import ConfigError, Dh2UrdfError, EmitterError, InputError, OutputError, TableError

CONFIGS = Path(__file__).parents[2] / "configs"
ARMS = "# convention: standard\nrobot,a,alpha,d\nleft,0.4,0,0.1\nbad,0.4,ninety,0.1\nright,0.3,0,0.1\n"
BARE = "joint,a,alpha,d\nshoulder,0,90,100\nelbow,400,0,0\n"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with tables in it."""
    shutil.copy(CONFIGS / "tables" / "ur5.csv", tmp_path)
    (tmp_path / "arms.csv").write_text(ARMS)
    (tmp_path / "bare.csv").write_text(BARE)
    (tmp_path / "run.yaml").write_text("inputs: [ur5.csv, arms.csv]\noutput: {directory: out}\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


class TestNames:
    def test_all_of_them_are_there(self) -> None:
        """Every public name can be asked for, is listed, no other is, and it is the very thing of its module."""
        for name in dh2urdf.__all__:
            assert getattr(dh2urdf, name) is not None
        assert {name for name in dir(dh2urdf) if not name.startswith("__")} == set(dh2urdf.__all__) - {"__version__"}
        assert dh2urdf.Manipulator is sys.modules["dh2urdf.manipulator"].Manipulator
        assert dh2urdf.kinematics.chain is sys.modules["dh2urdf.kinematics.chain"]

    @pytest.mark.long
    def test_they_are_typed(self, tmp_path: Path, types_cache: Path) -> None:
        """mypy --strict knows what each function takes and gives, and no name that is not there."""
        (tmp_path / "use.py").write_text(
            "import dh2urdf\n"
            "arm = dh2urdf.read('ur5.csv')\n"
            "reveal_type(arm)\n"
            "reveal_type(dh2urdf.convert(arm, formats=['urdf']).proofs)\n"
            "reveal_type(arm.fk([0.0] * 6))\n"
            "dh2urdf.convert(1)\n"
            "dh2urdf.reed\n"
        )
        checked = subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--cache-dir", str(types_cache), "use.py"],
            capture_output=True,
            text=True,
            check=False,
        )
        told = checked.stdout.splitlines()
        assert 'Revealed type is "dh2urdf.manipulator.Manipulator"' in told[0]
        assert "dh2urdf.kinematics.proof.Proof | None" in told[1].replace(
            "Union[dh2urdf.kinematics.proof.Proof, None]", "dh2urdf.kinematics.proof.Proof | None"
        )
        assert "numpy.ndarray" in told[2]
        assert [line.partition(": error: ")[0] for line in told if ": error:" in line] == ["use.py:6", "use.py:7"]


class TestRead:
    def test_a_table(self) -> None:
        """The one manipulator of a file, with the options of its reader as arguments of any kind."""
        assert dh2urdf.read("ur5.csv").name == "ur5"
        base = {"xyz": [0, 0, "30 cm"]}
        arm = dh2urdf.read(Path("bare.csv"), convention="modified", length_unit="mm", angle_unit="deg", base=base)
        assert (str(arm.convention), arm.rows[1].a, arm.rows[0].alpha) == ("modified", 0.4, np.pi / 2)
        assert arm.base.translation == (0.0, 0.0, 0.3)

    def test_one_of_several(self) -> None:
        """`robot` says which; without it the error says how, and how to get all of them."""
        assert dh2urdf.read("arms.csv", robot="right").rows[0].a == 0.3
        for how in ({}, {"robot": "rihgt"}):
            with pytest.raises(TableError):
                dh2urdf.read("arms.csv", **how)

    def test_all_of_several(self) -> None:
        """They come one by one; a bad one is in its place with its problems, and the others go on."""
        found = list(dh2urdf.read_all("arms.csv"))
        assert [item.name for item in found] == ["left", "bad", "right"]
        bad = found[1]
        assert isinstance(bad, dh2urdf.Rejected)
        assert bad.problems[0].field == "alpha"


class TestConvert:
    def test_it_is_what_the_command_writes(self, cli: Cli) -> None:
        """Byte for byte, from a file and from what was read, with the same options, into a file and without one."""
        cli("convert", "ur5.csv", "-o", "cli.urdf", "--frames", "dh", "--set", "density=1000")
        expected = Path("cli.urdf").read_bytes()
        for table in ("ur5.csv", dh2urdf.read("ur5.csv")):
            made = dh2urdf.convert(table, "api.urdf", frames="dh", density=1000)
            assert Path("api.urdf").read_bytes() == expected == made.files["api.urdf"]
            assert dh2urdf.convert(table, frames="dh", density=1000.0).text.encode() == expected
        assert cli("convert", "ur5.csv", "--to", "xacro").stdout == dh2urdf.convert("ur5.csv", formats="xacro").text

    def test_it_comes_with_its_proof(self) -> None:
        """Every format that can be read back has been; manipulator, robot and notices are at hand."""
        made = dh2urdf.convert("ur5.csv", formats=["urdf", "xacro"])
        assert list(made.files) == ["ur5.urdf", "ur5.urdf.xacro"]
        for proof in made.proofs.values():
            assert proof is not None
            assert proof.holds
            assert proof.position_error < 1e-12
        assert (made.manipulator, made.robot.name) == (dh2urdf.read("ur5.csv"), "ur5")
        Path("odd.csv").write_text("# convention: standard\na,alpha,d,colour\n0.4,0,0.1,red\n")
        assert "colour" in str(dh2urdf.convert("odd.csv").notices[0])

    def test_several_formats_fill_a_folder(self) -> None:
        """Under the manipulator's name, each with all its files; an option goes to every format that has it."""
        made = dh2urdf.convert("ur5.csv", "out/new", formats=["urdf", "xacro"], profile="portable")
        assert {path.name for path in Path("out/new").iterdir()} == set(made.files)
        assert set(made.files) == {"ur5.urdf", "ur5.urdf.xacro", "ur5_macro.xacro"}

    @pytest.mark.parametrize(
        ("how", "error"),
        [
            ({"frame": "dh"}, ConfigError),
            ({"frames": "d"}, ConfigError),
            ({"out": "folder"}, ConfigError),
            ({"meshes": "relative"}, ConfigError),
            ({"formats": "urdff"}, InputError),
            ({"formats": ["urdf", "urdf"]}, EmitterError),
            ({"robot": "ur10"}, TableError),
            ({"out": "ur5.csv/arm.urdf"}, OutputError),
            ({"out": "arm.docx"}, InputError),
        ],
        ids=lambda value: "-".join(value) if isinstance(value, dict) else "",
    )
    def test_what_is_wrong_is_told(self, how: dict[str, object], error: type[Dh2UrdfError]) -> None:
        """Each error is a documented one and speaks of arguments, not of flags; nothing is written."""
        Path("folder").mkdir()
        before = set(Path().iterdir())
        with pytest.raises(error) as raised:
            dh2urdf.convert("ur5.csv", **how)  # type: ignore[arg-type]
        assert "--" not in str(raised.value)
        assert set(Path().iterdir()) == before
        for given in ({"robot": "ur5"}, {"reader": "csv"}, {"convention": "standard"}):
            with pytest.raises(ConfigError):  # It is a manipulator already.
                dh2urdf.convert(dh2urdf.read("ur5.csv"), **given)  # type: ignore[arg-type]


class TestRun:
    def test_it_is_what_the_command_does(self, cli: Cli) -> None:
        """The same report, the same files; a failed manipulator is reported, and is no exception."""
        report = dh2urdf.run("run.yaml")
        assert report == json.loads(Path("out/report.json").read_bytes())
        assert report["exit_status"] == 1
        assert [entry["status"] for entry in report["manipulators"]] == ["ok", "ok", "failed", "ok"]
        written = Path("out/ur5.urdf").read_bytes()
        assert report == json.loads(cli("run", "run.yaml", "--json", "-o", "cli", status=1).stdout)
        assert Path("cli/ur5.urdf").read_bytes() == written

    @pytest.mark.long
    def test_it_can_be_changed(self) -> None:
        """Settings, another place and a dry run, as the command has them."""
        looked = dh2urdf.run("run.yaml", dry_run=True)
        assert not Path("out").exists()
        assert looked["manipulators"][0]["status"] == "planned"
        report = dh2urdf.run("run.yaml", Path("there"), settings={"emitters": ["urdf", "mjcf"], "proof.poses": 3})
        assert [file["path"] for file in report["manipulators"][0]["files"]] == ["ur5.urdf", "ur5.xml"]
        assert report["manipulators"][0]["proof"]["urdf"]["poses"] == 6
        assert Path("there/ur5.urdf").is_file()


class TestForwardKinematics:
    def test_of_any_link(self) -> None:
        """A robot has that of every link, at the joints on the way to it."""
        robot = dh2urdf.convert("ur5.csv").robot
        at_two = robot.fk([[0.0, 0.0], [np.pi / 2, 0.0]], "link_2")
        np.testing.assert_allclose(at_two[:, :3, 3], [[0, 0, 0.089159]] * 2, atol=1e-12)
        np.testing.assert_allclose(at_two[1, :3, 0], [0, 1, 0], atol=1e-12)
