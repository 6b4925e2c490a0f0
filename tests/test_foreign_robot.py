"""Joints that follow others."""

from math import inf, nan

import pytest
from numpy.polynomial.polynomial import polyval

from dh2urdf.robot import Follower, following, with_followers


def test_a_chain_of_followers_in_any_order() -> None:
    followers = {"c": Follower("b", -1.0, 0.5), "b": Follower("a", 2.0), "d": Follower("a")}
    assert following(followers, ["d", "c", "b", "a"]) == followers
    found = with_followers({"a": 0.25, "b": 9.0}, followers)
    assert found == {"a": 0.25, "b": 0.5, "c": 0.0, "d": 0.25}


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
    ],
)
def test_what_cannot_follow_moves_by_itself(followers: dict[str, Follower]) -> None:
    assert following(followers, ["a", "b", "c"]) == {}


@pytest.mark.parametrize("x", [0.0, 1.5, -0.75])
def test_a_joint_follows_by_a_polynomial(x: float) -> None:
    follower = Follower("a", -2.0, 0.25, (0.5, -0.125, 2.0))
    assert follower.value(x) == pytest.approx(polyval(x, (0.25, -2.0, 0.5, -0.125, 2.0)), abs=1e-15)
    assert follower.rate(x) == pytest.approx((follower.value(x + 1e-6) - follower.value(x - 1e-6)) / 2e-6, abs=1e-8)
    assert Follower("a", -2.0).rate(x) == -2.0
    assert not follower._replace(higher=(0.5, nan)).is_finite


def test_a_joint_without_a_leader_that_keeps_one_value() -> None:
    """And one that follows it."""
    followers = {"b": Follower("", 0.0, 0.4), "c": Follower("b", 2.0)}
    assert following(followers, ["a", "b", "c"]) == followers
    assert with_followers({"a": 1.0, "b": 7.0}, followers) == {"a": 1.0, "b": 0.4, "c": 0.8}


def test_a_fixed_joint_follows_nothing_and_leads_nothing() -> None:
    assert following({"b": Follower("a"), "a": Follower("c")}, ["b", "c"]) == {}


def test_an_orientation_is_passed_on() -> None:
    assert with_followers({"a": (0.0, 0.0, 0.0, 1.0)}, {"b": Follower("a", 2.0)})["b"] == (0.0, 0.0, 0.0, 1.0)
