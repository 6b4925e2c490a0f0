"""Paths and their file:// addresses, on every system."""

from pathlib import Path, PurePosixPath, PureWindowsPath

import pytest

from dh2urdf.meshes import file_address, mesh_finder, path_of_address


@pytest.mark.parametrize(
    ("path", "address"),
    [
        (str(PurePosixPath("/usr/share/arm.stl")), "file:///usr/share/arm.stl"),
        (str(PurePosixPath("/a folder/100%.stl")), "file:///a folder/100%.stl"),
        (str(PurePosixPath(r"/odd\\name.stl")), r"file:///odd\\name.stl"),
        (str(PurePosixPath("/home/C:/arm.stl")), "file:///home/C:/arm.stl"),
        (str(PureWindowsPath(r"C:\meshes\arm.stl")), "file:///C:/meshes/arm.stl"),
        (str(PureWindowsPath("d:/meshes/arm.stl")), "file:///d:/meshes/arm.stl"),
    ],
)
def test_an_address_leads_back_to_its_path(path: str, address: str) -> None:
    """With the drive of Windows behind three slashes, as RFC 8089 has it, and with forward slashes."""
    assert file_address(path) == address
    back = path_of_address(address)
    assert back == path or PureWindowsPath(back) == PureWindowsPath(path)


def test_other_texts_stay() -> None:
    """An address of a package, and a path."""
    for text in ("package://arm/meshes/a.stl", "meshes/a.stl", "C:/a.stl", "/C:/a.stl"):
        assert path_of_address(text) == text


def test_a_mesh_is_found_by_its_address(tmp_path: Path) -> None:
    """What is written is found again, also with a space in it."""
    file = tmp_path / "an arm.stl"
    file.touch()
    assert mesh_finder(tmp_path, {})(file_address(str(file))) == file
