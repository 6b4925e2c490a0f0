"""Functions that workers can import."""

import os
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture
def functions(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The module `worker_functions`, here and in every process that is started."""
    folder = str(Path(__file__).parent)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [folder, os.environ.get("PYTHONPATH")])))
    import worker_functions

    return worker_functions
