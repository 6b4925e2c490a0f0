from __future__ import annotations

import pytest
from hypothesis import given, strategies as st

from dh2urdf.manipulator import Convention, JointType
from dh2urdf_plugins.readers.header.words import misspelt, one_slip, read_header
from dh2urdf_plugins.readers.words.fields import convention_of, joint_type


@pytest.mark.parametrize(
    ("text", "field", "unit", "link"),
    [
        ("a", "a", None, None),
        ("R", "a", None, None),
        ("a [mm]", "a", "mm", None),
        ("α [r a d ]", "alpha", "rad", None),
        ("θ ( d e g )", "theta", "deg", None),
        ("a(mm)", "a", "mm", None),
        ("a/mm", "a", "mm", None),
        ("a_mm", "a", "mm", None),
        ("a, mm", "a", "mm", None),
        ("a in mm", "a", "mm", None),
        ("a_i [m]", "a", "m", "i"),
        ("aᵢ", "a", None, "i"),
        ("a_{i-1}", "a", None, "i-1"),
        ("$a_{i-1}$", "a", None, "i-1"),
        ("aᵢ₋₁ [mm]", "a", "mm", "i-1"),
        ("a(i-1)", "a", None, "i-1"),
        ("a_i-1", "a", None, "i-1"),
        ("a_j−1", "a", None, "i-1"),
        ("Link length (m)", "a", "m", None),
        ("a (m) [m]", "a", "m", None),
        ("a (in metres) [m]", "a", "m", None),
        ("d (along z) [mm]", "d", "mm", None),
        ("a [mm] [m]", "a", "mm and m", None),
        ("a_mm (m)", "a", "mm and m", None),
        ("theta in rad [deg]", "theta", "rad and deg", None),
        ("alpha_{i+1} [deg]", "alpha", "deg", "i+1"),
        ("alpha_{ii-1} [deg]", None, "deg", None),
        ("α", "alpha", None, None),
        ("𝛼", "alpha", None, None),
        ("α°", "alpha", "°", None),
        ("α [º]", "alpha", "°", None),
        ("α [\N{WHITE BULLET}]", "alpha", "°", None),
        (r"\alpha_{i-1}", "alpha", None, "i-1"),
        ("alpha_deg", "alpha", "deg", None),
        ("ALPHA (DEG)", "alpha", "DEG", None),
        ("Link-Twist", "alpha", None, None),
        ("d_m", "d", "m", None),
        ("Link offset", "d", None, None),
        ("theta*", "theta", None, None),
        ("ϑ_i", "theta", None, "i"),
        ("Joint offset", "offset", None, None),
        ("Joint Offset (d_i)", "d", None, "i"),
        ("velocity_deg_s", "velocity", "deg/s", None),
        ("θ (variable)", "theta", None, None),
        ("theta_i (var.) [deg]", "theta", "deg", "i"),
        ("max_vel_rad_per_sec", "velocity", "rad/sec", None),
        ("Ixx_kg_m2", "ixx", "kg·m2", None),
        ("cgx [mm]", "com_x", "mm", None),
        ("joint offset d [mm]", "d", "mm", None),
        ("Distance (d)", "d", None, None),
        ("angle θ_i (deg)", "theta", "deg", "i"),
        ("Kąt θ [°]", "theta", "°", None),
        ("角度θ/(°)", "theta", "°", None),
        ("Angle α", "alpha", None, None),
        ("offset (deg)", "offset", "deg", None),
        ("link length d", None, None, None),
        ("twist angle θ", None, None, None),
        ("Links", "link", None, None),
        ("Joints", "joint", None, None),
        ("q_min [deg]", "lower", "deg", None),
        ("velocity [deg/s]", "velocity", "deg/s", None),
        ("com_x [mm]", "com_x", "mm", None),
        ("com x", "com_x", None, None),
        ("ixx [kg·m²]", "ixx", "kg·m2", None),
        ("mass [kg]", "mass", "kg", None),
        ("effort (N m)", "effort", "N m", None),
        ("#", "index", None, None),
        ("i", "index", None, None),
        ("Joint Type", "type", None, None),
        ("σ", "type", None, None),
        ("comment", None, None, None),
        ("a b", None, None, None),
        ("", None, None, None),
    ],
)
def test_a_header_names_a_field_its_unit_and_its_link(
    text: str, field: str | None, unit: str | None, link: str | None
) -> None:
    """As textbooks, spreadsheets, LaTeX and code write it."""
    header = read_header(text)
    assert (header.field and header.field.name, header.unit, header.link) == (field, unit, link)


@pytest.mark.parametrize(
    ("word", "field"),
    [("alhpa", "alpha"), ("thta", "theta"), ("typ", "type"), ("offsets", "offset"), ("tetha", "theta")],
)
def test_a_header_with_one_slip_is_surely_a_field(word: str, field: str) -> None:
    """One letter more, less, other or exchanged, in a word of four or more; or all letters in another order."""
    meant = misspelt(word)
    assert meant is not None
    assert meant.name == field


@pytest.mark.parametrize("word", ["jm", "b", "dd", "comment", "remarks", "gear ratio", "mean", "ahtet"])
def test_other_words_are_no_misspelt_fields(word: str) -> None:
    """A column of somebody's own stands for itself."""
    assert misspelt(word) is None


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


@pytest.mark.parametrize(
    ("word", "kind"),
    [
        ("Revolute", JointType.REVOLUTE),
        ("r", JointType.REVOLUTE),
        ("0", None),
        ("hinge", JointType.REVOLUTE),
        ("T", JointType.PRISMATIC),
        *((word, JointType.REVOLUTE) for word in ("Rev", "Rot.", "rot", "rotacyjny")),
        *((word, JointType.PRISMATIC) for word in ("Pris.", "prism", "Trans.", "Traslacional", "translatif")),
        ("twist", None),
        ("linear", JointType.PRISMATIC),
        ("1", None),
        ("C", JointType.CONTINUOUS),
        ("FIXED", JointType.FIXED),
        ("prismatic_joint", JointType.PRISMATIC),
        ("spherical joint", None),
        ("joint", None),
        ("re-volute", JointType.REVOLUTE),
        ("2", None),
        ("-1", None),
        ("1.", None),
        ("spherical", None),
    ],
)
def test_a_word_means_a_type_of_joint(word: str, kind: JointType | None) -> None:
    """As published tables have them; nothing else is taken for one."""
    assert joint_type(word) is kind


@pytest.mark.parametrize(
    ("word", "convention"),
    [
        ("STANDARD", Convention.STANDARD),
        ("DH", Convention.STANDARD),
        ("classic", Convention.STANDARD),
        ("Spong", Convention.STANDARD),
        ("MDH", Convention.MODIFIED),
        ("modified DH", Convention.MODIFIED),
        ("modified Denavit-Hartenberg", Convention.MODIFIED),
        ("DH standard", Convention.STANDARD),
        ("standard (classic, distal)", Convention.STANDARD),
        ("modified (Craig)", Convention.MODIFIED),
        ("Craig DH", Convention.MODIFIED),
        ("Modified DH parameters (Craig)", Convention.MODIFIED),
        ("standard (Craig)", None),
        ("standard/modified", None),
        ("not modified", None),
        ("DH parameters", None),
        ("Craig's", None),
        ("khalil", Convention.MODIFIED),
        ("", None),
    ],
)
def test_a_word_means_a_convention(word: str, convention: Convention | None) -> None:
    """The common names of the two; any other word is not guessed at."""
    assert convention_of(word) is convention
