"""Contract tests and fixtures for the authors of plugins.

A contract is a class of tests, one for each thing that the pipeline relies on. An author runs all of them over a stage
by naming it in a subclass::

    from dh2urdf.testing import EmitterContract
    from my_lab.emitter import EMITTER

    class TestEmitter(EmitterContract):
        stage = EMITTER

A test that fails says which clause is broken, what was found, what is accepted and what to do. The built-in stages are
held to the same contracts. What this package gives is imported when it is asked for: pytest finds its fixtures in
`dh2urdf.testing.plugin` wherever dh2urdf is installed, and cost nothing to other tests.
"""

from __future__ import annotations

from dh2urdf._faces import face

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.testing.catalogs import catalog_of as catalog_of, do_run as do_run
    from dh2urdf.testing.emitter_contract import EmitterContract as EmitterContract
    from dh2urdf.testing.executor_contract import ExecutorContract as ExecutorContract
    from dh2urdf.testing.loader_contract import LoaderContract as LoaderContract
    from dh2urdf.testing.reader_contract import ReaderContract as ReaderContract
    from dh2urdf.testing.reference import (
        plain_robot as plain_robot,
        reference_manipulators as reference_manipulators,
    )
    from dh2urdf.testing.transform_contract import (
        EditContract as EditContract,
        TransformContract as TransformContract,
    )
else:
    __all__, __getattr__, __dir__ = face(
        __name__,
        {
            "catalogs": "catalog_of do_run",
            "emitter_contract": "EmitterContract",
            "executor_contract": "ExecutorContract",
            "loader_contract": "LoaderContract",
            "reader_contract": "ReaderContract",
            "reference": "plain_robot reference_manipulators",
            "transform_contract": "EditContract TransformContract",
        },
    )
