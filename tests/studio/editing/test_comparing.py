"""Descriptions with their mesh files, as a browser sends them; laid upon the arm of a table; and their numbers in it."""

import io
import math
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

import dh2urdf
import dh2urdf_studio
from dh2urdf.errors import InputError
from dh2urdf.plugin_system import Catalog
from dh2urdf.table_text import TableText
from dh2urdf_studio.drawing.scene import Drawing, Figure
from dh2urdf_studio.editing import comparing
from dh2urdf_studio.editing.comparing import NAME, GivenFiles, adopted, changed_cells, own_table
from dh2urdf_studio.editing.edits import with_cells
from dh2urdf_studio.editing.opening import gallery_table, open_tables
from dh2urdf_studio.editing.session import Session

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
    monkeypatch.setattr(comparing, "LARGEST", 2**20)
    monkeypatch.setattr(comparing, "MOST_FILES", 3)
    bomb = zipped({"a.obj": bytes(2**22)})
    assert len(bomb) < 2**14
    for sent, code in (
        ([("a.zip", bomb)], "too-many-files"),
        ([(f"{number}.obj", b"") for number in range(4)], "too-many-files"),
        ([("a.zip", b"PK")], "archive-broken"),
    ):
        with pytest.raises(InputError) as caught:
            GivenFiles(sent, catalog)
        assert caught.value.problems[0].code == code


@pytest.mark.parametrize("way", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_broken_archive_is_refused(catalog: Catalog, way: int) -> None:
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
                assert error.problems[0].code == "archive-broken"
                refused += 1
    assert refused > len(whole)


# --- Upon the arm of a table ------------------------------------------------------------------------------------------

# Two links of 0.3 m and 0.2 m in a plane, the second joint 2 mm off and tilted by 1°, the tip 5 mm too far.
ARM = """<robot name="other"><link name="world"/><link name="one"/><link name="two"/><link name="ee"/>
  <joint name="first" type="continuous"><parent link="world"/><child link="one"/><axis xyz="0 0 1"/></joint>
  <joint name="second" type="continuous"><parent link="one"/><child link="two"/><origin xyz="0.3 {dy} 0" rpy="{roll} 0 0"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="end" type="fixed"><parent link="two"/><child link="ee"/><origin xyz="{reach} 0 0"/></joint></robot>"""
TABLE = TableText(
    name="planar",
    convention="standard",
    rows=({"joint": "q1", "a": "0.3", "alpha": "0", "d": "0"}, {"joint": "q2", "a": "0.2", "alpha": "0", "d": "0"}),
)


def described(catalog: Catalog, **numbers: float) -> Figure:
    text = ARM.format(**{"dy": 0.0, "roll": 0.0, "reach": 0.2, **numbers})
    found = GivenFiles([("other.urdf", text.encode())], catalog).figure("other.urdf")
    assert not isinstance(found, str)
    return found


def test_the_same_arm(catalog: Catalog) -> None:
    """Its joints move along with those of the table, by their order."""
    session = Session(catalog, TABLE)
    session.lay_beside(described(catalog))
    beside = session.beside
    assert beside
    assert beside.agreement
    assert beside.agreement.holds
    assert max(max(each) for each in beside.worst) < 1e-12
    session.move({"q1": 0.4, "q2": -0.7})
    names = [node.name for node in session.drawing.nodes]
    poses = session.drawing.poses(session.joint_values())
    tip, tool0 = (poses[names.index(name)].translation for name in (f"{NAME}ee", "tool0"))
    assert tip == pytest.approx(tool0)


@pytest.mark.parametrize("name", ["panda.yaml", "stanford.csv", "track.csv"])
def test_the_file_of_a_table_is_its_arm(catalog: Catalog, name: str) -> None:
    """In both conventions, with joints that slide, and with frames of links that are not those of the table."""
    path = Path(dh2urdf_studio.__file__).parent / "arms" / name
    content = dh2urdf.convert(path).text.encode()
    (opened, *_) = open_tables(path, catalog)
    session = Session(catalog, opened.table)
    figure = GivenFiles([("arm.urdf", content)], catalog).figure("arm.urdf")
    assert not isinstance(figure, str)
    session.lay_beside(figure)
    assert session.beside
    assert session.beside.worst
    assert max(max(each) for each in session.beside.worst) < 1e-9


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ({"dy": 0.002}, [(0.0, 0.0), (0.002, 0.0), (0.002, 0.0)]),
        (
            {"roll": math.radians(1)},
            [(0.0, 0.0), (0.0, math.radians(1)), (2 * 0.2 * math.sin(math.radians(0.5)), math.radians(1))],
        ),
        ({"reach": 0.205}, [(0.0, 0.0), (0.0, 0.0), (0.005, 0.0)]),
    ],
)
def test_where_they_part(catalog: Catalog, numbers: dict[str, float], expected: list[tuple[float, float]]) -> None:
    """The joint at which the difference begins, and the largest difference of the tip, known by hand."""
    session = Session(catalog, TABLE)
    session.lay_beside(described(catalog, **numbers))
    assert session.beside
    for found, (distance, angle) in zip(session.beside.worst, expected, strict=True):
        assert found.distance == pytest.approx(distance, rel=0.05, abs=1e-12)
        assert found.distance <= distance + 1e-12
        assert found.angle == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize("tip", ["one", "none"])
