from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import pytest
from full_row import FULL_ROW
from hypothesis import given, strategies as st

from dh2urdf.cells.cell import ArmCall, Cell, CellCall
from dh2urdf.columns import in_columns
from dh2urdf.conversion.keys import DIGITS, column_keys, key_of, whole
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
from dh2urdf.plugin_system import load
from dh2urdf.rotations import RigidTransform
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.source import Mark, Problem

RAISED = RigidTransform((1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.5))
MESH = MeshShape(file=MeshFile(path="/link.stl", sha256="0" * 64))
BARE = DHRow(joint="elbow", link="forearm", a=0.3, alpha=0.0, d=0.0)
ARM = Manipulator(name="arm", convention=Convention.STANDARD, rows=(FULL_ROW, BARE))


def keys(tables: Sequence[Manipulator], recipe: str = "recipe", context: object = "here") -> list[str]:
    """The keys of manipulators that travel in one batch, in their order."""
    found = [""] * len(tables)
    for members, columns in in_columns(tables):
        for member, key in zip(members, column_keys(columns, recipe, [context] * len(members)), strict=True):
            found[member] = key
    return found


def key(table: Manipulator, **how: Any) -> str:
    (only,) = keys([table], **how)
    return only


def numbers(row: DHRow) -> list[DHRow]:
    """The row with another value in each place that holds a number, one at a time."""
    plain = ("a", "alpha", "d", "theta", "offset", "mass", "radius", "damping", "friction", "armature")
    changed = [replace(row, **{name: getattr(row, name) + 1e-9}) for name in plain]
    changed += [
        replace(row, limits=replace(row.limits, **{name: getattr(row.limits, name) + 1e-9}))
        for name in ("lower", "upper", "velocity", "effort")
    ]
    assert row.inertia is not None
    assert row.com is not None
    for each in fields(Inertia):
        tensor = replace(row.inertia, **{each.name: getattr(row.inertia, each.name) + 1e-9})
        changed.append(replace(row, inertia=tensor))
    for axis in range(3):
        com = [*row.com]
        com[axis] += 1e-9
        changed.append(replace(row, com=tuple(com)))
    return changed


OTHERS = [
    *(replace(ARM, rows=(row, BARE)) for row in numbers(FULL_ROW)),
    *(
        replace(ARM, rows=(FULL_ROW, replace(BARE, **change)))
        for change in (
            {"joint": "elbow_2"},
            {"link": "forearm_2"},
            {"type": JointType.PRISMATIC},
            {"type": JointType.FIXED},
            {"sign": -1},
            {"mass": 0.0},
            {"radius": 0.0},
            {"com": (0.0, 0.0, 0.0)},
            {"inertia": Inertia(ixx=0.0, iyy=0.0, izz=0.0)},
            {"limits": Limits(lower=0.0, upper=0.0)},
        )
    ),
    replace(ARM, name="arm_2"),
    replace(ARM, convention=Convention.MODIFIED),
    replace(ARM, rows=(FULL_ROW,)),
    replace(ARM, rows=(BARE, FULL_ROW)),
    replace(ARM, base=RAISED),
    replace(ARM, tool=RAISED),
    replace(ARM, geometry=LinkGeometry(shape="box")),
    replace(ARM, geometry=LinkGeometry(radius=0.05)),
    replace(ARM, density=1000.0),
    replace(ARM, base_mass=4.0),
    replace(ARM, base_mass=0.0),
    replace(ARM, payload=Payload(mass=2.0)),
    replace(ARM, payload=Payload(mass=3.0)),
    replace(ARM, payload=Payload(mass=2.0, com=(0.0, 0.0, 0.1))),
    replace(ARM, payload=Payload(mass=2.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0))),
    replace(ARM, base_geometry=LinkGeometry(shape="box")),
    replace(ARM, base_visual=MESH),
    replace(ARM, base_collision=MESH),
    replace(ARM, rows=(replace(FULL_ROW, visual=MESH), BARE)),
    replace(ARM, rows=(replace(FULL_ROW, visual=replace(MESH, file=replace(MESH.file, sha256="1" * 64))), BARE)),
    replace(ARM, rows=(replace(FULL_ROW, visual=replace(MESH, pose=RAISED)), BARE)),
    replace(ARM, rows=(replace(FULL_ROW, visual=replace(MESH, scale=(1.0, 1.0, 2.0))), BARE)),
    replace(ARM, rows=(replace(FULL_ROW, collision=MESH), BARE)),
    replace(ARM, visuals=False),
    replace(ARM, collisions=False),
    replace(ARM, notices=(Problem(message="read with care", severity="notice"),)),
]
"""Manipulators each of which differs from `ARM` in one thing."""


@dataclass(frozen=True, kw_only=True)
class QuietOptions:
    """Options of which the text shows nothing."""

    path: str = field(default="a", repr=False)
    words: frozenset[str] = frozenset()

    def __repr__(self) -> str:
        return "<options>"


