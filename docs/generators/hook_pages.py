"""The reference of the hooks, from `dh2urdf.hookspecs`: exact signatures, and the record that each hook gives."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from dh2urdf import hookspecs
from dh2urdf.plugin_system.records import CAPABILITIES, RECORDS
from dh2urdf.stages import Subcommand

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


def hooks() -> str:
    """A section for each hook: its signature, what it is for, and its record."""
    shown: set[type[Any]] = set()
    return "\n\n".join(text for hook, record in specified() for text in _hook(hook, record, shown))


def interface_version() -> str:
    """The sentence that tells the version of the interface."""
    return f"This is version **{hookspecs.INTERFACE_VERSION}** of the interface, as `dh2urdf --version` prints it."


def specified() -> list[tuple[Callable[..., Any], type[Any]]]:
    """Every hook, in the order of its module, with the record that it gives."""
    marked = f"{hookspecs.PROJECT}_spec"
    found = {name: value for name, value in vars(hookspecs).items() if hasattr(value, marked)}
    stages = [(found[f"dh2urdf_{kind}s"], record) for kind, record in RECORDS.items()]
    return [*stages, (found["dh2urdf_commands"], Subcommand)]


def signature(hook: Callable[..., Any]) -> str:
    """The signature of a hook, as its module writes it."""
    return f"def {hook.__name__}{inspect.signature(hook)}".replace("'", "")


def _hook(hook: Callable[..., Any], record: type[Any], shown: set[type[Any]]) -> Iterator[str]:
    yield f"## `{hook.__name__}`"
    yield f"```python\n{signature(hook)}: ...\n```"
    yield inspect.getdoc(hook) or ""
    kind = record.__name__.lower()
    for each in (record, *CAPABILITIES.get(kind, ())):  # type: ignore[call-overload]
        name = f"{each.__module__}.{each.__qualname__}"
        if each in shown:
            yield f"It may have [`{each.__qualname__}`][{name}], too."
        else:
            yield f"::: {name}\n    options:\n      heading_level: 3"
        shown.add(each)
