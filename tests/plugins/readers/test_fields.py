"""What the text of a header says, and words for types and conventions."""

import pytest
from hypothesis import given, strategies as st

from dh2urdf.manipulator import Convention, JointType
from dh2urdf_plugins.readers.header.words import misspelt, one_slip, read_header
from dh2urdf_plugins.readers.words.fields import convention_of, joint_type

HEADERS = {
    ("a", None, None): "a; R; a*; dh_a; DH parameter a; a (DH); link length (a)",
    ("a", "mm", None): "a [mm]; a/mm; a_mm; a, mm; a in mm; a {mm}; a <mm>; a|mm; DH a [mm]; a¹ [mm]; a [mm]†",
    ("a", None, "i"): "aᵢ; a_i*",
    ("a", None, "i-1"): "a_{i-1}; $a_{i-1}$; a(i-1); a_i-1; a_j−1",
    ("a", "mm", "i-1"): "aᵢ₋₁ [mm]",
    ("a", "mm", "i"): "Link length a_i/mm; 连杆长度ai/mm",
    ("a", "m", None): "Link length (m); a (m) [m]; a (in metres) [m]",
    ("a", "mm and m", None): "a [mm] [m]; a_mm (m)",
    ("theta", "rad and deg", None): "theta in rad [deg]",
    ("alpha", None, None): "α; 𝛼; Link-Twist; Angle α; twist α; α (twist); DH alpha",
    ("alpha", None, "i"): r"$\alpha_i$; ⍺ⱼ",
    ("alpha", None, "i-1"): r"\alpha_{i-1}",
    ("alpha", "°", None): "α°; α [º]; α [\N{WHITE BULLET}]",
    ("alpha", "DEG", None): "ALPHA (DEG)",
    ("alpha", "deg", "i+1"): "alpha_{i+1} [deg]",
    (None, "deg", None): "alpha_{ii-1} [deg]",
    ("d", None, None): "d¹; offset d; Link offset; Offset (d); d (offset); Distance (d)",
    ("d", None, "i"): "Joint Offset (d_i); Offset d_i",
    ("d", "mm", None): "joint offset d [mm]; d (along z) [mm]",
    ("theta", None, None): "theta*; θ (variable)",
    ("theta", "°", None): "Kąt θ [°]; 角度θ/(°)",
    ("theta", "deg", "i"): "angle θ_i (deg); theta_i (var.) [deg]",
    ("offset", "deg", None): "offset (deg)",
    ("velocity", "deg/s", None): "velocity_deg_per_s; velocity_deg_s; velocity [deg/s]",
    ("velocity", "°/s", None): "ω/(°/s)",
    ("effort", "Nm", None): "max [Nm]",
    ("effort", "N m", None): "effort (N m)",
    ("com", "mm", None): "CoG (x, y, z) [mm]",
    ("com_x", "mm", None): "cgx [mm]; com_x [mm]",
    ("inertia", "kg m2", None): "Inertia Tensor (3x3) [kg m²]",
    ("ixx", "kg·m2", None): "Ixx_kg_m2; ixx [kg·m²]",
    ("index", None, None): "#; i",
    ("type", None, None): "Joint Type; σ",
    (None, None, None): "link length d; twist angle θ; comment; a b; d1; grad; ",
}
"""Headers by what they say: the field, the unit and the link."""


@pytest.mark.parametrize(("said", "texts"), HEADERS.items(), ids=map(str, HEADERS))
def test_a_header_names_a_field_its_unit_and_its_link(said: tuple[str | None, ...], texts: str) -> None:
    """As textbooks, spreadsheets, LaTeX and code write it: units in any brackets, footnotes, a symbol behind its words."""
    for text in texts.split("; "):
        header = read_header(text)
        assert (header.field and header.field.name, header.unit, header.link) == said, text


def test_a_header_with_one_slip_is_surely_a_field() -> None:
    """One letter more, less, other or exchanged, in a word of four or more; or all letters in another order."""
    slips = {"alhpa": "alpha", "thta": "theta", "typ": "type", "offsets": "offset", "tetha": "theta", "torqe": "effort"}
    slips |= {"jointsgn": "sign", "lenght": "a", "geschwindigkiet": "velocity"}
    meant = {word: misspelt(word) for word in slips}
    assert {word: field and field.name for word, field in meant.items()} == slips
    others = ["jm", "b", "dd", "comment", "remarks", "gear ratio", "mean", "ahtet"]
    assert [word for word in others if misspelt(word)] == []


def slow_distance(left: str, right: str) -> int:
    """Optimal string alignment, by its recurrence."""
    table = [[max(i, j) if 0 in (i, j) else 0 for j in range(len(right) + 1)] for i in range(len(left) + 1)]
    for i in range(1, len(left) + 1):
        for j in range(1, len(right) + 1):
            other = left[i - 1] != right[j - 1]
            table[i][j] = min(table[i - 1][j] + 1, table[i][j - 1] + 1, table[i - 1][j - 1] + other)
            if i > 1 and j > 1 and left[i - 1] == right[j - 2] and left[i - 2] == right[j - 1]:
                table[i][j] = min(table[i][j], table[i - 2][j - 2] + 1)
    return table[-1][-1]


@given(st.text("abc", max_size=6), st.text("abc", max_size=6))
def test_one_slip_is_an_edit_distance_of_one(left: str, right: str) -> None:
    """Neighbours exchanged count as one slip."""
    assert one_slip(left, right) == (slow_distance(left, right) == 1)


TYPES = {
    JointType.REVOLUTE: "Revolute, r, hinge, Rot., re-volute, rotary joint, rotacyjny, ROTOIDE, 旋转关节, DÖNEL, 회전 관절",
    JointType.PRISMATIC: "T, linear, Pris., Traslacional, prismatic_joint, glissière, Поступательная, 移动副, 直動関節",
    JointType.CONTINUOUS: "C",
    JointType.FIXED: "FIXED, fixed joint, неподвижная, sabit, 고정",
    None: "0, 1, 2, -1, 1., twist, spherical, spherical joint, joint",
}
CONVENTIONS = {
    Convention.STANDARD: "STANDARD, DH, Spong, DH standard, standard (classic; distal), DH classique, clásica, 标准DH",
    Convention.MODIFIED: "MDH, modified Denavit-Hartenberg, modified (Craig), khalil, modifiziert, 改进D-H",
    None: "standard (Craig), standard/modified, not modified, DH parameters, Craig's, ",
}


@pytest.mark.parametrize(("kind", "words"), TYPES.items())
def test_a_word_means_a_type_of_joint(kind: JointType | None, words: str) -> None:
    """As published tables have them, in their languages; nothing else is taken for one."""
    assert {joint_type(word) for word in words.split(", ")} == {kind}


@pytest.mark.parametrize(("convention", "words"), CONVENTIONS.items())
def test_a_word_means_a_convention(convention: Convention | None, words: str) -> None:
    """The common names of the two; any other word is not guessed at."""
    assert {convention_of(word) for word in words.split(", ")} == {convention}
