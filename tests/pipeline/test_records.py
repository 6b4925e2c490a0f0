"""Whatever is put into a field of a record: the arm that was meant, or an error that names the field."""

import math
import typing
from dataclasses import fields, is_dataclass, replace
from datetime import timedelta
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from full_row import FULL_ROW, INERTIA

from dh2urdf import robot as robots
from dh2urdf.errors import RecordError, RecordTypeError, RecordValueError
from dh2urdf.manipulator import (
    Convention,
    DHRow,
    Inertia,
    JointType,
    Limits,
    LinkGeometry,
    Manipulator,
    MeshFile,
    MeshShape,
)
from dh2urdf.robot import Box, Cylinder, Inertial, Joint, Link, Origin, Robot
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf.source import Mark


class Measured:
    """A number of somebody else's library."""

    def __float__(self) -> float:
        return 0.25


class Counted:
    """A whole number of somebody else's library."""

    def __index__(self) -> int:
        return 2


class Unreadable:
    def __repr__(self) -> str:
        raise RuntimeError("no repr")


NUMBERS = [
    1,
    np.float32(0.1),
    np.longdouble(0.5),
    np.int64(1),
    np.array(0.3),
    np.array(Fraction(1, 3)),
    Fraction(1, 3),
    Decimal("0.1"),
    Measured(),
    Counted(),
]
"""Values that are one number without doubt."""

NO_NUMBERS = [
    "0.3",
    np.str_("0.3"),
    b"1",
    True,
    np.True_,
    np.array(True),
    1j,
    [0.3],
    {"m": 0.3},
    np.array([0.3], dtype=np.float32),
    np.array("0.3"),
    np.ma.masked,
    np.ma.masked_array(0.3, mask=True),
    np.timedelta64(1, "s"),
    timedelta(1),
    Decimal("snan"),
    10**400,
    Unreadable(),
]
"""Values that are none."""

NOT_FINITE = [math.nan, math.inf, -math.inf, np.float32("nan"), np.array(np.inf), Decimal("nan"), Decimal("inf")]


def label(value: object) -> str:
    try:
        written = repr(value).partition(" at 0x")[0]  # an address is another in every process
        return f"{type(value).__name__}-{written}"[:40]
    except RuntimeError:
        return "unreadable"


ROW = replace(FULL_ROW, sign=-1)
SLIDE = DHRow(joint="slide", link="carriage", type=JointType.PRISMATIC, a=0.1, alpha=-0.2, d=0.3, offset=0.02)
ARM = Manipulator(
    name="arm",
    convention=Convention.MODIFIED,
    rows=(ROW, SLIDE),
    base=RigidTransform.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)),
    tool=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.1)),
    geometry=LinkGeometry(shape="box", radius=0.03),
    density=1000.0,
    base_mass=4.0,
    base_geometry=LinkGeometry(shape="cylinder", radius=0.05),
    visuals=True,
    collisions=False,
)
MESH = MeshShape(file=MeshFile(path="/arm.stl", sha256="0" * 64), scale=(1.0, 2.0, 3.0))
JOINT = Joint(
    name="turn",
    type=JointType.REVOLUTE,
    parent="base",
    child="arm",
    origin=Origin(xyz=(0.0, 0.0, 1.0)),
    limits=Limits(lower=-1.0, upper=1.0, velocity=1.0, effort=1.0),
    damping=0.1,
    friction=0.1,
    armature=0.1,
)
RECORDS: list[Any] = [
    ARM,
    ROW,
    ROW.limits,
    INERTIA,
    ARM.geometry,
    MESH,
    MESH.file,
    JOINT,
    JOINT.origin,
    Box(size=(0.1, 0.2, 0.3)),
    Cylinder(radius=0.1, length=0.2),
    robots.Sphere(radius=0.1),
    robots.Mesh(filename="arm.stl", scale=(1.0, 1.0, 1.0)),
    robots.Material(name="red", rgba=(1.0, 0.0, 0.0, 1.0)),
    robots.Visual(geometry=Box(size=(0.1, 0.2, 0.3))),
    robots.Collision(geometry=Box(size=(0.1, 0.2, 0.3))),
    robots.Parameter(name="a_1", value=0.1, unit="m", joint="turn"),
    Inertial(mass=1.0, com=(0.0, 0.1, 0.2), inertia=INERTIA),
    Link(name="arm", inertial=Inertial(mass=1.0, inertia=INERTIA)),
    Robot(name="robot", links=(Link(name="base"), Link(name="arm")), joints=(JOINT,)),
]


