import json
import math
import pickle
import random
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import islice, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli

from dh2urdf.errors import ConfigError, ManipulatorError
from dh2urdf.fields import replace_unchecked
from dh2urdf.kinematics import forward_kinematics
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.quantities import Dimension
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.run_file.variation_section import LAWS
from dh2urdf.source import Mark, Problem
from dh2urdf.tasks.batch import Expected, batches
from dh2urdf.variations.binding import bind
from dh2urdf.variations.laws import Choices, DrawnValue, Grid, Law, LogUniform, Normal, Offset, Scale, Uniform
from dh2urdf.variations.sampling import Sampling
from dh2urdf.variations.variation import FIELDS, Rule, Variation, VariationCall, retyped, variant_columns

CONFIGS = Path(__file__).parents[3] / "configs"

ARM = Manipulator(
    name="arm",
    convention=Convention.STANDARD,
    rows=(
        DHRow(
            joint="pan", link="one", a=0.0, alpha=math.pi / 2, d=0.1, limits=Limits(lower=-1.0, upper=1.0, effort=9.0)
        ),
        DHRow(joint="lift", link="two", a=0.4, alpha=0.0, d=0.0, offset=0.25, mass=2.0),
        DHRow(joint="plate", link="three", type=JointType.FIXED, a=0.05, alpha=0.0, d=0.0, theta=0.5),
        DHRow(
            joint="slide",
            link="four",
            type=JointType.PRISMATIC,
            a=0.0,
            alpha=0.3,
            d=0.2,
            offset=0.05,
            sign=-1,
            limits=Limits(lower=0.0, upper=0.3, velocity=0.5),
            mass=1.0,
            inertia=Inertia(ixx=0.1, iyy=0.1, izz=0.1),
            damping=0.1,
        ),
        DHRow(joint="flange", link="five", type=JointType.FIXED, a=0.0, alpha=0.0, d=0.1),
    ),
    mark=Mark(file="arm.csv", line=2),
)
WHERE = Mark(file="run.yaml", line=4, column=7)


def rule(field: str, law: Law, *joints: int | str, **more: Any) -> Rule:
    return Rule(field=field, law=law, joints=joints or None, mark=WHERE, **more)


def variation(*rules: Rule, table: Manipulator = ARM, **more: Any) -> Variation:
    return bind(VariationCall(name="arm", of="arm", vary=rules, mark=WHERE, **more), table)


def drawn(some: Variation) -> list[dict[str, DrawnValue]]:
    return some.drawn(range(1, some.count + 1))


def made(some: Variation, number: int = 1) -> Manipulator:
    return some.made(number, some.drawn([number])[0])


def refused(*rules: Rule, **more: Any) -> Sequence[Problem]:
    with pytest.raises(ConfigError) as caught:
        variation(*rules, **{"count": 5} | more)
    return caught.value.problems


SCALE = Scale(low=0.8, high=1.2)
UNIFORM = Uniform(low=1.0, high=5.0)
MANY = (
    rule("a", SCALE, 2),
    rule("alpha", Offset(low=-0.1, high=0.1), "pan", "slide"),
    rule("mass", UNIFORM),
    rule("effort", LogUniform(low=1.0, high=100.0), 1),
    rule("d", Normal(mean=None, deviation=0.01, low=0.15, high=0.25), 4),
    rule("axes", Choices(values=(2, 3))),
)


class TestNumbers:
    @pytest.mark.parametrize("sampling", Sampling)
    def test_a_variant_is_made_by_itself(self, sampling: Sampling) -> None:
        """In any order and any shard, in another process too: its values depend on seed, count and number alone."""
        first = variation(*MANY, count=40, seed=7, sampling=sampling)
        expected = dict(enumerate(first.variants().tables(), 1))
        numbers = list(expected)
        random.Random(1).shuffle(numbers)  # noqa: S311 - an order
        again = pickle.loads(pickle.dumps(variation(*MANY, count=40, seed=7, sampling=sampling)))  # noqa: S301 - made here
        assert {number: made(again, number) for number in numbers} == expected
        assert drawn(replace(first, seed=8)) != drawn(first)

    @pytest.mark.parametrize("sampling", Sampling)
    @pytest.mark.parametrize(
        "more", [(), MANY[5:], (rule("velocity", Grid(values=(0.1, 0.2)), 4),)], ids=["", "axes", "grid"]
    )
    def test_many_at_once_are_drawn_as_each(self, sampling: Sampling, more: tuple[Rule, ...]) -> None:
        """To the last bit, for every law, and for more factors than a digest of the generator has words."""
        bounds = (
            rule("theta", Uniform(low=-0.0, high=0.0)),
            rule("lower", Uniform(low=-1e-300, high=0.0), 1),
            rule("upper", Offset(low=-0.0, high=1e300), 1),
            rule("damping", Choices(values=(1.0, 2.0, 0.5))),
        )
        many = variation(*MANY[:5], *bounds, *more, count=40, seed=7, sampling=sampling)
        assert len(many.factors) > 16
        for numbers in (range(1, 41), [40, 3], [7]):
            each = [many.drawn([number])[0] for number in numbers]
            assert repr(many.drawn(numbers)) == repr(each)


