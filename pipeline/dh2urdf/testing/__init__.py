"""Contract tests and fixtures for the authors of plugins.

A contract is a class of tests, one for each thing that the pipeline relies on. An author runs all of them over a stage
by naming it in a subclass::

    from dh2urdf.testing import EmitterContract
    from my_lab.emitter import EMITTER

    class TestEmitter(EmitterContract):
        stage = EMITTER

A test that fails says which clause is broken, what was found, what is accepted and what to do. The built-in stages are
held to the same contracts. What this package gives is imported when it is asked for: pytest finds its fixtures in
`dh2urdf.testing.plugin` wherever dh2urdf is installed, and whoever does not use them pays nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dh2urdf.testing.catalogs import catalog_of, do_run
    from dh2urdf.testing.emitter_contract import EmitterContract
    from dh2urdf.testing.executor_contract import ExecutorContract
    from dh2urdf.testing.loader_contract import LoaderContract
    from dh2urdf.testing.reader_contract import ReaderContract
    from dh2urdf.testing.reference import plain_robot, reference_manipulators
    from dh2urdf.testing.transform_contract import TransformContract

__all__ = [
    "EmitterContract",
    "ExecutorContract",
    "LoaderContract",
    "ReaderContract",
    "TransformContract",
    "catalog_of",
    "do_run",
    "plain_robot",
    "reference_manipulators",
]

_HOMES = {
    "EmitterContract": "emitter_contract",
    "ExecutorContract": "executor_contract",
    "LoaderContract": "loader_contract",
    "ReaderContract": "reader_contract",
    "TransformContract": "transform_contract",
    "catalog_of": "catalogs",
    "do_run": "catalogs",
    "plain_robot": "reference",
    "reference_manipulators": "reference",
}


def __getattr__(name: str) -> Any:  # noqa: ANN401 - whatever is asked for
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
