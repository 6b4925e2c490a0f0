from collections.abc import Callable

import pytest

from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.words.names import MAX_NAME, name_fault


@pytest.mark.parametrize(
    "name",
    ["a b", "Grün", "关节", "می\u200cخواهم", "👩\u200d🔧", "<a&b>", "${x}", "../x", "]]>", "'\"", "x" * MAX_NAME],
)
def test_any_visible_text_is_a_name(name: str) -> None:
    """Markup, xacro and paths are text like any other."""
    assert name_fault(name) is None


@pytest.mark.parametrize("blank", ["", "  ", "\N{NO-BREAK SPACE}"])
def test_an_empty_name_is_none(blank: str) -> None:
    assert name_fault(blank)


@pytest.mark.parametrize("sign", "\n\x00\x1b\x7f\x85\ud800\u200b\u202e\ufeff\u2028\uffff")
def test_a_name_that_nobody_can_see_is_none(sign: str) -> None:
    """The message names the code point and shows no control character."""
    fault = name_fault(f"a{sign}")
    assert fault is not None
    assert f"U+{ord(sign):04X}" in fault[0]
    assert fault[0].isprintable()
    assert name_fault("x" * (MAX_NAME + 1))


@pytest.mark.parametrize("name", ["_j1_", "__j1__", "**j1**"])
def test_a_name_in_typesetting_is_read_alike_fast_and_with_care(
    name: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """The two readings of `_j1_` differed, and the whole file was refused."""
    (arm,) = read(f"joint,type,a,alpha,d\n{name},R,0.3,0,0\n", convention="standard")
    assert isinstance(arm, Manipulator)
    assert [row.joint for row in arm.rows] == ["j1"]


@pytest.mark.parametrize("theta", ["θ2 - θ1", "q2-", "q2(+90°)", "0 (θ2)", "θ2 = 0"])
def test_a_theta_that_cannot_be_read_lacks_no_variable_besides(
    theta: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """There was a second error: that the row has no joint variable and no type."""
    (arm,) = read(f"a,alpha,d,theta\n0.3,0,0,q1\n0.2,0,0,{theta}\n", convention="standard")
    assert isinstance(arm, Rejected)
    assert [problem.found for problem in arm.problems] == [theta]
