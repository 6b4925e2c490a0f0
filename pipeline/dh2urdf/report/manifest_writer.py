"""The rows of a run while they come: into its manifest, and past all who gather something from them."""

from __future__ import annotations

from typing import TYPE_CHECKING, BinaryIO

from dh2urdf.output.whole_files import reporting_os_errors, write_all
from dh2urdf.report.axes import AxesOfRun
from dh2urdf.report.verdicts import Verdicts
from dh2urdf.tasks.failure_index import FailureIndex

if TYPE_CHECKING:
    from dh2urdf.report.overview import Overview
    from dh2urdf.results import Reproduction
    from dh2urdf.tasks.batch_report import BatchReport
    from dh2urdf.tasks.manifest_table import ManifestTable

REPORTED = 1000
"""Manipulators that the report repeats from the manifest: the first ones; `timing.json` has as many."""


class ManifestWriter:
    """The manifest of a run on its way.

    Everything is gathered in the process of the run while its workers work, so that nothing is left to do afterwards.

    Attributes:
        rows: the manifest, open to write and to read.
        reproduction: what is needed to do the run again.
        verdicts: what simulators say.
        index: what failed, and why.
        axes: what the axes of its tables say.
        table: the manifest as a table, where there will be one.
        overview: what the page for people says, where there will be one.
    """

    def __init__(self, rows: BinaryIO, place: str, told: Reproduction, verdicts: Verdicts | None = None) -> None:
        """Begin a manifest.

        Args:
            rows: an empty file.
            place: where the manifest will be, which errors name.
            told: what is needed to do the run again.
            verdicts: gathers what simulators say; None where none is asked.
        """
        self.rows, self.reproduction = rows, told
        self.verdicts = verdicts or Verdicts({})
        self.index = FailureIndex()
        self.axes = AxesOfRun(REPORTED)
        self.table: ManifestTable | None = None
        self.overview: Overview | None = None
        self._place = place

    def add(self, report: BatchReport) -> None:
        """Take the rows of a batch.

        Raises:
            OutputError: they cannot be written.
        """
        with reporting_os_errors(self._place):
            write_all(self.rows.fileno(), report.rows)
        self.index.add_ok(report.count - len(report.told))
        for row in report.told:
            self.index.add(row)
            self.verdicts.add(row)
            if self.overview:
                self.overview.add(row)
        if self.table and report.table:
            with reporting_os_errors(self.table.place):
                self.table.add(report.table)
