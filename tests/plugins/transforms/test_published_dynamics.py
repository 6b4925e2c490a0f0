"""Published dynamics of real arms: the mass matrix and the gravity torques of the URDF are those of the table.

The oracle knows neither the readers nor the transform: it computes both from the published numbers, by the Jacobians of
the centres of mass in the Denavit-Hartenberg product. Pinocchio computes them from the file.
"""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from plain_frames import shift, turn

from dh2urdf.errors import TransformError
from dh2urdf.kinematics.mass import has_zero_moments, inertia_problem, principal_moments, repaired
from dh2urdf.manipulator import Inertia, Manipulator
from dh2urdf.robot import Robot
from dh2urdf_plugins.formats.urdf import EMITTER as URDF
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.table import TableOptions
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

ARMS = yaml.safe_load((Path(__file__).parents[2] / "reference" / "dynamics.yaml").read_text("utf-8"))
HAND = {"mass": 0.73, "com": [-0.01, 0.0, 0.03], "inertia": [0.001, 0.0025, 0.0017, 0.0001, 0.0, -0.0002]}
"""Franka's hand, as its description has it but for two products of inertia, which it lacks."""
POSES = 20
GRAVITY = 9.81
SPARE = 1.0 + 1e-6
"""By how much the sum of the smaller moments of a repaired inertia exceeds the greatest."""
ELEMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


# --- The oracle -------------------------------------------------------------------------------------------------------


def number(text: float | str) -> float:
    """The number that a sum or a multiple of π is."""
    if not isinstance(text, str):
        return float(text)
    if "pi" in text:
        head, _, part = text.partition("/")
        return (-math.pi if head.startswith("-") else math.pi) / float(part or 1)
    return sum(float(term) for term in text.split(" + "))


