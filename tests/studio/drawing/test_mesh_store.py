"""Mesh files are read once, and before anybody asks for them."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest
import trimesh

from dh2urdf.errors import OutputError
from dh2urdf.studio.drawing import mesh_store
from dh2urdf.studio.drawing.mesh_files import DrawnMesh, triangles
from dh2urdf.studio.drawing.mesh_store import MeshStore

if TYPE_CHECKING:
    from pathlib import Path


def test_a_file_is_read_once_until_it_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "box.stl"
    trimesh.creation.box((1.0, 1.0, 1.0)).export(path)
    mesh = DrawnMesh(path=path)
    reads: list[DrawnMesh] = []
    monkeypatch.setattr(mesh_store, "triangles", lambda mesh: (reads.append(mesh), triangles(mesh))[1])
    store = MeshStore({"key": mesh})
    store.begin(["key"])
    before = store.triangles("key").result()
    assert store.triangles("key").result() == before == triangles(mesh)
    assert reads == [mesh]
    trimesh.creation.icosphere(subdivisions=1).export(path)
    os.utime(path, ns=(1, 1))
    assert store.triangles("key").result() != before
    path.unlink()
    with pytest.raises(OutputError, match="No such file"):
        store.triangles("key").result()
    assert "key" in store
    assert "other" not in store
    store.close()
