"""Built-in emitters: one file each."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from dh2urdf.stages import Checks

if TYPE_CHECKING:
    from collections.abc import Callable


def checks(check: str, descriptions: str, fix: str = "", *, finds_packages: bool = False) -> tuple[Checks, ...]:
    """The capability `Checks` of an emitter; none where the plugin of ``dh2urdf check`` is not installed.

    Args:
        check: the function of the plugin, as ``module:name``, which is imported when it is called.
        descriptions: another one.
        fix: another one, or none.
        finds_packages: as in `Checks`.
    """
    if find_spec("dh2urdf_check") is None:
        return ()

    def function(place: str) -> Callable[..., Any]:
        module, _, name = place.partition(":")

        def call(*given: Any) -> Any:  # noqa: ANN401 - as the function has it
            return getattr(import_module(f"dh2urdf_check.{module}"), name)(*given)

        return call

    return (Checks(function(check), function(descriptions), function(fix) if fix else None, finds_packages),)
