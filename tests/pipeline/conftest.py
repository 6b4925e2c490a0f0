"""Places for the output of runs."""

import os
from pathlib import Path

import pytest

from dh2urdf.output.remote_store import RemoteStore
from dh2urdf.output.store import Store, open_store


@pytest.fixture(params=["local", "memory", "s3", "folders"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Store:
    """An empty store: a folder; an object store in this process, and one of a real server; a remote file system."""
    if request.param == "local":
        return open_store(tmp_path / "out")
    pytest.importorskip("fsspec")
    if request.param == "memory":
        return open_store(f"memory://{os.urandom(6).hex()}/out")
    if request.param == "folders":  # SFTP and its like want a folder before there is a file in it, as this one does.
        return RemoteStore(f"file://{tmp_path}/out")
    return open_store(f"{request.getfixturevalue('bucket')}/some/prefix")
