"""Gives files to the programs that are installed: each program in one child process, each file in a fork of that.

A file of a stranger may crash its reader, keep it busy for ever or take it over. The fork is behind the fence of
`dh2urdf.isolation`, and answers with data. Where a program dies of a file, it gets the next one in a new child.
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

from dh2urdf.errors import CrashError, LoaderError, PluginError
from dh2urdf.isolation import ChildFailure, Data, KeptChildren, enter
from dh2urdf.stages import HeldRobot, Inspects, Question
from dh2urdf_check.ask.urdfdom import URDFDOM, command

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.plugin_system.catalog import Catalog

SECONDS = 60.0
"""How long a program may take for one file, and before for its start [s]."""
_OWN = ("dh2urdf", "dh2urdf_check", "dh2urdf_plugins")
"""Our packages: the sentences of messages are files in them."""
End: TypeAlias = Literal["loads", "refuses", "crashes", "unasked"]
"""What came of a file; a program that hangs on it crashes, and of one that was not asked nobody knows."""

_Sent = tuple[str, HeldRobot | None]
_SENT: Data[_Sent] = Data(_Sent)
"""What a child sends: the version of the program, or what it made of a file."""


class Program(NamedTuple):
    """A program that can be given files: the consumer of `check` that it stands for, and how it is given them."""

    consumer: str
    inspects: Inspects


class Asked(NamedTuple):
    """A file, and the folders and files that a program may read to load it."""

    question: Question
    readable: tuple[Path, ...]


class Answer(NamedTuple):
    """What a program made of a file."""

    program: Program
    name: str  # its title and version, such as MuJoCo 4.0.0
    end: End
    words: str = ""  # what it said when it did not load the file
    held: HeldRobot | None = None
    complaints: tuple[str, ...] = ()  # what it printed about the file


def programs(catalog: Catalog, consumers: Sequence[str]) -> list[Program]:
    """The programs that are installed, of all consumers, or of some."""
    found = []
    for provided in catalog.provided("loader"):
        loader = provided.stage
        if inspects := loader.can(Inspects):
            with suppress(PluginError):  # It is not installed.
                loader.require(loader.options())
                found.append(Program(loader.name, inspects))
    if command():
        found.append(Program("ros", URDFDOM))
    return [program for program in found if not consumers or program.consumer in consumers]


@contextmanager
def answering(found: Sequence[Program], files: Sequence[Asked]) -> Iterator[Iterator[tuple[Answer, ...]]]:
    """Programs at work on files, beside each other as cores allow; a context, which ends them.

    It yields for each file, in order, the answers of the programs that take its format.
    """
    is_over, pool = Event(), ThreadPoolExecutor(max_workers=max(1, len(os.sched_getaffinity(0))))
    at_work = [pool.submit(_Respondent(program).answers, files, is_over) for program in found]

    def answers() -> Iterator[tuple[Answer, ...]]:
        by_program = [future.result() for future in at_work]
        yield from (tuple(filter(None, of_file)) for of_file in zip(*by_program, strict=True))

    try:
        yield answers()
    finally:
        is_over.set()
        pool.shutdown(wait=True, cancel_futures=True)


class _Respondent:
    """A program, and the child in which it runs."""

    def __init__(self, program: Program) -> None:
        self._program, self._name = program, program.inspects.title
        self._children = KeptChildren()

    def answers(self, files: Sequence[Asked], is_over: Event) -> list[Answer | None]:
        """What it makes of some files, one after the other; None of those whose format it does not take."""
        with self._children:
            return [
                self._answer(file) if file.question.format in self._program.inspects.formats else None
                for file in files
                if not is_over.is_set()
            ]

    def _answer(self, file: Asked) -> Answer:
        inspects, failure, held, is_ready = self._program.inspects, None, None, False
        end: End = "loads"
        try:
            with self._children.child(self._name, _prepared, (inspects.prepare,), SECONDS, _SENT) as child:
                (version, _), is_ready = child.prepared[0], True
                self._name = f"{inspects.title} {version}".rstrip()
                given = (inspects, file.question, file.readable)
                result = child.call(_inspected, given, SECONDS, self._name, _SENT, in_fork=True)
            output, held = result.output, result.value[1]
        except Exception as error:  # noqa: BLE001 - whatever an import or a file makes it raise
            if not is_ready:
                return Answer(self._program, self._name, "unasked", f"it does not start: {_words(error)}")
            end = "refuses" if isinstance(error, LoaderError) else "unasked"
            end = "crashes" if isinstance(error, CrashError) else end  # also where it does not finish in time
            failure, output = error, error.__cause__.output if isinstance(error.__cause__, ChildFailure) else ""
        path, name = str(file.question.path), file.question.path.name
        printed = (each.replace(f"{path}:", "line ").replace(path, name) for each in inspects.complaints(output))
        said, words = tuple(dict.fromkeys(printed)), ""
        if failure is not None:
            words = _words(failure).removeprefix(f"{self._name} ") or "; ".join(said) or "it gives no reason"
        if end == "crashes" and said:  # What it says is clearer than the last characters that it printed.
            words = f"{words.partition('; it printed last')[0]}; it printed last: {said[-1]}"
        return Answer(self._program, self._name, end, words, held, said)


def _words(error: Exception) -> str:
    problems = getattr(error, "problems", None)
    return str(error) if problems is None else "; ".join(problem.message for problem in problems)


def _prepared(prepare: Callable[[], str]) -> _Sent:
    """In the child: import the program and all that the forks need."""
    import resource  # noqa: F401

    import landlock  # noqa: F401 - nothing can be imported behind the fence

    return prepare(), None


def _inspected(inspects: Inspects, question: Question, readable: Sequence[Path]) -> _Sent:
    """In a fork of the child: give a file to the program, behind the fence, where packages can be read."""
    packages = [Path(folder) for folder in sys.path if folder.endswith("-packages")]
    own = [Path(str(sys.modules[name].__file__)).parent for name in _OWN if name in sys.modules]
    enter((*readable, *packages, *own), SECONDS, starts_program=inspects.starts_program)
    return "", inspects.inspect(question)
