"""Gives files to the programs that are installed: each program in one child process, each file in a fork of that.

A file of a stranger may crash its reader, keep it busy for ever or take it over. The fork is behind the fence of
`dh2urdf.isolation`, and answers with data. Where a program dies of a file, it gets the next one in a new child.
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

from dh2urdf.errors import CrashError, LoaderError, PluginError
from dh2urdf.isolation import Child, ChildFailure, Data, enter
from dh2urdf.stages import HeldRobot, Inspects, Question
from dh2urdf_check.ask.urdfdom import URDFDOM, command

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import Self

    from dh2urdf.plugin_system.catalog import Catalog

SECONDS = 60.0
"""How long a program may take for one file, and before for its start [s]."""
_OWN = ("dh2urdf", "dh2urdf_check", "dh2urdf_plugins")
"""Our packages: the sentences of messages are files in them."""
End: TypeAlias = Literal["loads", "refuses", "crashes", "unasked"]

_Sent = tuple[str, HeldRobot | None]
_SENT: Data[_Sent] = Data(_Sent)
"""What a child sends: the version of the program, or what it made of a file."""


class Program(NamedTuple):
    """A program that can be given files.

    Attributes:
        consumer: the consumer of `check` that it stands for.
        inspects: how it is given them.
    """

    consumer: str
    inspects: Inspects


class Asked(NamedTuple):
    """A file, and what a program may read to load it.

    Attributes:
        question: what it is given.
        readable: folders and files.
    """

    question: Question
    readable: tuple[Path, ...]


class Answer(NamedTuple):
    """What a program made of a file.

    Attributes:
        program: which one, of `Program`.
        name: its title and version, such as ``MuJoCo 4.0.0``.
        end: whether it loads the file, refuses it, or crashes or hangs on it; ``unasked`` where nobody knows.
        words: what it said when it did not load the file.
        held: what it made of the file.
        complaints: what it printed about the file.
    """

    program: Program
    name: str
    end: End
    words: str = ""
    held: HeldRobot | None = None
    complaints: tuple[str, ...] = ()


def programs(catalog: Catalog, consumers: Sequence[str]) -> list[Program]:
    """The programs that are installed, of all consumers, or of some."""
    found = [
        Program(provided.stage.name, inspects)
        for provided in catalog.provided("loader")
        if (inspects := provided.stage.can(Inspects)) and _is_there(provided.stage)
    ]
    if command():
        found.append(Program("ros", URDFDOM))
    return [program for program in found if not consumers or program.consumer in consumers]


def _is_there(loader: Any) -> bool:  # noqa: ANN401 - a loader of any options
    try:
        loader.require(loader.options())
    except PluginError:
        return False
    return True


class Asking:
    """Programs that are at work on files, beside each other as cores allow; a context, which ends them."""

    def __init__(self, found: Sequence[Program], files: Sequence[Asked]) -> None:
        self._pool = ThreadPoolExecutor(max_workers=max(1, len(os.sched_getaffinity(0))))
        self._respondents = [_Respondent(program) for program in found]
        self._answers = [self._pool.submit(each.answers, files) for each in self._respondents]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for respondent in self._respondents:
            respondent.is_over = True
        self._pool.shutdown(wait=True, cancel_futures=True)

    def answers(self) -> Iterator[tuple[Answer, ...]]:
        """For each file, in order, what the programs made of it that take its format."""
        by_program = [future.result() for future in self._answers]
        yield from (tuple(filter(None, of_file)) for of_file in zip(*by_program, strict=True))


class _Respondent:
    """A program, and the child in which it runs."""

    def __init__(self, program: Program) -> None:
        self.program, self.name, self.is_over = program, program.inspects.title, False
        self._child: Child | None = None

    def answers(self, files: Sequence[Asked]) -> list[Answer | None]:
        """What it makes of some files, one after the other; None of those whose format it does not take."""
        try:
            return [
                self._answer(file) if file.question.format in self.program.inspects.formats else None
                for file in files
                if not self.is_over
            ]
        finally:
            if self._child is not None:
                self._child.end()

    def _answer(self, file: Asked) -> Answer:
        try:
            child = self._ready()
        except Exception as error:  # noqa: BLE001 - whatever an import raises
            return Answer(self.program, self.name, "unasked", f"it does not start: {_words(error)}")
        try:
            given = (self.program.inspects, file.question, file.readable)
            result = child.call(_inspected, given, SECONDS, self.name, _SENT, in_fork=True)
        except LoaderError as error:
            return self._not_loaded("refuses", error, file)
        except CrashError as error:  # also where it does not finish in time
            return self._not_loaded("crashes", error, file)
        except Exception as error:  # noqa: BLE001 - what came of the file is not known
            return self._not_loaded("unasked", error, file)
        said = self._said(result.output, file.question)
        return Answer(self.program, self.name, "loads", held=result.value[1], complaints=said)

    def _said(self, output: str, question: Question) -> tuple[str, ...]:
        """What it printed about a file, with places in that as ``line 12``."""
        said = self.program.inspects.complaints(output)
        path, name = str(question.path), question.path.name
        return tuple(dict.fromkeys(each.replace(f"{path}:", "line ").replace(path, name) for each in said))

    def _ready(self) -> Child:
        """The child, in which the program is imported; a new one where it is gone."""
        if self._child is not None and self._child.is_alive():
            return self._child
        if self._child is not None:
            self._child.end()
        self._child = Child.started()
        prepare = self.program.inspects.prepare
        version, _ = self._child.call(_prepared, (prepare,), SECONDS, self.name, _SENT).value
        self.name = f"{self.program.inspects.title} {version}".rstrip()
        return self._child

    def _not_loaded(self, end: End, error: Exception, file: Asked) -> Answer:
        output = error.__cause__.output if isinstance(error.__cause__, ChildFailure) else ""
        said = self._said(output, file.question)
        words = _words(error).removeprefix(f"{self.name} ") or "; ".join(said) or "it gives no reason"
        if end == "crashes" and said:  # What it says is clearer than the last characters that it printed.
            words = f"{words.partition('; it printed last')[0]}; it printed last: {said[-1]}"
        return Answer(self.program, self.name, end, words, complaints=said)


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
