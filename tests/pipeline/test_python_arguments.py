"""No field of a record and no argument of a function is without effect: one changes, and the result or a message does."""

from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from full_row import FULL_ROW, INERTIA
from solids import STL

import dh2urdf
from dh2urdf.errors import Dh2UrdfError
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
    Payload,
)
from dh2urdf.rotations import IDENTITY, RigidTransform

CONFIGS = Path(__file__).parents[2] / "configs"
UR5 = CONFIGS / "tables" / "ur5.csv"
PLACED = RigidTransform.from_xyz_rpy((0.1, 1 / 3, -0.2), (0.3, -0.4, 1.1))


def mesh(folder: Path, name: str) -> MeshShape:
    """A tetrahedron."""
    path = folder / name
    path.write_bytes(STL)
    return MeshShape(file=MeshFile(path=str(path), sha256=sha256(STL).hexdigest()))


def arm_in(folder: Path) -> Manipulator:
    """An arm that says something in every field."""
    seen = replace(
        FULL_ROW,
        joint="elbow",
        link="forearm",
        radius=None,
        visual=mesh(folder, "v.stl"),
        collision=mesh(folder, "c.stl"),
    )
    bare = DHRow(joint="rail", link="slide", type=JointType.PRISMATIC, a=0.3, alpha=0.4, d=0.1, limits=FULL_ROW.limits)
    return Manipulator(
        name="arm",
        convention=Convention.STANDARD,
        rows=(FULL_ROW, seen, bare),
        base=PLACED,
        tool=PLACED,
        geometry=LinkGeometry(shape="box", radius=0.05),
        density=2000.0,
        base_mass=5.0,
        payload=Payload(mass=1.5, com=(0.0, 0.01, 0.05), inertia=INERTIA),
        base_geometry=LinkGeometry(shape="box", radius=0.1),
        visuals=True,
        collisions=True,
    )


MESH = "a mesh of its own"
OTHERS: dict[type, dict[str, Any]] = {
    Manipulator: {
        "name": "other",
        "convention": "modified",
        "base": IDENTITY,
        "tool": IDENTITY,
        "density": 3000.0,
        "base_mass": 6.0,
        "visuals": False,
        "collisions": False,
    },
    DHRow: {"joint": "other", "link": "other", "type": JointType.CONTINUOUS, "sign": -1},
    LinkGeometry: {"shape": "capsule"},
    MeshShape: {"pose": PLACED, "scale": (2.0, 1.0, 1.0), "file": MESH},
}
"""What a field becomes; a number that is not here becomes 10 % larger."""
SAYS_WHERE = {"mark", "notices"}
"""Fields that only say where something was read."""


def changes(record: Any, rebuild: Callable[[Any], Any], place: str, mesh: MeshShape) -> Iterator[tuple[str, Any]]:
    """What makes the arm with one field changed, for each field of a record and of the records in it."""
    for field in fields(record):
        if field.name in SAYS_WHERE:
            continue
        value, where = getattr(record, field.name), f"{place}.{field.name}".lstrip(".")

        def put(changed: Any, name: str = field.name) -> Any:
            return rebuild(replace(record, **{name: changed}))

        others = OTHERS.get(type(record), {})
        if field.name in others:
            yield where, partial(put, mesh_of(others[field.name], field.name, mesh))
        elif is_dataclass(value):
            yield from changes(value, put, where, mesh)
        elif isinstance(value, tuple):
            yield from changes_of_items(value, put, where, mesh)
        elif value is not None:
            yield where, partial(put, value * 1.1 + 0.001)


def changes_of_items(items: Any, put: Callable[[Any], Any], where: str, mesh: MeshShape) -> Iterator[tuple[str, Any]]:
    """The same for each row, and for each number of a vector."""
    for number, item in enumerate(items):

        def put_item(changed: Any, number: int = number) -> Any:
            return put((*items[:number], changed, *items[number + 1 :]))

        if is_dataclass(item):
            yield from changes(item, put_item, f"{where}[{number}]", mesh)
        else:
            yield f"{where}[{number}]", partial(put_item, item + 0.011)


def mesh_of(changed: Any, field: str, mesh: MeshShape) -> Any:
    """What a field becomes."""
    if changed != MESH:
        return changed
    return mesh.file if field == "file" else mesh


def everything_of(arm: Manipulator) -> tuple[Any, ...]:
    """What is made of an arm: all files and what is said of it; or the message that refuses it."""
    try:
        made = dh2urdf.convert(arm, meshes="file", formats=["urdf", "mjcf"])
    except Dh2UrdfError as error:
        return (str(error),)
    return (*made.files.items(), *(str(notice) for notice in made.notices))


