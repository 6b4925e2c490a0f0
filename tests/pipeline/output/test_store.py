import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from dh2urdf.errors import OutputError
from dh2urdf.output.store import WORKING, LocalStore, Store, open_store


def everything(folder: Path) -> list[str]:
    """All files and folders below a folder."""
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*"))


class TestEveryStore:
    def test_what_was_written_can_be_read(self, store: Store) -> None:
        """A file holds the very bytes that were written, in whatever folder."""
        files = {"a.urdf": b"<robot/>\r\n\0\xff", "00001/b.urdf": b"", f"{WORKING}/journal/7": bytes(3_000_000)}
        for name, content in files.items():
            store.write(name, content)
        assert {name: store.read(name) for name in store.names()} == files
        assert {name: store.size(name) for name in files} == {name: len(files[name]) for name in files}

    def test_a_file_is_a_stream(self, store: Store) -> None:
        """A stream gives a file from its beginning to its end, or from any other place."""
        content = os.urandom(2_500_000)
        store.write("a", content)
        with store.open("a") as stream:
            assert stream.read(10) == content[:10]
            stream.seek(1_000_000)
            assert stream.read() == content[1_000_000:]

    @pytest.mark.parametrize("name", ["c", "no/such/folder", "a/b/c"])
    def test_what_is_not_there(self, store: Store, name: str) -> None:
        """A missing file has no size and is no trouble to remove; reading it is an error of one line."""
        store.write("a/b", b"")
        assert store.size(name) is None
        store.remove(name)
        store.remove_tree(name)
        assert list(store.names(name)) == []
        for read in (store.read, lambda name: store.open(name).__enter__()):
            with pytest.raises(OutputError) as caught:
                read(name)
            assert f"'{store}/{name}'" in str(caught.value)

    def test_names_of_a_folder(self, store: Store) -> None:
        """A folder's names are those below it, and not those of another whose name begins alike."""
        for name in ("a/1", "a/b/2", "ab/3", "4"):
            store.write(name, b"")
        assert sorted(store.names("a")) == ["a/1", "a/b/2"]
        assert sorted(store.names()) == ["4", "a/1", "a/b/2", "ab/3"]

    def test_removing(self, store: Store) -> None:
        """A file or a folder can be removed, and all others stay."""
        for name in ("a/1", "a/b/2", "ab/3", "4", "5"):
            store.write(name, b"")
        store.remove("4")
        store.remove_tree("a")
        assert sorted(store.names()) == ["5", "ab/3"]
        store.write("a/1", b"again")
        assert store.read("a/1") == b"again"

    def test_a_file_made_elsewhere_is_put_in_place(self, store: Store) -> None:
        """A file of a scratch folder goes where it belongs; scratch folders are gone at their end."""
        store.write("00001.tar", b"older")
        with store.scratch() as folder, store.scratch() as other:
            assert folder != other
            (folder / "shard").write_bytes(b"content")
            (other / "half").write_bytes(b"cont")
            store.put("00001.tar", folder / "shard")
        assert not folder.exists()
        assert not other.exists()
        assert list(store.names()) == ["00001.tar"]
        assert store.read("00001.tar") == b"content"

    @pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
    def test_scratch_is_gone_whatever_happens(self, store: Store, error: type[BaseException]) -> None:
        """An error and Ctrl-C take along what was being made."""
        folders = []

        def interrupted() -> None:
            with store.scratch() as folder:
                folders.append(folder)
                (folder / "shard").write_bytes(b"half")
                raise error

        with pytest.raises(error):
            interrupted()
        assert not folders[0].exists()
        assert list(store.names()) == []

    @pytest.mark.parametrize("name", ["", "..", "/etc/x", "a/../../x", "a//b", "./a", "a\\..\\x"])
    def test_a_name_that_leaves_the_store_is_refused(self, store: Store, name: str, tmp_path: Path) -> None:
        """Whatever is done, it is done below the address of the store."""
        made = tmp_path / "made"
        made.write_bytes(b"x")
        doings: list[Callable[[], object]] = [
            lambda: store.write(name, b"x"),
            lambda: store.put(name, made),
            lambda: store.read(name),
            lambda: store.open(name).__enter__(),
            lambda: store.size(name),
            lambda: store.remove(name),
            lambda: store.remove_tree(name),
        ]
        for doing in doings:
            with pytest.raises(OutputError) as caught:
                doing()
            assert caught.value.problems[0].code == "not-a-plain-name"
        assert everything(tmp_path) == ["made"]
        assert list(store.names()) == []

    def test_many_threads_at_once(self, store: Store) -> None:
        """Threads that write at the same time, as those of a worker of Dask, do not meet."""

        def write(thread: int) -> None:
            for number in range(20):
                store.write(f"{number}/{thread}", b"%d" % thread)
                store.write("same", b"%d" % thread * 1000)

        threads = [threading.Thread(target=write, args=[thread]) for thread in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(list(store.names())) == 81
        assert {store.read(f"{number}/2") for number in range(20)} == {b"2"}
        assert store.read("same") in {b"%d" % thread * 1000 for thread in range(4)}

    def test_a_fork_reaches_the_same_place(self, store: Store) -> None:
        """A worker process has the store of the run that started it, also where both had used it before."""
        store.write("before", b"")
        if (worker := os.fork()) == 0:
            try:
                store.write("made", b"by a worker")
                os._exit(int(store.read("made") != b"by a worker"))
            finally:
                os._exit(2)
        store.write("after", b"")
        assert os.waitstatus_to_exitcode(os.waitpid(worker, 0)[1]) == 0
        if not str(store).startswith("memory:"):
            assert store.read("made") == b"by a worker"

    def test_a_pickled_store_reaches_the_same_place(self, store: Store, tmp_path: Path) -> None:
        """A worker that was started elsewhere, in another folder, gets the store by pickle."""
        if str(store).startswith("memory:"):
            assert pickle.loads(pickle.dumps(store)).size("a/b") is None  # noqa: S301
            return  # Another process has another memory.
        (tmp_path / "elsewhere").mkdir()
        (tmp_path / "pickled").write_bytes(pickle.dumps(store))
        code = "import pickle; pickle.load(open('../pickled', 'rb')).write('a/b', b'content')"
        subprocess.run([sys.executable, "-c", code], cwd=tmp_path / "elsewhere", check=True, timeout=60)
        assert store.read("a/b") == b"content"
        assert everything(tmp_path / "elsewhere") == []


class TestOpenStore:
    def test_a_path_is_a_folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """Paths, absolute or not, and addresses of files are folders of this machine."""
        monkeypatch.chdir(tmp_path)
        for number, address in enumerate(["out", Path("out"), tmp_path / "out", f"file://{tmp_path}/out"]):
            store = open_store(address)
            assert isinstance(store, LocalStore)
            store.write(f"{number}", b"")
            assert (tmp_path / "out" / f"{number}").is_file()
