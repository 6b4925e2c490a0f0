import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from small_stages import one_joint, pickling

from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.conversion.outcome import ManifestRow, to_text
from dh2urdf.errors import MissingDependencyError
from dh2urdf.hookspecs import hookimpl
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import Catalog
from dh2urdf.plugin_system.catalog import Plugin
from dh2urdf.report.verdicts import coverage_line
from dh2urdf.robot import Robot
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.running import run as runs
from dh2urdf.running.run import execute
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Executor, KeepsKinematics, Loader, NoOptions, Reader, Rejected, Requires, Transform
from dh2urdf.tasks.batch_report import BatchReport
from dh2urdf.testing import plain_robot

# The stages of these tests are made here: the core is tried without any built-in plugin. Their tables are lists of
# names, a line each, and what a name begins with says what becomes of it.


def read(path: Path, _options: NoOptions) -> Iterator[Manipulator | Rejected]:
    for number, name in enumerate(path.read_text().splitlines(), start=1):
        mark = Mark(file=str(path), line=number)
        if name == "crash":
            raise ZeroDivisionError("no such number")
        if name.startswith("bad"):
            yield Rejected(name=name, problems=(Problem(message=f"{name} is bad"),), mark=mark)
        else:
            notices = (Problem(message="read with care", severity="notice"),) if name.startswith("odd") else ()
            yield one_joint(name, mark=mark, notices=notices)


@dataclass(frozen=True, kw_only=True)
class DrawOptions:
    length: float = field(default=0.5, metadata={"help": "length of the link [m]"})
    keeps: bool = field(default=True, metadata={"help": "whether it claims to keep the kinematics"})


def draw(manipulator: Manipulator, options: DrawOptions) -> Robot:
    notices = (Problem(message="drawn with care", severity="notice"),) if manipulator.name.startswith("odd") else ()
    return replace(plain_robot(one_joint(manipulator.name, options.length)), manipulator=None, notices=notices)


LOADER = """
from dataclasses import dataclass
from dh2urdf.errors import LoaderError
from dh2urdf.stages import LoadReport

@dataclass(frozen=True)
class Settings:
    poses, picture, time_limit = 3, True, 120.0

@dataclass(frozen=True)
class Timeless:
    poses, picture = 3, True

    @property
    def time_limit(self):
        raise ZeroDivisionError("no time")

def load_light(request, options):
    return LoadReport(simulator="ink", version="1")

def load(request, options):
    print("loading", request.path.name)
    if request.robot.name.startswith("heavy"):
        raise LoaderError("too heavy to hold")
    if request.picture:
        request.picture.write_text("an arm")
    return LoadReport(
        simulator="paper", version="1", position_error=request.expected["tool0"][0][3], poses=len(request.poses),
        picture=request.picture and request.picture.name,
    )
"""
"""A simulator, which works in a child process: a module of its own."""


class Lab:
    """A folder with a table and a run file, and a catalog of the stages above."""

    def __init__(self, folder: Path, loaders: tuple[Loader[Any], ...]) -> None:
        self.folder = folder
        self.output = folder / "out"
        module = ModuleType("lab")
        for kind, stages in {
            "readers": [Reader(name="list", summary="names", read=read, options=NoOptions, suffixes=(".list",))],
            "transforms": [
                Transform(
                    name="draw",
                    summary="draws",
                    transform=draw,
                    options=DrawOptions,
                    capabilities=(KeepsKinematics(lambda o: o.keeps),),
                )
            ],
            "emitters": [pickling(costly=True).stage],
            "loaders": loaders,
            "executors": [
                Executor(name="here", summary="here", options=NoOptions, map=lambda work, tasks, _: map(work, tasks))
            ],
        }.items():
            setattr(module, f"dh2urdf_{kind}", hookimpl(self.hook(kind, stages)))
        self.catalog = Catalog([Plugin(name="lab", distribution="lab 1.0", module=module)])

    @staticmethod
    def hook(kind: str, stages: Any) -> Callable[[], Any]:
        def provide() -> Any:
            return stages

        provide.__name__ = f"dh2urdf_{kind}"
        return provide

    def plan(self, config: str, **tables: str) -> runs.Plan:
        for name, text in tables.items():
            (self.folder / f"{name}.list").write_text(text)
        (self.folder / "run.yaml").write_text(
            config + "\ntransform: draw\nemitters: pickle\nexecution: here\noutput: {directory: out}\n"
            "report: {html: false}\n"
        )
        return make_plan(load_config(self.folder / "run.yaml"), self.catalog)

    def run(self, names: str, more: str = "", **how: Any) -> list[ManifestRow]:
        """The rows of a run over a table of names."""
        return rows(self.plan(f"inputs: names.list\n{more}", names=names.replace(" ", "\n")), **how)

    def written(self) -> set[str]:
        """The files of its manipulators."""
        return {path.name for path in self.output.iterdir()} - REPORTS if self.output.exists() else set()


