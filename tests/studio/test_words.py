import math

from dh2urdf.rotations import RigidTransform
from dh2urdf.table_text import TableText
from dh2urdf_studio import words


def test_numbers_are_in_the_units_of_the_table() -> None:
    """Millimetres and degrees, and no minus before a zero; of a small arm, as many digits as count."""
    pose = RigidTransform.from_xyz_rpy((0.1, -0.0, 0.25), (0.0, 0.0, math.pi / 2))
    told = words.numbers(pose, TableText(length_unit="mm", angle_unit="deg"), 0.3)
    assert "-0.00" not in told
    for number in ("100.00", "rpy <b>0.0000, 0.0000, 90.0000</b>°", "reach at most <b>300.00</b> mm"):
        assert number in told
    pose = RigidTransform.from_xyz_rpy((0.0008012, 0.0, 0.0002), (0.0, 0.0, 0.0))
    told = words.numbers(pose, TableText(length_unit="m", angle_unit="rad"), 0.0011)
    assert "0.0008012" in told
    assert "reach at most <b>0.0011000</b> m" in told
