"""What can go wrong, and the exit status that it means.

::

    Dh2UrdfError
    ├── InputError ................ exit 2: nothing could start
    │   ├── ConfigError              a run file or a word of the command line is wrong
    │   ├── TableError               a table cannot be read
    │   │   └── RecordError          a record, or a joint vector, made in Python cannot be used
    │   │       ├── RecordTypeError  a value has the wrong type; also a TypeError
    │   │       └── RecordValueError a value is wrong; also a ValueError
    │   ├── OutputError              nothing can be written where it should go
    │   ├── ExecutorError            nobody does the work: no worker can be started or reached, or all are gone
    │   └── UnknownStageError        no installed stage has the name
    ├── ManipulatorError .......... exit 1: this manipulator failed, others go on
    │   ├── TransformError           the transform refuses the manipulator
    │   ├── EditError                an edit refuses the table or the robot
    │   ├── RobotError               the finished robot breaks a rule
    │   ├── EmitterError             no file could be made of the robot
    │   ├── ProofError               what was written is not the arm of the table
    │   ├── LoaderError              a simulator refused the file or measured another arm
    │   ├── CrashError               whatever worked on it crashed or left without a result
    │   │   └── TimeLimitError       it did not finish in time
    │   └── StageError               a stage raised what it should not have raised
    └── PluginError ............... exit 3: the run needs a plugin that is broken
        ├── BrokenPluginError        it failed while it was imported, registered or run
        │   └── IncompatiblePluginError  it is made for another version of the plugin interface
        ├── StageConflictError       two plugins claim one stage name
        ├── MissingDependencyError   an optional package is not installed
        └── MissingProgramError      a program besides Python's packages is not installed, or not running

`TableWarning` is no error: it is what a careful person would look at, as Python's warning.

Every exception carries its data as attributes; its text says where, what was found, what is accepted and what to do.
"""

from __future__ import annotations

import sys
from functools import partial
from typing import TYPE_CHECKING, ClassVar

from dh2urdf.source import Messages, Problem, did_you_mean, in_file_order

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from dh2urdf.source import Mark

say = Messages(__file__)

SCREENFUL = 20
"""Problems that one message spells out; the rest are counted."""


class Dh2UrdfError(Exception):
    """Anything that dh2urdf itself raises.

    Attributes:
        exit_status: the status with which the command line ends on this error.
    """

    exit_status: ClassVar[int] = 2


class _ProblemsError(Dh2UrdfError):
    """An error that is a list of problems.

    Attributes:
        problems: all that was found, in the order of the file.
        notices: what a careful person would look at besides, in the order of the file.
    """

    def __init__(self, problems: Problem | str | Iterable[Problem], notices: Iterable[Problem] = ()) -> None:
        if isinstance(problems, str):
            problems = Problem(message=problems)
        self.problems = _several(self, (problems,) if isinstance(problems, Problem) else problems)
        self.notices = _several(self, notices)
        # The arguments are what pickle hands to __init__ again.
        super().__init__(self.problems, *([self.notices] if self.notices else []))

    def __str__(self) -> str:
        listed = [*self.notices[:SCREENFUL], *self.problems[:SCREENFUL]]
        lines = [str(problem) for problem in (in_file_order(listed) if self.notices else listed)]
        for problems, what in ((self.problems, "problem"), (self.notices, "notice")):
            if (more := len(problems) - SCREENFUL) > 0:
                lines.append(f"and {more} more {what}{'s' if more > 1 else ''}")
        return "\n".join(lines)


def _several(error: Exception, problems: Iterable[Problem]) -> tuple[Problem, ...]:
    """Raises a TypeError where problems are something else: code that prints them could not."""
    found = tuple(problems)
    for problem in found:
        if not isinstance(problem, Problem):
            raise TypeError(f"{type(error).__name__} was made of {problem!r:.60}, not of a text or of Problems")
    return found


_LONGEST_REASON = 200


class InputError(_ProblemsError):
    """What the user gave cannot be used, so nothing could start."""


class ConfigError(InputError):
    """A run file or the command line is wrong."""


class TableError(InputError):
    """A table cannot be read."""


class RecordError(TableError):
    """A record made in Python cannot be: a table, a row, a part of one, or a joint vector.

    Every field that is wrong is one of the problems. What is raised is a `RecordTypeError` or a `RecordValueError`.
    """


