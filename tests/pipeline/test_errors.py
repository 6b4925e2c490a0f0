import inspect
import pickle
from typing import Literal

import pytest

from dh2urdf import errors
from dh2urdf.errors import (
    SCREENFUL,
    BrokenPluginError,
    Dh2UrdfError,
    IncompatiblePluginError,
    InputError,
    ManipulatorError,
    MissingDependencyError,
    MissingProgramError,
    PluginError,
    StageConflictError,
    StageError,
    TableError,
    UnknownStageError,
)
from dh2urdf.source import Mark, Problem

PROBLEM = Problem(message="m", mark=Mark(file="a.csv", line=1), joint="j")


def public_classes() -> set[type[Dh2UrdfError]]:
    return {
        kind
        for name, kind in inspect.getmembers(errors, inspect.isclass)
        if issubclass(kind, Dh2UrdfError) and not name.startswith("_")
    }


EVERY_ERROR = [
    *(
        kind([PROBLEM])
        for kind in sorted(public_classes(), key=lambda kind: kind.__name__)
        if kind.__init__ is Dh2UrdfError.__init__
    ),
    UnknownStageError("emitter", "urfd", ["urdf", "xacro"]),
    StageError("emitter 'urdf'", "KeyError: 'x'", "Traceback …"),
    StageError("emitter 'urdf'", "KeyError: 'x'", plugin="lab = lab.plugin", distribution="lab 1.0"),
    BrokenPluginError("lab = lab.plugin", "lab 1.0", "OSError: gone", "Traceback …"),
    IncompatiblePluginError("lab = lab.plugin", "lab 1.0", "it is made for version 2"),
    StageConflictError("reader", "csv", ["one 1.0", "two 1.0"]),
    MissingDependencyError("loader 'pybullet'", "pybullet", "dh2urdf[pybullet]"),
    MissingProgramError("loader 'gazebo'", "the command gz", "apt-get install gz"),
]
by_name = pytest.mark.parametrize("error", EVERY_ERROR, ids=lambda error: type(error).__name__)


class TestHierarchy:
    def test_every_class_stands_in_the_drawing(self) -> None:
        """The drawing in the module's docstring shows every class."""
        assert errors.__doc__
        for kind in public_classes():
            assert f" {kind.__name__} " in f"{errors.__doc__} ".replace("\n", " ")

    @pytest.mark.parametrize(("parent", "status"), [(InputError, 2), (ManipulatorError, 1), (PluginError, 3)], ids=str)
    def test_every_class_has_the_exit_status_of_its_branch(self, parent: type[Dh2UrdfError], status: int) -> None:
        """Exit status 2 means that nothing could start, 1 that a manipulator failed, 3 that a plugin is broken."""
        branch = {kind for kind in public_classes() if issubclass(kind, parent)}
        assert len(branch) > 1
        assert {kind.exit_status for kind in branch} == {status}

    def test_every_class_belongs_to_one_branch(self) -> None:
        """What dh2urdf raises is an input's, a manipulator's or a plugin's fault, and of one of them only."""
        for kind in public_classes() - {Dh2UrdfError}:
            assert sum(issubclass(kind, parent) for parent in (InputError, ManipulatorError, PluginError)) == 1


@by_name
def test_it_survives_the_way_between_processes(error: Dh2UrdfError) -> None:
    """An error of a worker arrives in its own class, with the same text and all its data."""
    arrived = pickle.loads(pickle.dumps(error))  # noqa: S301 - made here
    assert type(arrived) is type(error)
    assert str(arrived) == str(error)
    assert vars(arrived) == vars(error)


class TestLists:
    def test_a_sentence_is_a_problem(self) -> None:
        """An error can be raised with a sentence, a problem or several."""
        assert TableError("no rows").problems == (Problem(message="no rows"),)
        assert TableError(PROBLEM).problems == (PROBLEM,)
        assert TableError(problem for problem in [PROBLEM, PROBLEM]).problems == (PROBLEM, PROBLEM)

    @pytest.mark.parametrize(("more", "last"), [(1, "and 1 more problem"), (1000, "and 1000 more problems")])
    def test_beyond_a_screenful_they_are_counted(self, more: int, last: str) -> None:
        """A thousand problems do not scroll the first away; none is lost from the data."""
        error = TableError([Problem(message=f"problem {number}") for number in range(SCREENFUL + more)])
        lines = str(error).splitlines()
        assert len(lines) == SCREENFUL + 1
        assert lines[-1] == last
        assert len(error.problems) == SCREENFUL + more

    def test_notices_stand_among_them_in_the_order_of_the_file(self) -> None:
        """What a careful person would look at is said beside what is wrong, and lost on no way to another process."""

        def at(line: int, severity: Literal["error", "notice"]) -> Problem:
            return Problem(message=f"line {line}", severity=severity, mark=Mark(file="a.csv", line=line))

        error = TableError([at(2, "error"), at(4, "error")], [at(1, "notice"), at(3, "notice")])
        for each in (error, pickle.loads(pickle.dumps(error))):  # noqa: S301 - made here
            assert str(each).splitlines() == [
                "a.csv:1: notice: line 1",
                "a.csv:2: error: line 2",
                "a.csv:3: notice: line 3",
                "a.csv:4: error: line 4",
            ]
            assert [problem.message for problem in each.notices] == ["line 1", "line 3"]