REPORTS = {"manifest.jsonl", "manifest.parquet", "report.json", "index.json", "timing.json"}


def rows(plan: runs.Plan, **how: Any) -> list[ManifestRow]:
    """The rows of a run, which are in its manifest and, of a short one, in its report."""
    _, report = execute(plan, **how)
    if not how.get("dry_run"):
        with plan.store.open("manifest.jsonl") as manifest:
            assert [json.loads(line) for line in manifest] == json.loads(to_text(report["manipulators"]))
    return json.loads(to_text(report["manipulators"]))  # type: ignore[no-any-return]


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Lab:
    (tmp_path / "paper_simulator.py").write_text(LOADER)
    monkeypatch.syspath_prepend(tmp_path)
    import paper_simulator  # type: ignore[import-not-found]

    def missing(_options: NoOptions) -> None:
        raise MissingDependencyError("loader 'absent'", "absent", "lab[absent]")

    loaders = [
        Loader(
            name=name,
            summary="loads",
            open=paper_simulator.load_light if name == "ink" else paper_simulator.load,
            options=paper_simulator.Timeless if name == "timeless" else paper_simulator.Settings,
            formats=formats,
            capabilities=(Requires(require),),
        )
        for name, formats, require in (
            ("paper", ("pickle",), lambda _: None),
            ("cardboard", ("sdf", "pickle"), lambda _: None),
            ("glass", ("sdf",), lambda _: None),
            ("absent", ("pickle",), missing),
            ("ink", ("pickle",), lambda _: None),
            ("timeless", ("pickle",), lambda _: None),
        )
    ]
    return Lab(tmp_path, tuple(loaders))


def messages(problems: Any) -> list[str]:
    return [problem["message"] for problem in problems]


class TestPlan:
    @pytest.mark.parametrize(
        "inputs",
        [
            "[a.list, '*.list']",
            "[a.list, ./a.list]",
            "['*.list', a.list]",
            "['?.list', '*.list']",
            "[link.list, a.list]",
        ],
    )
    def test_a_file_that_is_named_twice_is_made_once(self, lab: Lab, tmp_path: Path, inputs: str) -> None:
        """By a pattern and its path, two spellings, or a link; with a notice."""
        if "link" in inputs:
            (tmp_path / "link.list").symlink_to("a.list")
        made = rows(lab.plan(f"inputs: {inputs}", a="arm"))
        (arm,) = made
        (notice,) = arm["notices"]
        assert notice["code"] == "input-twice"

    def test_a_missing_package_is_known_before_anything_is_read(self, lab: Lab) -> None:
        """A loader that is not installed ends the run before it begins."""
        with pytest.raises(
            MissingDependencyError, match=r"loader 'absent' needs absent: .* -m pip install 'lab\[absent\]'"
        ):
            lab.run("arm", "loaders: [paper, absent]")
        assert lab.written() == set()


class TestExecute:
    def test_outcomes_come_in_the_order_of_the_inputs(self, lab: Lab) -> None:
        """One outcome per manipulator, with its source, and its files in the output folder."""
        plan = lab.plan("inputs: [a.list, b.list]", a="two\none", b="three")
        outcomes = rows(plan)
        assert [(outcome["name"], outcome["status"]) for outcome in outcomes] == [
            ("two", "ok"),
            ("one", "ok"),
            ("three", "ok"),
        ]
        assert [Path(outcome["source"]).name for outcome in outcomes] == ["a.list", "a.list", "b.list"]
        assert lab.written() == {"two.pickle", "one.pickle", "three.pickle"}
        assert outcomes[0]["proof"]["pickle"]["position_error"] < 1e-15
        timing = json.loads((lab.output / "timing.json").read_bytes())
        assert [set(entry) for entry in timing["manipulators"]] == [{"name", "transform", "emit"}] * 3

    def test_a_reader_that_breaks_ends_its_own_input(self, lab: Lab) -> None:
        """Manipulators before the crash and other inputs are written; the crash is reported with file, stage, traceback."""
        noted: list[BatchReport] = []
        plan = lab.plan("inputs: [a.list, b.list]", a="arm\ncrash\nleg", b="hand")
        first, crash, last = rows(plan, note=lambda report, _: noted.append(report))
        assert (first["name"], last["name"]) == ("arm", "hand")
        assert crash["status"] == "failed"
        (problem,) = crash["errors"]
        assert problem["message"].startswith("reader 'list' of lab 1.0 failed: ZeroDivisionError: no such number")
        assert problem["file"] == str(lab.folder / "a.list")
        tracebacks = [text for report in noted for text in report.tracebacks]
        assert ['raise ZeroDivisionError("no such number")' in text for text in tracebacks] == [True]