class TestGrids:
    def test_a_grid_is_complete(self) -> None:
        """Every combination once, the last factor fastest; the count is theirs."""
        grids = variation(
            rule("a", Grid(values=(0.3, 0.4, 0.5)), 2),
            rule("type", Grid(values=("prismatic", "revolute")), "pan"),
            rule("mass", Grid(values=(1.0, 2.0)), 1, 2),
        )
        found = [tuple(values[key] for key in ("a_2", "type_1", "mass_1", "mass_2")) for values in drawn(grids)]
        assert found == list(product((0.3, 0.4, 0.5), ("prismatic", "revolute"), (1.0, 2.0), (1.0, 2.0)))

    def test_other_laws_are_drawn_at_every_point(self) -> None:
        """With a count of several rounds, every point comes as often, each time with other values."""
        mixed = variation(rule("a", Grid(values=(0.3, 0.4)), 2), rule("mass", UNIFORM, 2), count=6)
        values = drawn(mixed)
        assert Counter(each["a_2"] for each in values) == {0.3: 3, 0.4: 3}
        assert len({each["mass_2"] for each in values}) == 6

    def test_a_sobol_sequence_is_even_at_every_point_of_a_grid(self) -> None:
        """Each point of the grid has values of all parts of a range, and all points together those of no grid."""
        size = 4
        grid = rule("radius", Grid(values=tuple(map(float, range(1, size + 1)))), 1)
        others = [rule("mass", Uniform(low=1.0, high=5.0), 2), rule("a", Uniform(low=0.0, high=1.0), 2)]
        rows = drawn(variation(grid, *others, count=32 * size, sampling=Sampling.SOBOL, seed=3))
        for point in range(1, size + 1):
            own = [row for row in rows if row["radius_1"] == point]
            for key, low, width in (("mass_2", 1.0, 4.0), ("a_2", 0.0, 1.0)):
                assert sorted(int((float(row[key]) - low) / width * 32) for row in own) == list(range(32))
        without = drawn(variation(*others, count=32 * size, sampling=Sampling.SOBOL, seed=3))
        assert {(row["mass_2"], row["a_2"]) for row in rows} == {(row["mass_2"], row["a_2"]) for row in without}

    def test_a_sobol_sequence_has_no_part_in_the_order_of_a_grid(self) -> None:
        """Also where each point of the grids has one variant: values of the fastest grid go with no half of a range."""
        grids = [
            rule("radius", Grid(values=tuple(map(float, range(1, size + 1)))), joint)
            for joint, size in ((1, 32), (2, 4))
        ]
        for seed in range(5):
            rows = drawn(
                variation(*grids, rule("mass", Uniform(low=0.0, high=1.0), 2), sampling=Sampling.SOBOL, seed=seed)
            )
            assert len(rows) == 128
            for value in (1.0, 2.0, 3.0, 4.0):
                own = [float(row["mass_2"]) for row in rows if row["radius_2"] == value]
                assert 4 < sum(mass < 0.5 for mass in own) < 28


