"""Collision pairs of small mechanisms whose contacts are known, and of arms that MuJoCo measures."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from random import Random
from types import MappingProxyType

import pytest

import dh2urdf
from dh2urdf.errors import InputError
from dh2urdf.manipulator import JointType, Limits
from dh2urdf.robot import Box, Collision, Follower, Joint, Link, Mesh, Origin, Robot, Sphere
from dh2urdf_plugins.collision_pairs.options import PairOptions
from dh2urdf_plugins.collision_pairs.scene import Mechanism
from dh2urdf_plugins.collision_pairs.search import collision_pairs, robot_pairs
from dh2urdf_plugins.formats import mjcf
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap

pytest.importorskip("pinocchio")

TABLES = Path(__file__).parents[3] / "configs" / "tables"
RADIUS = 0.1
OPTIONS = PairOptions(trials=2000)


def ball(name: str, *, radius: float = RADIUS) -> Link:
    return Link(name=name, collisions=(Collision(geometry=Sphere(radius=radius)),))


def slide(child: str, lower: float, upper: float, *, parent: str = "base", y: float = 0.0, x: float = 0.0) -> Joint:
    """A joint along x: at q the child is at (x + q, y)."""
    return Joint(
        name=f"to_{child}",
        type=JointType.PRISMATIC,
        parent=parent,
        child=child,
        origin=Origin(xyz=(x, y, 0.0)),
        axis=(1.0, 0.0, 0.0),
        limits=Limits(lower=lower, upper=upper, velocity=1.0, effort=1.0),
    )


def hold(child: str, *, parent: str = "base", x: float = 0.0, y: float = 0.0) -> Joint:
    return Joint(name=f"to_{child}", type=JointType.FIXED, parent=parent, child=child, origin=Origin(xyz=(x, y, 0.0)))


def reasons(
    links: list[Link],
    joints: list[Joint],
    options: PairOptions = OPTIONS,
    followers: Mapping[str, Follower] = MappingProxyType({}),
    **more: Mapping[str, object],
) -> dict[tuple[str, str], str]:
    joints = [replace(joint, follows=followers.get(joint.name)) for joint in joints]
    mechanism = Mechanism(robot=Robot(name="test", links=tuple(links), joints=tuple(joints)), **more)  # type: ignore[arg-type]
    found = collision_pairs(mechanism, lambda _: (b"", ".stl"), options)
    return {(pair.link1, pair.link2): pair.reason for pair in found.disabled}


def between(lower: float, upper: float, other: float, options: PairOptions = OPTIONS) -> str | None:
    """The reason of two balls of which one slides towards the other, which is held at a distance."""
    # A wide base of an own shape, far away, keeps the two from being neighbours.
    base = Link(name="base", collisions=(Collision(geometry=Sphere(radius=RADIUS), origin=Origin(xyz=(0, 9.0, 0))),))
    found = reasons(
        [base, ball("slider"), ball("post")], [slide("slider", lower, upper), hold("post", x=other)], options
    )
    assert found[("base", "slider")] == found[("base", "post")] == "Adjacent"
    return found.get(("post", "slider"))


class TestReasons:
    def test_default_is_contact_where_the_robot_starts(self) -> None:
        """At 0; a pair that touches there needs no other reason, though it is apart in most states."""
        assert between(-5.0, 5.0, 0.15) == "Default"

    def test_a_joint_whose_limits_leave_0_out_starts_in_their_middle(self) -> None:
        assert between(1.0, 5.0, 3.15) == "Default"
        assert between(1.0, 5.0, 0.95) is None

    @pytest.mark.parametrize(("free", "reason"), [(0.02, "Always"), (0.10, None)])
    def test_always_is_contact_in_more_than_95_percent(self, free: float, reason: str | None) -> None:
        """The slider touches the post in all but a part of its way, which begins where the robot starts."""
        way = 0.2
        assert between(0.0, way, 2.0 * RADIUS + free * way) == reason

    def test_never_is_no_contact_in_any_state(self) -> None:
        assert between(-1.0, 1.0, 1.3) == "Never"

    def test_a_contact_in_few_states_is_found(self) -> None:
        """One state in fifty; a pair that touches sometimes has to be checked."""
        assert between(-1.0, 1.0, 1.16) is None

    @pytest.mark.parametrize(("distance", "reason"), [(0.0, "Never"), (0.004, "Never"), (0.01, None)])
    def test_a_pair_that_comes_near_is_not_never(self, distance: float, reason: str | None) -> None:
        """The two are 5 mm apart at the end of the way."""
        options = PairOptions(trials=2000, min_distance=distance)
        assert between(-1.0, 1.0, 1.0 + 2.0 * RADIUS + 0.005, options) == reason

    def test_a_pair_that_is_near_where_the_robot_starts_is_not_never(self) -> None:
        """All other states are apart by more, but for a few."""
        assert between(0.0, 1000.0, -2.0 * RADIUS - 0.005, PairOptions(trials=10)) is None

    def test_pairs_are_sorted_by_their_names(self) -> None:
        """As MoveIt sorts them: the first link of a pair is the smaller name, capitals before small letters."""
        links = [ball(name, radius=0.01) for name in ("base", "b", "Z", "a")]
        found = reasons(links, [hold(name, x=place) for place, name in enumerate(("b", "Z", "a"), start=1)])
        assert list(found) == [("Z", "a"), ("Z", "b"), ("Z", "base"), ("a", "b"), ("a", "base"), ("b", "base")]


class TestNeighbours:
    def test_links_without_a_shape_are_bridges(self) -> None:
        """All that meet at a region of bare links are neighbours; what is behind another shape is not."""
        bare = [Link(name=name) for name in ("base", "wrist", "socket")]
        links = [*bare, *(ball(name, radius=0.01) for name in ("left", "right", "hand", "finger"))]
        joints = [
            hold("left", x=1.0),
            hold("right", x=-1.0),
            slide("wrist", 0.0, 0.1, y=1.0),
            slide("socket", 0.0, 0.1, parent="wrist"),
            slide("hand", 0.0, 0.1, parent="socket"),
            slide("finger", 0.0, 0.1, parent="hand", y=1.0),
        ]
        found = reasons(links, joints)
        adjacent = {pair for pair, reason in found.items() if reason == "Adjacent"}
        assert adjacent == {("hand", "left"), ("hand", "right"), ("left", "right"), ("finger", "hand")}
        assert found[("finger", "left")] == found[("finger", "right")] == "Never"

    def test_links_without_a_shape_are_in_no_pair(self) -> None:
        found = reasons([Link(name="base"), ball("one"), ball("two")], [hold("one", x=1.0), hold("two", x=-1.0)])
        assert found == {("one", "two"): "Adjacent"}


class TestWhatMoves:
    def links(self) -> list[Link]:
        base = Link(name="base", collisions=(Collision(geometry=Sphere(radius=0.01), origin=Origin(xyz=(0, 9.0, 0))),))
        return [base, ball("one"), ball("two")]

    def test_a_joint_that_mimics_follows(self) -> None:
        """The two balls meet only where both are at the same x; a follower keeps the distance."""
        joints = [slide("one", -1.0, 1.0), slide("two", -1.0, 1.0, x=0.5)]
        assert ("one", "two") not in reasons(self.links(), joints)
        found = reasons(self.links(), joints, followers={"to_two": Follower("to_one", 1.0, 0.1)})
        assert found[("one", "two")] == "Never"
        found = reasons(self.links(), joints, followers={"to_two": Follower("to_one", -1.0, 0.0)})
        assert ("one", "two") not in found
        found = reasons(self.links(), joints, followers={"to_two": Follower("to_one", 1.0, -0.5)})
        assert found[("one", "two")] == "Default"

    def test_a_follower_of_a_follower_follows_the_first(self) -> None:
        """In whatever order the joints are."""
        links = [*self.links(), ball("three")]
        joints = [slide("three", -1.0, 1.0, x=0.5), slide("two", -1.0, 1.0, x=9.0), slide("one", -1.0, 1.0)]
        followers = {"to_three": Follower("to_two", -0.5), "to_two": Follower("to_one", -2.0)}
        assert reasons(links, joints, followers=followers)[("one", "three")] == "Never"

    @pytest.mark.parametrize(("kind", "reason"), [("fixed", "Never"), ("planar", "Never"), ("floating", None)])
    def test_loose_joints_turn(self, kind: str, reason: str | None) -> None:
        """A planar joint turns its link about z, a floating one anyhow: then the arm reaches the post above."""
        arm = Link(name="arm", collisions=(Collision(geometry=Box(size=(2.0, 0.1, 0.1))),))
        post = Link(name="post", collisions=(Collision(geometry=Box(size=(0.5, 0.5, 0.1))),))
        base = self.links()[0]
        joint = Joint(name="to_post", type=JointType.FIXED, parent="base", child="post", origin=Origin(xyz=(0, 0, 0.7)))
        loose = {} if kind == "fixed" else {"to_arm": kind}
        assert reasons([base, arm, post], [hold("arm"), joint], loose=loose).get(("arm", "post")) == reason

    @pytest.mark.parametrize(("distance", "reason"), [(1.3, "Never"), (1.05, None)])
    def test_a_planar_joint_turns_all_the_way(self, distance: float, reason: str | None) -> None:
        """A post beside the arm, at a right angle, is met only where the arm is turned that far."""
        arm = Link(name="arm", collisions=(Collision(geometry=Box(size=(2.0, 0.1, 0.1))),))
        found = reasons(
            [self.links()[0], arm, ball("post")], [hold("arm"), hold("post", y=distance)], loose={"to_arm": "planar"}
        )
        assert found.get(("arm", "post")) == reason


class TestErrors:
    @pytest.mark.parametrize(
        ("joints", "followers", "code"),
        [
            ([slide("one", 0, 1)], {}, "no-tree"),
            ([slide("one", 0, 1, parent="two"), slide("two", 0, 1, parent="one")], {}, "no-tree"),
            ([slide("one", 0, 1), slide("two", 0, 1), slide("two", 0, 1, parent="one")], {}, "no-tree"),
            ([slide("one", 0, 1), slide("tow", 0, 1)], {}, "joint-of-no-link"),
            *(
                ([slide("one", 0, 1), slide("two", 0, 1)], {"to_one": follower, "to_two": other}, "leader-not-followed")
                for follower, other in (
                    (Follower("to_tow"), Follower("to_one")),
                    (Follower("to_two"), Follower("to_one")),
                    (Follower("to_two", math.nan), Follower("to_one")),
                )
            ),
        ],
    )
    def test_what_is_no_mechanism(self, joints: list[Joint], followers: dict[str, Follower], code: str) -> None:
        with pytest.raises(InputError) as caught:
            reasons([ball("base"), ball("one"), ball("two")], joints, followers=followers)
        assert caught.value.problems[0].code == code

    def test_a_mesh_that_is_none(self) -> None:
        link = Link(name="one", collisions=(Collision(geometry=Mesh(filename="part.stl")),))
        with pytest.raises(InputError) as caught:
            reasons([ball("base"), link], [hold("one")])
        assert caught.value.problems[0].code == "collision-mesh-unreadable"


@pytest.mark.parametrize("table", ["ur5.csv", "panda.yaml", "scara.csv"])
def test_no_pair_of_never_touches_in_other_states(table: str) -> None:
    """MuJoCo measures the distances at states of another seed: pairs of Never keep apart, and others do touch."""
    mujoco = pytest.importorskip("mujoco")
    manipulator = next(iter(dh2urdf.read_all(TABLES / table)))
    robot = alpha_swap(manipulator, AlphaSwapOptions())
    found = robot_pairs(robot, PairOptions())
    assert robot_pairs(robot, PairOptions()) == found
    (file,) = mjcf.EMITTER.emit(robot, "arm", mjcf.MjcfOptions(actuators="none"))
    model = mujoco.MjModel.from_xml_string(file.content.decode())
    data = mujoco.MjData(model)
    solid = {}
    for geom in range(model.ngeom):
        if model.geom_group[geom] == 3:
            solid.setdefault(model.body(model.geom_bodyid[geom]).name, []).append(geom)
    assert set(found.links) == set(solid)
    random, nearest = Random(20261123), {}  # noqa: S311 - states, no secrets
    joints = [
        (robot.moving_joints[place], model.joint(joint.name).qposadr[0])
        for place, joint in enumerate(robot.moving_joints)
    ]
    names = sorted(solid)
    for _ in range(1500):
        for joint, place in joints:
            lower, upper = joint.limits.lower, joint.limits.upper
            data.qpos[place] = random.uniform(-math.pi if lower is None else lower, math.pi if upper is None else upper)
        mujoco.mj_kinematics(model, data)
        for one in names:
            for other in names:
                if one < other:
                    distance = min(
                        mujoco.mj_geomDistance(model, data, first, second, 1.0, None)
                        for first in solid[one]
                        for second in solid[other]
                    )
                    nearest[one, other] = min(distance, nearest.get((one, other), 1.0))
    never = {(pair.link1, pair.link2) for pair in found.disabled if pair.reason == "Never"}
    disabled = {(pair.link1, pair.link2) for pair in found.disabled}
    assert bool(never) is (table != "scara.csv")
    assert [pair for pair in never if nearest[pair] <= 0.0] == []
    # What is left to check comes near indeed, or the pairs would be useless.
    assert [pair for pair in nearest if pair not in disabled and nearest[pair] > 0.1] == []


def test_the_seed_decides_about_what_is_rare() -> None:
    """Another seed draws other states: a contact in one state of a thousand is found by some of them."""
    found = {
        between(-1.0, 1.0, 1.2 - 0.002, PairOptions(trials=300, seed=seed, min_distance=0.0)) for seed in range(12)
    }
    assert found == {"Never", None}
