"""Two plugins with one name, and plugins that are left out: by the commands, as a person types them."""

import json
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from dh2urdf import __version__

Command = Callable[..., CompletedProcess[str]]

STAGES = """
from pathlib import Path
from dh2urdf.hookspecs import hookimpl
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.stages import EmittedFile, Emitter, NoOptions, Reader

with Path("imported").open("a") as log:
    log.write("{who}\\n")

def read(path, options):
    row = DHRow(joint="turn", link="one", a=0.5, alpha=0.0, d=0.0)
    yield Manipulator(name="arm_by_{who}", convention=Convention.STANDARD, rows=(row,))

def emit(robot, stem, options):
    return [EmittedFile(name=stem + ".usd", content=b"by {who}")]

@hookimpl
def dh2urdf_readers():
    yield Reader(name="table", summary="s", read=read, options=NoOptions, suffixes=(".tab",))

@hookimpl
def dh2urdf_emitters():
    yield Emitter(name="usd", summary="s", emit=emit, options=NoOptions, suffixes=(".usd",))
"""
RUN = "inputs: [a.csv, b.csv]\nemitters: [{emitter}]\noutput: {{directory: out}}\nreport: {{html: false}}\n"
BUILT_IN = f"dh2urdf {__version__}"
TABLE = "# convention: standard\na, alpha, d\n0.4, pi/2, 0.1\n0.3, 0, 0\n"
CLAIMED = "emitter 'usd' is claimed by lab-one 1.0 and by lab-two 1.0; say which is meant: lab-one:usd or lab-two:usd"


@pytest.fixture
def site(tmp_path: Path, install: Callable[..., None]) -> list[Path]:
    """Two distributions, each in a folder of its own, whose plugins claim the same names; each import is written down."""
    folders = [tmp_path / "site_one", tmp_path / "site_two"]
    for folder, who in zip(folders, ("one", "two"), strict=True):
        install(folder, f"lab-{who}", STAGES.replace("{who}", who), plugin=f"plugin_{who}")
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text(TABLE)
    (tmp_path / "arm.tab").touch()
    (tmp_path / "run.yaml").write_text(RUN.format(emitter="usd"))
    return folders


@pytest.fixture
def imported(tmp_path: Path) -> Callable[[], set[str]]:
    """Who has been imported since it was asked last."""

    def since() -> set[str]:
        log = tmp_path / "imported"
        found = set(log.read_text().split()) if log.exists() else set()
        log.unlink(missing_ok=True)
        return found

    return since


class TestAClash:
    def test_it_is_an_error_for_who_uses_the_name(self, dh2urdf: Command, site: list[Path], tmp_path: Path) -> None:
        """The place, both distributions and both ways to say which is meant; nothing is written."""
        assert f"run.yaml:2:12: error: {CLAIMED}" in dh2urdf("run", "run.yaml", path=site, status=3).stderr
        assert CLAIMED in dh2urdf("convert", "a.csv", "--to", "usd", path=site, status=3).stderr
        assert not (tmp_path / "out").exists()

    @pytest.mark.parametrize("order", [1, -1])
    def test_the_run_file_says_which(self, dh2urdf: Command, site: list[Path], tmp_path: Path, order: int) -> None:
        """Whatever is found first: `distribution:stage` decides, with several workers, too; reports have the short name."""
        (tmp_path / "run.yaml").write_text(RUN.format(emitter='"lab-one:usd"'))
        dh2urdf("run", "run.yaml", "--workers", "2", path=site[::order])
        assert (tmp_path / "out" / "a.usd").read_text() == (tmp_path / "out" / "b.usd").read_text() == "by one"
        report = json.loads((tmp_path / "out" / "report.json").read_bytes())
        assert {file["stage"] for row in report["manipulators"] for file in row["files"]} == {"usd"}

    def test_the_command_line_says_which(self, dh2urdf: Command, site: list[Path], tmp_path: Path) -> None:
        """In `run` by --set, in `convert` by --to and --from."""
        dh2urdf("run", "run.yaml", "--set", "emitters.0.stage=lab-two:usd", path=site)
        assert (tmp_path / "out" / "a.usd").read_text() == "by two"
        words = ("convert", "arm.tab", "--from", "lab-one:table", "--to", "Lab_Two:usd")
        assert dh2urdf(*words, path=site).stdout == "by two"
        dh2urdf("convert", "arm.tab", "--from", "lab-two:table", "-o", "arm.urdf", path=site)
        assert "arm_by_two" in (tmp_path / "arm.urdf").read_text()

    def test_it_is_listed(self, dh2urdf: Command, site: list[Path]) -> None:
        """`dh2urdf plugins` names it without anybody using it, and its JSON has it as its schema says."""
        assert "claimed twice: emitter usd by lab-one 1.0 and lab-two 1.0" in dh2urdf("plugins", path=site).stdout
        clashes = json.loads(dh2urdf("plugins", "--json", path=site).stdout)["clashes"]
        assert [(clash["kind"], clash["name"]) for clash in clashes] == [("reader", "table"), ("emitter", "usd")]
        assert clashes[1]["choices"] == ["lab-one:usd", "lab-two:usd"]


