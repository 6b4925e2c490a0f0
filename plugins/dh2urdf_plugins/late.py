"""Functions that are imported when they are called: a run that does not need a stage's function pays for none."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

from dh2urdf.errors import MissingDependencyError


@dataclass(frozen=True, slots=True)
class Late:
    """A function that is imported when it is called.

    Attributes:
        place: its module and its name, with a colon between them.
        needs: who needs which package, and what installs that, of a function that needs one.
    """

    place: str
    needs: tuple[str, str, str] | None = None

    def __call__(self, *arguments: Any) -> Any:  # noqa: ANN401 - those of the function
        """What the function returns."""
        if self.needs:
            try:
                import_module(self.needs[1])
            except ImportError as error:
                raise MissingDependencyError(*self.needs, error) from None
        module, _, name = self.place.partition(":")
        return getattr(import_module(module), name)(*arguments)
