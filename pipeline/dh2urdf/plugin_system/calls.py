"""Calls of stages, what they answer, and whose fault it is when one fails: a stage's function may do anything.

What a stage refuses in an error of `dh2urdf.errors` goes on as it is, with the name of a plugin's stage in front where
nothing else tells which stage that is. Anything else is a fault of the stage, and told with the plugin, its
distribution and its version: as a `StageError` where it concerns one manipulator, as a `BrokenPluginError` where the
whole run depends on it. So is an answer that is not what `dh2urdf.stages` says.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from dh2urdf import stages
from dh2urdf.errors import (
    BrokenPluginError,
    Dh2UrdfError,
    ExecutorError,
    InputError,
    ManipulatorError,
    MissingDependencyError,
    MissingProgramError,
    OutputError,
    ProofError,
    RecordError,
    RecordTypeError,
    StageError,
    TableError,
    TableWarning,
)
from dh2urdf.isolation.attribution import UNKNOWN, Attribution, current, reason_of, traceback_of
from dh2urdf.plugin_system.catalog import KINDS, Catalog, Plugin, load, load_plugin
from dh2urdf.plugin_system.options import make_options
from dh2urdf.source import listed, shown
from dh2urdf.stages import EmittedFile

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf.source import Mark, Problem
    from dh2urdf.stages import Edit, Emitter, Executor, Kind, Loader, Reader, Transform

S = TypeVar("S", "Reader[Any]", "Transform[Any]", "Edit[Any]", "Emitter[Any]", "Loader[Any]", "Executor[Any]")
T = TypeVar("T")

_OWN = "raised by dh2urdf itself, not by a stage"


@dataclass(frozen=True, slots=True, kw_only=True)
class Call(Generic[S]):
    """A stage with the options that this run gives it, and the plugin that provides it, where a catalog knows one.

    To another process it goes by name: a worker has the same plugins installed, and no stage need be picklable. It
    finds the stage in the same plugin, and imports no other.
    """

    stage: S
    options: Any
    plugin: Plugin | None = field(default=None, repr=False)

    @property
    def kind(self) -> Kind:
        """The kind of the stage."""
        for kind in KINDS:
            if isinstance(self.stage, getattr(stages, kind.capitalize())):
                return kind
        raise TypeError(self.stage)

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that the options name."""
        given = [getattr(self.options, each.name) for each in fields(self.options)]
        return tuple([value for value in given if isinstance(value, Path)])

    def __str__(self) -> str:
        return f"{self.kind} {self.stage.name!r}"

    @property
    def attribution(self) -> Attribution:
        """A context in which the stage is called."""
        return Attribution(str(self), self.plugin)

    def __reduce__(self) -> tuple[Callable[..., Call[Any]], tuple[Any, ...]]:
        is_installed = self.plugin is not None and self.plugin.is_installed
        whose = (self.plugin.name, self.plugin.distribution_name) if self.plugin and is_installed else None
        import pickle

        with depending_on(self, "options"):
            return _installed_call, (whose, self.kind, self.stage.name, pickle.dumps(self.options))


def default_call(catalog: Catalog, stage: S) -> Call[S]:
    """Return a stage of a catalog with its default options."""
    return Call(stage=stage, options=stage.options(), plugin=catalog.plugin_of(stage))


def call_of(catalog: Catalog, stage: S, given: Any, mark: Mark | None = None, folder: Path | None = None) -> Call[S]:  # noqa: ANN401
    """Return a stage of a catalog with the options that a user gives it; see `make_options`."""
    call = Call(stage=stage, options=None, plugin=catalog.plugin_of(stage))
    options = make_options(stage.options, given, mark=mark, where=str(call), plugin=call.plugin, folder=folder)
    return replace(call, options=options)


def _installed_call(whose: tuple[str, str] | None, kind: Kind, name: str, options: bytes) -> Call[Any]:
    import pickle

    catalog = _catalog(whose)
    stage: Any = catalog.get(kind, name)
    call = Call(stage=stage, options=None, plugin=catalog.plugin_of(stage))
    with depending_on(call, "options"):
        return replace(call, options=pickle.loads(options))  # noqa: S301 - our own parent sent them