class TestLeavingOut:
    def test_it_ends_a_clash(
        self, dh2urdf: Command, site: list[Path], tmp_path: Path, imported: Callable[[], set[str]]
    ) -> None:
        """The other one has the name to itself; what is left out is imported by no process, workers included."""
        dh2urdf("run", "run.yaml", "--without", "plugin_one", "--workers", "2", path=site)
        assert (tmp_path / "out" / "a.usd").read_text() == "by two"
        assert imported() == {"two"}

    @pytest.mark.parametrize(
        "words",
        [("--without", "lab-two", "convert", "arm.tab", "-o", "arm.usd"), ("schema", "--without", "lab-two")],
        ids=" ".join,
    )
    def test_other_commands_heed_it(
        self, dh2urdf: Command, site: list[Path], imported: Callable[[], set[str]], words: tuple[str, ...]
    ) -> None:
        """With the option before the command or behind."""
        dh2urdf(*words, path=site)
        assert imported() == {"one"}

    def test_help_imports_no_plugin(self, dh2urdf: Command, site: list[Path], imported: Callable[[], set[str]]) -> None:
        """Of each command; that of the program lists the commands that plugins add."""
        for words in (("run",), ("convert",), ("check",), ("plugins",), ("schema",)):
            dh2urdf(*words, "--help", path=site)
        assert imported() == set()


ALL_FORMATS = """
from dataclasses import replace
from pathlib import Path
from dh2urdf.hookspecs import hookimpl
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.formats.urdf import EMITTER
from dh2urdf_plugins.readers.stages import CSV
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

with Path("imported").open("a") as log:
    log.write("greedy\\n")

def emit(robot, stem, options):
    return [EmittedFile(name=stem + ".urdf", content=b"greedy")]

@hookimpl
def dh2urdf_readers():
    return [replace(CSV, read=None)]

@hookimpl
def dh2urdf_transforms():
    return [replace(TRANSFORM, transform=None)]

@hookimpl
def dh2urdf_emitters():
    claims = [("urdf", (".urdf", ".sdf")), ("robot", (".urdf", ".robot")), ("lab", (".lab.urdf",))]
    return [replace(EMITTER, name=name, emit=emit, suffixes=ends, capabilities=()) for name, ends in claims]
"""
HANGING = """
from pathlib import Path
with Path("imported").open("a") as log:
    log.write("hanging\\n")
raise SystemExit("imported")
"""


