"""Comment lines: those that declare something under a key, sentences that do, and prose."""

from collections.abc import Callable

import pytest

from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected

Read = Callable[..., list[Manipulator | Rejected]]


PROSE = [
    "6 degrees of freedom, repeatability 0.1 mm, reach 850 mm", "TCP: the middle of the gripper", "see fig. 3 in [2]",
    "lengths in m, angles in rad", "see https://example.org/a?b=c", "################", "Created: 2024-01-05 10:30",
    "base, tool and defaults are not given", "in the lab, and not at home", "R = revolute, P = prismatic", "offset -90",
    'the "classic" arm, with "quotes"', "all joints ±170", "max. torque 50 Nm", "joint limits in degrees", "a in cm",
    "modified on 2020-01-01", "an RRRRRR arm", "not the modified DH convention", "reach of 850 millimetres",
    "inertia in kg mm^2", "lengths in m, rev. 3", "angles are given in turn", "Robot Alpha, rev 3", "m in g, I in g·m²",
    "counterclockwise is positive", "with 6 axes and a hand", "Link 1 -> Link 2: elbow", "<https://example.org/j1>",
]  # fmt: skip


@pytest.mark.parametrize("comment", PROSE)
@pytest.mark.parametrize("form", ["# {}", "# {},,", "'# {}", '"# {}",,'])
def test_everything_else_is_prose_and_passed_over_in_silence(comment: str, form: str, read: Read) -> None:
    """Above the header, between the rows, behind them and below them, and as a spreadsheet writes it."""
    line = form.format(comment.replace('"', '""') if form.startswith('"') else comment)
    table = f"{line}\na,alpha,d\n{line}\n0.3,0,0.1\n{line}\n0.2,0,0,# {comment}\n{line}\n"
    (arm,) = read(table, convention="standard")
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    assert [(row.a, row.d) for row in arm.rows] == [(0.3, 0.1), (0.2, 0)]
    assert arm.notices == ()
    (arm,) = read(f"# {comment}\njoints: [{{a: 0.3, alpha: 0, d: 0}}]\n", ".yaml", convention="standard")
    assert arm.notices == ()