@cache
def _catalog(whose: tuple[str, str] | None) -> Catalog:
    return load_plugin(*whose) if whose else load()


# --- Whose fault it is ------------------------------------------------------------------------------------------------


@contextmanager
def blaming(call: Call[Any], what: str = "") -> Iterator[None]:
    """Turn whatever a stage raises about one manipulator, unless it is an error of dh2urdf, into one that names it.

    `what` is asked of the stage, where that is not its work itself, such as ``notices``.

    Raises:
        StageError: the stage raised something else.
    """
    try:
        with call.attribution:
            yield
    except (KeyboardInterrupt, MissingDependencyError, MissingProgramError, StageError):
        raise
    except (InputError, ManipulatorError) as error:
        if _is_fault(error, call):
            raise fault(call, error, what) from error
        if call.plugin and not call.plugin.is_builtin and call.kind not in ("reader", "loader"):
            # A run may have five emitters with the same table. Problems of a reader are in its file, and the errors of
            # a loader have its name already.
            name = f"{f'`{what}` of the ' if what else ''}{call.attribution}: "
            named = [
                each if name in each.message else replace(each, message=name + each.message) for each in error.problems
            ]
            if error.args[:1] == (error.problems,):  # what pickle makes it of again
                error.args = (tuple(named), *error.args[1:])
            error.problems = tuple(named)
        raise
    except BaseException as error:
        raise fault(call, error, what) from error


def _is_fault(error: InputError | ManipulatorError, call: Call[Any]) -> bool:
    """Whether an error of dh2urdf is nothing that a stage may refuse a manipulator with."""
    if isinstance(error, ExecutorError) or not getattr(error, "problems", ()):
        return True
    if call.kind == "reader":
        # A reader makes the records of a table, whose values come from the file. Their types do not.
        return isinstance(error, RecordTypeError) and call.plugin is not None and not call.plugin.is_builtin
    return isinstance(error, (RecordError, OutputError))


def fault(call: Call[Any], error: BaseException, what: str = "") -> StageError:
    """Return the error that says which stage failed at a manipulator, and how."""
    plugin = call.plugin
    return StageError(
        f"`{what}` of the {call}" if what else str(call),
        reason_of(error),
        traceback_of(error),
        plugin=plugin.name if plugin else "",
        distribution=plugin.distribution if plugin else "",
    )


@contextmanager
def depending_on(call: Call[Any], what: str = "") -> Iterator[None]:
    """Turn whatever a stage raises that a whole run needs, unless it is an error of dh2urdf, into one that names it.

    `what` is asked of the stage, where that is not its work itself, such as ``require``.

    Raises:
        BrokenPluginError: the stage raised something else.
    """
    try:
        with call.attribution:
            yield
    except (Dh2UrdfError, KeyboardInterrupt):
        raise
    except BaseException as error:
        if _OWN in getattr(error, "__notes__", ()):
            raise
        plugin = call.plugin
        raise BrokenPluginError(
            plugin.name if plugin else call.stage.name,
            plugin.distribution if plugin else UNKNOWN,
            f"{f'`{what}` of ' if what else ''}the {call} failed: {reason_of(error)}",
            traceback_of(error),
        ) from error


@contextmanager
def own_work() -> Iterator[None]:
    """Mark whatever is raised as the host's own, also on its way through an executor, which calls the host.

    A note of an exception survives the way between processes.
    """
    try:
        yield
    except Dh2UrdfError:
        raise
    except Exception as error:
        error.add_note(_OWN)
        raise


@contextmanager
def reading(path: Path, place: str = "") -> Iterator[None]:
    """Turn what the operating system declares about a file into an error of the file: the stage that reads it is sound.

    Raises:
        TableError: a table cannot be read.
        OutputError: a file that dh2urdf has written for `place` cannot be read.
    """
    try:
        yield
    except (StageError, ProofError) as error:
        reason = error.__cause__
        if not isinstance(reason, OSError) or not reason.errno or reason.filename not in (None, os.fspath(path)):
            raise
        from dh2urdf.documents.text_files import unreadable
        from dh2urdf.output.whole_files import refused

        raise (refused(place, reason, "read") if place else TableError(unreadable(path, reason))) from error


