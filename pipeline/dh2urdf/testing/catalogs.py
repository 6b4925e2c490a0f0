"""Stages without discovery, and a run of them in a temporary folder."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from dh2urdf.hookspecs import hookimpl
from dh2urdf.plugin_system.catalog import KINDS, Catalog, Plugin
from dh2urdf.plugin_system.records import RECORDS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.stages import Stage


def catalog_of(*stages: Stage, plugins: tuple[Any, ...] = ()) -> Catalog:
    """A catalog of some stages and plugins, and of nothing that happens to be installed.

    Args:
        stages: records of any kind.
        plugins: modules with hooks, such as ``dh2urdf_plugins`` for the built-in stages.
    """
    by_kind = {kind: tuple(stage for stage in stages if isinstance(stage, RECORDS[kind])) for kind in KINDS}
    hooks = {f"dh2urdf_{kind}s": hookimpl(lambda some=some: some) for kind, some in by_kind.items()}
    found = [Plugin(name="stages of a test", module=SimpleNamespace(**hooks), distribution="a test")]
    found += [Plugin(name=module.__name__, module=module, distribution=module.__name__) for module in plugins]
    return Catalog(found)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOutput:
    """What a run wrote.

    Attributes:
        folder: its output folder.
        exit_status: that of `dh2urdf run`: 0 where all is done, 1 where a manipulator failed.
        report: the content of its report.json.
    """

    folder: Path
    exit_status: int
    report: dict[str, Any]


def do_run(folder: Path, run_file: str, tables: Mapping[str, str | bytes], catalog: Catalog | None = None) -> RunOutput:
    """A run from a run file, as `dh2urdf run` does it, in this process.

    Args:
        folder: where the run file and the tables are written, and the output goes, under ``build``.
        run_file: the text of the run file, without a section `output`; without a section `report`, no report.html is
            written, which takes a second.
        tables: the contents of the files that it names.
        catalog: the stages; by default all that are installed.

    Raises:
        Dh2UrdfError: whatever keeps the run from starting.
    """
    from dh2urdf.plugin_system.catalog import load
    from dh2urdf.run_file.config import load_config
    from dh2urdf.run_file.plan import make_plan
    from dh2urdf.running.run import execute

    for name, content in tables.items():
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    path, build = folder / "run.yaml", folder / "build"
    page = "" if re.search(r"^report:", run_file, re.MULTILINE) else "report: {html: false}\n"
    path.write_text(f"{run_file}\noutput: {{directory: build}}\n{page}", "utf-8")
    result, _ = execute(make_plan(load_config(path), catalog or load()))
    report = json.loads((build / "report.json").read_bytes())
    return RunOutput(folder=build, exit_status=result.exit_status, report=report)
