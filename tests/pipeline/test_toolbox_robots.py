"""Robots of the Robotics Toolbox for Python as tables: T(q) of the toolbox itself, and attributes as it documents them."""

import inspect
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from plain_frames import dh, shift, turn

import dh2urdf
from dh2urdf.errors import ProofError, TableError
from dh2urdf.manipulator import Convention, JointType


class Robot:
    """What counts of a DHRobot."""

    def __init__(self, *links: Any, base: Any = None, tool: Any = None, name: str = "twin") -> None:
        self.links, self.name = links, name
        self.base, self.tool = (SimpleNamespace(A=np.eye(4) if each is None else each) for each in (base, tool))

    def fkine(self, q: list[float]) -> Any:
        pose = self.base.A
        for link, value in zip(self.links, q, strict=True):
            variable = (-value if link.isflip else value) + link.offset
            theta, d = (link.theta, variable) if link.isprismatic else (variable, link.d)
            pose = pose @ dh("modified" if link.mdh else "standard", theta, d, link.a, link.alpha)
        return SimpleNamespace(A=pose @ self.tool.A)


def link(*, slides: bool = False, mdh: bool = False, **said: Any) -> Any:
    given = {"a": 0.0, "alpha": 0.0, "d": 0.0, "theta": 0.0, "offset": 0.0, "isflip": False, "qlim": None, "m": 0.0}
    given |= {"r": np.zeros(3), "I": np.zeros((3, 3)), "G": 0.0, "Jm": 0.0, "B": 0.0, "Tc": np.zeros(2), "name": ""}
    return SimpleNamespace(isprismatic=slides, isrevolute=not slides, mdh=mdh, **(given | said))


@pytest.mark.parametrize("mdh", [False, True])
def test_every_feature(*, mdh: bool) -> None:
    """Offsets, flips, sliding joints, base and tool; friction and rotors behind their gears; what is 0 is not said."""
    inertia = np.array([[0.3, 0.01, -0.02], [0.01, 0.4, 0.03], [-0.02, 0.03, 0.5]])
    robot = Robot(
        link(
            mdh=mdh,
            a=0.3,
            alpha=-0.7,
            d=0.2,
            offset=0.1,
            theta=9.0,
            isflip=True,
            qlim=np.array([-1.0, 2.0]),
            name="upper",
            m=2.0,
            r=np.array([0.1, -0.2, 0.3]),
            I=inertia,
            G=-50.0,
            Jm=2e-4,
            B=1e-3,
            Tc=np.array([0.2, -0.3]),
        ),
        link(mdh=mdh, slides=True, I=inertia, a=0.1, alpha=0.4, theta=-0.9, d=9.0, offset=0.05, name="slider"),
        base=shift(0.4) @ turn("x", 0.5),
        tool=shift(z=0.1) @ turn("z", -0.3),
    )
    arm = dh2urdf.from_roboticstoolbox(robot)
    assert arm.convention is (Convention.MODIFIED if mdh else Convention.STANDARD)
    q = [0.4, -0.2]
    assert np.abs(arm.fk(q) - robot.fkine(q).A).max() < 1e-15
    first, second = arm.rows
    assert (first.link, first.sign, first.limits.lower, first.limits.upper) == ("upper", -1, -1.0, 2.0)
    assert (first.mass, first.com) == (2.0, (0.1, -0.2, 0.3))
    assert first.inertia == dh2urdf.Inertia(ixx=0.3, iyy=0.4, izz=0.5, ixy=0.01, ixz=-0.02, iyz=0.03)
    assert (first.damping, first.friction, first.armature) == pytest.approx((2.5, 15.0, 0.5))
    assert [notice.code for notice in arm.notices] == ["toolbox-friction", "toolbox-link-without-mass"]
    assert second.type is JointType.PRISMATIC
    assert (second.mass, second.com, second.inertia, second.limits.lower, second.damping) == (None,) * 5


def test_what_is_no_dh_robot() -> None:
    """A robot of elementary transforms, links of both conventions, a base that is no pose, a T(q) that is another."""
    no_robot = SimpleNamespace(links=[SimpleNamespace(ets=())], name="panda")
    for robot in (no_robot, Robot(link(), link(mdh=True)), Robot(link(), base=2.0 * np.eye(4))):
        with pytest.raises(TableError):
            dh2urdf.from_roboticstoolbox(robot)

    class Another(Robot):
        def fkine(self, q: list[float]) -> Any:
            return super().fkine([1.01 * value for value in q])

    with pytest.raises(ProofError):
        dh2urdf.from_roboticstoolbox(Another(link(a=0.3), link(a=0.2)))


def test_the_models_of_the_toolbox() -> None:
    """Every DH model that it ships: T(q) to rounding at random joint vectors, and a URDF that is proved."""
    models = pytest.importorskip("roboticstoolbox.models.DH", reason="roboticstoolbox-python is not installed")
    generator = np.random.default_rng(3)
    names, proved = [], []
    for name, model in inspect.getmembers(models, inspect.isclass):
        robot = model()
        arm = dh2urdf.from_roboticstoolbox(robot, name=name)
        for _ in range(3):
            q = generator.uniform(-2.0, 2.0, robot.n)
            expected = robot.fkine(q).A
            assert np.abs(arm.fk(q) - expected).max() <= 1e-13 * max(1.0, np.abs(expected).max()), name
        names.append(name)
        proof = dh2urdf.convert(arm).proofs["urdf"]
        proved.append((name, proof is not None and proof.holds))
    assert proved == [(name, True) for name in names]
    assert {"Panda", "Puma560", "Stanford", "UR5", "KR5", "IRB140"} <= set(names)


def test_inertias_as_they_were_published() -> None:
    """The Puma's third link: the nearest that a body can have, with a warning; refused or computed where that is asked for."""
    robot = Robot(link(m=4.8, r=np.array([-0.0203, -0.0141, 0.07]), I=np.diag([0.066, 0.086, 0.0125]), a=0.0203))
    with pytest.warns(dh2urdf.TableWarning):
        arm = dh2urdf.from_roboticstoolbox(robot)
    inertia = arm.rows[0].inertia
    assert inertia is not None
    assert (inertia.ixx, inertia.iyy, inertia.izz) == pytest.approx((0.06975, 0.086, 0.01625), rel=1e-5)
    (moving,) = (link for link in dh2urdf.convert(arm).robot.links if link.name == "link_1")
    assert moving.inertial is not None
    assert moving.inertial.mass == 4.8
    kept = dh2urdf.from_roboticstoolbox(robot, inertias="keep")
    with pytest.raises(TableError):
        dh2urdf.convert(kept)
    assert kept.notices == ()
    with pytest.warns(dh2urdf.TableWarning):
        assert dh2urdf.from_roboticstoolbox(robot, inertias="recompute").rows[0].inertia is None
    wrong: Any = "fix"
    with pytest.raises(TableError):
        dh2urdf.from_roboticstoolbox(robot, inertias=wrong)
