"""The stages that a run file asks for: found in the catalog, with their options, or what is wrong with each."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from dh2urdf.documents.text_files import LONG_PATH
from dh2urdf.errors import InputError, PluginError
from dh2urdf.plugin_system.options import make_options
from dh2urdf.source import Problem, shown
from dh2urdf.stage_calls.calls import Call

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.run_file.records import InputCall, StageCall
    from dh2urdf.source import Mark
    from dh2urdf.stages import Emitter, Loader, Reader


class AskedStages:
    """Finds stages, and gathers what is wrong.

    Attributes:
        problems: all that is wrong, each with its place in the run file.
        notices: the findings about inputs, by the path of the file that says it: named twice, or by a pattern that
            could not be searched everywhere.
    """

    def __init__(self, catalog: Catalog, problems: Iterable[Problem], folder: Path) -> None:
        self.problems = list(problems)
        self.notices: dict[Path, Problem] = {}
        self._catalog = catalog
        self._folder = folder

    def call(self, kind: Any, asked: StageCall) -> Call[Any] | None:  # noqa: ANN401 - a kind of stage
        """The stage of a kind with its options; None where something is wrong.

        Raises:
            PluginError: the plugin that it needs is broken, or several claim its name; the error has the place.
        """
        with self._at(asked.mark):
            stage = self._catalog.get(kind, asked.stage) if asked.stage else self._catalog.usual(kind)
            plugin = self._catalog.plugin_of(stage)
            where = f"{kind} {stage.name!r}"
            given, folder = asked.options, self._folder
            options = make_options(stage.options, given, mark=asked.mark, where=where, plugin=plugin, folder=folder)
            return Call(stage=stage, options=options, plugin=plugin)
        return None

    def calls(self, kind: Any, asked: Sequence[StageCall]) -> list[Call[Any] | None]:  # noqa: ANN401 - a kind of stage
        """Stages of a kind, each name once: files and reports are named by these names."""
        calls = [self.call(kind, each) for each in asked]
        first: dict[str, StageCall] = {}
        for given, call in zip(asked, calls, strict=True):
            if call is not None and (other := first.setdefault(call.stage.name, given)) is not given:
                self.problems.append(
                    Problem(
                        message=f"the {call.kind} {call.stage.name!r} stands twice in one run",
                        mark=given.mark,
                        field=f"{call.kind}s",
                        found=call.stage.name,
                        accepted="each name once",
                        suggestion=f"it stands first at {other.mark}",
                    )
                )
        return calls

    def readers(self, inputs: Iterable[InputCall]) -> tuple[tuple[Path, Call[Reader[Any]]], ...]:
        """Every input file once with its reader: the one that is named, or that of its suffix."""
        found: list[tuple[Path, Call[Reader[Any]]]] = []
        first: dict[tuple[int, int], tuple[Path, Call[Reader[Any]], Mark | None]] = {}
        for given in inputs:
            self.notices.update((path, notice) for path, notice in zip(given.paths, given.notices, strict=False))
            calls: dict[str, Call[Reader[Any]] | None] = {}
            before = len(self.problems)
            for path in given.paths:
                if len(self.problems) > before:
                    break  # What is wrong with a file is often wrong with all files of this input.
                with self._at(given.mark):
                    name = given.stage or self._catalog.reader_for(path).name
                    if name not in calls:
                        calls[name] = self.call("reader", given.read_by(name))
                    if (call := calls[name]) is None:
                        break
                    status = path.stat()
                    earlier = first.setdefault((status.st_dev, status.st_ino), (path, call, given.mark))
                    if earlier[0] is path:
                        found.append((path, call))
                    else:
                        alike = (call.stage, call.options) == (earlier[1].stage, earlier[1].options)
                        self._note_again(earlier[0], given.mark, earlier[2], alike=alike)
        return tuple(found)

    def _note_again(self, path: Path, mark: Mark | None, first: Mark | None, *, alike: bool) -> None:
        """Notes that a file is an input a second time: once is enough, unless the two are read in different ways."""
        problem = Problem(
            message=f"{shown(str(path), LONG_PATH)} is an input twice{', and is read once' if alike else ''}",
            severity="notice" if alike else "error",
            mark=mark,
            field="inputs",
            found=None if alike else str(path),
            accepted=None if alike else "each file once, with one reader and its options",
            suggestion=f"the first time is at {first}" if first != mark else None,
        )
        if alike:
            self.notices.setdefault(path, problem)
        else:
            self.problems.append(problem)

    def check_loaders(
        self,
        asked: Sequence[StageCall],
        loaders: Sequence[Call[Loader[Any]] | None],
        asked_emitters: Sequence[StageCall],
        emitters: Sequence[Call[Emitter[Any]] | None],
    ) -> None:
        """Every loader takes a file that the run writes."""
        both = zip(asked_emitters, emitters, strict=True)
        formats = [call.stage.name if call else each.stage or "" for each, call in both]
        for each, loader in zip(asked, loaders, strict=True):
            if loader is not None and not set(loader.stage.formats) & set(formats):
                self.problems.append(
                    Problem(
                        message=f"the loader {loader.stage.name!r} has no file to load",
                        mark=each.mark,
                        field="loaders",
                        found=", ".join(formats),
                        accepted=f"one of the emitters {', '.join(loader.stage.formats)} in the section `emitters`",
                    )
                )

    @contextmanager
    def _at(self, mark: Mark | None) -> Iterator[None]:
        """Problems with what a place asks for are reported with the place."""
        try:
            yield
        except InputError as error:
            self.problems += [problem.about(mark=mark) for problem in error.problems]
        except PluginError as error:
            error.mark = error.mark or mark
            raise
