"""Built-in emitters: one file each."""

from __future__ import annotations

from importlib.util import find_spec

from dh2urdf.stages import Checks
from dh2urdf_plugins.late import Late


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

    function = "dh2urdf_check.{}".format
    fixes = Late(function(fix)) if fix else None
    return (Checks(Late(function(check)), Late(function(descriptions)), fixes, finds_packages),)
