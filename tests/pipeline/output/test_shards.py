import io
import os
import subprocess
import tarfile
from collections.abc import Iterable
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from dh2urdf.output.layouts import is_shard_of, members, shard_stem, writing_shard
from dh2urdf.output.store import Store, open_store

SAMPLE = [
    ("arm_1.urdf", b"<robot/>\n" * 700),
    ("arm_1.png", bytes(range(256)) * 10),
    ("arm_2.urdf", b""),
    ("arm_2.urdf.xacro", b"x" * 512),
    ("机械臂.urdf", b"<robot name='\xe6'/>"),
    ("n" * 100 + ".urdf", b"one byte too long for a plain header"),
    ("n" * 95 + ".urdf", b"the longest that fits"),
    ("robots/arm_3.urdf", b"\0" * 1025),
]
names = st.text(st.characters(codec="utf-8", exclude_characters="/\\\0"), min_size=1, max_size=150).filter(
    lambda name: name not in (".", "..")
)
files = st.lists(st.tuples(names, st.binary(max_size=1500)), max_size=8)


def written(store: Store, some: Iterable[tuple[str, bytes]], name: str = "000001.tar") -> list[int]:
    """Write a shard; where each content begins."""
    with writing_shard(store, name) as add:
        return [add(file, content) for file, content in some]


@pytest.fixture(scope="module")
def module_store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    return open_store(tmp_path_factory.mktemp("out"))


class TestReaders:
    def test_tarfile_reads_it(self, store: Store) -> None:
        """Python's own reader finds the files in their order, at the offsets that were returned, without time or owner."""
        offsets = written(store, SAMPLE)
        content = store.read("000001.tar")
        with tarfile.open(fileobj=io.BytesIO(content), mode="r:") as shard:
            found = shard.getmembers()
            assert [(member.name, shard.extractfile(member).read()) for member in found] == SAMPLE  # type: ignore[union-attr]
        assert [member.offset_data for member in found] == offsets
        facts = {(m.mode, m.mtime, m.uid, m.gid, m.uname, m.gname, m.type) for m in found}
        assert facts == {(0o644, 0, 0, 0, "", "", tarfile.REGTYPE)}

    def test_gnu_tar_reads_it(self, module_store: Store, tmp_path: Path) -> None:
        """GNU tar lists and unpacks it without a word of complaint."""
        written(module_store, SAMPLE)
        shard = str(Path(str(module_store)) / "000001.tar")
        environment = {**os.environ, "LC_ALL": "C.UTF-8", "TZ": "UTC", "TAR_OPTIONS": "--quoting-style=literal"}
        listing = subprocess.run(
            ["tar", "tvf", shard],  # noqa: S607
            env=environment,
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=True,
        )
        assert listing.stderr == ""
        assert [line.split(None, 5)[-1] for line in listing.stdout.splitlines()] == [name for name, _ in SAMPLE]
        assert {line[:14] for line in listing.stdout.splitlines()} == {"-rw-r--r-- 0/0"}
        subprocess.run(["tar", "xf", shard], cwd=tmp_path, env=environment, check=True)  # noqa: S607
        assert {name: (tmp_path / name).read_bytes() for name, _ in SAMPLE} == dict(SAMPLE)

    def test_webdataset_reads_it(self, module_store: Store) -> None:
        """WebDataset finds one sample for each manipulator, with its files by what follows the first dot."""
        webdataset = pytest.importorskip("webdataset")
        arms = {f"arm_{number}": {"urdf": b"<%d/>" % number, "png": os.urandom(600)} for number in range(30)}
        arms[shard_stem("UR 10e rev. 2.1")] = {"urdf": b"<ur/>", "macro.xacro": b"<xacro/>"}
        written(module_store, [(f"{key}.{end}", text) for key, own in arms.items() for end, text in own.items()])
        dataset = webdataset.WebDataset(f"file:{module_store}/000001.tar", shardshuffle=False)
        found = [{key: value for key, value in sample.items() if key != "__url__"} for sample in dataset]
        for sample in found:
            sample.pop("__local_path__", None)
        assert found == [{"__key__": key, **own} for key, own in arms.items()]


class TestBytes:
    @given(files)
    def test_any_files_are_read_back(self, module_store: Store, some: list[tuple[str, bytes]]) -> None:
        """Whatever names and contents are, `tarfile` and the reader here find them, and the shard is of whole records."""
        offsets = written(module_store, some)
        content = module_store.read("000001.tar")
        assert len(content) % 10_240 == 0
        with tarfile.open(fileobj=io.BytesIO(content), mode="r:") as shard:
            assert [(member.name, member.offset_data, member.size) for member in shard] == [
                (name, offset, len(text)) for (name, text), offset in zip(some, offsets, strict=True)
            ]
        assert list(members(content).items()) == list(dict(some).items())
        assert is_shard_of(content, some)

    def test_a_large_shard(self, module_store: Store) -> None:
        """A shard that goes to the disk in many pieces is the same as one of a single piece."""
        many = [(f"arm_{number:05d}.urdf", b"%d " % number * 1500) for number in range(300)]
        written(module_store, many)
        assert is_shard_of(module_store.read("000001.tar"), many)


class TestWhole:
    @pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, GeneratorExit])
    @pytest.mark.parametrize("count", [0, 1, 300])
    def test_an_error_leaves_the_older_shard(self, store: Store, error: type[BaseException], count: int) -> None:
        """A shard that is not finished is not there, and an older one of the name is."""
        written(store, SAMPLE)
        older = store.read("000001.tar")

        def interrupted(name: str) -> None:
            with writing_shard(store, name) as add:
                for number in range(count):
                    add(f"arm_{number}.urdf", bytes(1000))
                raise error

        for name in ("000001.tar", "000002.tar"):
            with pytest.raises(error):
                interrupted(name)
        with store.lock():
            assert {name for name in store.names() if not name.endswith("/lock")} == {"000001.tar"}
        assert store.read("000001.tar") == older


class TestDamage:
    @given(st.data())
    def test_a_shard_that_was_cut_or_changed(self, module_store: Store, data: st.DataObject) -> None:
        """Every missing byte is noticed, and every other one."""
        some = data.draw(files.filter(bool))
        written(module_store, some)
        content = module_store.read("000001.tar")
        place = data.draw(st.integers(0, len(content) - 1))
        assert not is_shard_of(content[:place], some)
        changed = bytearray(content)
        changed[place] ^= data.draw(st.integers(1, 255))
        assert not is_shard_of(bytes(changed), some)

    @pytest.mark.parametrize("content", [b"", b"<robot/>", b"\xff" * 512, b"a" * 10_240, bytes(512)])
    def test_what_is_no_shard(self, content: bytes) -> None:
        """Any other file has no files."""
        assert members(content) == {}
        assert not is_shard_of(content, [])


class TestStems:
    @given(st.text(st.characters(codec=None), max_size=200))
    def test_a_stem_has_no_dot(self, name: str) -> None:
        """Up to the first dot is the whole stem, whatever a manipulator is called."""
        stem = shard_stem(name)
        assert f"{stem}.urdf".partition(".")[0] == stem
        assert shard_stem(stem) == stem
