"""Angles that were rounded or cut from parts of π are known, and other numbers are not."""

import math

import pytest

from dh2urdf_plugins.descriptions.description import part_of_pi


class TestRoundedPi:
    @pytest.mark.parametrize(
        ("text", "word"),
        [
            *[("1.5708", "pi/2"), ("-1.571", "-pi/2"), ("1.570796327", "pi/2"), ("3.14159", "pi")],
            *[("3.1415", "pi"), ("0.785", "pi/4"), ("2.356194", "3*pi/4"), ("-3.142", "-pi"), ("4.712388", "6*pi/4")],
        ],
    )
    def test_rounded_and_cut_ones_are_known(self, text: str, word: str) -> None:
        found = part_of_pi(text)
        assert found is not None
        value, said = found
        assert said == word
        assert value == pytest.approx(float(text), abs=1e-3)
        assert value * 4 / math.pi == pytest.approx(round(value * 4 / math.pi), abs=1e-15)

    @pytest.mark.parametrize("text", ["1.57", "3.14", "1.5709", "1.5", "0", "0.000", "1.570796326794896", "pi", "nan"])
    def test_other_numbers_are_not(self, text: str) -> None:
        assert part_of_pi(text) is None
