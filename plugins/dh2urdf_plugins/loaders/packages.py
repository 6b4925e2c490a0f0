"""The packages that a loader needs: asked for before a run, imported in the child process."""

from __future__ import annotations

import importlib
import importlib.util
from dataclasses import dataclass
from typing import Any

from dh2urdf.errors import MissingDependencyError


@dataclass(frozen=True, slots=True)
class Packages:
    """The packages of one loader, which an extra of its own name installs.

    Attributes:
        loader: name of the loader.
        names: by the module that is imported, the package that has it.
    """

    loader: str
    names: dict[str, str]

    def require(self, *modules: str) -> None:
        """Ask whether the packages of some modules are there, without importing them.

        Raises:
            MissingDependencyError: one of them is not installed.
        """
        for module in modules:
            if importlib.util.find_spec(module.partition(".")[0]) is None:
                raise self._missing(module)

    def load(self, module: str) -> Any:  # noqa: ANN401 - a module without type information
        """Import a module.

        Raises:
            MissingDependencyError: its package is not installed, or lacks a library of the system.
        """
        try:
            return importlib.import_module(module)
        except ImportError as error:
            raise self._missing(module, error) from error

    def _missing(self, module: str, reason: str | ImportError = "") -> MissingDependencyError:
        extra = f"dh2urdf[{self.loader}]"
        return MissingDependencyError(f"loader {self.loader!r}", self.names[module], extra, reason)
