import math
from statistics import NormalDist

import pytest
from hypothesis import assume, given, strategies as st

from dh2urdf.variations.laws import Choices, LogUniform, Normal, Offset, Scale, Uniform, evenly_spaced

NUMBERS = st.floats(-1e6, 1e6)
UNIT = st.floats(2.0**-53, 1 - 2.0**-53)
STANDARD = NormalDist()


@given(NUMBERS, NUMBERS, UNIT, NUMBERS)
def test_a_range_is_kept(one: float, other: float, u: float, nominal: float) -> None:
    """Nothing is drawn outside of a range: rounding included."""
    low, high = sorted((one, other))
    assert low <= Uniform(low=low, high=high).draw(u) <= high
    ends = sorted((nominal * low, nominal * high))
    assert ends[0] <= Scale(low=low, high=high).draw(u, nominal) <= ends[1]
    assert nominal + low <= Offset(low=low, high=high).draw(u, nominal) <= nominal + high


@given(st.floats(1e-300, 1e300), st.floats(1e-300, 1e300), UNIT)
def test_a_logarithmic_range_is_kept(one: float, other: float, u: float) -> None:
    """And the logarithm of what is drawn is uniform."""
    low, high = sorted((one, other))
    found = LogUniform(low=low, high=high).draw(u)
    assert low <= found <= high
    expected = math.log(low) + u * (math.log(high) - math.log(low))
    assert math.log(found) == pytest.approx(expected, abs=1e-12, rel=1e-12)


@given(NUMBERS, st.floats(1e-3, 1e3), st.floats(-8, 8), st.floats(1e-3, 8), UNIT)
def test_the_bounds_of_a_normal_distribution_are_kept(
    mean: float, deviation: float, start: float, width: float, u: float
) -> None:
    """Also far from the mean, and of the distribution cut there u lies below what is drawn."""
    low = mean + start * deviation
    high = mean + min(start + width, 9.0) * deviation
    assume(low < high)
    law = Normal(mean=mean, deviation=deviation, low=low, high=high)
    found = law.draw(u)
    assert low <= found <= high
    assume(law.probability() > 1e-3)
    z_low, z_high, z = ((x - mean) / deviation for x in (low, high, found))
    share = (STANDARD.cdf(z) - STANDARD.cdf(z_low)) / (STANDARD.cdf(z_high) - STANDARD.cdf(z_low))
    assert share == pytest.approx(u, abs=1e-6)


def test_a_normal_distribution_is_about_the_nominal_value_by_default() -> None:
    """Its median is the nominal value where the bounds lie about it alike."""
    law = Normal(mean=None, deviation=0.1, low=0.2, high=0.6)
    assert law.draw(0.5, 0.4) == pytest.approx(0.4, abs=1e-15)
    assert law.probability(0.4) == pytest.approx(0.9545, abs=1e-4)


@given(st.integers(1, 20), UNIT)
def test_choices_are_equally_likely(count: int, u: float) -> None:
    """Each has an equal part of the numbers between 0 and 1."""
    assert Choices(values=tuple(map(float, range(count)))).draw(u) == math.floor(u * count)


def test_even_spaces_end_where_they_should() -> None:
    """Both ends are exact."""
    assert evenly_spaced(0.1, 0.7, 4) == pytest.approx((0.1, 0.3, 0.5, 0.7), abs=1e-15)
    assert evenly_spaced(0.1, 0.7, 4)[-1] == 0.7
    assert evenly_spaced(-1.0, 1.0, 2) == (-1.0, 1.0)