class TestTables:
    def test_only_what_varies_changes(self) -> None:
        """Every other row and field is the table's."""
        some = variation(rule("a", SCALE, 2), rule("upper", UNIFORM, "slide"), count=10)
        for found, values in zip(some.variants().tables(), drawn(some), strict=True):
            rows = list(ARM.rows)
            rows[1] = replace(rows[1], a=values["a_2"])
            rows[3] = replace(rows[3], limits=replace(rows[3].limits, upper=values["upper_4"]))
            assert found == replace(ARM, name=found.name, rows=tuple(rows))
            assert 0.32 <= float(values["a_2"]) <= 0.48

    def test_the_inertia_follows_the_mass(self) -> None:
        """A body with twice the mass has twice the inertia; one without a tensor gets none."""
        made_arm = made(variation(rule("mass", Choices(values=(3.0,))), count=1))
        inertia = made_arm.rows[3].inertia
        assert inertia is not None
        assert (inertia.ixx, inertia.iyy, inertia.izz) == pytest.approx((0.3, 0.3, 0.3))
        assert made_arm.rows[1].inertia is None

    @pytest.mark.parametrize(("axes", "rows"), [(1, 1), (2, 3)])
    def test_the_number_of_axes(self, axes: int, rows: int) -> None:
        """The rows before the next axis stay, fixed ones with the axis before them; the tool follows the last."""
        some = variation(rule("axes", Choices(values=(axes,))), rule("mass", UNIFORM), count=1)
        (values,), found = drawn(some), made(some)
        assert found.rows == tuple(
            replace(row, mass=values[f"mass_{number}"], inertia=found.rows[number - 1].inertia)
            for number, row in enumerate(ARM.rows[:rows], start=1)
        )
        assert len(values) == rows + 1
        assert found.tool == ARM.tool

    @pytest.mark.parametrize("row", [ARM.rows[1], ARM.rows[3], ARM.rows[2], replace(ARM.rows[0], sign=-1, theta=0.7)])
    @pytest.mark.parametrize("kind", JointType)
    def test_another_type_of_joint_stands_where_it_stood(self, row: DHRow, kind: JointType) -> None:
        """At joint value 0, the arm is where it was; what belongs to the other kind of motion is gone."""
        changed = retyped(row, kind)
        before, after = (
            np.array(as_matrices(forward_kinematics(arm, [0.0] * len(arm.moving_rows))))
            for arm in (replace(ARM, rows=(each,)) for each in (row, changed))
        )
        np.testing.assert_allclose(after, before, rtol=0, atol=1e-15)
        assert changed.type is kind
        if {row.type, kind} <= {JointType.REVOLUTE, JointType.CONTINUOUS}:
            assert changed.limits.effort == row.limits.effort
        elif row.type is not kind:
            assert (changed.limits, changed.damping, changed.offset) == (Limits(), None, 0.0)
        if kind is JointType.FIXED:
            assert changed.sign == 1

    def test_a_drawn_type_leaves_out_what_it_has_not(self) -> None:
        """A joint that is drawn fixed has no limits to draw, a continuous one no bounds; the others keep their values."""
        types = Grid(values=("revolute", "continuous", "prismatic", "fixed"))
        values = drawn(
            variation(rule("type", types, 1), rule("lower", Uniform(low=-1, high=-0.5), 1), rule("effort", UNIFORM, 1))
        )
        keys = [set(each) - {"type_1"} for each in values]
        assert keys == [{"lower_1", "effort_1"}, {"effort_1"}, {"lower_1", "effort_1"}, set()]


class TestImpossible:
    @pytest.mark.parametrize(
        ("field", "law"),
        [
            ("mass", Offset(low=-30.0, high=-20.0)),
            ("damping", Offset(low=-2.0, high=-1.0)),
            ("a", Scale(low=1e300, high=1e301)),
        ],
    )
    def test_what_no_arm_has_fails(self, field: str, law: Law) -> None:
        """The variant alone."""
        row = replace(ARM.rows[1], a=1e300, damping=0.0)
        some = variation(rule(field, law), table=replace(ARM, rows=(row,)), count=1)
        with pytest.raises(ManipulatorError) as caught:
            made(some)
        assert [(each.code, each.field) for each in caught.value.problems] == [("drawn-impossible", field)]


HUNDRED = Grid(values=tuple(map(float, range(1, 101))))
ANGLES = rule("lower", Uniform(low=-0.2, high=-0.1), units=(Dimension.ANGLE,))


