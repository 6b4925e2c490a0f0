from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import ManipulatorError
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.source import Mark
from dh2urdf.variations.binding import bind
from dh2urdf.variations.laws import Choices, Law, Normal, Scale, Uniform
from dh2urdf.variations.variation import Rule, Variation, VariationCall, variant_columns

if TYPE_CHECKING:
    from dh2urdf.columns import ManipulatorColumns

ARM = Manipulator(
    name="arm",
    convention=Convention.MODIFIED,
    rows=(
        DHRow(
            joint="turn",
            link="one",
            a=0.5,
            alpha=0.1,
            d=0.2,
            limits=Limits(lower=-1.0, upper=1.0),
            mass=2.0,
            inertia=Inertia(ixx=0.1, iyy=0.2, izz=0.25),
            mark=Mark(file="arm.csv", line=2),
        ),
        DHRow(
            joint="slide",
            link="two",
            type=JointType.PRISMATIC,
            a=0.0,
            alpha=math.pi / 2,
            d=0.1,
            offset=0.3,
            limits=Limits(lower=0.0, upper=0.4),
            mark=Mark(file="arm.csv", line=4),
        ),
    ),
    mark=Mark(file="arm.csv", line=2),
)


def variation(*rules: tuple[str, Law], count: int = 50) -> Variation:
    vary = tuple(Rule(field=field, law=law) for field, law in rules)
    return bind(VariationCall(name="v", of="arm", vary=vary, count=count, seed=3), ARM)


def columns_of(some: Variation) -> tuple[list[int], ManipulatorColumns] | None:
    return variant_columns(some, some.variants().names, some.drawn(range(1, some.count + 1)))


@pytest.mark.parametrize(
    "rules",
    [
        (("a", Uniform(low=0.1, high=0.9)), ("alpha", Choices(values=(0.0, 0.5, math.pi)))),
        (
            ("mass", Uniform(low=1.0, high=5.0)),
            ("radius", Uniform(low=0.01, high=0.02)),
            ("a", Scale(low=1.0, high=2.0)),
        ),
        (
            ("lower", Uniform(low=-2.0, high=0.3)),
            ("upper", Uniform(low=0.0, high=2.0)),
            ("d", Normal(mean=None, deviation=0.1, low=-1.0, high=1.0)),
        ),
        (
            ("damping", Uniform(low=-1.0, high=2.0)),
            ("friction", Uniform(low=0.0, high=2.0)),
            ("armature", Uniform(low=0.0, high=1.0)),
        ),
        (("offset", Uniform(low=-1.0, high=1.0)), ("velocity", Uniform(low=-1.0, high=3.0))),
    ],
    ids=lambda rules: " ".join(field for field, _ in rules),
)
def test_they_are_the_tables_of_the_variants(rules: tuple[tuple[str, Law], ...]) -> None:
    """Every table is the variant's own, to the last bit, with its marks and notices; impossible ones are left out."""
    some = variation(*rules)
    found = columns_of(some)
    assert found
    places, columns = found
    assert places
    for place, values in enumerate(some.drawn(range(1, 51))):
        try:
            table = some.manipulator(place + 1, values)
        except ManipulatorError:
            assert place not in places
            continue
        picked = columns.pick(places.index(place))
        assert picked == table
        assert picked.notices == table.notices
        assert [row.mark for row in picked.rows] == [row.mark for row in table.rows]


def test_where_no_variant_is_an_arm_there_are_no_columns() -> None:
    """All fail alone, each for its own values."""
    found = columns_of(variation(("lower", Uniform(low=2.0, high=3.0))))
    assert found
    assert (found[0], len(found[1])) == ([], 0)


def test_drawn_types_differ_in_more_than_numbers() -> None:
    """Where types or numbers of axes are drawn there are no columns of all."""
    assert columns_of(variation(("type", Choices(values=("revolute", "prismatic"))))) is None
