"""The files about a run: its manifest, its report, the index of its failures, the manifest as a table, its durations.

All that a run found is in its manifest, and no duration: a repeated run writes the same bytes. Durations are in
`timing.json`. The other files are made of the rows of the manifest once it is complete, read one by one, and of the
tables of the first manipulators, which are kept as their batches go to the workers.
"""

from __future__ import annotations

import platform
import shlex
from dataclasses import asdict
from hashlib import file_digest
from importlib.metadata import version
from importlib.util import find_spec
from itertools import islice
from typing import TYPE_CHECKING, Any, BinaryIO, Final

import orjson

from dh2urdf._version import __version__
from dh2urdf.cells.cell import Cell
from dh2urdf.conversion.outcome import to_text
from dh2urdf.errors import pip_install
from dh2urdf.kinematics.facts import KinematicFacts, kinematic_facts, kinematic_facts_of_columns
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.whole_files import reporting_os_errors, write_all
from dh2urdf.plugin_system.options import plain
from dh2urdf.report.manifest_table import ManifestTable, can_write_parquet
from dh2urdf.report.verdicts import FailureIndex, Verdicts

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from dh2urdf.conversion.one_manipulator import Recipe
    from dh2urdf.output.store import Store
    from dh2urdf.report.overview import Overview
    from dh2urdf.results import ArmAxes, AxesEntry, InputEntry, Reproduction, RunReport
    from dh2urdf.tasks.batch import Batch, Single
    from dh2urdf.tasks.batch_report import BatchReport, Result
    from dh2urdf.variations.variation import VariationCall

SCHEMA: Final = "dh2urdf-report/1"  # name and version of the form of `report.json`
INDEX, REPORT, TIMING, PAGE = "index.json", "report.json", "timing.json", "report.html"
TABLE = "manifest.parquet"  # the manifest as a table
HOW_TO_GET = f"a page with pictures of it, report.html, needs jinja2 and matplotlib: {pip_install('dh2urdf[report]')}"
"""The message where the page cannot be written."""
REPORTED = 1000
"""Manipulators that the report repeats from the manifest: the first ones; `timing.json` has as many."""
FULL, EXAMPLES = 24, 6
"""Manipulators of a run that is shown in full on the page, and those that are shown of a longer one: its first ones."""


def can_write_html() -> bool:
    """Whether jinja2, matplotlib and what it draws pixels with are installed; they are not imported."""
    return all(find_spec(package) for package in ("jinja2", "matplotlib", "PIL"))


class ManifestWriter:
    """The manifest of a run on its way: `rows` is an empty file, and `place` where the manifest will be, for errors."""

    def __init__(self, rows: BinaryIO, place: str, told: Reproduction, verdicts: Verdicts | None = None) -> None:
        self.rows, self.reproduction = rows, told
        self.verdicts = verdicts or Verdicts({})  # what simulators say
        self.index = FailureIndex()
        self.axes: list[ArmAxes] = []  # what the axes of the first tables declare that could be read
        self._place = place
        self._axes_left = REPORTED
        self._first: list[Single] = []

    def add(self, report: BatchReport) -> None:
        """Add the rows of a batch."""
        with reporting_os_errors(self._place):
            write_all(self.rows.fileno(), report.rows)

    def see(self, batch: Batch) -> None:
        """Keep what is in a batch, and the axes of its tables; batches come in the order of the run."""
        self._first += batch.begin(FULL - len(self._first))
        groups, singles = batch.first_groups(self._axes_left)
        found: list[tuple[int, tuple[str, ...], KinematicFacts]] = [
            (place, arms, kinematic_facts(table)) for place, what in singles.items() for arms, table in tables_of(what)
        ]
        for places, tables in groups:
            its = kinematic_facts_of_columns(tables)
            found += [(place, (), facts) for place, facts in zip(places, its, strict=True)]
        for place, arms, facts in sorted(found, key=lambda each: each[0]):
            self.axes.append({"name": batch.names[place], "arms": list(arms), **axes_entry(facts)})
        self._axes_left = max(0, self._axes_left - len(batch))

    def shown(self, count: int) -> list[Single]:
        """What is shown in full of a run of so many manipulators, on its page."""
        return self._first if count <= FULL else self._first[:EXAMPLES]


def tables_of(what: object) -> list[tuple[tuple[str, ...], Manipulator]]:
    """The tables of a manipulator or cell, each once, with the arms of a cell that have it; none of what is neither."""
    if isinstance(what, Cell):
        named = {name: tuple(arm.name for arm in what.call.arms if arm.of == name) for name in what.manipulators}
        return [(named[name], table) for name, table in what.manipulators.items()]
    return [((), what)] if isinstance(what, Manipulator) else []