class TestBinding:
    @pytest.mark.parametrize(
        ("code", "rules", "how"),
        [
            ("type-without-field", [rule("lower", UNIFORM, "plate")], {}),
            ("start-of-other-type", [rule("type", Choices(values=("prismatic",)), 1), rule("upper", SCALE, 1)], {}),
            ("other-measure", [ANGLES], {}),
            ("points-too-many", [rule("mass", HUNDRED)], {"count": None}),
            (
                "sobol-dimensions",
                [rule("a", UNIFORM)],
                {"table": replace_unchecked(ARM, rows=(ARM.rows[0],) * 21202), "sampling": Sampling.SOBOL},
            ),
        ],
    )
    def test_what_cannot_be_bound(self, code: str, rules: Sequence[Rule], how: dict[str, Any]) -> None:
        """One problem, at its place."""
        (found,) = refused(*rules, **how)
        assert found.code == code
        assert found.mark is not None

    def test_a_multiple_of_0_varies_nothing(self) -> None:
        """All variants would be the same arm; a rule that varies one joint may name others, or be for all joints."""
        (problem,) = refused(rule("a", SCALE, 1))
        assert (problem.code, problem.joint) == ("multiple-of-0", "pan")
        assert {"a_1", "a_2"} <= set(drawn(variation(rule("a", SCALE, 1, 2), count=1))[0])
        flat = replace(ARM, rows=tuple(replace(row, a=0.0) for row in ARM.rows))
        assert drawn(variation(rule("a", SCALE), table=flat, count=1))[0]["a_1"] == 0


# --- Many at once, as columns -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "rules",
    [
        [("a", Uniform(low=0.1, high=0.9)), ("alpha", Choices(values=(0.0, 0.5, math.pi)))],
        [("mass", Uniform(low=1.0, high=5.0)), ("radius", Uniform(low=0.01, high=0.02)), ("a", SCALE)],
        [("lower", Uniform(low=-2.0, high=0.3)), ("upper", Uniform(low=0.0, high=2.0)), MANY[4]],
        [("damping", Uniform(low=-1.0, high=2.0)), ("friction", UNIFORM), ("armature", UNIFORM)],
        [("offset", Uniform(low=-1.0, high=1.0)), ("velocity", Uniform(low=-1.0, high=3.0))],
    ],
)
def test_columns_are_the_tables_of_the_variants(rules: list[Any]) -> None:
    """Every table is the variant's own, to the last bit, with its marks and notices; impossible ones are left out."""
    some = variation(*(each if isinstance(each, Rule) else rule(*each) for each in rules), count=50, seed=3)
    found = variant_columns(some, some.variants().names, drawn(some))
    assert found
    places, columns = found
    assert places
    for place, values in enumerate(drawn(some)):
        try:
            table = some.made(place + 1, values)
        except ManipulatorError:
            assert place not in places
            continue
        picked = columns.pick(places.index(place))
        assert (picked, picked.notices) == (table, table.notices)
        assert [row.mark for row in picked.rows] == [row.mark for row in table.rows]


# --- The run ----------------------------------------------------------------------------------------------------------

TABLE = "# convention: standard\njoint,a,alpha,d,lower,upper\nshoulder,0,pi/2,0.1,-1,1\nelbow,0.4,0,0,-2,2\nwrist,0.3,-pi/2,0.05,-2,2\n"
RUN = """inputs: arm.csv
variations:
  - of: arm
    count: 12
    seed: 3
    sampling: {sampling}
    vary:
      - {{joints: [2, wrist], field: a, scale: [0.8, 1.2]}}
      - {{joints: all, field: alpha, offset: [-1 deg, 1 deg]}}
      - {{joints: elbow, field: upper, uniform: [-3, 2]}}
      - {{joints: 1, field: type, choices: [revolute, prismatic, continuous]}}
      - {{joints: all, field: mass, log-uniform: [0.5, 5 kg]}}
proof: {{poses: 4}}
"""


def report(folder: Path) -> list[dict[str, Any]]:
    entries: list[dict[str, Any]] = json.loads((folder / "report.json").read_bytes())["manipulators"]
    return entries


