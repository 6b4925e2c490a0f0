"""Tables as READMEs, lecture notes and programs have them, and the poses that their authors measured or computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from dh2urdf.manipulator import Manipulator

if TYPE_CHECKING:
    from readings import Read


# --- Whole tables, and where their authors say that the tip is --------------------------------------------------------

IRB_120 = """# convention: standard
θ,d (mm),a (mm),α (rad)
θ1,290,0,-π/2
θ2 - π/2,0,270,0
θ3,0,70,-π/2
θ4,302,0,π/2
θ5,0,0,-π/2
θ6 + π,72,0,0
"""
"""The flange of an IRB 120 in its home position is at (374, 0, 630) mm, says ABB's manual."""
KR_210 = """Links,α(i-1),a(i-1),d(i),θ(i)
0->1,0,0,0.75,q1
1->2,- pi/2,0.35,0,q2 - pi/2
2->3,0,1.25,0,q3
3->4,-pi/2,-0.054,1.50,q4
4->5,pi/2,0,0,q5
5->6,-pi/2,0,0,q6
6->EE,0,0,0.303,q7
"""
"""The gripper of a KR 210 is at (2.153, 0, 1.946) m where all joints are 0, says its URDF."""
MARKED = """# convention: standard
k,θ,d,a,α
1,q1+π/2,0.47,0,π/2
2,q2+π/2,0.16,−0.15,π/2
3,q3+π/2,0,0.18,0
4,q4,0,0.17,π/2
5,q5+π/2,0.05,0,π/2
6,q6,0.20,0,0
"""
OPEN_MANIPULATOR = """% Units: mm, degrees
%           a(i-1)  alpha(i-1)  d(i)    theta_offset
Joint,Name,a(i-1),alpha(i-1),d(i),theta_offset,type
1,Base,0,0,77,0,R
2,Shoulder,0,-90,0,-90,R
3,Elbow,128,0,0,90,R
4,Wrist,124,0,0,0,R
5,End Effector,126,0,0,0,fixed
"""
PUBLISHED = {
    "IRB 120": (IRB_120, 6, (0.374, 0, 0.630)),
    "KR 210": (KR_210, 7, (2.153, 0, 1.946)),
    "an exam": (MARKED, 6, (0.71, 0, 0.37)),
    "OpenManipulator": (OPEN_MANIPULATOR, 4, (0.25, 0, 0.205)),
}


@pytest.mark.parametrize("arm_name", PUBLISHED)
def test_the_tip_is_where_the_author_says(arm_name: str, read: Read) -> None:
    """Where all joints are 0: in the maker's manual, in its URDF, in a tutor's key, and in the comment of a program."""
    text, axes, tip = PUBLISHED[arm_name]
    (arm,) = read(text)
    assert isinstance(arm, Manipulator), arm.problems
    np.testing.assert_allclose(arm.fk([0.0] * axes)[:3, 3], tip, atol=1e-12)


# --- Joint variables that are counted from 0 --------------------------------------------------------------------------


# --- Advice that leads to a table that works --------------------------------------------------------------------------


# --- Units in other letters -------------------------------------------------------------------------------------------


# --- YAML of other programs -------------------------------------------------------------------------------------------