class TestBuiltInNames:
    @pytest.fixture
    def greedy(self, tmp_path: Path, install: Callable[..., None]) -> list[Path]:
        """A distribution that claims names and suffixes of built-in stages."""
        install(tmp_path / "greedy", "greedy", ALL_FORMATS)
        (tmp_path / "a.csv").write_text(TABLE)
        return [tmp_path / "greedy"]

    def test_a_name_and_a_suffix_mean_the_built_in_stage(
        self, dh2urdf: Command, greedy: list[Path], tmp_path: Path
    ) -> None:
        """Another distribution that claims them breaks nothing."""
        dh2urdf("convert", "a.csv", "-o", "out.urdf", path=greedy)
        assert (tmp_path / "out.urdf").read_text().startswith("<?xml")
        assert dh2urdf("convert", "a.csv", "--to", "urdf", path=greedy).stdout.startswith("<?xml")

    @pytest.mark.parametrize(
        ("words", "chosen"), [(("--to", "greedy:urdf"), b"greedy"), (("-o", "out.lab.urdf"), b"greedy")]
    )
    def test_what_chooses_the_other_one(
        self, dh2urdf: Command, greedy: list[Path], tmp_path: Path, words: tuple[str, str], chosen: bytes
    ) -> None:
        """Its full name, a name or a suffix that no built-in stage has, and a longer suffix."""
        answer = dh2urdf("convert", "a.csv", *words, path=greedy)
        written = (tmp_path / words[1]).read_bytes() if words[0] == "-o" else answer.stdout.encode()
        assert written.startswith(chosen)

    def test_a_warning_says_so(self, dh2urdf: Command, greedy: list[Path]) -> None:
        """Where the other plugin is imported for something else, or its entry point names the stage: once."""
        told = dh2urdf("convert", "a.csv", "-o", "out.v2.urdf", path=greedy).stderr
        used = f"warning: the emitter 'urdf' of {BUILT_IN} is used"
        assert told.count(f"{used}; `greedy:urdf` chooses the one of greedy 1.0\n") == 1
        assert told.count(f"{used} for files .urdf; `greedy:robot` chooses the one of greedy 1.0\n") == 1


class TestWhatIsNotNeeded:
    @pytest.fixture
    def hanging(self, tmp_path: Path, install: Callable[..., None]) -> list[Path]:
        """A plugin whose import is seen, and a plugin of two stages whose entry points name them."""
        install(tmp_path / "site", "hanging", HANGING)
        install(tmp_path / "site", "lab-one", STAGES.replace("{who}", "one"), plugin="emitter.usd")
        points = tmp_path / "site" / "lab_one-1.0.dist-info" / "entry_points.txt"
        points.write_text(points.read_text() + "reader.table = lab_one_emitter_usd\n")
        (tmp_path / "a.csv").write_text(TABLE)
        (tmp_path / "b.csv").write_text(TABLE)
        (tmp_path / "arm.tab").touch()
        (tmp_path / "run.yaml").write_text(RUN.format(emitter="urdf"))
        return [tmp_path / "site"]

    def test_what_built_in_stages_do_imports_no_plugin(
        self, dh2urdf: Command, hanging: list[Path], imported: Callable[[], set[str]]
    ) -> None:
        """So no plugin can stop it."""
        dh2urdf("convert", "a.csv", "-o", "out.urdf", path=hanging)
        dh2urdf("run", "run.yaml", "--workers", "2", path=hanging)
        assert imported() == set()

    def test_a_name_in_an_entry_point_is_found_by_it(
        self, dh2urdf: Command, hanging: list[Path], imported: Callable[[], set[str]]
    ) -> None:
        """The other plugins are not asked; one module may have an entry point for each of its stages."""
        words = ("convert", "arm.tab", "--from", "table", "--to", "usd")
        assert dh2urdf(*words, path=hanging).stdout == "by one"
        assert imported() == {"one"}
        listed = json.loads(dh2urdf("plugins", "--json", path=hanging).stdout)
        theirs = [(each["kind"], each["name"]) for each in listed["stages"] if each["distribution"] == "lab-one 1.0"]
        assert theirs == [("reader", "table"), ("emitter", "usd")]
