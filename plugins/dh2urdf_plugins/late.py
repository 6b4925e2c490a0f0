"""Functions that are imported when they are called: a run that does not need a stage's function pays for none."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any


@dataclass(frozen=True, slots=True)
class Late:
    """A function that is imported when it is called.

    Attributes:
        place: its module and its name, with a colon between them.
    """

    place: str

    def __call__(self, *arguments: Any) -> Any:  # noqa: ANN401 - those of the function
        """What the function returns."""
        module, _, name = self.place.partition(":")
        return getattr(import_module(module), name)(*arguments)