class TestNames:
    @pytest.mark.parametrize("names", ["arm arm.cardboard", "ARM.Cardboard arm"])
    def test_a_second_picture_is_no_file_of_another_manipulator(self, lab: Lab, names: str) -> None:
        """What is ``arm.cardboard.png`` by its second simulator keeps an arm.cardboard from its stem, either way round."""
        outcomes = lab.run(names, "loaders: [paper, cardboard]")
        pictures = [load["picture"] for outcome in outcomes for load in outcome["loaders"].values()]
        files = [file["path"] for outcome in outcomes for file in outcome["files"]]
        assert len({name.casefold() for name in (*pictures, *files)}) == 6
        assert lab.written() == {*pictures, *files}
        assert [len(outcome["notices"]) for outcome in outcomes] == [0, 1]


class TestLoaders:
    def test_the_report_of_each_is_in_the_outcome(self, lab: Lab) -> None:
        """By the loader's name, with what the simulator printed, how long it took, and a picture of its own name."""
        (outcome,) = lab.run("arm", "loaders: [paper, cardboard]")
        assert set(outcome["loaders"]) == {"paper", "cardboard"}
        assert [report["picture"] for report in outcome["loaders"].values()] == ["arm.png", "arm.cardboard.png"]
        assert outcome["loaders"]["paper"]["output"] == "loading arm.pickle\n"
        assert outcome["loaders"]["paper"]["poses"] == 3
        (timing,) = json.loads((lab.output / "timing.json").read_bytes())["manipulators"]
        assert set(timing) == {"name", "transform", "emit", "load paper", "load cardboard"}
        assert lab.written() == {"arm.pickle", "arm.png", "arm.cardboard.png"}

    @pytest.mark.parametrize(("keeps", "expected"), [(True, 0.5), (False, 0.6)])
    def test_it_is_held_against_the_table_or_the_robot(self, *, lab: Lab, keeps: bool, expected: float) -> None:
        """The expected pose at zero is the DH product's; where the transform gives another arm, that arm's."""
        plan = lab.plan("inputs: arm.list\nloaders: paper", arm="arm")
        options = DrawOptions(length=expected, keeps=keeps)
        recipe = replace(plan.recipe, transform=replace(plan.recipe.transform, options=options))
        (outcome,) = rows(replace(plan, recipe=recipe))
        assert outcome["loaders"]["paper"]["position_error"] == expected

    def test_one_that_refuses_does_not_silence_the_next(self, lab: Lab) -> None:
        """All loaders are asked; each has its verdict, and the manipulator has the errors of all that failed."""
        result, report = execute(lab.plan("inputs: names.list\nloaders: [paper, cardboard, ink]", names="heavy\narm"))
        heavy, arm = report["manipulators"]
        assert {name: load["verdict"] for name, load in heavy["loaders"].items()} == {
            "paper": "failed",
            "cardboard": "failed",
            "ink": "passed",
        }
        assert messages(heavy["errors"]) == ["paper: too heavy to hold", "cardboard: too heavy to hold"]
        assert messages(heavy["loaders"]["cardboard"]["errors"]) == ["cardboard: too heavy to hold"]
        assert {load["verdict"] for load in arm["loaders"].values()} == {"passed"}
        assert {
            name: (entry["passed"], entry["failed"], entry["of"]) for name, entry in report["coverage"].items()
        } == {"paper": (1, 1, 2), "cardboard": (1, 1, 2), "ink": (2, 0, 2)}
        assert result.exit_status == 1

    def test_an_optional_one_fails_nothing(self, lab: Lab) -> None:
        """What it refuses is one notice for all manipulators, and so is that it is not installed."""
        config = "inputs: names.list\nloaders: [{stage: paper, optional: true}, ink, {stage: absent, optional: true}]"
        result, report = execute(lab.plan(config, names="heavy\nheavy2\narm"))
        assert result.exit_status == 0
        heavy = report["manipulators"][0]
        assert heavy["errors"] == []
        assert {name: load["verdict"] for name, load in heavy["loaders"].items()} == {
            "paper": "failed",
            "ink": "passed",
            "absent": "missing",
        }
        told = {(notice["loader"], notice["manipulators"], notice["message"]) for notice in report["simulator_notices"]}
        assert told == {
            ("paper", 2, "paper: too heavy to hold"),
            ("absent", 3, f"loader 'absent' needs absent: {sys.executable} -m pip install 'lab[absent]'"),
        }
        assert coverage_line(report["coverage"]) == (
            "paper 3 of 3 (2 refused), ink 3 of 3, absent 0 of 3 (not installed)"
        )

    @pytest.mark.parametrize("resume", [False, True])
    def test_the_coverage_counts_all_manipulators(self, *, lab: Lab, resume: bool) -> None:
        """Those outside the sample, and those that failed before there was a file, also when a run is resumed."""
        config = "inputs: names.list\nloaders: paper\nsample: {first: 3, every: 5}"
        names = "\n".join(["arm0", "bad", "arm2", *(f"arm{number}" for number in range(3, 12))])
        if resume:
            execute(lab.plan(config, names=names))
        _, report = execute(lab.plan(config, names=names), resume=resume)
        assert coverage_line(report["coverage"]) == "paper 4 of 12 (sample; 1 without a file)"
        why = [row.get("not_loaded", {}).get("paper") for row in report["manipulators"]]
        outside = "not in the sample"
        assert why == [None, "no file", None, outside, outside, None, *[outside] * 4, None, outside]


