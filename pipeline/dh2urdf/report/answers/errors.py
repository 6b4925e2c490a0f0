"""What `--json` prints where a command fails: what standard error says, as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from dh2urdf._version import __version__
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.results import ErrorReport

SCHEMA: Final = "dh2urdf-error/1"
"""Name and version of the form."""


def error_report(kind: str, exit_status: int, error: BaseException, message: str) -> ErrorReport:
    """A command that failed.

    Args:
        kind: of what kind the failure is, such as ``table``, ``config`` or ``usage``.
        exit_status: the status with which the command ends.
        error: what was raised, with its problems and notices, if it has any.
        message: what is wrong where it has no problems.
    """
    problems: Sequence[Problem] = getattr(error, "problems", ())
    notices: Sequence[Problem] = getattr(error, "notices", ())
    return {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": exit_status,
        "kind": kind,
        "errors": [problem.as_json() for problem in problems or (Problem(message=message),)],
        "notices": [notice.as_json() for notice in notices],
    }