def of_type(*wanted: Any) -> list[Any]:
    """Every field of every record whose annotation is one of some types, None aside."""
    found = []
    for record in RECORDS:
        hints = typing.get_type_hints(type(record))
        for field in fields(record):
            hint = hints[field.name]
            bare = [part for part in typing.get_args(hint) if part is not type(None)] or [hint]
            if hint in wanted or (len(bare) == 1 and bare[0] in wanted):
                found.append(pytest.param(record, field.name, id=f"{type(record).__name__}.{field.name}"))
    assert found
    return found


def refused(record: Any, name: str, value: object) -> RecordError:
    """The error that a field's value is."""
    with pytest.raises(RecordError) as raised:
        replace(record, **{name: value})
    (problem,) = raised.value.problems
    assert problem.field is not None
    assert problem.field.startswith(name)
    assert problem.mark == Mark(file=f"{type(record).__name__}()")
    assert problem.accepted
    if isinstance(record, DHRow) and name != "joint":
        assert problem.joint == record.joint
    assert isinstance(raised.value, (TypeError, ValueError))
    return raised.value


VEC3 = typing.get_type_hints(Box)["size"]
EXACT = (Manipulator, DHRow, LinkGeometry, MeshShape)


class TestNumbers:
    @pytest.mark.parametrize("value", NUMBERS, ids=label)
    @pytest.mark.parametrize(("record", "name"), of_type(float))
    def test_one_number_of_any_type_is_the_float_that_it_is(self, record: Any, name: str, value: Any) -> None:
        """float32 keeps its value, Fraction and Decimal are rounded once, and the type is float."""
        made = getattr(replace(record, **{name: value}), name)
        assert type(made) is float
        assert made == float(value)

    @pytest.mark.parametrize("value", NO_NUMBERS, ids=label)
    @pytest.mark.parametrize(("record", "name"), of_type(float))
    def test_everything_else_is_refused(self, record: Any, name: str, value: Any) -> None:
        """Texts, truth values, moments, complex numbers, and arrays that hold several numbers or might."""
        refused(record, name, value)

    @pytest.mark.parametrize("value", NOT_FINITE, ids=label)
    @pytest.mark.parametrize(("record", "name"), of_type(float))
    def test_what_is_not_finite_is_refused_by_name(self, record: Any, name: str, value: Any) -> None:
        """By the records of a table; what a transform computes is left to the check of the finished robot."""
        if isinstance(record, EXACT):
            assert f"{float(value)} is not a finite number" in str(refused(record, name, value))
        else:
            assert not math.isfinite(getattr(replace(record, **{name: value}), name))

    @pytest.mark.parametrize("value", [np.array([0.3]), np.array([0.3, 0.4])], ids=label)
    @pytest.mark.parametrize(("record", "name"), of_type(float))
    def test_columns_are_refused_by_the_records_of_a_table(self, record: Any, name: str, value: Any) -> None:
        """A number for each of many arms, as `dh2urdf.columns` makes them, is none of one arm."""
        if isinstance(record, EXACT):
            refused(record, name, value)
        else:
            assert getattr(replace(record, **{name: value}), name) is value

    @pytest.mark.parametrize("value", [1, -1, 1.0, np.int8(-1), np.float32(1), Fraction(-1), Decimal(1)], ids=label)
    def test_a_direction_of_any_type_is_1_or_minus_1(self, value: Any) -> None:
        """The sign is an int."""
        made = replace(ROW, sign=value).sign
        assert (type(made), made) == (int, int(value))


