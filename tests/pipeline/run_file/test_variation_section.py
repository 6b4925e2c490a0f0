import math
import sys
from pathlib import Path

import pytest

from dh2urdf.errors import MissingDependencyError
from dh2urdf.plugin_system import load
from dh2urdf.quantities import Dimension
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.variations.laws import Choices, Grid, Law, LogUniform, Normal, Offset, Scale, Uniform
from dh2urdf.variations.sampling import Sampling
from dh2urdf.variations.variation import VariationCall

RULE = "{joints: 1, field: a, scale: [1, 2]}"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arm.csv").write_text("# convention: standard\na,alpha,d\n0.4,pi/2,0\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def read(text: str) -> tuple[tuple[VariationCall, ...], list[str]]:
    Path("run.yaml").write_text(f"inputs: arm.csv\nvariations: {text.replace('RULE', RULE)}\n")
    config = load_config(Path("run.yaml"))
    return config.variations, [str(problem) for problem in config.problems]


def law(field: str, text: str) -> Law:
    joints = "" if field == "axes" else "joints: all, "
    (call,), problems = read(f"{{of: arm, count: 5, vary: [{{{joints}field: {field}, {text}}}]}}")
    assert problems == []
    return call.vary[0].law


@pytest.mark.usefixtures("folder")
class TestRight:
    def test_everything_is_read(self) -> None:
        """Names, count, seed, sampling and rules, with their places."""
        (call,), problems = read(
            "\n  - {name: many, of: arm, count: 10000, seed: 7, sampling: sobol,\n"
            "     vary: [{joints: [2, elbow], field: a, scale: [0.8, 1.2]}, {joints: all, field: mass, uniform: [1, 5]}]}"
        )
        assert problems == []
        assert (call.name, call.of, call.count, call.seed) == ("many", "arm", 10000, 7)
        assert call.sampling is Sampling.SOBOL
        assert [(rule.field, rule.joints, rule.law) for rule in call.vary] == [
            ("a", (2, "elbow"), Scale(low=0.8, high=1.2)),
            ("mass", None, Uniform(low=1.0, high=5.0)),
        ]
        assert (str(call.mark), str(call.of_mark)) == ("run.yaml:3:5", "run.yaml:3:22")
        assert [str(mark) for mark in call.vary[0].joint_marks] == ["run.yaml:4:23", "run.yaml:4:26"]

    def test_the_short_form_has_defaults(self) -> None:
        """One variation, one rule and one joint need no lists; a grid needs no count."""
        (call,), problems = read("{of: arm, vary: {joints: 1, field: a, grid: [0.1, 0.2]}}")
        assert problems == []
        assert (call.name, call.count, call.seed, call.sampling) == ("arm", None, 0, Sampling.RANDOM)
        assert call.vary[0].joints == (1,)

    @pytest.mark.parametrize(
        ("field", "text", "expected"),
        [
            ("a", "choices: [0.3, 400 mm, sqrt(2)/10]", Choices(values=(0.3, 0.4, math.sqrt(2) / 10))),
            ("alpha", "choices: [pi/2, -90 deg]", Choices(values=(math.pi / 2, -math.pi / 2))),
            ("type", "choices: [revolute, prismatic]", Choices(values=("revolute", "prismatic"))),
            ("axes", "grid: [4, 5, 6]", Grid(values=(4, 5, 6))),
            ("d", "grid: {from: 0, to: 300 mm, points: 4}", Grid(values=(0.0, 0.3 / 3, 0.3 * 2 / 3, 0.3))),
            ("radius", "uniform: [10 mm, 5 cm]", Uniform(low=0.01, high=0.05)),
            ("effort", "log-uniform: [1, 100 Nm]", LogUniform(low=1.0, high=100.0)),
            ("d", "normal: {deviation: 1 mm, bounds: [0, 0.1]}", Normal(mean=None, deviation=0.001, low=0.0, high=0.1)),
            (
                "mass",
                "normal: {mean: 3, deviation: 1, bounds: [1, 5]}",
                Normal(mean=3.0, deviation=1.0, low=1.0, high=5.0),
            ),
            ("damping", "uniform: [0, 2 Nms]", Uniform(low=0.0, high=2.0)),
            ("friction", "uniform: [0, 2 Nm]", Uniform(low=0.0, high=2.0)),
            ("armature", "choices: [0, 0.1, 3 kg]", Choices(values=(0.0, 0.1, 3.0))),
            ("theta", "offset: [-1 deg, 1 deg]", Offset(low=-math.pi / 180, high=math.pi / 180)),
            ("velocity", "scale: [1/2, 2]", Scale(low=0.5, high=2.0)),
            ("lower", "uniform: [-100 mm, -0.05]", Uniform(low=-0.1, high=-0.05)),
            ("upper", "uniform: [90 deg, 720 deg]", Uniform(low=math.pi / 2, high=4 * math.pi)),
        ],
    )
    def test_every_law_is_read_in_si_units(self, field: str, text: str, expected: Law) -> None:
        """Numbers may be expressions and have units."""
        assert law(field, text) == expected

    def test_units_are_remembered(self) -> None:
        """Whether bounds are angles or lengths is known from their units, and from nothing where there are none."""
        for text, units in (("[-1, 1]", ()), ("[-1 deg, 1]", (Dimension.ANGLE,)), ("[-1 mm, 1]", (Dimension.LENGTH,))):
            (call,), _ = read(f"{{of: arm, count: 5, vary: {{joints: 1, field: lower, uniform: {text}}}}}")
            assert call.vary[0].units == units

    def test_settings_reach_it(self) -> None:
        """`--set` changes a count for once."""
        read("{of: arm, count: 1000, vary: {joints: 1, field: a, scale: [1, 2]}}")
        config = load_config(Path("run.yaml"), ["variations.0.count=5", "variations.0.vary.scale=[1, 3]"])
        assert config.problems == ()
        assert config.variations[0].count == 5
        assert config.variations[0].vary[0].law == Scale(low=1.0, high=3.0)


@pytest.mark.usefixtures("folder")
def test_scipy_is_asked_for_before_anything_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it is not installed, the run names the extra."""
    read("{of: arm, count: 5, sampling: sobol, vary: RULE}")
    monkeypatch.setitem(sys.modules, "scipy.stats", None)
    with pytest.raises(MissingDependencyError, match=r"dh2urdf\[sampling\]"):
        make_plan(load_config(Path("run.yaml")), load())
