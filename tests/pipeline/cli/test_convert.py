import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import Cli
from lxml import etree

from dh2urdf_plugins.formats.xacro.reader import expand

ARM = "joint,a,alpha,d\nshoulder,0,pi/2,0.1\nelbow,0.4,0,0\n"
STANDARD = f"# convention: standard\n{ARM}"
ARMS = "# convention: standard\nrobot,a,alpha,d\nleft,0.4,0,0.1\nright,0.4,0,0.1\n../up,0.4,0,0.1\nbad,0.4,ninety,0.1\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The working directory, with tables in it."""
    (tmp_path / "arm.csv").write_text(STANDARD)
    (tmp_path / "bare.csv").write_text(ARM)
    (tmp_path / "arms.csv").write_text(ARMS)
    return tmp_path


def files(folder: Path) -> set[str]:
    """What was written."""
    return {path.name for path in folder.iterdir()} - {"arm.csv", "bare.csv", "arms.csv"}


def robot_name(urdf: str | Path) -> str:
    return str((etree.parse(urdf).getroot() if isinstance(urdf, Path) else etree.fromstring(urdf.encode())).get("name"))


@pytest.mark.usefixtures("folder")
class TestStandardOutput:
    def test_a_urdf_is_the_default(self, cli: Cli) -> None:
        """Without -o the URDF goes to standard output, and nothing else does: the closing line is on standard error."""
        answer = cli("convert", "arm.csv")
        assert robot_name(answer.stdout) == "arm"
        assert answer.stderr.count("\n") == 1
        assert cli("convert", "arm.csv", "--quiet") == (answer.stdout, "")

    def test_it_is_the_same_as_the_file(self, cli: Cli, folder: Path) -> None:
        """Byte for byte; a dash names standard output too."""
        cli("convert", "arm.csv", "-o", "arm.urdf")
        expected = (folder / "arm.urdf").read_text("utf-8")
        assert cli("convert", "arm.csv").stdout == cli("convert", "arm.csv", "-o", "-").stdout == expected

    def test_a_xacro_is_one_file(self, cli: Cli, folder: Path) -> None:
        """The macro and its call are in one file, that the real xacro expands without another."""
        text = cli("convert", "arm.csv", "--to", "xacro").stdout
        alone = folder / "alone"
        alone.mkdir()
        (alone / "any.xacro").write_text(text, "utf-8")
        expanded = subprocess.run(
            [sys.executable, "-c", "import xacro; xacro.main()", str(alone / "any.xacro")],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        assert {joint.get("name") for joint in etree.fromstring(expanded.encode()).findall("joint")} >= {
            *("shoulder", "elbow")
        }


@pytest.mark.usefixtures("folder")
class TestFiles:
    def test_the_suffix_chooses_the_format(self, cli: Cli, folder: Path) -> None:
        """.urdf is a URDF; .urdf.xacro and .xacro are xacro, whose macro lies beside."""
        for name in ("one.urdf", "two.urdf.xacro", "three.xacro", "FOUR.URDF"):
            assert cli("convert", "arm.csv", "-o", name, "-q") == ("", "")
        assert files(folder) == {
            *("one.urdf", "two.urdf.xacro", "two_macro.xacro", "three.xacro", "three_macro.xacro", "FOUR.URDF")
        }
        assert b'name="shoulder"' in expand(folder / "two.urdf.xacro")
        assert b'name="shoulder"' in expand(folder / "three.xacro")

    @pytest.mark.parametrize("name", ["robots", "robots/", "new/"])
    def test_a_folder_takes_a_file_of_the_name_of_the_table(self, cli: Cli, folder: Path, name: str) -> None:
        """As it does of several tables, so that a pattern may match one."""
        (folder / "robots").mkdir()
        cli("convert", "arm.csv", "-o", name)
        assert robot_name(folder / name / "arm.urdf") == "arm"

    def test_a_folder_where_the_macro_goes_leaves_nothing(self, cli: Cli, folder: Path) -> None:
        """Both files, or none."""
        (folder / "arm_macro.xacro").mkdir()
        cli("convert", "arm.csv", "-o", "arm.xacro", status=2)
        assert files(folder) == {"arm_macro.xacro"}


@pytest.mark.usefixtures("folder")
class TestRobot:
    def test_a_name_that_is_a_path_names_no_file(self, cli: Cli, folder: Path) -> None:
        """The user's -o does."""
        cli("convert", "arms.csv", "--robot", "../up", "-o", "up.urdf")
        assert files(folder) == {"up.urdf"}
        assert robot_name(folder / "up.urdf") == "../up"


@pytest.mark.usefixtures("folder")
class TestOptions:
    def test_the_convention_is_never_guessed(self, cli: Cli) -> None:
        """A table that says none is an error; --convention says it."""
        cli("convert", "bare.csv", status=2)
        standard, modified = (cli("convert", "bare.csv", "--convention", word).stdout for word in ("DH", "Craig"))
        assert standard == cli("convert", "arm.csv").stdout.replace('name="arm"', 'name="bare"').replace(
            "arm:", "bare:"
        )
        assert standard != modified

    def test_base_and_tool(self, cli: Cli, folder: Path, tool0_of: Callable[..., Callable[..., object]]) -> None:
        """--base and --tool take the YAML of a table."""
        cli("convert", "arm.csv", "--base", "{xyz: [1, 0, 0.3]}", "--tool", "{xyz: [0, 0, 0.1]}", "-o", "arm.urdf")
        pose = tool0_of(folder / "arm.urdf")([0, 0])
        assert [float(x) for x in pose[:3, 3]] == pytest.approx([1.4, -0.1, 0.4])  # type: ignore[index]

    @pytest.mark.parametrize("setting", ["shape=box", "transform.shape=box", " shape = box"])
    def test_set(self, cli: Cli, setting: str) -> None:
        """--set reaches every option of the stages, with or without the kind of stage."""
        text = cli("convert", "arm.csv", "--set", setting, "--set", "radius=0.02").stdout
        assert '<box size="0.04 0.04 0.4"/>' in text

    @pytest.mark.parametrize(
        ("words", "found"),
        [
            (["--to", "udrf"], "udrf"),
            (["--base", "{xyz: [0, 0]}"], "xyz"),
            (["--frames", "dh", "--set", "frames=aligned"], "frames=aligned"),
            (["--set", "executor.workers=1"], "executor.workers"),
        ],
    )
    def test_a_wrong_word_is_an_error_before_anything_is_written(
        self, cli: Cli, folder: Path, words: list[str], found: str
    ) -> None:
        """Status 2, nothing on standard output, and the word that is wrong in the message."""
        answer = cli("convert", "arm.csv", *words, status=2)
        assert answer.stdout == ""
        assert found in answer.stderr
        assert files(folder) == set()


def test_a_conversion_that_fails_leaves_no_empty_folder(cli: Cli, folder: Path) -> None:
    """The emitter refuses a name when the folder is there already; one that was there before stays."""
    (folder / "bad.csv").write_text(STANDARD.replace("shoulder", "shoulder pan"))
    (folder / "old").mkdir()
    words = ("convert", "bad.csv", "--to", "ros2", "--set", "package=my_arm", "-o")
    for place in ("new/workspace/src", "old/src"):
        cli(*words, place, status=1)
    assert files(folder) == {"bad.csv", "old"}
    assert list((folder / "old").iterdir()) == []
