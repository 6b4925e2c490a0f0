import errno
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from interrupted import at_every_step

from dh2urdf.errors import OutputError
from dh2urdf.output.store import WORKING, LocalStore

TEMPORARY = f"{WORKING}/temporary"


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    return LocalStore(tmp_path / "out")


def files(folder: Path) -> dict[str, bytes]:
    """Every file below a folder and what is in it."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@contextmanager
def another_process(code: str, *words: str | Path) -> Iterator[subprocess.Popen[str]]:
    """A process that runs a piece of code, killed at the end."""
    command = [sys.executable, "-c", code, *map(str, words)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        try:
            yield process
        finally:
            process.kill()


class TestWriting:
    def test_only_its_own_folder_is_used(self, store: LocalStore, tmp_path: Path) -> None:
        """Files appear under their names, and all else is in one folder that is gone with the lock."""
        with store.lock():
            store.write("a.urdf", b"1")
            store.write("00001/b.urdf", b"2")
            with store.scratch() as folder:
                assert folder.parent == tmp_path / "out" / TEMPORARY
                assert files(tmp_path / "out") == {"a.urdf": b"1", "00001/b.urdf": b"2", f"{WORKING}/lock": b""}
        assert files(tmp_path / "out") == {"a.urdf": b"1", "00001/b.urdf": b"2"}
        assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["00001", "a.urdf"]

    def test_files_are_readable_as_the_user_wants_it(self, store: LocalStore, tmp_path: Path) -> None:
        """A file has the permissions that the process's umask leaves, like any other new file."""
        (tmp_path / "usual").write_bytes(b"")
        store.write("a", b"")
        with store.scratch() as folder:
            (folder / "made").write_bytes(b"")
            store.put("b", folder / "made")
        for name in "ab":
            assert (tmp_path / "out" / name).stat().st_mode == (tmp_path / "usual").stat().st_mode

    def test_a_folder_that_was_removed_is_made_again(self, store: LocalStore, tmp_path: Path) -> None:
        """Who tidies up beneath a run does not end it."""
        store.write("a/b", b"1")
        for name in ("a", WORKING):
            assert subprocess.run(["rm", "-r", tmp_path / "out" / name], check=False).returncode == 0  # noqa: S607
            store.write("a/b", b"2")
        assert files(tmp_path / "out") == {"a/b": b"2"}

    def test_what_is_written_next_is_not_what_a_fork_writes(self, store: LocalStore, tmp_path: Path) -> None:
        """Workers that were forked from one process write at once and never into each other's temporary files."""
        store.write("before", b"")
        workers = []
        for number in range(3):
            if (worker := os.fork()) == 0:
                try:
                    for file in range(200):
                        store.write(f"{number}/{file}", b"%d" % number * 5000)
                    os._exit(0)
                finally:
                    os._exit(1)
            workers.append(worker)
        assert [os.waitpid(worker, 0)[1] for worker in workers] == [0, 0, 0]
        found = files(tmp_path / "out")
        assert found == {"before": b""} | {f"{n}/{file}": b"%d" % n * 5000 for n in range(3) for file in range(200)}


class TestFullDisk:
    CODE = """
import resource, sys
from pathlib import Path
from dh2urdf.errors import OutputError
from dh2urdf.output.store import LocalStore
resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))
store = LocalStore(Path(sys.argv[1]))
for doing in (lambda: store.write("old", b"x" * 9000), lambda: store.write("new", b"x" * 9000)):
    try:
        doing()
    except OutputError as error:
        print(error)
"""

    def test_half_of_a_file_is_not_left(self, store: LocalStore, tmp_path: Path) -> None:
        """A file that cannot be finished is not there, nor a temporary one; the older one is, and a line says why."""
        store.write("old", b"old")
        with another_process(self.CODE, store.directory) as process:
            lines = process.communicate(timeout=60)[0].splitlines()
        reason = os.strerror(errno.EFBIG)
        assert lines == [f"error: cannot write '{tmp_path}/out/{name}': {reason}" for name in ("old", "new")]
        assert files(tmp_path / "out") == {"old": b"old"}