class RecordTypeError(RecordError, TypeError):
    """A value in a record has a type that its field does not accept."""


class RecordValueError(RecordError, ValueError):
    """A value in a record is none that its field accepts, or contradicts another one."""


class TableWarning(UserWarning):
    """A notice of a table or of its robot, as `dh2urdf.read`, `Manipulator.from_dh` and `dh2urdf.convert` warn of it.

    ``warnings.filterwarnings("ignore", category=dh2urdf.TableWarning)`` turns them off; `notices` still has them.
    """


class OutputError(InputError):
    """Nothing can be written where it should go: no permission, no space, not a folder."""


class ExecutorError(InputError):
    """Nobody does the work: no worker can be started or reached, none is fit for it, or all are gone."""


class UnknownStageError(InputError):
    """No installed stage has the name.

    Attributes:
        kind: the kind of stage asked for, such as ``emitter``.
        name: the name asked for.
        installed: the names that are installed.
    """

    def __init__(self, kind: str, name: str, installed: Sequence[str]) -> None:
        self.kind, self.name, self.installed = kind, name, tuple(installed)
        there, near = ", ".join(sorted(installed)) or f"nothing: no {kind} is installed", did_you_mean(name, installed)
        super().__init__(say("stage-unknown", found=name, kind=kind, installed=there, suggestion=near))

    def __reduce__(self) -> tuple[type[UnknownStageError], tuple[str, str, tuple[str, ...]]]:
        return type(self), (self.kind, self.name, self.installed)


class ManipulatorError(_ProblemsError):
    """One manipulator failed; others are not concerned."""

    exit_status = 1


class TransformError(ManipulatorError):
    """The transform refuses the manipulator."""


class EditError(ManipulatorError):
    """An edit refuses the table or the robot."""


class RobotError(ManipulatorError):
    """The finished robot breaks a rule that the readers of robot descriptions rely on."""


class EmitterError(ManipulatorError):
    """No file could be made of the robot."""


class ProofError(ManipulatorError):
    """The forward kinematics of what was written differs from the DH product."""


class LoaderError(ManipulatorError):
    """A simulator refused the file, or measured another arm."""


class CrashError(ManipulatorError):
    """The process that worked on the manipulator crashed, was killed, or left without a result."""


class TimeLimitError(CrashError):
    """The process that worked on the manipulator did not finish in time, and was ended."""


class StageError(ManipulatorError):
    """A stage raised something that is not an error of dh2urdf: a fault of the stage, not of the table.

    Attributes:
        stage: kind and name, such as ``emitter 'urdf'``.
        reason: what it raised.
        traceback: the traceback as text, for ``--debug``.
        plugin: the entry point of the plugin that provides the stage; empty where it came from none.
        distribution: name and version of the plugin's distribution; empty where it came from none.
    """

    def __init__(
        self, stage: str, reason: str, traceback: str = "", *, plugin: str = "", distribution: str = ""
    ) -> None:
        self.stage, self.reason, self.traceback = stage, reason, traceback
        self.plugin, self.distribution = plugin, distribution
        of, whom = f" of {distribution}" if plugin else "", "the stage's authors"
        if plugin:
            whom = f"the authors of {distribution} (plugin {plugin!r})"
        super().__init__(say("stage-failed", stage=stage, of=of, reason=reason, whom=whom))

    def __reduce__(self) -> tuple[Callable[..., StageError], tuple[str, ...]]:
        made = partial(type(self), plugin=self.plugin, distribution=self.distribution)
        return made, (self.stage, self.reason, self.traceback)


class PluginError(Dh2UrdfError):
    """The run needs a plugin that does not work.

    Attributes:
        mark: where the run file asks for it; None where it does not.
    """

    exit_status = 3
    mark: Mark | None = None

    def __str__(self) -> str:
        return str(self.problem) if self.mark else self.problem.message

    @property
    def problem(self) -> Problem:
        """What is wrong with the plugin, and what to do."""
        return Problem(message=super().__str__(), mark=self.mark)


