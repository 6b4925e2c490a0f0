"""The command ``check``: rules about robot descriptions, and what each reader of them does with each fault."""

from __future__ import annotations

from dh2urdf.hookspecs import hookimpl
from dh2urdf.stages import Subcommand


@hookimpl
def dh2urdf_commands() -> tuple[Subcommand, ...]:
    """``check``."""
    summary = "Say what each simulator will do with a robot description."
    return (Subcommand(name="check", summary=summary, function="dh2urdf_check.command:command", behind="info"),)
