import pickle
from dataclasses import replace
from random import Random
from typing import Any

from hypothesis import given, strategies as st

from dh2urdf.columns import columns_of, in_columns
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, LinkGeometry, Manipulator
from dh2urdf.rotations import RigidTransform
from dh2urdf.source import Mark

NUMBERS = st.one_of(st.sampled_from([0.0, 0.5, 1, -2]), st.floats(allow_nan=False, allow_infinity=False))


def row(number: int = 1, **more: Any) -> DHRow:
    known: dict[str, Any] = {"joint": f"joint_{number}", "link": f"link_{number}", "a": 0.0, "alpha": 0.0, "d": 0.0}
    return DHRow(**(known | more))


def table(*rows: DHRow, name: str = "arm", **more: Any) -> Manipulator:
    return Manipulator(**({"name": name, "convention": Convention.STANDARD, "rows": rows or (row(),)} | more))


@st.composite
def tables(draw: st.DrawFn) -> Manipulator:
    """Manipulators of few structures and any numbers, so that some differ in numbers only."""

    def maybe(value: Any) -> Any:
        return value if draw(st.booleans()) else None

    rows = []
    for number in range(1, draw(st.integers(1, 2)) + 1):
        a, b, c, d = (draw(NUMBERS) for _ in range(4))
        rows.append(
            row(
                number,
                type=draw(st.sampled_from([JointType.REVOLUTE, JointType.PRISMATIC])),
                a=a,
                alpha=b,
                sign=draw(st.sampled_from([1, -1])),
                limits=maybe(Limits(lower=min(c, d), upper=max(c, d))) or Limits(),
                mass=maybe(a),
                com=maybe((a, b, 0.0)),
                inertia=maybe(Inertia(ixx=a, iyy=b, izz=c, iyz=d)),
                friction=maybe(d),
            )
        )
    more: dict[str, Any] = {
        "base": RigidTransform.from_xyz_rpy((0.0, 0.0, draw(st.sampled_from([0.0, 1.0])))),
        "geometry": LinkGeometry(shape=draw(st.sampled_from([None, "box"]))),
        "mark": Mark(file="arms.csv", line=draw(st.integers(1, 99))),
    }
    return table(*rows, name=draw(st.text(min_size=1, max_size=3).filter(str.strip)), **more)


class TestManipulatorsInColumns:
    @given(st.lists(tables(), max_size=12))
    def test_are_what_they_were(self, given_tables: list[Manipulator]) -> None:
        """Every one of them is in one group, as it was, its place in the file included."""
        groups = in_columns(given_tables)
        assert sorted(place for places, _ in groups for place in places) == list(range(len(given_tables)))
        for places, columns in groups:
            assert len(columns) == len(places)
            for index, place in enumerate(places):
                assert columns.pick(index) == given_tables[place]
                assert columns.pick(index).mark == given_tables[place].mark

    @given(st.lists(tables(), min_size=1, max_size=6), st.data())
    def test_travel_to_another_process(self, given_tables: list[Manipulator], data: st.DataObject) -> None:
        """What a worker gets is what was sent, whether places are lines alone, more than that, or missing."""
        ((_, columns), *_) = in_columns(given_tables)
        marks = st.sampled_from([None, Mark(file="b.csv", line=3, column=4), Mark(file="c.parquet", place="row 7")])
        places = st.sampled_from([None, 12, (12, None, None), (3, 4, "B3")])
        count, rows = len(columns), len(columns.table.rows)
        lines = data.draw(st.lists(st.tuples(*[places] * rows), min_size=count, max_size=count))
        sent = replace(columns, lines=tuple(lines))
        if data.draw(st.booleans()):
            sent = replace(sent, marks=tuple(data.draw(st.lists(marks, min_size=count, max_size=count))))
        got = pickle.loads(pickle.dumps(sent))  # noqa: S301 - our own columns
        assert (got.names, got.marks, got.lines, got.tables()) == (sent.names, sent.marks, sent.lines, sent.tables())
        assert [own.mark for own in got.tables()] == list(sent.marks)
        for table, mark, own in zip(got.tables(), sent.marks, lines, strict=True):
            for row, place in zip(table.rows, own, strict=True):
                line, column, name = (place, None, None) if isinstance(place, int) else place or (None, None, None)
                told = mark and place and Mark(file=mark.file, line=line, column=column, place=name)
                assert row.mark == (told or None)

    @given(st.lists(NUMBERS, min_size=1, max_size=9), st.randoms())
    def test_may_be_taken_in_any_order(self, numbers: list[float], random: Random) -> None:
        """Some of them are columns again, with a float wherever they are alike."""
        many = [table(row(a=number, mass=1.0), name=f"arm_{k}") for k, number in enumerate(numbers)]
        ((_, columns),) = in_columns(many)
        places = random.choices(range(len(many)), k=5)
        taken = columns.take(tuple(places))  # numpy takes a tuple for the indices of one entry
        assert [taken.pick(k) for k in range(5)] == [many[place] for place in places]
        assert bool(columns_of(taken)) is (len({numbers[place] for place in places}) > 1)