class BrokenPluginError(PluginError):
    """A plugin failed while it was imported, registered or run.

    Attributes:
        plugin: the plugin's entry point or module.
        distribution: name and version of the distribution that provides it.
        reason: what it raised.
        traceback: the traceback as text, for ``--debug``.
    """

    def __init__(self, plugin: str, distribution: str, reason: str, traceback: str = "") -> None:
        self.plugin, self.distribution, self.reason, self.traceback = plugin, distribution, reason, traceback
        super().__init__(plugin, distribution, reason, traceback)

    @property
    def problem(self) -> Problem:
        """What is wrong with the plugin, and what to do."""
        name, about = self.plugin.partition(" = ")[0], {"plugin": self.plugin, "distribution": self.distribution}
        return say("plugin-broken", self.mark, reason=self.reason, name=name, **about)


class IncompatiblePluginError(BrokenPluginError):
    """A plugin is made for another version of the plugin interface; nothing of it was imported.

    Attributes:
        reason: for which version it is made, which one this is, and what to do.
    """

    @property
    def problem(self) -> Problem:
        """What is wrong with the plugin, and what to do."""
        about = {"plugin": self.plugin, "distribution": self.distribution}
        return say("plugin-incompatible", self.mark, reason=self.reason, **about)


class StageConflictError(PluginError):
    """Two plugins claim one stage name, and it is not said which is meant.

    Attributes:
        kind: the kind of stage.
        name: the name that both claim.
        distributions: who claims it: name and version of each.
    """

    def __init__(self, kind: str, name: str, distributions: Sequence[str]) -> None:
        self.kind, self.name, self.distributions = kind, name, tuple(distributions)
        super().__init__(kind, name, tuple(distributions))

    @property
    def choices(self) -> tuple[str, ...]:
        """The unambiguous name of each, such as ``lab-tools:csv``; none where they are of one distribution."""
        names = [distribution.partition(" ")[0] for distribution in self.distributions]
        return tuple(f"{name}:{self.name}" for name in names) if len(set(names)) == len(names) else ()

    @property
    def problem(self) -> Problem:
        """What is wrong with the plugins, and what to do."""
        choice = f"say which is meant: {' or '.join(self.choices)}; or" if self.choices else "to choose,"
        owners = " and by ".join(self.distributions)
        return say("stage-claimed-twice", self.mark, kind=self.kind, name=self.name, owners=owners, choice=choice)


def pip_install(requirement: str) -> str:
    """Return the command that installs a package for the Python that runs, whichever `pip` comes first in PATH."""
    from shlex import quote

    return f"{quote(sys.executable)} -m pip install '{requirement}'"


class MissingDependencyError(PluginError):
    """A stage needs an optional package that is not installed, or that lacks a library of the system.

    Args:
        stage: kind and name, such as ``loader 'pybullet'``.
        package: what is missing.
        extra: the extra of this distribution that installs it, such as ``dh2urdf[pybullet]``.
        reason: why the package is of no use where it is installed, or what an attempt to import it raised.

    Attributes:
        stage, package, extra: as given.
        reason: why the package is of no use; empty where it is not installed.
    """

    def __init__(self, stage: str, package: str, extra: str, reason: str | ImportError = "") -> None:
        if isinstance(reason, ModuleNotFoundError):
            reason = ""
        self.stage, self.package, self.extra = stage, package, extra
        self.reason = " ".join(str(reason).split())[:_LONGEST_REASON]
        super().__init__(stage, package, extra, self.reason)

    @property
    def problem(self) -> Problem:
        """What is missing, and what to do."""
        about = {"stage": self.stage, "package": self.package}
        if self.reason:
            return say("package-unusable", self.mark, reason=self.reason, **about)
        return say("package-missing", self.mark, command=pip_install(self.extra), **about)


class MissingProgramError(PluginError):
    """A stage needs a program that no Python package brings, and it is not installed or not running.

    Attributes:
        stage: kind and name, such as ``loader 'gazebo'``.
        program: what is missing.
        remedy: how to install or start it.
    """

    def __init__(self, stage: str, program: str, remedy: str) -> None:
        self.stage, self.program, self.remedy = stage, program, remedy
        super().__init__(stage, program, remedy)

    @property
    def problem(self) -> Problem:
        """What is missing, and what to do."""
        return say("program-missing", self.mark, stage=self.stage, program=self.program, remedy=self.remedy)
