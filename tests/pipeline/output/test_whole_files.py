import os
import re
from pathlib import Path

import pytest
from command_line import Cli
from hypothesis import given, strategies as st

import dh2urdf
from dh2urdf.errors import OutputError
from dh2urdf.output.whole_files import LONGEST_STEM, Stems, put_in_place, safe_stem, staging, write_all, write_files
from dh2urdf.stages import EmittedFile

LONGEST_SUFFIX = "_macro.xacro"
any_text = st.text(st.characters(codec=None), max_size=300)
"""Any text at all, lone surrogates included: a table may come from anywhere."""


def tree(folder: Path) -> dict[str, bytes]:
    """Every file below a folder and what is in it."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class TestSafeStem:
    @given(any_text)
    def test_any_name_becomes_a_plain_file_name(self, name: str) -> None:
        """Whatever a manipulator is called, its files have a name that stays in the folder, on every file system."""
        stem = safe_stem(name)
        file = stem + LONGEST_SUFFIX
        assert Path(file).name == file
        assert len(file.encode()) <= 255
        assert stem[0] not in ".-"
        assert stem.isprintable()
        assert not set(stem) & set("/\\:*?\"<>|$`'&;!~ \0")
        assert not stem.endswith((".", " "))

    @pytest.mark.parametrize(
        ("name", "stem"),
        [
            ("../../etc/passwd", "etc_passwd"),
            ("C:\\Windows\\x", "C__Windows_x"),
            (".bashrc", "bashrc"),
            ("-rf", "rf"),
            ("KUKA LBR iiwa", "KUKA_LBR_iiwa"),
            ("gen3+gripper", "gen3+gripper"),
            ("机械臂", "机械臂"),
            ("a\nb\0c", "a_b_c"),
            ("$(touch x)", "touch_x"),
            ("", "robot"),
            ("con", "con_"),
            ("NUL.tar.gz", "NUL_.tar.gz"),
            ("console", "console"),
        ],
    )
    def test_what_a_file_system_would_act_on(self, name: str, stem: str) -> None:
        """Paths, hidden files, flags, control characters, shell words and devices become plain names."""
        assert safe_stem(name) == stem

    def test_long_names_stay_apart(self) -> None:
        """Names that differ only beyond the longest stem get stems that differ."""
        stems = {safe_stem("x" * 1000 + end) for end in "abc"}
        assert len(stems) == 3
        assert {len(stem) for stem in stems} == {LONGEST_STEM}


class TestStems:
    @pytest.mark.parametrize(
        ("first", "second"), [("arm", "arm"), ("Arm", "aRM"), ("a b", "a/b"), ("straße", "STRASSE"), ("", "robot")]
    )
    def test_names_that_clash_get_stems_of_their_own(self, first: str, second: str) -> None:
        """Equal stems, also on file systems that ignore case, get different names, and a notice says which."""
        stems = Stems()
        stem, nothing = stems.claim(first)
        other, notice = stems.claim(second)
        assert nothing is None
        assert other == f"{safe_stem(second)}-2"
        assert notice is not None
        assert (notice.severity, notice.robot) == ("notice", second)
        assert notice.code == "stem-changed"
        assert stem.casefold() != other.casefold()

    def test_a_name_that_looks_like_a_numbered_one(self) -> None:
        """A manipulator that is really called arm-2 is not overwritten by the second arm."""
        stems = Stems()
        given_out = [stems.claim(name)[0] for name in ("arm", "arm-2", "arm", "arm", "ARM-2")]
        assert given_out == ["arm", "arm-2", "arm-3", "arm-4", "ARM-2-2"]

    @given(names=st.lists(st.text("ab-_.", max_size=6), max_size=50))
    def test_no_two_manipulators_share_a_file(self, names: list[str]) -> None:
        """Whatever is behind their stems: each name is compared with all others."""
        endings = [(".b", ".a.b"), ("_a.b",), ("-b_a.b",), (".a.a.b",)]
        stems = Stems(endings=endings)
        given_out = [stems.claim(name)[0] for name in names]
        own = [{stem + ending for some in endings for ending in some} for stem in given_out]
        assert len(set().union(*own)) == sum(map(len, own))


class TestStaging:
    @pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, SystemExit, GeneratorExit])
    def test_nothing_is_left_behind_whatever_happens(self, tmp_path: Path, error: type[BaseException]) -> None:
        """An error, Ctrl-C and a plugin that leaves all take the half-written files along."""
        (tmp_path / "old.urdf").write_text("old")

        def interrupted() -> None:
            with staging(tmp_path) as folder:
                (folder / "old.urdf").write_text("half of the new")
                raise error

        with pytest.raises(error):
            interrupted()
        assert tree(tmp_path) == {"old.urdf": b"old"}
        assert len(list(tmp_path.iterdir())) == 1

    def test_a_file_where_the_folder_should_be(self, tmp_path: Path) -> None:
        """A file in the way is an error of one line that names it and the system's reason."""
        (tmp_path / "out").write_text("a file")
        with pytest.raises(OutputError, match=re.escape(f"'{tmp_path / 'out'}'")), staging(tmp_path / "out"):
            pass


