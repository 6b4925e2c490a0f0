"""Descriptions with their mesh files, as a browser sends them."""

from __future__ import annotations

import io
import zipfile
from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import InputError
from dh2urdf_studio.drawing.scene import Drawing
from dh2urdf_studio.editing import comparing as given_files
from dh2urdf_studio.editing.comparing import GivenFiles

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog

TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
SHAPE = '<visual><geometry><mesh filename="{}"/></geometry></visual>'


def urdf(*meshes: str) -> bytes:
    return f"<robot name='r'><link name='l'>{''.join(map(SHAPE.format, meshes))}</link></robot>".encode()


def zipped(files: dict[str, bytes]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return target.getvalue()


@pytest.mark.parametrize("packed", [False, True])
def test_meshes_are_found(catalog: Catalog, *, packed: bool) -> None:
    """By their package, from the description, or by the end of their path; those that are missing are named."""
    sent = {
        "arm/urdf/arm.urdf": urdf(
            "package://arm/meshes/a.obj", "../meshes/b.obj", "package://other/visual/c.obj", "d.obj", "x/gone.obj"
        ),
        "arm/meshes/a.obj": TRIANGLE,
        "arm/meshes/b.obj": TRIANGLE,
        "arm/meshes/visual/c.obj": TRIANGLE,
        "arm/meshes/collision/c.obj": TRIANGLE,
        "d.obj": TRIANGLE,
        "arm/notes.doc": b"",
    }
    files = GivenFiles([("all.zip", zipped(sent))] if packed else list(sent.items()), catalog)
    assert files.descriptions == ["arm/urdf/arm.urdf"]
    figure = files.figure("arm/urdf/arm.urdf")
    assert not isinstance(figure, str)
    root = files.path("")
    found = {address: path.relative_to(root).as_posix() for address, path in figure.files.items()}
    assert found == {
        "package://arm/meshes/a.obj": "arm/meshes/a.obj",
        "../meshes/b.obj": "arm/meshes/b.obj",
        "package://other/visual/c.obj": "arm/meshes/visual/c.obj",
        "d.obj": "d.obj",
    }
    drawing = Drawing.of([figure])
    assert (len(drawing.meshes), drawing.unseen) == (4, ("x/gone.obj",))
    files.close()
    assert not root.exists()


@pytest.mark.parametrize("up", ["", "../", "../../"])
def test_an_included_file_is_one_of_those_that_were_sent(
    tmp_path: Path, catalog: Catalog, monkeypatch: pytest.MonkeyPatch, up: str
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / "more.xml").write_text('<x><worldbody><body name="secret"/></worldbody></x>')
    main = f'<mujoco><include file="{up}more.xml"/><worldbody><body name="a"/></worldbody></mujoco>'
    sent = [("arm.xml", main.encode()), ("more.xml", b'<x><worldbody><body name="given"/></worldbody></x>')]
    files = GivenFiles(sent, catalog)
    figure = files.figure("arm.xml")
    if up:
        assert isinstance(figure, str)
        assert f"'{up}more.xml'" in figure
        assert str(tmp_path) not in figure
    else:
        assert not isinstance(figure, str)
        assert [link.name for link in figure.robot.links] == ["world", "given", "a"]
    files.close()


@pytest.mark.parametrize("name", ["../out.obj", "/out/out.obj", "a/../../out.obj", "..\\out.obj", "C:\\out.obj"])
def test_nothing_is_written_or_found_elsewhere(tmp_path: Path, catalog: Catalog, name: str) -> None:
    """Neither a name of a file that was sent nor an address in a description leads out of the folder."""
    secret = tmp_path / "secret.obj"
    secret.write_bytes(TRIANGLE)
    description = urdf(str(secret), f"file://{secret}", f"../../../../../../../..{secret}")
    for sent in ([(name, TRIANGLE)], [("a.zip", zipped({name: TRIANGLE}))]):
        files = GivenFiles([("a.urdf", description), *sent], catalog)
        root = files.path("")
        assert [path.name for path in root.rglob("*")] == ["a.urdf"]
        figure = files.figure("a.urdf")
        assert not isinstance(figure, str)
        assert figure.files == {}
        files.close()


def test_what_is_too_much(monkeypatch: pytest.MonkeyPatch, catalog: Catalog) -> None:
    """A ZIP that unpacks to more than may be kept, too many files, and a file that is no ZIP."""
    monkeypatch.setattr(given_files, "LARGEST", 2**20)
    monkeypatch.setattr(given_files, "MOST_FILES", 3)
    bomb = zipped({"a.obj": bytes(2**22)})
    assert len(bomb) < 2**14
    for sent, message in (
        ([("a.zip", bomb)], "more than 3 files, or more than 1 MB"),
        ([(f"{number}.obj", b"") for number in range(4)], "more than 3 files"),
        ([("a.zip", b"PK")], "cannot be unpacked"),
    ):
        with pytest.raises(InputError, match=message):
            GivenFiles(sent, catalog)


@pytest.mark.parametrize("way", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_broken_archive_is_refused_with_its_name(catalog: Catalog, way: int) -> None:
    """However it is packed, and wherever a byte of it was lost or changed: nothing else is raised."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", way) as archive:
        archive.writestr("arm.urdf", urdf("a.obj") * (1 if way == zipfile.ZIP_STORED else 20))  # for a packer to pack
    whole = target.getvalue()
    refused = 0
    for place in range(len(whole)):
        for content in (whole[:place], whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :]):
            try:
                GivenFiles([("arm.zip", content)], catalog).close()
            except InputError as error:
                assert "'arm.zip' cannot be unpacked" in str(error)
                refused += 1
    assert refused > len(whole)