def test_a_cell_has_the_keys_of_its_tables() -> None:
    """A field that makes another arm makes another cell; the text of a manipulator shows next to none of them."""
    call = CellCall(name="cell", arms=(ArmCall(name="left", of="arm", prefix="left_"),))
    cells = [Cell(call=call, manipulators={"arm": arm}) for arm in (ARM, replace(ARM), *OTHERS)]
    first, same, *others = [key_of(whole(cell), "recipe") for cell in cells]
    assert first == same
    assert len({first, *others}) == len(OTHERS) + 1


def test_options_count_whatever_their_text_shows() -> None:
    """Fields without a place in the text count, and the order of a set, which is another one in each process, does not."""
    words = [f"word_{k}" for k in range(20)]
    options = [QuietOptions(), QuietOptions(path="b"), QuietOptions(words=frozenset(words))]
    assert len({key_of(whole(each), "") for each in options}) == 3
    last = QuietOptions(words=frozenset(reversed(words)))
    assert key_of(whole(last), "") == key_of(whole(options[-1]), "")
    assert whole(last) == ("QuietOptions", [("path", "a"), ("words", sorted(map(repr, words)))])


def test_every_field_of_a_manipulator_is_among_the_differences() -> None:
    """A field that is added has to be added here, and to the key."""
    names = {field.name for field in fields(Manipulator)} - {"mark"}
    assert {name for name in names for other in OTHERS if getattr(other, name) != getattr(ARM, name)} == names


def test_whatever_differs_in_a_table_gives_another_key() -> None:
    """Every number, in the tenth digit; every name, type and sign; what is given and what is left open; all else."""
    found = [key(table) for table in (ARM, *OTHERS)]
    assert len(set(found)) == len(OTHERS) + 1
    assert {len(each) for each in found} == {DIGITS}


@pytest.mark.parametrize("how", [{"recipe": "other"}, {"context": "there"}, {"context": ("here", 1)}])
def test_the_recipe_and_the_context_count(how: dict[str, Any]) -> None:
    """Another option of a stage, another stem, another folder: other files."""
    assert key(ARM, **how) != key(ARM)


def test_lines_of_the_file_do_not_count() -> None:
    """A comment more in a table is no reason to make its robots again."""
    rows = tuple(replace(row, mark=Mark(file="arm.csv", line=number)) for number, row in enumerate(ARM.rows, 7))
    assert key(replace(ARM, mark=Mark(file="arm.csv", line=7), rows=rows)) == key(ARM)


ALL = (ARM, *OTHERS)
ALONE = [key(table) for table in ALL]


@given(st.lists(st.integers(0, len(OTHERS)), max_size=12))
def test_the_company_does_not_count(places: list[int]) -> None:
    """A manipulator has the key that it has alone, in every batch and at every place."""
    assert keys([ALL[place] for place in places]) == [ALONE[place] for place in places]


NUMBERS = st.floats(allow_nan=False, allow_infinity=False)


@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=2, max_size=6))
def test_equal_numbers_and_only_they_have_equal_keys(values: list[tuple[float, float]]) -> None:
    """Of manipulators in columns, whatever the numbers."""
    tables = [replace(ARM, rows=(replace(FULL_ROW, a=a, mass=mass), BARE)) for a, mass in values]
    found = keys(tables)
    for first, one in zip(found, values, strict=True):
        for second, other in zip(found, values, strict=True):
            assert (first == second) is (one == other)


# --- The recipe -------------------------------------------------------------------------------------------------------


@pytest.fixture
def plan_key(tmp_path: Path) -> Any:
    """The key of a run file's recipe."""
    (tmp_path / "arm.csv").write_text("a,alpha,d\n0,0,1\n")

    def of(text: str = "") -> str:
        (tmp_path / "run.yaml").write_text(f"inputs: arm.csv\n{text}\n")
        return make_plan(load_config(tmp_path / "run.yaml"), load()).key

    return of


@pytest.mark.parametrize(
    "text",
    [
        "transform: {options: {frames: dh}}",
        "emitters: [urdf, xacro]",
        "loaders: mujoco",
        "proof: {poses: 33}",
        "output: {meshes: file}",
    ],
)
def test_what_is_done_counts(plan_key: Any, text: str) -> None:
    """Every stage with every option, and how the files are proved."""
    assert plan_key(text) != plan_key()


@pytest.mark.parametrize(
    "text",
    [
        "transform: {stage: alpha-swap, options: {frames: aligned}}",
        "execution: {stage: local, options: {workers: 2}, time_limit: 5}",
        "output: {directory: elsewhere}",
    ],
)
def test_who_does_it_does_not_count(plan_key: Any, text: str) -> None:
    """Workers, time limits, the folder as a whole, and defaults that are said."""
    assert plan_key(text) == plan_key()


def test_versions_count(plan_key: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A newer version of the core, of a plugin or of Python may write other files."""
    before = plan_key()
    monkeypatch.setattr("dh2urdf.conversion.keys.__version__", "99")
    assert plan_key() != before
    monkeypatch.undo()
    monkeypatch.setattr("dh2urdf.plugin_system.discovery.Plugin.distribution", "lab 2.0")
    assert plan_key() != before
