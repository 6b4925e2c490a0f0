"""A run does not write over what it reads: its tables, its run file, its meshes."""

from __future__ import annotations

import os
import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.errors import ConfigError
from dh2urdf.output.journal import MANIFEST
from dh2urdf.output.layouts import Form
from dh2urdf.output.store import WORKING, LocalStore, Store
from dh2urdf.report.manifest import INDEX, PAGE, REPORT, TABLE, TIMING
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.run_file.plan import Plan

say = Messages(__file__)

OWN_FILES = (MANIFEST, TABLE, INDEX, REPORT, TIMING, PAGE)
"""The files of a run beside those of its manipulators."""
_SHARD = re.compile(r"[0-9]{6}\.tar")


def refuse_overwriting(plan: Plan) -> None:
    """Refuses a run that would write over one of its inputs, and protects the others from it.

    Which files a run writes is known before it begins by their names: its own, and those with the endings that its
    emitters declare. The rest, such as the files of a ROS package, the store refuses when it comes.

    Raises:
        ConfigError: a file that the run writes is one that it reads; it names all of them.
    """
    emitters = [call.stage for call in plan.recipe.emitters]
    suffixes = tuple(ending for each in emitters for ending in each.endings)
    pictures = (".png",) if plan.recipe.loaders else ()
    _refuse_overwriting(plan, plan.store, (*suffixes, *pictures), "output.directory")
    if plan.reports is not None:
        _refuse_overwriting(plan, plan.reports, (), "report.directory")


def _refuse_overwriting(plan: Plan, store: Store, suffixes: tuple[str, ...], field: str) -> None:
    if not isinstance(store, LocalStore):
        return
    problems, names = [], set()
    for path in dict.fromkeys(_inputs(plan)):
        own = set(_names_in(store, path))
        names |= own
        if any(
            name.endswith(suffixes)
            or name.startswith(f"{WORKING}/")
            or name in OWN_FILES
            or (plan.layout.form is Form.SHARDS and _SHARD.fullmatch(name))
            for name in own
        ):
            problems.append(say("run-overwrites-input", field=field, found=str(path), path=path, store=str(store)))
    if problems:
        raise ConfigError(problems)
    store.protect(names)


def _inputs(plan: Plan) -> Iterator[Path]:
    """Every file that a run reads, as far as it is known before its tables are read."""
    yield from plan.files
    for path, reader in plan.inputs:
        yield path
        yield from reader.files
    for stage in plan.recipe.calls:
        yield from stage.files
    for call in plan.meshes:
        for shapes in (call.base, *(shapes for _, shapes in call.joints)):
            for shape in (shapes.visual, shapes.collision):
                if shape is not None:
                    yield Path(shape.file.path)


def _names_in(store: LocalStore, path: Path) -> Iterator[str]:
    """Yield the names of a file in the folder of a store, in lower case: by its own path, and by links."""
    root = os.path.realpath(store.directory)
    by_folder = os.path.join(os.path.realpath(path.parent), path.name)  # noqa: PTH118
    for place in dict.fromkeys((by_folder, os.path.realpath(path))):
        name = os.path.relpath(place, root)
        if name != ".." and not name.startswith("../"):
            yield name.casefold()
    for own in OWN_FILES:
        with suppress(OSError, ValueError):
            if os.path.samefile(path, os.path.join(root, own)):  # noqa: PTH118, PTH121
                yield own
