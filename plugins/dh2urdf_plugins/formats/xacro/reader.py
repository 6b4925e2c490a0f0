"""Reads a xacro into a robot, as the real xacro expands it: one of our own in this process, a stranger's in a fence."""

from __future__ import annotations

import functools
import importlib.util
import io
import sys
import threading
import types
from importlib.machinery import ModuleSpec, SourceFileLoader
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ProofError
from dh2urdf.source import Mark, Messages
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from dh2urdf.robot import Robot
    from dh2urdf.stages import Expansion

say = Messages(__file__)


_ONE_AT_A_TIME = threading.Lock()
"""xacro keeps what it is at in variables of its module: two threads would expand into each other."""


def read_xacro(path: Path) -> Robot:
    """The robot of a xacro file, expanded with the defaults of its arguments."""
    return parse_urdf(expand(path), f"{path} (expanded)")


def read_foreign_xacro(path: Path, expansion: Expansion | None = None) -> Robot:
    """The robot of a xacro file of unknown origin, expanded where it can do no harm."""
    return parse_urdf(expand_foreign(path, expansion).content, f"{path} (expanded)")


def expand(path: Path, arguments: Mapping[str, str] | None = None) -> bytes:
    """The text that the real xacro makes of a file that this project wrote, with values of its arguments.

    It evaluates the expressions of the file as Python does, in this process: `expand_foreign` is for all other files.
    """
    with _ONE_AT_A_TIME:
        xacro = _own_xacro()
        # xacro takes the whole path of an included file for a pattern, brackets in a folder's name included; with the
        # folder as its root directory, it sees the file names alone.
        xacro.root_dir = str(path.parent)
        try:
            document = xacro.process_file(path.name, mappings=dict(arguments or {}))
        except Exception as error:  # xacro evaluates Python: anything may come out.
            said = " ".join(str(error).split()) or repr(error)
            raise ProofError(say("xacro-unexpandable", Mark(file=str(path)), reason=said)) from error
    text: bytes = document.documentElement.toprettyxml(indent="  ", encoding="utf-8")
    return text


@functools.cache
def _own_xacro() -> Any:  # noqa: ANN401 - a module whose variables are set
    """A copy of the module xacro for this project alone.

    xacro keeps its root directory in a variable and prints its warnings: in a copy, neither reaches a program that uses
    xacro itself, or prints, at the same time.
    """
    import xacro

    name = f"{__package__}._xacro"
    spec = ModuleSpec(name, SourceFileLoader(name, xacro.__file__), origin=xacro.__file__, is_package=True)
    spec.submodule_search_locations = list(xacro.__path__)
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    SourceFileLoader(name, xacro.__file__).exec_module(module)
    silent = types.SimpleNamespace(stdout=io.StringIO(), stderr=io.StringIO())
    module.sys = module.color.sys = silent  # type: ignore[attr-defined]
    return module
