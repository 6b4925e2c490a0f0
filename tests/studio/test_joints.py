import math
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.manipulator import JointType, Limits
from dh2urdf.robot import Joint
from dh2urdf_studio import joints


def joint(kind: JointType = JointType.REVOLUTE, lower: float | None = -1.0, upper: float | None = 2.0) -> Joint:
    return Joint(name="x", type=kind, parent="a", child="b", limits=Limits(lower=lower, upper=upper))


@given(st.floats(-10, 10), st.sampled_from(["m", "cm", "mm"]), st.sampled_from(["rad", "deg"]))
def test_what_is_shown_is_the_value(value: float, length: str, angle: str) -> None:
    """A value in the slider's unit leads back to the value, inside the limits."""
    for kind in (JointType.REVOLUTE, JointType.PRISMATIC):
        (slider,) = joints.sliders([joint(kind)], length, angle)
        wanted = min(max(value, -1.0), 2.0)
        assert math.isclose(slider.value(slider.shown(value)), wanted, rel_tol=1e-12, abs_tol=1e-12)


@pytest.mark.parametrize(("text", "shown"), [("1,5", 1.5), ("pi/2", 1.570796), ("45°", 0.785398), ("-9", -1.0)])
def test_a_box_takes_what_a_cell_takes(text: str, shown: float) -> None:
    """Decimal commas too; the value is inside the limits."""
    (slider,) = joints.sliders([joint()])
    assert slider.read(text) == pytest.approx(shown, abs=1e-6)


@pytest.mark.parametrize(
    ("kind", "limits", "expected"),
    [
        (JointType.CONTINUOUS, (None, None), (-math.pi, math.pi)),
        (JointType.REVOLUTE, (-1e300, 1e300), (-1000.0, 1000.0)),
        (JointType.REVOLUTE, (-3.0, -0.5), (-3.0, -0.5)),
    ],
)
def test_limits_of_sliders(kind: JointType, limits: tuple[float | None, float | None], expected: Any) -> None:
    """Without limits half a turn to both sides, and none beyond use; zero is what is nearest to it inside them."""
    sliders = joints.sliders([joint(kind, *limits)])
    assert (sliders[0].lower, sliders[0].upper) == expected
    assert joints.kept({}, sliders) == joints.kept({"x": math.nan}, sliders) == {"x": min(0.0, expected[1])}
    assert all(sliders[0].holds(joints.anywhere(sliders)["x"]) for _ in range(100))
