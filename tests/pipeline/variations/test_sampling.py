import warnings
from collections import Counter

import pytest
from hypothesis import given, strategies as st

from dh2urdf.variations.sampling import MOST_POINTS, Sampling, permuted, points as points_of, regrouped


def point(sampling: Sampling, *, seed: int, count: int, index: int, dimensions: int) -> list[float]:
    found = points_of(sampling, seed=seed, count=count, indices=[index], dimensions=dimensions)
    return [float(x) for (x,) in found]


def points(sampling: Sampling, count: int, dimensions: int, seed: int = 7) -> list[list[float]]:
    every = points_of(sampling, seed=seed, count=count, indices=range(count), dimensions=dimensions)
    return [list(map(float, x)) for x in every.T]


SEEDS = st.integers(0, 2**64 - 1)


@given(st.sampled_from(Sampling), SEEDS, st.integers(1, MOST_POINTS), st.data())
def test_coordinates_are_above_0_and_below_1(sampling: Sampling, seed: int, count: int, data: st.DataObject) -> None:
    """Of every kind of sampling, for the first and the last of a billion points."""
    count = min(count, 2**16) if sampling is Sampling.SOBOL else count  # The first point of a long one takes a while.
    index = data.draw(st.integers(0, count - 1) | st.just(count - 1))
    found = point(sampling, seed=seed, count=count, index=index, dimensions=5)
    assert len(found) == 5
    assert all(0.0 < x < 1.0 for x in found)


@pytest.mark.parametrize("sampling", Sampling)
def test_every_point_is_made_by_itself(sampling: Sampling) -> None:
    """In any order, and again: nothing is remembered of other points that could change one."""
    forwards = points(sampling, 50, 12)
    backwards = [point(sampling, seed=7, count=50, index=i, dimensions=12) for i in reversed(range(50))]
    assert forwards == backwards[::-1]
    assert points(sampling, 50, 12, seed=8) != forwards


def test_the_points_are_known() -> None:
    """They are the same on every machine and in every version: these were computed once."""
    known = {
        sampling: [round(x, 12) for x in point(sampling, seed=7, count=1000, index=41, dimensions=3)]
        for sampling in Sampling
    }
    assert known == KNOWN


KNOWN = {
    Sampling.RANDOM: [0.202657213971, 0.440725636657, 0.238533904238],
    Sampling.LATIN_HYPERCUBE: [0.717202657214, 0.341440725637, 0.782238533904],
    Sampling.SOBOL: [0.802475677605, 0.573209306812, 0.573553573852],
}


def test_random_points_are_uniform() -> None:
    """A tenth of 5,000 points in each tenth of each of ten dimensions, within six standard deviations."""
    found = points(Sampling.RANDOM, 5000, 10)
    for dimension in range(10):
        counts = Counter(int(x[dimension] * 10) for x in found)
        assert all(abs(counts[tenth] - 500) < 6 * (5000 * 0.1 * 0.9) ** 0.5 for tenth in range(10))
    for left, right in ((0, 1), (3, 8)):  # independent: a quarter of the points where both are in their upper half
        both = sum(x[left] > 0.5 and x[right] > 0.5 for x in found)
        assert abs(both - 1250) < 6 * (5000 * 0.25 * 0.75) ** 0.5


@given(st.integers(1, 300), SEEDS)
def test_a_latin_hypercube_has_one_point_in_every_stratum(count: int, seed: int) -> None:
    """In each dimension."""
    found = points(Sampling.LATIN_HYPERCUBE, count, 3, seed)
    for dimension in range(3):
        assert sorted(int(x[dimension] * count) for x in found) == list(range(count))


def test_the_dimensions_of_a_latin_hypercube_are_independent() -> None:
    """Its permutations differ: the correlation of two dimensions is that of chance."""
    np = pytest.importorskip("numpy")
    correlation = np.corrcoef(np.array(points(Sampling.LATIN_HYPERCUBE, 2000, 6)).T)
    assert np.abs(correlation - np.eye(6)).max() < 6 / 2000**0.5


@given(st.integers(1, 500), st.text())
def test_a_permutation_has_every_place_once(count: int, key: str) -> None:
    """Whatever the number and the key."""
    assert sorted(permuted(index, count, key) for index in range(count)) == list(range(count))


@pytest.mark.parametrize(("dimensions", "count"), [(1, 64), (7, 100), (40, 257)])
def test_sobol_points_are_scipys_shifted(dimensions: int, count: int) -> None:
    """Each differs from scipy's of the same index by one and the same pattern of bits in each dimension."""
    np = pytest.importorskip("numpy")
    qmc = pytest.importorskip("scipy.stats.qmc")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that a count which is no power of 2 spreads less evenly
        expected = qmc.Sobol(dimensions, scramble=False).random(count)
    scale = 2.0**52
    found = (np.array(points(Sampling.SOBOL, count, dimensions)) * scale).astype(np.int64)
    shifts = found ^ (expected * scale).astype(np.int64)
    assert (shifts == shifts[0]).all()
    assert len(set(shifts[0].tolist())) == dimensions


@given(st.integers(1, 300), st.integers(1, 40), SEEDS)
def test_every_point_is_in_one_group(count: int, groups: int, seed: int) -> None:
    """Those of a group follow each other, and together they are all."""
    found = [regrouped(index, groups, count, seed) for index in range(count)]
    assert sorted(found) == list(range(count))
    for group in range(min(groups, count)):
        own = found[group::groups]
        assert own == list(range(own[0], own[0] + len(own)))