class TestInterrupts:
    @pytest.mark.parametrize("name", ["old", "new"])
    def test_an_interrupt_between_any_two_steps(self, store: LocalStore, tmp_path: Path, name: str) -> None:
        """Whatever step of the writing is interrupted, the old file or the new one is there, whole, and no other."""
        allowed = [{"old": b"old"}, {"old": b"new"} if name == "old" else {"old": b"old", "new": b"new"}]
        interrupted = 0

        def write() -> None:
            store.write(name, b"new")

        store.write("old", b"old")
        for was_interrupted in at_every_step(write):
            interrupted += was_interrupted
            found = files(tmp_path / "out")
            assert found in allowed, f"interrupt {interrupted}"
            store.write("old", b"old")
            store.remove("new")
        assert interrupted > 10
        assert found == allowed[1]

    WRITER = """
import sys
from pathlib import Path
from dh2urdf.output.store import LocalStore
store = LocalStore(Path(sys.argv[1]))
with store.lock():
    for number in range(100_000):
        store.write(f"{number // 50}/{number % 50}", b"%d." % number * 20_000)
        store.append("journal", b"%d\\n" % number)
        with store.scratch() as folder:
            (folder / "shard").write_bytes(b"%d." % number * 20_000)
            store.put(f"shard{number}", folder / "shard")
"""

    @pytest.mark.parametrize("wait", [0.0, 0.003, 0.007, 0.012, 0.02])
    @pytest.mark.long
    def test_a_killed_writer_leaves_whole_files(self, store: LocalStore, tmp_path: Path, wait: float) -> None:
        """After SIGKILL every file is whole; what is left besides goes when the next run begins."""
        out = tmp_path / "out"
        with another_process(self.WRITER, out) as process:
            while not (out / "0" / "7").exists() and process.poll() is None:
                time.sleep(0.001)
            time.sleep(wait)
            os.killpg(process.pid, signal.SIGKILL)
            assert process.wait() == -signal.SIGKILL
        assert (out / TEMPORARY).is_dir()
        with store.lock():
            found = files(out)
            assert not any(name.startswith(TEMPORARY) for name in found)
            assert found.pop(f"{WORKING}/lock") == b""
            lines = found.pop("journal").split(b"\n")[:-1]
            assert lines == [b"%d" % number for number in range(len(lines))]
            assert len(lines) <= len([name for name in found if "/" in name]) <= len(lines) + 1
            for name, content in found.items():
                folder, _, file = name.rpartition("/")
                number = int(folder) * 50 + int(file) if folder else int(name.removeprefix("shard"))
                assert content == b"%d." % number * 20_000
        assert not (out / WORKING).exists()


class TestLock:
    HOLDER = """
import os, sys, time
from pathlib import Path
from dh2urdf.output.store import LocalStore
with LocalStore(Path(sys.argv[1])).lock():
    child = os.fork()
    if child == 0:
        time.sleep(60)
        os._exit(0)
    print(child, flush=True)
    time.sleep(60)
"""

    @contextmanager
    def locked(self, folder: Path) -> Iterator[tuple[subprocess.Popen[str], int]]:
        """A process that has the lock of a folder, and the number of a child of it."""
        with another_process(self.HOLDER, folder) as holder:
            assert holder.stdout is not None
            child = int(holder.stdout.readline())
            try:
                yield holder, child
            finally:
                os.kill(child, signal.SIGKILL)

    def test_a_second_run_is_refused(self, store: LocalStore) -> None:
        """While a run is at work in a folder, another process gets one line, and nothing of the first is touched."""
        with self.locked(store.directory) as (holder, _):
            store.write(f"{TEMPORARY}/of-the-first", b"")
            with pytest.raises(OutputError) as caught, store.lock():
                pass
            assert [problem.code for problem in caught.value.problems] == ["store-busy"]
            assert files(store.directory) == {f"{TEMPORARY}/of-the-first": b"", f"{WORKING}/lock": b""}
            assert holder.poll() is None

    def test_a_run_that_was_killed_keeps_nobody_out(self, store: LocalStore) -> None:
        """The lock ends with the process that has it, though a child of that process lives on; its leftovers go."""
        with self.locked(store.directory) as (holder, child):
            store.write(f"{TEMPORARY}/of-the-first", b"")
            holder.kill()
            holder.wait()
            os.kill(child, 0)
            with store.lock():
                assert files(store.directory) == {f"{WORKING}/lock": b""}

    def test_two_runs_of_one_process(self, store: LocalStore, tmp_path: Path) -> None:
        """In one process too a second run is refused, by whatever path it comes, and the first keeps its lock."""
        (tmp_path / "link").symlink_to(tmp_path / "out")
        with store.lock():
            for path in ("out", "link"):
                with pytest.raises(OutputError), LocalStore(tmp_path / path).lock():
                    pass

    def test_one_run_after_another(self, store: LocalStore) -> None:
        """The lock can be taken again and again, after an error too; what a run keeps for the next one stays."""
        for number in range(3):
            with suppress(ZeroDivisionError), store.lock():
                store.write(f"{WORKING}/journal/{number}", b"")
                _ = 1 / 0
        assert sorted(files(store.directory)) == [f"{WORKING}/journal/{number}" for number in range(3)]
        with store.lock():
            store.remove_tree(f"{WORKING}/journal")
        assert files(store.directory) == {}
        assert list(store.directory.iterdir()) == []

    @pytest.mark.long
    def test_many_runs_want_one_lock(self, tmp_path: Path) -> None:
        """Of processes that take and leave a lock in turns, no two have it at once, though its file comes and goes."""
        code = """
import os, sys, time
from pathlib import Path
from dh2urdf.errors import OutputError
from dh2urdf.output.store import LocalStore
folder, done = Path(sys.argv[1]), 0
while done < 300:
    try:
        with LocalStore(folder / "out").lock():
            os.close(os.open(folder / "inside", os.O_CREAT | os.O_EXCL))
            os.unlink(folder / "inside")
            done += 1
    except OutputError as error:
        assert "another run" in str(error), error
"""
        with another_process(code, tmp_path) as one, another_process(code, tmp_path) as two:
            assert (one.wait(60), two.wait(60)) == (0, 0)
