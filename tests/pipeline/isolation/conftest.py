"""Functions for child processes."""

from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture
def functions(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The module `isolated_functions`, which a child can import."""
    monkeypatch.syspath_prepend(Path(__file__).parent)
    import isolated_functions

    return isolated_functions
