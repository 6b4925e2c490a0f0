"""The hooks of a plugin: one per kind of stage and one for commands, each giving records of `dh2urdf.stages`.

A plugin implements any of them with `hookimpl`, in a module that its distribution names as an entry point of the
group ``dh2urdf``. The group says for which major version of this interface the plugin is made: see
`dh2urdf.plugin_system.discovery`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pluggy

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.stages import Edit, Emitter, Executor, Loader, Reader, Subcommand, Transform

PROJECT = "dh2urdf"
INTERFACE_VERSION = "0.7"
"""Version of all that is public, which `tests/public_interface/recorded.json` lists.

The major number changes where plugins have to change with it, the minor number where something is added. Before 1.0 the
minor number stands for both.
"""

hookspec = pluggy.HookspecMarker(PROJECT)
hookimpl = pluggy.HookimplMarker(PROJECT)


@hookspec
def dh2urdf_readers() -> Iterable[Reader[Any]]:
    """Stages that read manipulators from files."""
    return ()


@hookspec
def dh2urdf_transforms() -> Iterable[Transform[Any]]:
    """Stages that make a robot of a manipulator."""
    return ()


@hookspec
def dh2urdf_edits() -> Iterable[Edit[Any]]:
    """Stages that change a table before the transform, or a robot after it."""
    return ()


@hookspec
def dh2urdf_emitters() -> Iterable[Emitter[Any]]:
    """Stages that make the files of a robot."""
    return ()


@hookspec
def dh2urdf_loaders() -> Iterable[Loader[Any]]:
    """Stages that load a file into a simulator and report what the simulator found."""
    return ()


@hookspec
def dh2urdf_executors() -> Iterable[Executor[Any]]:
    """Stages that run the pipeline over many manipulators."""
    return ()


@hookspec
def dh2urdf_commands() -> Iterable[Subcommand]:
    """Commands of the program ``dh2urdf``, beside its own ones."""
    return ()
