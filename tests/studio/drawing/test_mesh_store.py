"""Mesh files are read once, and before anybody asks for them."""

from __future__ import annotations

import importlib
import os
import threading
import time
from typing import TYPE_CHECKING

import pytest
import trimesh

from dh2urdf.errors import OutputError
from dh2urdf.isolation import Child
from dh2urdf_studio.drawing import mesh_files as mesh_store
from dh2urdf_studio.drawing.mesh_files import DrawnMesh, MeshStore, triangles

if TYPE_CHECKING:
    from pathlib import Path


def test_a_file_is_read_once_until_it_changes(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    trimesh.creation.box((1.0, 1.0, 1.0)).export(path)
    mesh = DrawnMesh(path=path)
    store = MeshStore({"key": mesh})
    store.begin(["key"])
    reading = store.triangles("key")
    before = reading.result()
    assert store.triangles("key") is reading
    assert before == triangles(mesh)
    trimesh.creation.icosphere(subdivisions=1).export(path)
    os.utime(path, ns=(1, 1))
    assert store.triangles("key").result() != before
    path.unlink()
    with pytest.raises(OutputError, match="No such file"):
        store.triangles("key").result()
    assert "key" in store
    assert "other" not in store
    store.close()


def test_a_reader_that_crashes_costs_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A new one reads the next file, and none is left."""
    meshes = {name: DrawnMesh(path=tmp_path / f"{name}.stl") for name in ("bad", "good")}
    for mesh in meshes.values():
        trimesh.creation.box((1.0, 1.0, 1.0)).export(mesh.path)
    readers: list[Child] = []
    monkeypatch.setattr(Child, "started", lambda: (readers.append(Child()), readers[-1])[1])
    store = MeshStore(meshes)
    with monkeypatch.context() as patch:
        (tmp_path / "aborting.py").write_text("import os\ndef read(_mesh): os.abort()\n")
        monkeypatch.syspath_prepend(tmp_path)
        patch.setattr(mesh_store, "triangles", importlib.import_module("aborting").read)
        message = r"'bad\.stl' cannot be read: the reader of 'bad\.stl' crashed \(aborted\)"
        with pytest.raises(OutputError, match=message):
            store.triangles("bad").result()
    assert store.triangles("good").result() == triangles(meshes["good"])
    store.close()
    assert [reader.is_alive() for reader in readers] == [False, False]


def test_what_is_being_read_at_the_end_is_ended_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two that end one reader at once would close what the other one reads: `view` ended with a false message then."""
    os.mkfifo(tmp_path / "pipe.stl")  # nobody writes to it, so its reader waits
    ends: list[Child] = []
    is_there = threading.Event()

    def watched() -> Child:
        child = Child()
        end = child.end
        monkeypatch.setattr(child, "end", lambda: (ends.append(child), end())[1])
        is_there.set()
        return child

    monkeypatch.setattr(Child, "started", watched)
    store = MeshStore({"pipe": DrawnMesh(path=tmp_path / "pipe.stl")})
    reading = store.triangles("pipe")
    assert is_there.wait(60)
    while not store.is_reading:
        time.sleep(0.01)
    store.close()
    with pytest.raises(OutputError, match=r"the reader of 'pipe\.stl' crashed \(killed\)"):
        reading.result(60)
    assert len(ends) == 1
