import errno
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from importlib import import_module
from pathlib import Path

import pytest

from dh2urdf.errors import MissingDependencyError, OutputError
from dh2urdf.output import remote_store
from dh2urdf.output.remote_store import RemoteStore
from dh2urdf.output.store import open_store

pytest.importorskip("s3fs")


def refusal(store: RemoteStore) -> str:
    """What a store declares about a file that it cannot write."""
    with pytest.raises(OutputError) as caught:
        store.write("a", b"content")
    (line,) = str(caught.value).splitlines()
    return line


class TestAddresses:
    @pytest.mark.parametrize("address", ["s3://", "s3:///", "memory://", "s3://bucket/*", "s3://b?cket", "s3://b/[a]"])
    def test_an_address_that_names_no_place(self, address: str) -> None:
        """Without a bucket, and with what fsspec takes for a wildcard, nothing can be written anywhere."""
        with pytest.raises(OutputError) as caught:
            open_store(address)
        assert caught.value.problems[0].code == "address-without-name"

    @pytest.mark.parametrize("name", ["a*", "a?", "00001/[a]"])
    def test_a_name_with_a_wildcard_is_refused(self, name: str) -> None:
        """A name that fsspec would take for those of other files is not given to it."""
        with pytest.raises(OutputError) as caught:
            open_store("memory://wild/cards").remove_tree(name)
        assert caught.value.problems[0].code == "name-is-pattern"

    @pytest.mark.parametrize(
        ("address", "text"),
        [
            ("s3://key:se/cr+et@bucket/a@b", "s3://…@bucket/a@b"),
            ("memory://user:secret@host/a", "memory://…@host/a"),
            ("memory://bucket/a:b", "memory://bucket/a:b"),
        ],
    )
    def test_a_password_is_not_shown(self, address: str, text: str) -> None:
        """Where an address holds a password, messages do not."""
        store = open_store(address)
        assert str(store) == text
        with pytest.raises(OutputError) as caught:
            store.read("../a")
        assert "secret" not in str(caught.value)


class TestMissingPackages:
    @pytest.mark.parametrize(
        ("address", "missing", "message"),
        [
            ("s3://bucket/a", "fsspec.core", "output to s3:// needs fsspec: {python} -m pip install 'dh2urdf[remote]'"),
            ("s3://bucket/a", "s3fs", "output to s3:// needs s3fs: {python} -m pip install 'dh2urdf[remote]'"),
            ("gs://bucket/a", "gcsfs", "output to gs:// needs gcsfs: {python} -m pip install 'gcsfs'"),
        ],
    )
    def test_the_line_says_what_to_install(
        self, monkeypatch: pytest.MonkeyPatch, address: str, missing: str, message: str
    ) -> None:
        """Where the package for an address is not installed, the message is the command that installs it."""
        already_imported = import_module("fsspec.registry")._registry
        monkeypatch.delitem(already_imported, "s3", raising=False)
        monkeypatch.setitem(sys.modules, missing, None)
        with pytest.raises(MissingDependencyError) as caught:
            open_store(address)
        assert str(caught.value) == message.format(python=sys.executable)


class TestObjectStore:
    @pytest.mark.usefixtures("s3_server")
    def test_a_bucket_that_is_not_there_is_not_made(self) -> None:
        """A misspelt bucket is an error of one line at the first file, and stays missing."""
        address = f"s3://missing-{os.urandom(6).hex()}/prefix"
        for _ in range(2):
            line = refusal(RemoteStore(address))
            assert line == f"error: cannot write '{address}/a': The specified bucket does not exist"
        assert list(open_store(address).names()) == []
        assert open_store(address).size("a") is None

    WRITER = """
import sys
from dh2urdf.output.store import open_store
store = open_store(sys.argv[1])
for number in range(10_000):
    store.write(f"{number}", b"%d." % number * 500_000)
    print(number, flush=True)
"""

    @pytest.mark.parametrize("wait", [0.0, 0.01, 0.03])
    def test_a_killed_writer_leaves_whole_objects(self, bucket: str, wait: float) -> None:
        """After SIGKILL in the middle of a transfer every object is whole."""
        with subprocess.Popen([sys.executable, "-c", self.WRITER, bucket], stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            assert [process.stdout.readline() for _ in range(3)] == [b"0\n", b"1\n", b"2\n"]
            time.sleep(wait)
            process.send_signal(signal.SIGKILL)
        store = open_store(bucket)
        names = list(store.names())
        assert len(names) >= 3
        assert all(store.read(name) == b"%d." % int(name) * 500_000 for name in names)


def waiting(server: socket.socket) -> Iterator[socket.socket]:
    """The connections that wait at a server."""
    server.settimeout(0.1)
    with suppress(TimeoutError):
        while True:
            yield server.accept()[0]


class TestTrouble:
    @pytest.fixture(autouse=True)
    def elsewhere(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        """No credentials but those of the test, no address of an earlier test, and no long pauses."""
        import s3fs

        s3fs.S3FileSystem.clear_instance_cache()
        for name in ("AWS_PROFILE", "AWS_SESSION_TOKEN"):
            monkeypatch.delenv(name, raising=False)
        for name in ("AWS_CONFIG_FILE", "AWS_SHARED_CREDENTIALS_FILE", "BOTO_CONFIG"):
            monkeypatch.setenv(name, str(tmp_path / "none"))
        monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
        monkeypatch.setenv("AWS_ACCESS_KEY_ID", "key")
        monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "secret")
        retries = {"mode": "standard", "total_max_attempts": 2}
        monkeypatch.setattr(remote_store, "_S3_LIMITS", {**remote_store._S3_LIMITS, "retries": retries})

    def test_nobody_is_there(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Where no server answers, the line names the address that was tried."""
        monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:1")
        line = refusal(RemoteStore("s3://bucket/prefix"))
        assert line == (
            "error: cannot write 's3://bucket/prefix/a': "
            'Could not connect to the endpoint URL: "http://127.0.0.1:1/bucket/prefix/a"'
        )

    def test_a_server_that_does_not_answer(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """A server that takes a question and is silent is asked so often as is allowed, and not again by others."""
        monkeypatch.setattr(remote_store, "_S3_LIMITS", {**remote_store._S3_LIMITS, "read_timeout": 0.2})
        with socket.create_server(("127.0.0.1", 0)) as server:
            monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{server.getsockname()[1]}")
            with pytest.raises(OutputError, match="cannot read 's3://bucket/prefix/a': Read timeout on endpoint URL"):
                RemoteStore("s3://bucket/prefix").read("a")
            assert len(list(waiting(server))) == 2

    @pytest.mark.parametrize("size", [10, 20_000_000])
    def test_a_server_that_takes_nothing(self, monkeypatch: pytest.MonkeyPatch, size: int) -> None:
        """A server that never gives leave to send, or that takes nothing of what is sent, is given up."""
        monkeypatch.setattr(remote_store, "_PATIENCE", 0.5 - size / 1e6)
        with socket.create_server(("127.0.0.1", 0)) as server:
            monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{server.getsockname()[1]}")
            store = RemoteStore("s3://bucket/prefix")
            with store.scratch() as folder:
                (folder / "shard").write_bytes(bytes(size))
                for doing in (lambda: store.write("a", bytes(size)), lambda: store.put("a", folder / "shard")):
                    with pytest.raises(OutputError) as caught:
                        doing()
                    reason = os.strerror(errno.ETIMEDOUT)
                    assert str(caught.value) == f"error: cannot write 's3://bucket/prefix/a': {reason}"
