"""What a contract test says where a stage breaks a clause."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any, NoReturn

import pytest

from dh2urdf.plugin_system.catalog import RECORDS

if TYPE_CHECKING:
    from collections.abc import Callable

_SHOWN = 1200
"""Characters of what was found that a message repeats."""


def breach(stage: Any, clause: Callable[..., Any], *, found: str, accepted: str, remedy: str) -> NoReturn:  # noqa: ANN401 - any author's object
    """Fail a test: say which clause is broken, what was found, what is accepted and what to do.

    Args:
        stage: the stage.
        clause: the test; the first line of its docstring is the clause.
        found: what was found.
        accepted: what is accepted.
        remedy: what to do.
    """
    kind = next((kind for kind, record in RECORDS.items() if isinstance(stage, record)), type(stage).__name__)
    said = (inspect.getdoc(clause) or "").partition("\n")[0]
    found = found if len(found) <= _SHOWN else f"{found[:_SHOWN]} …"
    found = found.replace("\n", "\n        ")
    raise pytest.fail.Exception(
        f"{kind} {getattr(stage, 'name', '?')!r} breaks the contract, clause {clause.__name__}: {said}\n"
        f"    found: {found}\n"
        f"    accepted: {accepted}\n"
        f"    what to do: {remedy}",
        pytrace=False,
    ) from None  # What the stage raised is in the message.
