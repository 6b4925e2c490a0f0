"""The work of a run: what a worker does with a batch of manipulators.

Manipulators that differ in numbers only are made side by side, a hundred times as fast, where every stage can; the
rest, and whatever there is something to say about, is made one by one. The bytes are the same either way.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from dh2urdf.isolation.process import collected_at_the_end, this_process
from dh2urdf.plugin_system.attribution import collected_lines
from dh2urdf.running.batch_work import Assignment, Work
from dh2urdf.stage_calls.calls import own_work

if TYPE_CHECKING:
    from dh2urdf.tasks.batch import Batch
    from dh2urdf.tasks.batch_report import BatchReport


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchWorker(Assignment):
    """Makes batches, in whatever process.

    What is wrong with a manipulator fails it alone; what is wrong with the run, such as a full disk, is raised.
    """

    @property
    def distributions(self) -> tuple[str, ...]:
        """The distributions whose stages are used: see `dh2urdf.stages.Executor`."""
        return tuple(sorted({call.plugin.distribution_name for call in self.recipe.calls if call.plugin}))

    def __call__(self, batch: Batch) -> BatchReport:
        """Make a batch, and put it in its place."""
        is_worker = self.home != this_process()
        kept = self.children.kept(is_worker=is_worker)
        with kept, own_work(), collected_at_the_end(), collected_lines(is_worker=is_worker) as lines:
            report = Work(self, batch).done()
        return replace(report, printed=tuple(lines))
