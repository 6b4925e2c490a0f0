"""Joints that follow others."""

from dataclasses import replace
from math import inf, nan

import pytest
from numpy.polynomial import Polynomial

from dh2urdf.manipulator import JointType
from dh2urdf.robot import Follower, Joint, followers_of, with_followers


def able(followers: dict[str, Follower], names: str = "abcd") -> dict[str, Follower]:
    """The laws of joints of these names that follow."""
    joints = [Joint(name=each, type=JointType.REVOLUTE, parent="p", child=each) for each in names]
    return followers_of(replace(joint, follows=followers.get(joint.name)) for joint in joints)


@pytest.mark.parametrize("names", ["abcd", "dcba"])
def test_a_chain_of_followers_is_multiplied_out_in_any_order(names: str) -> None:
    followers = {"c": Follower("b", -1.0, 0.5), "b": Follower("a", 2.0, 0.25), "d": Follower("a")}
    whole = able(followers, names)
    assert whole == {"b": Follower("a", 2.0, 0.25), "c": Follower("a", -2.0, 0.25), "d": Follower("a")}
    assert list(whole) == sorted(whole, key=names.index)
    assert with_followers({"a": 0.25, "b": 9.0}, whole) == {"a": 0.25, "b": 0.75, "c": -0.25, "d": 0.25}


@pytest.mark.parametrize(
    ("own", "leader"), [((0.5, -2.0), (0.1, 1.0, 0.25, -3.0)), ((0.5, 1.0, -2.0), (1.5, 0.5, 0.75))]
)
def test_powers_are_multiplied_out(own: tuple[float, ...], leader: tuple[float, ...]) -> None:
    """Held against numpy's polynomials."""
    b, c = (Follower(name, law[1], law[0], law[2:]) for name, law in (("a", leader), ("b", own)))
    wanted = Polynomial(own)(Polynomial(leader))
    assert able({"b": b, "c": c})["c"].factors == pytest.approx(wanted.coef, abs=1e-14)


@pytest.mark.parametrize(
    "followers",
    [
        {"b": Follower("c"), "c": Follower("b")},
        {"b": Follower("b")},
        {"b": Follower("gone")},
        {"b": Follower("")},
        {"b": Follower("a", nan)},
        {"b": Follower("a", 1.0, inf)},
        {"b": Follower("c"), "c": Follower("gone")},
        {"b": Follower("", 0.0, 0.4, (1.0,))},
        {"b": Follower("a", 1.0, 0.0, (0.0, 0.0, 0.0, 1.0))},
    ],
)
def test_what_cannot_follow_moves_by_itself(followers: dict[str, Follower]) -> None:
    assert able(followers) == {}


def test_a_law_beyond_the_fourth_power_leads_nowhere() -> None:
    cubic = Follower("a", 1.0, 0.0, (0.0, 1.0))
    assert able({"b": cubic, "c": cubic._replace(leader="b")}) == {"b": cubic}


@pytest.mark.parametrize("x", [0.0, 1.5, -0.75])
def test_a_joint_follows_by_a_polynomial(x: float) -> None:
    follower = Follower("a", -2.0, 0.25, (0.5, -0.125, 2.0))
    assert follower.value(x) == pytest.approx(Polynomial((0.25, -2.0, 0.5, -0.125, 2.0))(x), abs=1e-15)
    assert follower.rate(x) == pytest.approx((follower.value(x + 1e-6) - follower.value(x - 1e-6)) / 2e-6, abs=1e-8)
    assert Follower("a", -2.0).rate(x) == -2.0
    assert not follower._replace(higher=(0.5, nan)).is_sound


def test_a_joint_without_a_leader_that_keeps_one_value() -> None:
    """And one that follows it."""
    whole = able({"b": Follower("", 0.0, 0.4), "c": Follower("b", 2.0)})
    assert with_followers({"a": 1.0, "b": 7.0}, whole) == {"a": 1.0, "b": 0.4, "c": 0.8}


def test_a_fixed_joint_follows_nothing_and_leads_nothing() -> None:
    assert able({"b": Follower("a"), "a": Follower("c")}, "bc") == {}


def test_an_orientation_is_passed_on() -> None:
    assert with_followers({"a": (0.0, 0.0, 0.0, 1.0)}, {"b": Follower("a", 2.0)})["b"] == (0.0, 0.0, 0.0, 1.0)
