"""Calls of stages, and whose fault it is when one fails: a stage's function may raise anything.

What a stage refuses in an error of `dh2urdf.errors` goes on as it is. Anything else is a fault of the stage, and told
with the plugin, its distribution and its version: as a `StageError` where it concerns one manipulator, as a
`BrokenPluginError` where the whole run depends on it.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from dh2urdf.discovery import UNKNOWN
from dh2urdf.errors import BrokenPluginError, Dh2UrdfError, RecordError, StageError
from dh2urdf.faults import INTERRUPTS, reason_of, traceback_of
from dh2urdf.registry import RECORDS, Catalog, Plugin, load, load_plugin
from dh2urdf.stages import Emitter, Executor, Kind, Loader, Reader, Transform

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

S = TypeVar("S", Reader[Any], Transform[Any], Emitter[Any], Loader[Any], Executor[Any])
T = TypeVar("T")

_OWN = "raised by dh2urdf itself, not by a stage"


@dataclass(frozen=True, slots=True, kw_only=True)
class Call(Generic[S]):
    """A stage with the options that this run gives it.

    To another process it goes by name: a worker has the same plugins installed, and no stage need be picklable. It
    finds the stage in the same plugin, and imports no other.

    Attributes:
        stage: the stage.
        options: an instance of its options type.
        plugin: who provides it; None where it was not found in a catalog.
    """

    stage: S
    options: Any
    plugin: Plugin | None = field(default=None, repr=False)

    @property
    def kind(self) -> Kind:
        """The kind of the stage."""
        return next(kind for kind, record in RECORDS.items() if isinstance(self.stage, record))

    def __str__(self) -> str:
        return f"{self.kind} {self.stage.name!r}"

    def __reduce__(self) -> tuple[Callable[..., Call[Any]], tuple[Any, ...]]:
        is_installed = self.plugin is not None and self.plugin.is_installed
        whose = (self.plugin.name, self.plugin.distribution_name) if self.plugin and is_installed else None
        return _installed_call, (whose, self.kind, self.stage.name, self.options)


def default_call(catalog: Catalog, stage: S) -> Call[S]:
    """A stage of a catalog with its default options."""
    return Call(stage=stage, options=stage.options(), plugin=catalog.plugin_of(stage))


def _installed_call(whose: tuple[str, str] | None, kind: Kind, name: str, options: Any) -> Call[Any]:  # noqa: ANN401 - the stage's own
    catalog = _catalog(whose)
    stage: Any = catalog.get(kind, name)
    return Call(stage=stage, options=options, plugin=catalog.plugin_of(stage))


@cache
def _catalog(whose: tuple[str, str] | None) -> Catalog:
    return load_plugin(*whose) if whose else load()


@contextmanager
def blaming(call: Call[Any]) -> Iterator[None]:
    """Turn whatever a stage raises about one manipulator, unless it is an error of dh2urdf, into one that names it.

    Raises:
        StageError: the stage raised something else.
    """
    try:
        yield
    except (Dh2UrdfError, *INTERRUPTS) as error:
        # A reader makes the records of a table. What another stage puts wrongly into one is its own fault.
        if isinstance(error, RecordError) and call.kind != "reader":
            raise _fault(call, error) from error
        raise
    except BaseException as error:
        raise _fault(call, error) from error


def _fault(call: Call[Any], error: BaseException) -> StageError:
    plugin = call.plugin
    return StageError(
        str(call),
        reason_of(error),
        traceback_of(error),
        plugin=plugin.name if plugin else "",
        distribution=plugin.distribution if plugin else "",
    )


@contextmanager
def own_work() -> Iterator[None]:
    """Marks whatever is raised as the host's own, also on its way through an executor, which calls the host.

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
def depending_on(call: Call[Any], what: str = "") -> Iterator[None]:
    """Turn whatever a stage raises that a whole run needs, unless it is an error of dh2urdf, into one that names it.

    Args:
        call: the stage.
        what: what is asked of it, where that is not its work itself, such as ``require``.

    Raises:
        BrokenPluginError: the stage raised something else.
    """
    try:
        yield
    except (Dh2UrdfError, *INTERRUPTS):
        raise
    except BaseException as error:
        if _OWN in getattr(error, "__notes__", ()):
            raise
        raise broken(error, call, what) from error


def broken(error: BaseException, call: Call[Any], what: str = "") -> BrokenPluginError:
    """The error that says which plugin failed with which stage, and how."""
    plugin = call.plugin
    return BrokenPluginError(
        plugin.name if plugin else call.stage.name,
        plugin.distribution if plugin else UNKNOWN,
        f"{f'`{what}` of ' if what else ''}the {call} failed: {reason_of(error)}",
        traceback_of(error),
    )


def a_record(value: T, *kinds: type[Any]) -> T:
    """What a stage gave, which is of one of these kinds.

    Raises:
        TypeError: it is something else, which a third party's stage may well give.
    """
    if not isinstance(value, kinds):
        wanted = " or ".join(f"{kind.__module__}.{kind.__name__}" for kind in kinds)
        raise TypeError(f"it gave {type(value).__name__}, not {wanted}")
    return value
