"""Loads in child processes: each has its own, or a fork of one that has imported the simulator before.

Nothing that a load does may change what is reported of the next manipulator. So a child that is kept only imports its
simulator, and makes every load in a fork of itself. What was printed while the simulator was imported is part of the
output of each load, as if it were the only one.
"""

from __future__ import annotations

import os
import time
from dataclasses import replace
from functools import partial, update_wrapper
from types import NoneType
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.errors import CrashError, LoaderError
from dh2urdf.isolation.child_process import ChildFailure, run_in_child
from dh2urdf.isolation.encodings import Data
from dh2urdf.measuring import load_function
from dh2urdf.plugin_system.calls import a_record, several_records
from dh2urdf.source import Problem
from dh2urdf.stages import LoadReport, Reusable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from dh2urdf.isolation.kept_children import KeptChildren
    from dh2urdf.stages import Loader, LoadRequest

O = TypeVar("O")  # noqa: E741 - the options type of a stage

_REPORT: Data[LoadReport] = Data(LoadReport)  # What reads meshes of unknown origin answers with data.


def load_in_child(
    loader: Loader[O],
    request: LoadRequest,
    options: O,
    who: str | None = None,
    children: KeptChildren | None = None,
) -> LoadReport:
    """Call a loader in a child process and complete its report with what the simulator printed.

    Messages call it `who`, such as ``the loader 'toy' of lab 1.0``. Without `children` that are kept, it has a child
    for this one load.

    Raises:
        CrashError: as `dh2urdf.isolation.child_process.run_in_child`.
        LoaderError: whatever the loader refuses; the findings in the output follow it.
    """
    # The folder of a file in the making has another name in every run.
    folder = f"{request.path.parent}{os.sep}"

    def told(problems: Iterable[Problem], output: str, simulator: str = "") -> Iterator[Problem]:
        """Yield problems and those in the output, without the folder, each with the name of simulator or loader."""
        for problem in (*problems, *several_records(loader.read_output(request, output), Problem)):
            message, names = problem.message.replace(folder, ""), [simulator or loader.name, loader.name]
            is_named = any(name.casefold() in message.casefold() for name in names)
            yield replace(problem, message=message if is_named else f"{names[0]}: {message}")

    try:
        limit = a_record(loader.time_limit(options), int, float, NoneType)
        who = who or f"the loader {loader.name!r}"
        opened = load_function(loader)
        load = update_wrapper(partial(_report, opened), opened)
        reusable = loader.can(Reusable)
        if children is None or reusable is None or limit is None:
            # A person ends one without a limit, by closing its window.
            child = run_in_child(load, request, options, timeout=limit, who=who, encoding=_REPORT)
        else:
            started = time.monotonic()  # A part of the time may be needed for the import.
            with children.child(who, reusable.prepare, (options,), limit) as kept:
                spent = time.monotonic() - started
                child = kept.call(load, (request, options), limit, who, _REPORT, in_fork=True, spent=spent)
    except (LoaderError, CrashError) as error:
        output = error.__cause__.output if isinstance(error.__cause__, ChildFailure) else ""
        raise type(error)(tuple(told(error.problems, output))) from error
    report = child.value
    return replace(
        report,
        joints=tuple(map(_tuples, report.joints)),
        hold=_tuples(report.hold),
        findings=tuple(told(report.findings, child.output, report.simulator)),
        output=child.output.replace(folder, ""),
    )


def _report(load: Callable[[LoadRequest, Any], LoadReport], request: LoadRequest, options: Any) -> LoadReport:  # noqa: ANN401 - of any loader
    """In the child: return what a loader gives, which is a `LoadReport`, or it is at fault."""
    return a_record(load(request, options), LoadReport)


def _tuples(value: Any) -> Any:  # noqa: ANN401 - plain values of a report
    """Return plain values as loaders give them: JSON does not tell vectors and pairs, which are tuples, from lists."""
    if isinstance(value, dict):
        return {name: _tuples(each) for name, each in value.items()}
    if not isinstance(value, list):
        return value
    is_flat = value and not any(isinstance(each, (list, dict)) for each in value)
    return tuple(value) if is_flat else [_tuples(each) for each in value]