# --- What stages answer: a TypeError or ValueError is reported as the stage's own fault -------------------------------


def a_record(value: T, *kinds: type[Any]) -> T:
    """Return what a stage gave, which is of one of these kinds.

    Raises:
        TypeError: it is something else, which a third party's stage may well give.
    """
    if not isinstance(value, kinds):
        raise TypeError(f"it gave {_name(type(value))}, not {' or '.join(map(_name, kinds))}")
    return value


def _name(kind: type[Any]) -> str:
    """Return the name by which a plugin imports a type."""
    if kind.__module__ == "builtins":
        return kind.__name__.replace("NoneType", "None")
    is_of_stages = getattr(stages, kind.__name__, None) is kind
    return f"{stages.__name__ if is_of_stages else kind.__module__}.{kind.__name__}"


def items_of(value: Iterable[T] | None, kind: type[Any] | str) -> Iterator[T]:
    """Yield what a stage gives one by one.

    Raises:
        TypeError: it gave nothing of which there can be several.
    """
    if not isinstance(value, Iterable) or isinstance(value, (str, bytes)):
        wanted = kind if isinstance(kind, str) else f"several of {_name(kind)}"
        raise TypeError(f"it gave {_name(type(value))}, not {wanted}")
    return iter(value)


def several_records(value: Iterable[T] | None, kind: type[T]) -> list[T]:
    """Return several records that a stage gave.

    Raises:
        TypeError: one of them is something else.
    """
    return [a_record(each, kind) for each in items_of(value, kind)]


def emitted_files(value: Iterable[EmittedFile] | None, stem: str, *, in_folders: bool = False) -> list[EmittedFile]:
    """Return the files that an emitter gave for a stem; `in_folders` is whether they lie in folders of their own.

    Raises:
        TypeError: one of them is no file, its name is no text, or its content is not bytes.
        ValueError: a file would lie elsewhere than in the output folder itself, or in such a folder; or its name does
            not begin with the stem, so that the files of two manipulators may have one name; or two names differ in
            case at most.
    """
    files = several_records(value, EmittedFile)
    for file in files:
        for what, kind in (("name", str), ("content", bytes)):
            if not isinstance(given := getattr(file, what), kind):
                found = f"{given!r:.60} ({type(given).__name__})"
                raise TypeError(f"it gave an EmittedFile whose {what} is {found}, not {kind.__name__}")
        parts = file.name.split("/") if in_folders else [file.name]
        if in_folders and len(parts) == 1:
            raise ValueError(f"{shown(file.name)} lies in no folder; accepted: the path of a file in one")
        for part in parts:
            a_plain_name(part)
        if not in_folders and not file.name.casefold().startswith(stem.casefold()):
            raise ValueError(f"{shown(file.name)} does not begin with the stem {shown(stem)} that it was given")
    if len(files) > 1 and len({file.name.casefold() for file in files}) < len(files):
        raise ValueError(f"it gave two files of one name: {listed([shown(file.name) for file in files])}")
    return files


def a_plain_name(name: str) -> str:
    """Return the name of a file without a folder.

    Raises:
        ValueError: it leads somewhere else, or no file can have it.
    """
    if not name or name in {".", ".."} or "/" in name or "\\" in name or "\0" in name:
        raise ValueError(f"{shown(name)} is not a plain file name; accepted: a name without a folder")
    return name


# --- Notices ----------------------------------------------------------------------------------------------------------


def warn_of(notices: Iterable[Problem], depth: int = 1) -> None:
    """Give notices as warnings, each once, at the line that called a public function, `depth` functions above.

    Not while a stage is at work, such as a reader that calls `from_dh`: the caller of the stage reports its notices.
    """
    if current() is None:
        for text in dict.fromkeys(map(str, notices)):
            warnings.warn(text, TableWarning, stacklevel=depth + 2)