def axes_entry(facts: KinematicFacts) -> AxesEntry:
    """What the axes of a table declare about its kinematics, as plain data [m, rad]."""
    opw: Any = None
    if facts.opw is not None:
        opw = asdict(facts.opw) | {"offsets": list(facts.opw.offsets), "signs": list(facts.opw.signs)}
    parallel = [list(names) for names in facts.parallel]
    return {"parallel": parallel, "spherical_wrist": list(facts.spherical_wrist), "opw": opw}


def run_report(manifest: ManifestWriter, result: Result) -> RunReport:
    """The report of a run as plain data."""
    manifest.rows.seek(0)
    return {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": result.exit_status,
        "reproduction": manifest.reproduction,
        "coverage": manifest.verdicts.coverage,
        "simulator_notices": manifest.verdicts.notices(),
        "manipulators": [orjson.loads(row) for row in islice(manifest.rows, REPORTED)],
        "left_out": max(0, sum(result.statuses.values()) - REPORTED),
        "axes": manifest.axes,
    }


def write_reports(
    store: Store, manifest: ManifestWriter, result: Result, table: Path | None, overview: Overview | None = None
) -> RunReport:
    """Write `index.json`, `report.json` and, where pyarrow is installed, `manifest.parquet`; the report as plain data.

    `table` is a name for the temporary file of the table; `overview` gathers what a page for people says.
    """
    columns = ManifestTable() if table and can_write_parquet() else None
    gathering: list[Any] = [each for each in (manifest.index, manifest.verdicts, overview, columns) if each]
    manifest.rows.seek(0)
    for row in map(orjson.loads, manifest.rows):
        for each in gathering:
            each.add(row)
    store.write(INDEX, to_text(manifest.index.as_json()))
    report = run_report(manifest, result)
    store.write(REPORT, to_text(report))
    if columns and table:
        with reporting_os_errors(f"{store}/{TABLE}"):
            columns.write(table, manifest.rows)
        store.put(TABLE, table)
    else:
        store.remove(TABLE)  # An older one would describe another run.
    return report


def write_timing(store: Store, result: Result) -> None:
    """Write `timing.json`: how long the run and its steps took, added up over all its workers [s]."""
    steps = dict(result.seconds)
    total = steps.pop("total", 0.0)
    rate = result.made / total if total else None
    told = {"total": total, "per_second": rate, "steps": steps, "manipulators": result.timings[:REPORTED]}
    store.write(TIMING, to_text(told))


MOST_INPUTS = 1000  # input files that are hashed and listed; of a longer list the first ones
CITATION = (
    f"The dh2urdf authors, dh2urdf {__version__}: Denavit-Hartenberg tables as robot descriptions that are provably "
    "the same arm, software under the MIT licence, 2026"
)
HOW_DRAWN = (
    "zero and both ends of the limits, then vectors drawn evenly inside the limits by Python's "
    'random.Random("dh2urdf N"), where N is the number of joints; simulators are asked at the vector nearest to zero '
    "and at the first of these vectors"
)
"""Where joint vectors of proofs and of simulators come from: `dh2urdf.kinematics.proof` draws them."""


def command_line(path: Path, overrides: Sequence[str]) -> str:
    """The command that makes the same files: who works, and where the output goes, makes no difference to them."""
    settings = [word for word in overrides if not word.startswith(("execution.", "output.directory"))]
    return shlex.join(["dh2urdf", "run", str(path), *(part for word in settings for part in ("--set", word))])


def reproduction(
    command: str | None, files: Iterable[Path], recipe: Recipe, variations: Iterable[VariationCall]
) -> Reproduction:
    """What is to be known of a run besides what became of it; the files are read once more, for their hashes."""
    paths = list(files)
    distributions = {call.plugin.distribution.rpartition(" ")[::2] for call in recipe.calls if call.plugin}
    names = ("name", "of", "count", "seed", "sampling")
    drawn: list[Any] = [{name: plain(getattr(call, name)) for name in names} for call in variations]
    stages: Any = [
        {"kind": call.kind, "stage": call.stage.name, "options": plain(call.options)} for call in recipe.calls
    ]
    return {
        "command": command,
        "inputs": [_input(path) for path in paths[:MOST_INPUTS]],
        "inputs_left_out": max(0, len(paths) - MOST_INPUTS),
        "versions": {
            "dh2urdf": __version__,
            "Python": platform.python_version(),
            "numpy": version("numpy"),
            **dict(sorted(each for each in distributions if each[0])),
        },
        "variations": drawn,
        "stages": stages,
        "joint_vectors": HOW_DRAWN,
        "citation": CITATION,
    }


def _input(path: Path) -> InputEntry:
    try:
        with path.open("rb") as file:
            return {"path": str(path), "sha256": file_digest(file, "sha256").hexdigest()}
    except OSError:  # The run says what is wrong with it.
        return {"path": str(path), "sha256": None}