def test_another_chain(catalog: Catalog, tip: str) -> None:
    """It is drawn all the same, and why there are no differences is there to be read."""
    session = Session(catalog, TABLE)
    session.lay_beside(described(catalog), tip_link=tip)
    assert session.beside
    assert session.beside.chain is None
    agreement = session.beside.agreement
    assert agreement.first_difference if agreement else "'none'" in session.beside.refusal
    assert f"{NAME}ee" in [node.name for node in session.drawing.nodes]


def test_an_edit_is_compared_anew_and_taking_it_away(catalog: Catalog) -> None:
    session = Session(catalog, TABLE)
    session.lay_beside(described(catalog))
    session.edit(1, "a", "0.25")
    assert session.beside
    assert session.beside.worst[-1].distance == pytest.approx(0.05)
    session.lay_beside(None)
    assert session.beside is None
    assert not any(node.name.startswith(NAME) for node in session.drawing.nodes)


def test_what_is_no_description(catalog: Catalog) -> None:
    """A message names the file without its folder; a file that no emitter reads is no description."""
    files = GivenFiles([("in/a.urdf", b"<robot"), ("a.step", b"")], catalog)
    assert files.descriptions == ["in/a.urdf"]
    found = files.figure("in/a.urdf")
    assert isinstance(found, str)
    assert "dh2urdf-" not in found


@pytest.mark.parametrize(
    ("file", "cells", "ends", "most"),
    [
        ("ur5.csv", {(0, "d"): "0.092"}, {}, 1),
        ("ur5.csv", {(1, "a"): "-0.43", (3, "alpha"): "1.6", (5, "theta"): "0.25"}, {}, 3),
        ("ur5.csv", {(2, "sign"): "-1", (2, "theta"): "0.5"}, {}, 2),
        ("panda.yaml", {(3, "a"): "0.09"}, {}, 1),  # of eight rows, of which its own table has seven
        ("panda.yaml", {}, {"base": "{xyz: [0.1, 0, 0], rpy: [0, 0, 0.3]}", "tool": "{xyz: [0, 0, 0.2]}"}, 3),
        ("stanford.csv", {(2, "d"): "0.1", (4, "alpha"): "1.5"}, {}, 2),
    ],
)
def test_the_table_becomes_the_description(catalog: Catalog, file: str, cells: dict, ends: dict, most: int) -> None:
    """Of an arm that differs in a few numbers only these are taken; the other cells keep their texts."""
    table = gallery_table(file, catalog)
    other = replace(with_cells(table, cells), **ends)
    described = Session(catalog, other).arm
    assert described
    text = dh2urdf.convert(described.manipulator).text
    session = Session(catalog, table)
    files = GivenFiles([("other.urdf", text.encode())], catalog)
    figure = files.figure("other.urdf")
    assert not isinstance(figure, str)
    session.lay_beside(figure)
    found, arm = session.beside, session.arm
    assert arm
    assert found
    assert found.agreement
    assert not found.agreement.holds
    ends = found.agreement.base_link, found.agreement.tip_link
    own = own_table(files.path("other.urdf"), catalog, arm.manipulator, ends)
    taken = adopted(table, arm.manipulator, found, own, catalog)
    assert taken
    assert 0 < changed_cells(table, taken) <= most
    session.put(taken)
    assert session.beside
    assert session.beside.agreement
    assert session.beside.agreement.holds
    session.undo()
    assert session.table == table
    files.close()