class TestVectors:
    GIVEN: typing.ClassVar[list[Any]] = [
        [1, 2, 3],
        np.array([1, 2, 3]),
        np.array([1.0, 2.0, 3.0], dtype=np.float32),
        (Fraction(1), Decimal(2), np.int64(3)),
        range(1, 4),
    ]

    @pytest.mark.parametrize(("record", "name"), of_type(VEC3))
    def test_three_numbers_in_any_sequence(self, record: Any, name: str) -> None:
        """Lists, tuples, arrays, ranges: a tuple of floats."""
        for given in (*self.GIVEN, (number for number in (1, 2, 3))):
            made = getattr(replace(record, **{name: given}), name)
            assert made == (1.0, 2.0, 3.0)
            assert set(map(type, made)) == {float}

    @pytest.mark.parametrize(
        "value",
        [
            [1, 2],
            [],
            "1 2 3",
            1.0,
            {1, 2, 3},
            np.zeros((1, 3)),
            np.ma.masked_array([1.0, 2.0, 3.0], mask=[False, True, False]),
            ["1", "2", "3"],
            [1, 2, None],
            [1, True, 2],
        ],
        ids=label,
    )
    @pytest.mark.parametrize(("record", "name"), of_type(VEC3))
    def test_everything_else_is_refused(self, record: Any, name: str, value: Any) -> None:
        """What has no order, another length, or other things than numbers in it; the item is named."""
        error = refused(record, name, value)
        if isinstance(value, list) and len(value) == 3:
            assert str(error.problems[0].field).endswith("]")


class TestChoices:
    @pytest.mark.parametrize("word", ["prismatic", "Prismatic", " PRISMATIC ", np.str_("prismatic")], ids=label)
    def test_a_type_may_be_given_as_text(self, word: str) -> None:
        """The enum's value, in any case."""
        for record in (ROW, JOINT):
            assert replace(record, type=word).type is JointType.PRISMATIC
        assert replace(ARM, convention=" Standard").convention is Convention.STANDARD

    @pytest.mark.parametrize(
        ("record", "name", "value", "says"),
        [
            (ARM, "convention", "foo", "accepted: standard or modified, as text or as a dh2urdf.Convention"),
            (ARM, "convention", None, "NoneType"),
            (ROW, "type", "R", "is no JointType"),
            (JOINT, "type", 0, "int"),
        ],
    )
    def test_any_other_word_is_refused(self, record: Any, name: str, value: Any, says: str) -> None:
        """With the words that are accepted, and the one that was probably meant."""
        assert says in str(refused(record, name, value))


class TestNamesAndRecords:
    @pytest.mark.parametrize(("record", "name"), of_type(str))
    def test_names_are_text(self, record: Any, name: str) -> None:
        """numpy's text becomes Python's; bytes, numbers and None are refused."""
        made = getattr(replace(record, **{name: np.str_("box")}), name)
        assert (type(made), made) == (str, "box")
        optional = type(None) in typing.get_args(typing.get_type_hints(type(record))[name])
        for value in (b"box", 1, 0.5, ["box"], *(() if optional else (None,))):
            assert isinstance(refused(record, name, value), RecordTypeError)

    @pytest.mark.parametrize("name", ["joint", "link"])
    @pytest.mark.parametrize("value", ["", " ", "\t"])
    def test_a_row_has_names(self, name: str, value: str) -> None:
        """A name that is empty is none."""
        with pytest.raises(RecordValueError, match=f"the {name} has no name"):
            replace(ROW, **{name: value})  # type: ignore[arg-type]

    @pytest.mark.parametrize(
        ("record", "name"),
        [
            *(
                (record, field.name)
                for record in RECORDS
                for field in fields(record)
                if is_dataclass(getattr(record, field.name))
            )
        ],
        ids=lambda value: value if isinstance(value, str) else type(value).__name__,
    )
    def test_a_part_is_a_record(self, record: Any, name: str) -> None:
        """No mapping, no tuple, no text stands for one: their meaning would be a guess."""
        for value in ({"lower": 1}, (1.0, 2.0), "box", 1.0, ARM):
            assert isinstance(refused(record, name, value), RecordTypeError)

    def test_the_numbers_of_a_part_are_checked_with_the_row(self) -> None:
        """NaN in limits or in an inertia, and columns, which only this package makes."""
        for part, value in (
            ({"limits": Limits(lower=math.nan, upper=1.0)}, "limits.lower"),
            ({"limits": Limits(effort=math.inf)}, "limits.effort"),
            ({"limits": Limits(velocity=np.array([1.0, 2.0]))}, "limits.velocity"),  # type: ignore[arg-type]
            ({"inertia": Inertia(ixx=1.0, iyy=math.nan, izz=1.0)}, "inertia.iyy"),
        ):
            with pytest.raises(RecordError) as raised:
                replace(ROW, **part)  # type: ignore[arg-type]
            assert [problem.field for problem in raised.value.problems] == [value]