class TestWriteFiles:
    def test_a_file_may_lie_in_a_folder_which_is_put_in_place_and_gone_from_staging(self, tmp_path: Path) -> None:
        """The folders are made, here and where the file belongs."""
        with staging(tmp_path / "out") as folder:
            write_files(folder, [EmittedFile(name="p/q/a.urdf", content=b"<a/>"), EmittedFile(name="p/b", content=b"")])
            put_in_place(folder, ["p/q/a.urdf"], tmp_path / "out")
        assert tree(tmp_path / "out") == {"p/q/a.urdf": b"<a/>"}

    @pytest.mark.parametrize("name", ["", ".", "..", "../x.urdf", "sub/../../x.urdf", "sub//x", "/tmp/x.urdf", "x/"])  # noqa: S108
    def test_a_name_that_leaves_the_folder_is_refused(self, tmp_path: Path, name: str) -> None:
        """Nothing is written outside the folder, or to a folder."""
        inside = tmp_path / "out" / "staging"
        inside.mkdir(parents=True)
        with pytest.raises(OutputError) as caught:
            write_files(inside, [EmittedFile(name=name, content=b"x")])
        assert caught.value.problems[0].code == "not-a-plain-name"
        assert tree(tmp_path) == {}


class TestPutInPlace:
    def test_a_link_is_replaced_not_followed(self, tmp_path: Path) -> None:
        """A link that stands where a file goes is replaced; what it points to stays as it is."""
        target = tmp_path / "precious"
        target.write_text("precious")
        out = tmp_path / "out"
        out.mkdir()
        (out / "a.urdf").symlink_to(target)
        with staging(out) as folder:
            write_files(folder, [EmittedFile(name="a.urdf", content=b"new")])
            put_in_place(folder, ["a.urdf"], out)
        assert target.read_text() == "precious"
        assert not (out / "a.urdf").is_symlink()

    def test_a_folder_in_the_way_of_one_file_stops_all(self, tmp_path: Path) -> None:
        """The files of one manipulator belong together: where one cannot be put in place, no older one is replaced."""
        (tmp_path / "a.urdf").write_text("old")
        (tmp_path / "b.xacro").mkdir()

        def place() -> None:
            with staging(tmp_path) as folder:
                write_files(folder, [EmittedFile(name=name, content=b"new") for name in ("a.urdf", "b.xacro")])
                put_in_place(folder, ["a.urdf", "b.xacro"], tmp_path)

        with pytest.raises(OutputError, match=r"b\.xacro"):
            place()
        assert tree(tmp_path) == {"a.urdf": b"old"}


class TestAddresses:
    """An address that is taken for a path: its folder ``s3:`` would be made here, and nobody would find the file."""

    @pytest.mark.parametrize(
        "words",
        [
            ("convert", "arm.csv", "-o", "s3://bucket/arm.urdf"),
            ("extract", "arm.urdf", "-o", "https://host/arm.yaml"),
            ("init", "s3://bucket/arm.csv"),
        ],
        ids=" ".join,
    )
    def test_output_is_refused(self, tmp_path: Path, cli: Cli, words: tuple[str, ...]) -> None:
        """With what writes there, and nothing is made."""
        (tmp_path / "arm.csv").write_text("# convention: standard\na, alpha, d\n0.4, 0, 0.1\n")
        dh2urdf.convert(tmp_path / "arm.csv", tmp_path / "arm.urdf")
        before = tree(tmp_path)
        cli(*words, status=2)
        assert tree(tmp_path) == before
        assert not list(tmp_path.glob("*:"))


class TestNoFiles:
    """A path at which a device, a pipe or a socket is: a rename would put a file in its place, for all that use it."""

    @pytest.fixture(params=["pipe", "/dev/null", "/proc/self/fd/1"])  # the last as /dev/stdout is
    def path(self, request: pytest.FixtureRequest, tmp_path: Path) -> Path:
        path = tmp_path / "out" / "arm.urdf"
        path.parent.mkdir()
        os.mkfifo(path) if request.param == "pipe" else path.symlink_to(request.param)
        return path

    def test_none_is_replaced(self, path: Path) -> None:
        """Neither by a function that writes a file, nor by the second of two files, of which none is put in place."""

        def place() -> None:
            with staging(path.parent) as folder:
                write_files(folder, [EmittedFile(name=name, content=b"new") for name in ("a.xacro", "arm.urdf")])
                put_in_place(folder, ["a.xacro", "arm.urdf"], path.parent)

        arm = dh2urdf.read("# convention: standard\na, alpha, d\n0.4, 0, 0.1\n", reader="csv")
        before = os.lstat(path)
        for write in (place, lambda: dh2urdf.convert(arm, path), lambda: dh2urdf.convert(arm).robot.to_urdf(path)):
            with pytest.raises(OutputError) as caught:
                write()
            assert [problem.code for problem in caught.value.problems] == ["device-not-writable"]
            after = os.lstat(path)
            assert (after.st_ino, after.st_mode) == (before.st_ino, before.st_mode)
            assert list(path.parent.iterdir()) == [path]


class TestWriteAll:
    def test_a_system_that_takes_some_at_a_time(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """What one call does not take, the next ones do, and no byte is written twice."""
        write = os.write
        monkeypatch.setattr(os, "write", lambda descriptor, content: write(descriptor, content[:7]))
        with (tmp_path / "file").open("wb", buffering=0) as file:
            write_all(file.fileno(), bytes(range(250)))
        assert (tmp_path / "file").read_bytes() == bytes(range(250))
