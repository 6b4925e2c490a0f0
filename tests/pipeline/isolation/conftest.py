"""Functions for child processes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from types import ModuleType


@pytest.fixture
def functions(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The module `isolated_functions`, which a child can import."""
    monkeypatch.syspath_prepend(Path(__file__).parent)
    import isolated_functions

    return isolated_functions
