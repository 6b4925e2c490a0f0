"""One robot is the oracle of many: whatever is made side by side is what `alpha_swap` and `emit` make by themselves."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from random import Random
from typing import Any
from unittest import mock

import pytest
from any_tables import manipulators
from hypothesis import HealthCheck, given, settings, strategies as st

from dh2urdf.columns import in_columns
from dh2urdf.fields import replace_unchecked
from dh2urdf.manipulator import Inertia, Limits, LinkGeometry, Manipulator
from dh2urdf.robot import Robot
from dh2urdf.rotations import HALF_PI
from dh2urdf.stages import EmitsInColumns, TransformsInColumns
from dh2urdf_plugins.formats.urdf import EMITTER, UrdfOptions
from dh2urdf_plugins.transforms import exact as transform_module
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM, AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap

FRAMES = st.sampled_from(["aligned", "dh"])
SHAPES = ["cylinder", "box", "capsule", "arm"]
QUARTERS = [quarters * HALF_PI for quarters in (0, 1, -1, 2, -2, 3)]


def _lengths(r: Random, count: int, *, least: float = -0.8) -> list[float]:
    """A column of lengths as tables have them: all alike, all different, or nothing for some."""
    one = round(r.uniform(least, 0.8), r.choice([1, 3, 17]))
    match r.choice(["nothing", "alike", "different", "different", "nothing for some", "short for some"]):
        case "nothing":
            return [0.0] * count
        case "alike":
            return [one] * count
        case "nothing for some":
            return [r.choice([0.0, -0.0, one]) for _ in range(count)]
        case "short for some":
            return [one * 10.0 ** r.choice([0, 0, -1, -2, -4, -6]) for _ in range(count)]
    return [r.uniform(least, 0.8) for _ in range(count)]


def _angles(r: Random, count: int) -> list[float]:
    """A column of angles: quarter turns, or anything."""
    one = r.choice([0.0, 0.0, *QUARTERS, 0.3])
    match r.choice(["alike", "alike", "quarter turns", "any", "quarter turns for some"]):
        case "alike":
            return [one] * count
        case "quarter turns":
            return [r.choice(QUARTERS) for _ in range(count)]
        case "any":
            return [r.uniform(-7.0, 7.0) for _ in range(count)]
    return [r.choice([one, r.uniform(-3.0, 3.0)]) for _ in range(count)]


FIELDS: dict[str, Any] = {
    "mass": 2.0,
    "com": (0.1, -0.2, 0.0),
    "inertia": Inertia(ixx=1.2, iyy=1.3, izz=1.4, ixy=0.1, ixz=-0.05),
    "radius": 0.03,
    "damping": 0.5,
    "limits": Limits(lower=-0.4, upper=1.1, velocity=2.0, effort=50.0),
}
"""What a row may say besides its geometry; in each table it is as many times as large."""
TABLES: dict[str, Any] = {
    "geometry": LinkGeometry(shape="box", radius=0.03),
    "base_geometry": LinkGeometry(radius=0.03),
    "density": 1000.0,
    "base_mass": 4.0,
}


@st.composite
def families(draw: st.DrawFn, with_numbers: Callable[..., Any], largest: int = 16) -> list[Manipulator]:
    """Manipulators that differ in numbers only."""
    table, count = draw(manipulators(most=4)), draw(st.integers(1, largest))
    r = Random(draw(st.integers(0, 2**32)))  # noqa: S311 - repeatable
    columns = []
    for row in table.rows:
        said = {name: value for name, value in FIELDS.items() if r.random() < 0.4}
        shares = [r.uniform(0.5, 2.0) if r.random() < 0.7 else 1.0 for _ in range(count)]
        places = zip(*(_lengths(r, count) for _ in "ad"), *(_angles(r, count) for _ in "αθ"), strict=True)
        columns.append(
            [
                replace(
                    row,
                    **dict(zip(("a", "d", "alpha", "theta"), place, strict=True)),
                    **{name: with_numbers(value, lambda x, s=share: s * x) for name, value in said.items()},
                )
                for place, share in zip(places, shares, strict=True)
            ]
        )
    common = {name: value for name, value in TABLES.items() if r.random() < 0.3}
    return [replace(table, name=f"arm_{k}", rows=rows, **common) for k, rows in enumerate(zip(*columns, strict=True))]


@st.composite
def options(draw: st.DrawFn) -> AlphaSwapOptions:
    return AlphaSwapOptions(
        frames=draw(FRAMES),
        shape=draw(st.sampled_from(SHAPES)),  # type: ignore[arg-type]
        radius=draw(st.sampled_from([None, None, 0.05])),
        base_collision=draw(st.booleans()),
    )


def made(tables: Sequence[Manipulator], how: AlphaSwapOptions) -> dict[int, tuple[Robot, bytes]]:
    """Robot and file of those tables that are made side by side, by their places."""
    found = {}
    for places, group in in_columns(tables):
        for members, robots in TRANSFORM.can(TransformsInColumns).transform_columns(group, how) or ():
            files = EMITTER.can(EmitsInColumns).emit_columns(
                robots, [name.upper() for name in robots.names], UrdfOptions()
            )
            for index, (member, own) in enumerate(zip(members, files, strict=True)):
                assert bool(own) is bool(robots.sure[index])
                if own:
                    table = tables[places[member]]
                    assert [file.name for file in own] == [f"{table.name.upper()}.urdf"]
                    assert robots.names[index] == table.name
                    found[places[member]] = robots.pick(index), own[0].content
    return found


def alone(table: Manipulator, how: AlphaSwapOptions) -> tuple[Robot, bytes]:
    robot = alpha_swap(table, how)
    return robot, EMITTER.emit(robot, "any", UrdfOptions())[0].content


class TestWhatIsMadeSideBySide:
    @pytest.mark.long
    @settings(max_examples=250, suppress_health_check=[HealthCheck.function_scoped_fixture])
    @given(st.data(), options())
    def test_is_what_is_made_alone_byte_for_byte(
        self, with_numbers: Callable[..., Any], data: st.DataObject, how: AlphaSwapOptions
    ) -> None:
        """The robots are the same, and so is every byte of their files, whatever some of them lack."""
        tables = data.draw(families(with_numbers))
        with mock.patch.object(transform_module, "FEWEST", 1):
            for place, (robot, content) in made(tables, how).items():
                expected, bytes_alone = alone(tables[place], how)
                assert content == bytes_alone
                assert robot == expected
                assert robot.comment == expected.comment

    def test_reference_robots_too(self, reference_robots: Sequence[Any]) -> None:
        """Published tables beside scaled ones give their robots and files."""
        how = AlphaSwapOptions()
        for reference in reference_robots:
            nominal = reference.manipulator
            scaled = [
                replace(
                    nominal,
                    name=f"arm_{k}",
                    rows=tuple(replace(row, a=row.a * (1 + 0.1 * k), d=row.d * (1 + 0.1 * k)) for row in nominal.rows),
                )
                for k in range(10)
            ]
            for place, own in made(scaled, how).items():
                assert own == alone(scaled[place], how)


class TestWhatIsSure:
    @pytest.mark.parametrize(
        "fault",
        [
            {"a": math.nan},
            {"theta": 1.5708},
            {"mass": 0.0},
            {"radius": 0.0},
            {"damping": -1.0},
            {"limits": Limits(lower=1.0, upper=-1.0, velocity=1.0, effort=1.0)},
            {"limits": Limits(lower=-1.0, upper=1.0, velocity=0.0, effort=1.0)},
            {"inertia": Inertia(ixx=1.0, iyy=1.0, izz=3.0)},
        ],
        ids=str,
    )
    def test_is_not_spoilt_by_a_neighbour(self, table: Callable[..., Manipulator], fault: dict[str, Any]) -> None:
        """One bad table of many costs itself."""
        given_numbers = {
            "mass": 1.0,
            "radius": 0.03,
            "damping": 0.1,
            "limits": Limits(lower=-1.0, upper=1.0, velocity=1.0, effort=1.0),
            "inertia": Inertia(ixx=1.0, iyy=1.0, izz=1.0),
        }
        good = [replace(table({"a": 0.3 + 0.01 * k, **given_numbers}), name=f"arm_{k}") for k in range(9)]
        bad = replace_unchecked(good[4], name="bad", rows=(replace_unchecked(good[4].rows[0], **fault),))
        tables = [*good, bad]
        assert len(in_columns(tables)) == 1
        assert sorted(made(tables, AlphaSwapOptions())) == list(range(9))

    @pytest.mark.parametrize("frames", ["aligned", "dh"])
    @pytest.mark.parametrize("convention", ["standard", "modified"])
    @pytest.mark.parametrize("types", [("revolute",) * 6, ("prismatic", "revolute", "fixed", "continuous")], ids=str)
    def test_are_ordinary_robots(
        self, table: Callable[..., Manipulator], frames: Any, convention: str, types: tuple[str, ...]
    ) -> None:
        """A hundred arms of random lengths are all made side by side, whatever their joints."""
        r = Random(7)  # noqa: S311 - repeatable
        tables = []
        for k in range(100):
            rows = [
                {"type": name, "a": r.uniform(0.1, 0.5), "alpha": QUARTERS[number % 3], "d": r.uniform(0.1, 0.3)}
                for number, name in enumerate(types)
            ]
            tables.append(replace(table(*rows, convention=convention), name=f"arm_{k}"))
        assert sorted(made(tables, AlphaSwapOptions(frames=frames))) == list(range(100))

    def test_may_lack_a_segment(self, table: Callable[..., Manipulator]) -> None:
        """Arms that are drawn differently are made in as many groups, each at once."""
        tables = [replace(table({"a": 0.0 if k % 3 else 0.2, "d": 0.1 + k}), name=f"arm_{k}") for k in range(60)]
        ((_, group),) = in_columns(tables)
        groups = TRANSFORM.can(TransformsInColumns).transform_columns(group, AlphaSwapOptions())
        assert groups is not None
        assert sorted(len(places) for places, _ in groups) == [20, 40]
        assert sorted(made(tables, AlphaSwapOptions())) == list(range(60))
