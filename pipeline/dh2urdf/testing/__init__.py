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

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.testing.catalogs import catalog_of as catalog_of, do_run as do_run
    from dh2urdf.testing.reader_contract import ReaderContract as ReaderContract
    from dh2urdf.testing.reference import plain_robot as plain_robot, reference_manipulators as reference_manipulators
    from dh2urdf.testing.robot_contracts import (
        EditContract as EditContract,
        EmitterContract as EmitterContract,
        TransformContract as TransformContract,
    )
    from dh2urdf.testing.worker_contracts import ExecutorContract as ExecutorContract, LoaderContract as LoaderContract
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "catalogs": "catalog_of do_run",
            "reader_contract": "ReaderContract",
            "reference": "plain_robot reference_manipulators",
            "robot_contracts": "EditContract EmitterContract TransformContract",
            "worker_contracts": "ExecutorContract LoaderContract",
        },
    )
