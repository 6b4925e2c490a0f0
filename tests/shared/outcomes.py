"""What comes of a call, to be compared with what comes of another."""

from collections.abc import Callable
from typing import Any


def outcome(call: "Callable[[], Any]") -> Any:
    """What a call returns, or the type and text of its error."""
    try:
        return call()
    except Exception as error:  # noqa: BLE001 - all are compared
        return type(error), str(error)