@pytest.mark.long
def test_every_field_of_every_record_has_an_effect(tmp_path: Path) -> None:
    """One is changed, and a file, a notice or an error is another; and a table in YAML says it."""
    arm, other = arm_in(tmp_path), mesh(tmp_path, "other.stl")
    before = everything_of(arm)
    assert len(before) > 1
    every = list(changes(arm, lambda changed: changed, "", other))
    every += [(name, partial(replace, arm, **{name: other})) for name in ("base_visual", "base_collision")]
    tried = {where.rpartition(".")[2].partition("[")[0] for where, _ in every}
    records = (Manipulator, DHRow, Limits, Inertia, Payload, LinkGeometry, MeshShape)
    assert tried >= {field.name for kind in records for field in fields(kind)} - SAYS_WHERE - {
        *("rows", "limits", "inertia", "geometry", "base_geometry", "payload"),  # whose own fields are changed
        *("visual", "collision"),
        *("acceleration", "jerk", "follows"),  # tests/plugins/emitters/test_urdf_1_2.py, kinematics/test_followers.py
    }
    without_effect, unsaid = [], []
    for where, change in every:
        try:
            changed = change()
        except Dh2UrdfError as error:
            assert where.rpartition(".")[2].partition("[")[0] in str(error)
            continue
        assert changed != arm, where
        if everything_of(changed) == before:
            without_effect.append(where)
        try:
            text = changed.to_yaml()
        except Dh2UrdfError as error:
            unsaid.append((where, str(error)))
        else:
            assert dh2urdf.read(text, reader="yaml") == changed, where
    assert without_effect == []
    # A continuous joint has no bounds in a table; YAML refuses them by name.
    assert [where for where, _ in unsaid] == [f"rows[{number}].type" for number in range(3)]
    assert all("limits.lower" in said and "limits.upper" in said for _, said in unsaid)


class TestArguments:
    ROW: ClassVar[Any] = ({"a": 400, "alpha": 0, "d": 1},)
    MM: ClassVar[Any] = {"convention": "standard", "units": {"length": "mm", "angle": "deg"}}

    def test_a_transform_is_in_metres_whatever_the_table_is_in(self) -> None:
        """A `RigidTransform` is the base to the last bit; a matrix has the table's unit, as it has in a file."""
        for argument in ("base", "tool"):
            arm = Manipulator.from_dh(list(self.ROW), **self.MM, **{argument: PLACED})
            assert getattr(arm, argument) == PLACED
            matrix = np.eye(4)
            matrix[0, 3] = 100.0
            arm = Manipulator.from_dh(list(self.ROW), **self.MM, **{argument: matrix})
            assert getattr(arm, argument).translation == (0.1, 0.0, 0.0)

    @pytest.mark.parametrize(
        ("call", "field"),
        [
            *((lambda out=out: dh2urdf.convert(UR5, out), "out") for out in ("", 3, b"arm.urdf", [], True)),
            (lambda: dh2urdf.run(""), "config"),
            (lambda: dh2urdf.convert(UR5).robot.to_urdf(3), "out"),
            (lambda: dh2urdf.read(UR5, robot=1), "robot"),
            (lambda: dh2urdf.check("arm.urdf", arguments="a:=3"), "arguments"),
            (lambda: dh2urdf.check("arm.urdf", without=["urdff"]), "without"),
            *(
                (lambda wrong=wrong: Manipulator.from_dh([[1, 2, 3]], **{wrong: 7}), wrong)
                for wrong in ("mark", "file")
            ),
            (lambda: dh2urdf.read(UR5, conventoin="standard"), "conventoin"),
            (lambda: dh2urdf.run({"inputs": {str(UR5)}}), None),
            (lambda: dh2urdf.run({"inputs": str(UR5)}, settings={"nokey": "dh"}), None),
            (lambda: dh2urdf.run(UR5), None),
        ],
    )
    def test_what_no_function_can_use_is_refused_by_name(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: Callable[[], Any], field: str | None
    ) -> None:
        """Nothing is written: an empty text would be the working directory."""
        monkeypatch.chdir(tmp_path)
        with pytest.raises(Dh2UrdfError) as raised:
            call()
        assert [problem.field for problem in raised.value.problems] == [field]  # type: ignore[attr-defined]
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize("inertia", [None, INERTIA])
    def test_records_are_in_si_units_whatever_the_table_is_in(self, inertia: Inertia | None) -> None:
        """A payload, a shape and an inertia, alone and inside a mapping."""
        payload = Payload(mass=1.1, com=(0.1, 1 / 3, 0.0), inertia=inertia)
        shape = LinkGeometry(shape="box", radius=0.1)
        units = {"length": "mm", "angle": "deg", "mass": "g", "inertia": "g·mm²"}
        how: dict[str, Any] = {**self.MM, "units": units}
        arm = Manipulator.from_dh(list(self.ROW), payload=payload, base={"geometry": shape}, **how)
        assert arm.payload == payload
        assert arm.base_geometry == shape
        mapping = {"mass": "1.1 kg", "com": ["0.1 m", f"{1 / 3!r} m", 0], "inertia": inertia}
        given = {key: value for key, value in mapping.items() if value is not None}
        assert Manipulator.from_dh(list(self.ROW), payload=given, **how).payload == payload
        assert dh2urdf.read(UR5, payload=payload).payload == payload