@pytest.fixture(params=list(Sampling))
def run_file(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    (tmp_path / "arm.csv").write_text(TABLE)
    path = tmp_path / "run.yaml"
    path.write_text(RUN.format(sampling=request.param))
    return path


def test_a_run_makes_proves_and_reports_variants(
    cli: Cli, run_file: Path, tool0_of: Callable[[Path], Callable[..., np.ndarray]]
) -> None:
    """The input, then every variant: proved, its drawn values reported, and the file is the arm of these values.

    Impossible ones, whose lower bound is above the upper one, fail alone with their reason.
    """
    out = run_file.parent / "out"
    cli("run", run_file, "-o", out, "--workers", 2, status=1)
    first, *variants = report(out)
    assert (first["name"], first["drawn"]) == ("arm", {})
    assert [entry["name"] for entry in variants] == [f"arm_{number:02d}" for number in range(1, 13)]
    for entry in variants:
        values = entry["drawn"]
        assert Path(entry["source"]).name == "run.yaml"
        if values["upper_2"] < -2:
            assert entry["status"] == "failed"
            assert entry["files"] == []
            assert (entry["errors"][0]["line"], entry["errors"][0]["column"]) == (10, 9)
            assert entry["errors"][0]["joint"] == "elbow"
            continue
        assert entry["status"] == "ok"
        assert entry["proof"]["urdf"]["position_error"] < 1e-12
        q = [0.3, -0.6, 1.1]
        sliding = values["type_1"] == "prismatic"
        T = np.eye(4)
        for a, alpha, d, theta in (
            (0.0, values["alpha_1"], 0.1 + (q[0] if sliding else 0), 0 if sliding else q[0]),
            (values["a_2"], values["alpha_2"], 0.0, q[1]),
            (values["a_3"], values["alpha_3"], 0.05, q[2]),
        ):
            c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
            T = T @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
        np.testing.assert_allclose(tool0_of(out / f"{entry['name']}.urdf")(q), T, rtol=0, atol=1e-12)
    assert {entry["status"] for entry in variants} == {"ok", "failed"}


@pytest.mark.parametrize(
    ("of", "joint", "table", "code"),
    [
        ("amr", 2, TABLE, "made-of-nothing"),
        ("arm", 2, TABLE.replace("0.4", "x"), "not-made"),
        ("arm", 9, TABLE, "varied-joint-unknown"),
    ],
)
def test_a_variation_of_nothing_fails_once(
    cli: Cli, tmp_path: Path, *, of: str, joint: int, table: str, code: str
) -> None:
    """Not once for every variant; the rest of the run is made."""
    (tmp_path / "arm.csv").write_text(table)
    (tmp_path / "other.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(
        "inputs: [arm.csv, other.csv]\n"
        f"variations: {{of: {of}, count: 1000, vary: [{{joints: {joint}, field: a, scale: [1, 2]}}]}}\n"
    )
    cli("run", "run.yaml", "-o", tmp_path / "out", status=1)
    entries = report(tmp_path / "out")
    assert [entry["name"] for entry in entries] == ["arm", "other", of]
    assert (entries[-1]["status"], entries[-1]["errors"][0]["code"]) == ("failed", code)


def test_nothing_grows_with_the_count(tmp_path: Path) -> None:
    """The batches of a billion variants come one by one, each small enough to be sent to a worker."""
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(
        "inputs: arm.csv\nvariations: {of: arm, count: 1000000000, sampling: latin-hypercube,"
        " vary: [{joints: all, field: mass, uniform: [1, 2]}]}\n"
    )
    plan = make_plan(load_config(tmp_path / "run.yaml"), load())
    expected, made = Expected(plan), 0
    for batch in islice(batches(plan, expected), 20):
        assert batch.first == made
        made += len(batch)
        assert len(pickle.dumps(batch)) < 10_000 + 100 * len(batch)
    assert batch.names[-1] == batch.stems[-1] == f"arm_{made - 1:010d}"
    assert expected.total == 1_000_000_001


def test_the_manual_keeps_its_word(cli: Cli, tmp_path: Path) -> None:
    """Its run file is run, with fewer variants, and gives what it says."""
    root = CONFIGS.parent
    text = (root / "docs" / "variations.md").read_text("utf-8")
    config = text.split("```yaml\n")[1].split("```")[0]
    (tmp_path / "run.yaml").write_text(config.replace("configs/", f"{CONFIGS}/"))
    cli("run", "run.yaml", "-o", tmp_path / "out", "--set", "variations.0.count=20", "--workers", 1)
    entries = report(tmp_path / "out")
    assert [entry["name"] for entry in entries[:2]] == ["ur5", "ur5_01"]
    assert [f'"a_{joint}": {entries[5]["drawn"][f"a_{joint}"]:.3f}' for joint in (2, 3)] == [
        '"a_2": -0.476',
        '"a_3": -0.455',
    ]
    for word in (*FIELDS, *LAWS, *Sampling):
        assert f"`{word}" in text or f"**{word}" in text