def tensor(elements: list[float]) -> NDArray[np.float64]:
    ixx, iyy, izz, ixy, ixz, iyz = elements
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def dynamics(
    arm: dict[str, Any], q: NDArray[np.float64], payload: dict[str, Any] | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mass matrix and gravity torques: sums over the bodies of what the Jacobians of their centres make of them."""
    pose, axes, bodies = np.eye(4), [], []
    for row, angle in zip(arm["rows"], q, strict=True):
        screw = shift(x=number(row["a"])) @ turn("x", number(row["alpha"]))
        if arm["convention"] == "modified":
            pose = pose @ screw
        axes.append((pose[:3, 2].copy(), pose[:3, 3].copy()))
        pose = pose @ turn("z", angle) @ shift(z=number(row["d"]))
        if arm["convention"] == "standard":
            pose = pose @ screw
        bodies.append((pose, row, len(axes)))
    if payload:
        bodies.append((pose @ shift(*arm.get("tool", (0, 0, 0))), payload, len(axes)))
    mass_matrix, torques = np.zeros((len(q), len(q))), np.zeros(len(q))
    for frame, body, moved_by in bodies:
        centre = frame[:3, :3] @ [number(part) for part in body["com"]] + frame[:3, 3]
        linear, angular = np.zeros((3, len(q))), np.zeros((3, len(q)))
        for column, (axis, point) in enumerate(axes[:moved_by]):
            linear[:, column] = np.cross(axis, centre - point)
            angular[:, column] = axis
        inertia = frame[:3, :3] @ tensor(body["inertia"]) @ frame[:3, :3].T
        mass_matrix += body["mass"] * linear.T @ linear + angular.T @ inertia @ angular
        torques += body["mass"] * GRAVITY * linear[2]
    return mass_matrix, torques


# --- The tables -------------------------------------------------------------------------------------------------------


def as_csv(arm: dict[str, Any], payload: dict[str, Any] | None) -> str:
    """One column for each number."""
    lines = [f"# convention: {arm['convention']}", f"# tool: {{xyz: {arm.get('tool', [0, 0, 0])}}}"]
    if payload:
        lines.append(f"# payload: {_payload(payload)}")
    lines.append(",".join(("a", "alpha", "d", "mass", "com_x", "com_y", "com_z", *ELEMENTS)))
    for row in arm["rows"]:
        cells = (row["a"], row["alpha"], row["d"], row["mass"], *row["com"], *row["inertia"])
        lines.append(",".join(map(str, cells)))
    return "\n".join([*lines, ""])


def _payload(payload: dict[str, Any]) -> str:
    inertia = ", ".join(f"{name}: {value}" for name, value in zip(ELEMENTS, payload["inertia"], strict=True))
    return f"{{mass: {payload['mass']}, com: {payload['com']}, inertia: {{{inertia}}}}}"


def read(text: str, folder: Path) -> Manipulator:
    path = folder / "arm.csv"
    path.write_text(text, encoding="utf-8")
    (arm,) = stages.CSV.read(path, TableOptions())
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    return arm


def robot_of(arm: Manipulator, **options: Any) -> Robot:
    return TRANSFORM.transform(arm, TRANSFORM.options(**options))


def possible(arm: dict[str, Any]) -> dict[str, Any]:
    """The arm with 1e-3 kg·m² more about x, y and z where an inertia is none of a body."""
    rows = [
        row | {"inertia": [value + 1e-3 * (k < 3) for k, value in enumerate(row["inertia"])]}
        if inertia_problem(Inertia(**dict(zip(ELEMENTS, row["inertia"], strict=True))))
        else row
        for row in arm["rows"]
    ]
    return arm | {"rows": rows}


# --- The proof --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("payload", [None, HAND], ids=["alone", "with payload"])
@pytest.mark.parametrize("frames", ["aligned", "dh"])
@pytest.mark.parametrize("name", ARMS)
def test_the_robot_moves_as_the_published_numbers_say(
    name: str, frames: str, payload: dict[str, Any] | None, tmp_path: Path
) -> None:
    """Mass matrix and gravity torques at 20 joint vectors; and no mass that moves beside the published ones."""
    pinocchio = pytest.importorskip("pinocchio")
    arm = possible(ARMS[name])
    robot = robot_of(read(as_csv(arm, payload), tmp_path), frames=frames)
    masses = [row["mass"] for row in arm["rows"]] + ([payload["mass"]] if payload else [])
    (base,) = (link.inertial for link in robot.links if link.name == "base_link_inertia")
    assert base is not None
    assert robot.mass - base.mass == pytest.approx(sum(masses), rel=1e-12)
    (file,) = URDF.emit(robot, "arm", URDF.options())
    model = pinocchio.buildModelFromXML(file.content.decode())
    data = model.createData()
    dice = np.random.default_rng(7)
    for _ in range(POSES):
        q = dice.uniform(-math.pi, math.pi, len(arm["rows"]))
        mass_matrix, torques = dynamics(arm, q, payload)
        found = pinocchio.crba(model, data, q)
        found = np.triu(found) + np.triu(found, 1).T
        assert np.abs(found - mass_matrix).max() <= 1e-12 * np.abs(mass_matrix).max()
        assert np.abs(pinocchio.computeGeneralizedGravity(model, data, q) - torques).max() <= 1e-12 * max(
            1.0, np.abs(torques).max()
        )


def test_an_inertia_that_no_body_has_is_refused(tmp_path: Path) -> None:
    """Two of those identified for the LBR iiwa 14: each is named, with its place."""
    arm = read(as_csv(ARMS["iiwa14"], None), tmp_path)
    with pytest.raises(TransformError) as caught:
        robot_of(arm)
    problems = caught.value.problems
    assert {problem.joint for problem in problems} == {"joint_4", "joint_7"}
    assert all(problem.code == "inertia-of-no-body" and problem.mark and problem.mark.line for problem in problems)


PUBLISHED = {
    "Puma 560, link 3": [0.066, 0.086, 0.0125, 0, 0, 0],
    "Puma 560, link 1": [0, 0.35, 0, 0, 0, 0],
    "UR10, link 6": [0, 0, 0.0001, 0, 0, 0],
    "iiwa 14, link 7": [0.001, 0.001, 0.1, 0.0, 0.0, 0.0],
    "turned": [0.2, 0.1, 0.9, 0.05, -0.1, 0.07],
    "negative": [-0.1, 0.5, 0.3, 0.02, 0, 0],
}
"""Inertias that no body has, as they are published, or like them."""


class TestInertias:
    """`keep` refuses them; `repair` takes the nearest that a body can have; `recompute` that of the drawn shape."""

    @pytest.mark.parametrize("elements", PUBLISHED.values(), ids=PUBLISHED)
    def test_the_repaired_is_the_nearest(self, elements: list[float]) -> None:
        """No tensor that a body can have and that has no smaller moment is nearer: scipy looks for one."""
        optimize = pytest.importorskip("scipy.optimize", reason="scipy is not installed")
        raised = repaired(Inertia(**dict(zip(ELEMENTS, elements, strict=True))))
        assert inertia_problem(raised) is None
        before, after = tensor(elements), tensor([getattr(raised, name) for name in ELEMENTS])
        moments = np.linalg.eigvalsh(before)
        found = optimize.minimize(
            lambda m: float(((m - moments) ** 2).sum()),
            np.full(3, 2.0 * moments[2]),
            bounds=[(max(moment, 0.0), None) for moment in moments],
            constraints=[{"type": "ineq", "fun": lambda m, k=k: m.sum() - 2.0 * m[k]} for k in range(3)],
            options={"ftol": 1e-16, "maxiter": 1000},
        )
        assert np.linalg.norm(after - before) == pytest.approx(math.sqrt(found.fun), rel=1e-4)
        assert np.abs(before @ after - after @ before).max() <= 1e-14  # the same axes

    @pytest.mark.parametrize("how", ["repair", "recompute"])
    @pytest.mark.parametrize("elements", PUBLISHED.values(), ids=PUBLISHED)
    def test_simulators_take_the_inertia(self, elements: list[float], how: str, tmp_path: Path) -> None:
        """MuJoCo and PyBullet have the moments that were written; as published, neither takes them."""
        mujoco, bullet = pytest.importorskip("mujoco"), pytest.importorskip("pybullet")
        text = "# convention: standard\na,alpha,d,mass,ixx,iyy,izz,ixy,ixz,iyz\n"
        arm = read(text + f"0.3,0.4,0.1,2,{','.join(map(str, elements))}\n", tmp_path)
        robot = robot_of(arm, inertias=how)
        (notice,) = (notice for notice in robot.notices if notice.field == "inertia")
        assert (notice.joint, notice.mark and notice.mark.line) == ("joint_1", 3)
        body = next(link.inertial for link in robot.links if link.name == "link_1")
        assert body is not None
        assert body.mass == 2.0
        wanted = principal_moments(body.inertia)
        if how == "recompute":  # the inertia that the table without one gets
            own = robot_of(replace(arm, rows=(replace(arm.rows[0], inertia=None),)))
            assert body == next(link.inertial for link in own.links if link.name == "link_1")
        path = tmp_path / "arm.urdf"
        path.write_bytes(URDF.emit(robot, "arm", URDF.options())[0].content)
        model = mujoco.MjModel.from_xml_path(str(path))
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "link_1")
        assert sorted(model.body_inertia[number]) == pytest.approx(wanted, rel=1e-6)
        client = bullet.connect(bullet.DIRECT)
        try:
            flags = bullet.URDF_USE_INERTIA_FROM_FILE
            loaded = bullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client)
            joints = range(bullet.getNumJoints(loaded, physicsClientId=client))
            names = [bullet.getJointInfo(loaded, joint, physicsClientId=client)[12].decode() for joint in joints]
            info = bullet.getDynamicsInfo(loaded, names.index("link_1"), physicsClientId=client)
            assert sorted(info[2]) == pytest.approx(wanted, rel=1e-4)
        finally:
            bullet.disconnect(client)


class TestFloor:
    """Moments of 0, as UR prints those of its last link."""

    def test_a_floor_makes_them_those_of_a_body(self, tmp_path: Path) -> None:
        """The least that the triangle inequality asks for, and a notice."""
        table = ARMS["ur20"]
        last = table["rows"][-1] | {"inertia": [0, 0, 0.0002, 0, 0, 0]}
        arm = read(as_csv(table | {"rows": [*table["rows"][:-1], last]}, None), tmp_path)
        robot = robot_of(arm, inertia_floor=1e-6, frames="dh")
        body = next(link.inertial for link in robot.links if link.name == "link_6")
        assert body is not None
        assert principal_moments(body.inertia) == pytest.approx((1e-4 * SPARE, 1e-4 * SPARE, 2e-4), rel=1e-12)
        assert [notice.code for notice in robot.notices if notice.field == "inertia"] == ["inertia-replaced"]

    @pytest.mark.parametrize(
        ("elements", "floor", "expected"),
        [
            ([0, 0, 2e-4, 0, 0, 0], 1e-6, (1e-4 * SPARE, 1e-4 * SPARE, 2e-4)),
            ([0, 0, 2e-4, 0, 0, 0], 3e-4, (3e-4, 3e-4, 3e-4)),
            ([0, 1e-3, 2e-3, 0, 0, 0], 1e-6, (5e-4 + 1e-9, 1.5e-3 + 1e-9, 2e-3)),
            ([0, 0, 0, 0, 0, 0], 1e-6, (1e-6, 1e-6, 1e-6)),
            ([1, 1, 0, 1, 0, 0], 1e-6, (SPARE, SPARE, 2)),  # a rod across x and y
        ],
    )
    def test_only_moments_of_0_are_raised(
        self, elements: list[float], floor: float, expected: tuple[float, ...]
    ) -> None:
        """To the floor, or to what a body with the other moments has; the axes stay."""
        given = Inertia(**dict(zip(ELEMENTS, elements, strict=True)))
        raised = repaired(given, floor)
        assert has_zero_moments(given)
        assert inertia_problem(raised) is None
        assert principal_moments(raised) == pytest.approx(expected, rel=1e-12)
        before, after = tensor(elements), tensor([getattr(raised, name) for name in ELEMENTS])
        assert np.abs(before @ after - after @ before).max() <= 1e-15 * np.abs(after).max()
