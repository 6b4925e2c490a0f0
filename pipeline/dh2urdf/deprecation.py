"""What goes away says so first, for one version of the plugin interface at least."""

from __future__ import annotations


def warn_deprecated(what: str, *, instead: str, gone_in: str) -> None:
    """Warn who uses something public that will go: `docs/compatibility.md`.

    The warning points to the line outside of dh2urdf that led here, however many of its own functions lie between.

    Args:
        what: what goes away, as its users write it, such as ``Reader(schema=…)``.
        instead: what takes its place.
        gone_in: the version of the plugin interface in which it is gone, such as ``2.0``.
    """
    import inspect
    import warnings

    level, frame = 1, inspect.currentframe()
    while frame is not None and f"{frame.f_globals.get('__name__')}.".startswith("dh2urdf."):
        level, frame = level + 1, frame.f_back
    warnings.warn(
        f"{what} is gone in version {gone_in} of dh2urdf's plugin interface: use {instead}",
        DeprecationWarning,
        stacklevel=level,
    )