class TestLongRuns:
    def test_what_is_slow_is_a_sample(self, lab: Lab) -> None:
        """Beyond the first thousand, a slow proof is made, and a simulator asked, for every fiftieth manipulator."""
        assert lab.plan("inputs: a.list", a="arm").recipe.sample == Sample(first=1000, every=50)
        names = " ".join(f"arm{number}" for number in range(12))
        outcomes = lab.run(names, "loaders: paper\nsample: {first: 3, every: 5}")
        proved = [number for number, outcome in enumerate(outcomes) if outcome["proof"]["pickle"]]
        assert proved == [0, 1, 2, 5, 10]
        assert [number for number, outcome in enumerate(outcomes) if outcome["loaders"]] == proved

    def test_the_proof_can_be_a_sample(self, lab: Lab) -> None:
        """How many are proved is a setting; all of them are by default."""
        outcomes = lab.run("a b c d e", "proof: {every: 2}")
        assert [bool(outcome["proof"]["pickle"]) for outcome in outcomes] == [True, False, True, False, True]


class TestCallsInOtherProcesses:
    def test_executors_are_told_whose_stages_a_run_uses(self, lab: Lab) -> None:
        """Of the work in other processes: not that of a reader, whose tables come from the run's own."""
        plan = lab.plan("inputs: names.list", names="x")
        seen: list[tuple[str, ...]] = []

        def watch(function: Any, tasks: Any, _options: NoOptions) -> Iterator[Any]:
            seen.append(function.distributions)
            return map(function, tasks)

        other = Plugin(name="far = far", distribution="far-lab 2.0")
        recipe = replace(plan.recipe, emitters=tuple(replace(call, plugin=other) for call in plan.recipe.emitters))
        executor = replace(plan.executor, stage=replace(plan.executor.stage, map=watch))
        execute(replace(plan, executor=executor, recipe=recipe))
        assert seen == [("far-lab", "lab")]

    def test_a_missing_result_fails_its_own_batch(self, lab: Lab) -> None:
        """Those that come after it are of their own batches."""
        plan = lab.plan("inputs: names.list", names="a\nb\nc\nd")

        def forgetful(function: Any, tasks: Any, _options: NoOptions) -> Iterator[Any]:
            next(tasks)
            yield from map(function, [*tasks])

        executor = replace(plan.executor, stage=replace(plan.executor.stage, map=forgetful))
        statuses = [row["status"] for row in rows(replace(plan, executor=executor))]
        assert statuses == ["failed", "ok", "ok", "ok"]

    def test_an_executor_has_ended_before_the_folder_is_given_back(self, lab: Lab) -> None:
        """Wherever an interrupt comes: a worker that goes on would write into a folder that is another run's by then."""
        plan = lab.plan("inputs: names.list", names="x\ny")
        locked_at_its_end: list[bool] = []

        def interrupt(_result: Any) -> None:
            raise KeyboardInterrupt

        result = type("Result", (), {"__class__": property(interrupt)})()  # isinstance() asks for it

        def interrupted(_function: Any, tasks: Any, _options: NoOptions) -> Iterator[Any]:
            next(tasks)
            try:
                yield result
            finally:
                locked_at_its_end.append((lab.output / ".dh2urdf" / "lock").exists())

        executor = replace(plan.executor, stage=replace(plan.executor.stage, map=interrupted))
        with pytest.raises(KeyboardInterrupt):
            execute(replace(plan, executor=executor))
        assert locked_at_its_end == [True]
