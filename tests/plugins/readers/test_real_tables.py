"""Tables as makers, textbooks and spreadsheets have them: what a person meant, or a word about it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest
from readings import STANDARD

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf_plugins.readers.header.columns import TURN_ROUND

if TYPE_CHECKING:
    from readings import Read, ReadOne


# --- Titles and rows of units -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "# convention: standard\na [mm],alpha [deg],d [mm]\n-425,90,162.5\n",
        "UR5e,,\nDH parameters,,\nconvention: standard,,\na [mm],alpha [deg],d [mm]\n,,\n-425,90,162.5\n",
        "convention,standard\nunits: {length: mm, angle: deg}\na,alpha,d\n-425,90,162.5\n",
        "# convention: standard\na,alpha,d\nmm,deg,mm\n-425,90,162.5\n",
        "# convention: standard\na,alpha,d\n\n[mm],[°],[mm]\n-425,90,162.5\n",
        "convention;standard;\na;alpha;d\n(mm);(deg);(mm)\n-425;90;162,5\n",
        "convention\tstandard\t\na\talpha\td\nmm\tdeg\tmm\n-425\t90\t162.5\n",
        '# convention: standard\n"a\n[mm]","alpha\n[deg]","d\n[mm]"\n-425,90,162.5\n',
        '# convention: standard\n"The arm\nof the lab",,\na [mm],alpha [deg],d [mm]\n-425,90,162.5\n',
    ],
)
def test_titles_and_units_of_a_spreadsheet_are_read(text: str, read: Read) -> None:
    """Above and below the header, in commas, semicolons and tabs."""
    (arm,) = read(text)
    assert isinstance(arm, Manipulator), arm.problems
    assert arm.convention is Convention.STANDARD
    assert [(row.a, row.alpha, row.d) for row in arm.rows] == [(-0.425, math.pi / 2, 0.1625)]


def test_titles_of_columns_that_were_merged_cover_their_parts(read_one: ReadOne) -> None:
    """A merged cell leaves its text in its first cell, and nothing in the others."""
    arm = read_one(
        "a,alpha,d,mass,Center of mass,,,Limits [deg],\n,,,,x,y,z,lower,upper\n0.3,0,0.1,1,0.01,0.02,0.03,-90,180\n"
    )
    (row,) = arm.rows
    assert row.com == (0.01, 0.02, 0.03)
    assert (row.limits.lower, row.limits.upper) == (-math.pi / 2, math.pi)


# --- Comments ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("comments", "name"),
    [
        ("# Manipulator: KUKA KR 6\n", "KUKA KR 6"),
        ('# model = "KR 6 R900"\n', "KR 6 R900"),
        ("# Roboter: Nr. 5: der neue\n", "Nr. 5: der neue"),
        ("Robot,UR5,\n", "UR5"),
        ("# robot: UR5\n# model: CB3\n", "UR5"),
        ("# robot: UR5\n# name: ur5\n", "ur5"),
    ],
)
def test_other_keys_say_the_name(comments: str, name: str, read_one: ReadOne) -> None:
    """Those that a column of names is called, too."""
    arm = read_one(f"{comments}a,alpha,d\n0.3,0,0\n")
    assert (arm.name, arm.notices) == (name, ())


# --- Columns ----------------------------------------------------------------------------------------------------------


# --- Cells ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("field", ["a", "alpha", "d", "theta", "offset", "lower"])
def test_such_a_number_is_refused_in_bulk(field: str, read: Read) -> None:
    """On the fast path, among numbers with usual exponents."""
    fields = ("a", "alpha", "d", "theta", "offset", "lower", "upper")
    row = dict.fromkeys(fields, "0") | {"a": "0.3", "lower": "-1", "upper": "1"}
    rows = [row | {"d": "1e-05"} for _ in range(400)]
    rows[300] |= {field: "1e-400"}
    lines = "".join(f"r{k},{','.join(row.values())}\n" for k, row in enumerate(rows))
    arms = read(f"{STANDARD}robot,{','.join(fields)}\n{lines}")
    assert [arm.name for arm in arms if not isinstance(arm, Manipulator)] == ["r300"]


@pytest.mark.parametrize(("word", "sign"), [("WAHR", -1), ("FAUX", 1), ("VERDADERO", -1), ("nein", 1)])
def test_truth_values_of_spreadsheets_are_read(word: str, sign: int, read_one: ReadOne) -> None:
    """In the languages that headers are read in."""
    assert read_one(f"a,alpha,d,flip\n0.3,0,0,{word}\n").rows[0].sign == sign
    assert read_one(f"joints: [{{a: 0.3, alpha: 0, d: 0, flip: {word}}}]", ".yaml").rows[0].sign == sign


# --- Words in other languages, and in other places --------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "Articulación;a (mm);alfa (°);d (mm);Límite inferior (°);Límite superior (°);Par máximo (Nm)\nx;0;90;340;-170;170;176\n",
        "Gelenk;a [mm];α [°];d [mm];Grenze unten [°];Grenze oben [°];Drehmoment [Nm]\nx;0;90;340;-170;170;176\n",
        "Articulation;a (mm);alpha (°);d (mm);Butée min (°);Butée max (°);Couple (N.m)\nx;0;90;340;-170;170;176\n",
        "Junta;Comprimento a (mm);Torção α (°);Deslocamento d (mm);Faixa (°);Torque máximo (Nm)\nx;0;90;340;±170;176\n",
        "关节;连杆长度a/(mm);连杆扭转角α/(°);连杆偏距d/(mm);关节范围/(°);最大力矩(N·m)\nx;0;90;340;-170～170;176\n",
        "Przegub;Długość członu a [mm];Skręcenie członu α [°];Odsunięcie członu d [mm];Zakres ruchu [°];Moment obrotowy [Nm]\nx;0;90;340;±170;176\n",
        "Eklem;Uzuv uzunluğu a (mm);Burulma açısı α (°);Öteleme d (mm);Hareket aralığı (°);TORK (Nm)\nx;0;90;340;±170;176\n",
        "Eklem;UZUV UZUNLUĞU [mm];Burulma Açısı [deg];Eklem Kaçıklığı [mm];Alt sınır [deg];Üst sınır [deg];Tork [Nm]\nx;0;90;340;-170;170;176\n",
        "Шарнир;Длина звена a [mm];Угол скручивания α [°];Смещение d [mm];Диапазон [°];Крутящий момент [Nm]\nx;0;90;340;±170;176\n",
        "関節;リンク長a[mm];ねじれ角α[°];リンクオフセットd[mm];可動範囲[°];最大トルク[Nm]\nx;0;90;340;±170;176\n",
        "관절;링크 길이 a [mm];비틀림 각 α [°];링크 오프셋 d [mm];하한 [°];상한 [°];토크 [Nm]\nx;0;90;340;-170;170;176\n",
        "关节,连杆长度ai/mm,扭转角αi/(°),偏距di/mm,角度下限/(°),角度上限/(°),力矩/(N·m)\nx,0,90,340,-170,170,176\n",
    ],
)
def test_tables_of_other_languages_are_read(text: str, read_one: ReadOne) -> None:
    """As spreadsheets there have them."""
    (row,) = read_one(text).rows
    assert (row.joint, row.a, row.alpha, row.d) == ("x", 0, math.pi / 2, 0.34)
    assert (row.limits.lower, row.limits.upper) == pytest.approx((-17 / 18 * math.pi, 17 / 18 * math.pi), abs=1e-15)
    assert row.limits.effort == 176


@pytest.mark.parametrize("name", ["θ_offset", "theta_offset_i", "Joint angle offset"])
@pytest.mark.parametrize("kind", ["R", "P"])
def test_an_offset_of_theta_is_the_constant_part_of_theta(name: str, kind: str, read_one: ReadOne) -> None:
    """It was refused; it is an angle, also where the joint slides."""
    arm = read_one(f"type,a,alpha,d,{name}\n{kind},0.3,0,0.1,pi/2\n")
    expected = read_one(f"type,a,alpha,d,theta\n{kind},0.3,0,0.1,pi/2\n")
    assert arm.fk([0.7]) == pytest.approx(expected.fk([0.7]))
    assert read_one(f"type,a,alpha,d,{name} [deg]\n{kind},0.3,0,0.1,30\n").rows[0].theta == pytest.approx(math.pi / 6)


@pytest.mark.parametrize(
    ("header", "row", "count"),
    [
        ("theta", "q1,0", 1),
        ("theta", "0,pi/2", 0),
        ("theta", "q1,0.2", 0),
        ("offset", "0.3,0.2", 1),
    ],
)
def test_an_offset_of_theta_beside_theta_is_read_where_it_is_0(header: str, row: str, count: int, read: Read) -> None:
    """Whether both are added is not said."""
    arms = read(f"{STANDARD}a,alpha,d,{header},theta offset\n0.3,0,0.1,{row}\n")
    assert sum(isinstance(arm, Manipulator) for arm in arms) == count


@pytest.mark.parametrize(
    ("keys", "theta"),
    [
        ("theta_offset: 0, theta: 0.2", 0.2),
        ("theta: 0.2, theta_offset: 0.0", 0.2),
        ("theta: 0.2, theta_offset: 0.3", None),
        ("theta: 0, theta_offset: 0.3", None),
        ("theta: 0.2, θ: 0", None),
    ],
)
def test_two_keys_of_theta(keys: str, theta: float | None, read: Read) -> None:
    """In either order; of two that are theta itself, none is dropped, though one be 0."""
    (arm,) = read(f"convention: standard\njoints: [{{a: 0.3, alpha: 0, d: 0, {keys}}}]", ".yaml")
    assert (arm.rows[0].theta if isinstance(arm, Manipulator) else None) == theta


@pytest.mark.parametrize(
    "table",
    [
        "parameter,J1,J2,J3\na,0,0.3,0.2\nalpha,pi/2,0,0\nd,0.1,0,0",
        "parameter,J1,J2\na,0,0.3\nalpha,pi/2,0\nd,0.1,0",
        "param;1;2;3\na [mm];0;300;200\nalpha;90;0;0\nd;100;0;0",
        "a,0,0.3,0.2\nalpha,0,0,0\nd,0.1,0,0",
    ],
)
def test_a_table_whose_joints_are_in_columns_is_to_be_turned_round(table: str) -> None:
    """The advice was that no field is called '0.3'."""
    with pytest.raises(TableError) as caught:
        dh2urdf.read(f"# convention: standard\n{table}\n", reader="csv")
    assert TURN_ROUND in str(caught.value)


# --- Legends, footnotes and cells that say that there is nothing ------------------------------------------------------


@pytest.mark.parametrize(
    ("above", "header"),
    [
        ("", "sigma"),
        ("# joint 0: prismatic, joint 1: revolute\n", "σ"),
        ("# 1 revolute joint and 1 prismatic joint\n", "sigma_j"),
    ],
)
def test_a_legend_that_agrees_and_joints_that_are_counted_change_nothing(
    above: str, header: str, read_one: ReadOne
) -> None:
    arm = read_one(f"{above}{header},a,alpha,d\n1,0.3,0,0\n0,0,0,0.1\n")
    assert [row.type.value for row in arm.rows] == ["prismatic", "revolute"]


def test_a_row_of_names_that_are_headers_too_is_a_row(read_one: ReadOne) -> None:
    """Numbers are in it."""
    assert [row.joint for row in read_one("joint,link,a,alpha,d\nmass,base plate,0.3,0,0\n").rows] == ["mass"]