class TestRows:
    @pytest.mark.parametrize(
        ("rows", "says"), [((), "the table has no rows"), ("rows", "str"), ({"shoulder": ROW}, "dict")]
    )
    def test_what_is_no_rows_is_refused(self, rows: Any, says: str) -> None:
        """One row alone, none, twins."""
        assert says in str(refused(ARM, "rows", rows))

    @pytest.mark.parametrize(
        ("changes", "field"),
        [
            ({"type": "fixed", "sign": 1}, "offset"),
            ({"type": "fixed", "offset": 0}, "sign"),
            ({"limits": Limits(lower=1.0, upper=-1.0)}, "limits.lower"),
        ],
    )
    def test_a_row_that_contradicts_itself_is_refused(self, changes: dict[str, Any], field: str) -> None:
        """Where it is made, with its joint."""
        with pytest.raises(RecordValueError) as raised:
            replace(ROW, **changes)
        (problem,) = raised.value.problems
        assert (problem.joint, problem.field) == ("shoulder", field)


class TestTransforms:
    def test_a_homogeneous_matrix_is_a_transform(self) -> None:
        """An array of shape (4, 4), or lists; single precision is brought to the nearest rotation."""
        matrix = np.eye(4)
        matrix[:3] = np.column_stack([np.reshape(ARM.base.rotation, (3, 3)), ARM.base.translation])
        for given in (matrix, matrix.tolist(), matrix.ravel()):
            assert replace(ARM, base=given).base == ARM.base
        single = replace(ARM, base=matrix.astype(np.float32)).base
        assert single.rotation == pytest.approx(ARM.base.rotation, abs=1e-7)
        turned = np.reshape(single.rotation, (3, 3))
        np.testing.assert_allclose(turned @ turned.T, np.eye(3), atol=1e-15)

    @pytest.mark.parametrize(
        ("value", "says"),
        [
            (np.diag([1.0, 1.0, -1.0, 1.0]), "the matrix is no rotation"),
            (np.eye(3), "another shape"),
            (None, "NoneType"),
            (RigidTransform(IDENTITY.rotation, ("0", 0.0, 0.0)), "is of type str"),
        ],
    )
    def test_what_is_no_rigid_transform_is_refused(self, value: Any, says: str) -> None:
        """Mirrored and stretched axes, another shape, NaN."""
        for name in ("base", "tool"):
            assert says in str(refused(ARM, name, value))
        assert says in str(refused(MESH, "pose", value))


class TestMessages:
    def test_all_that_is_wrong_is_named_at_once(self) -> None:
        """Record, joint, field, what was found, what is accepted, and what to do."""
        with pytest.raises(RecordTypeError) as raised:
            DHRow(joint="hip", link="thigh", type="revolut", a="0.4", alpha=True, d=math.nan)  # type: ignore[arg-type]
        found = [(problem.field, problem.found) for problem in raised.value.problems]
        assert found == [("type", "'revolut'"), ("a", "'0.4'"), ("alpha", "True"), ("d", "nan")]
        assert all(problem.joint == "hip" and problem.accepted for problem in raised.value.problems)
