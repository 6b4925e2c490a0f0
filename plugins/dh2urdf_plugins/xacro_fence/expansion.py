"""Expands a stranger's xacro in a child process, by the real xacro whose ways out are closed."""

from __future__ import annotations

import os
import re
import types
from collections import ChainMap
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.documents import DOCUMENT_TYPE, check_encoding, refuse_other_kind
from dh2urdf.errors import CrashError, ProofError, TimeLimitError
from dh2urdf.isolation import Data, enter, run_in_child, tell_of_missing_wall
from dh2urdf.meshes import packages_in
from dh2urdf.source import Mark, Messages
from dh2urdf.stages import Expansion
from dh2urdf_plugins.xacro_fence.files import Files
from dh2urdf_plugins.xacro_fence.places import Place, keep_places, place_of_failure, places

if TYPE_CHECKING:
    from xml.dom.minidom import Document

say = Messages(__file__)

_Result = tuple[bytes, list[Place | None], str | None]
_NOT_THERE = r"\[Errno 2\] No such file or directory: (.*)"
EXPANSION = 30.0  # how long an expansion may take [s]: it computes whatever the file asks for
MAX_OUTPUT = 2**26  # size of what comes out [B]
_RESULT: Data[_Result] = Data(_Result)
STEPS_OF_MACRO = 100  # as how many steps of expressions the call of a macro counts


class Expanded(NamedTuple):
    """What xacro made of a file: the text, and where each element comes from, in the order of the text.

    A place is None where xacro has made the element. The first file is named as it was given; others are relative to
    the current folder where they are in it and the first is, and absolute otherwise.
    """

    content: bytes
    places: list[Place | None]


def expand_foreign(path: Path, expansion: Expansion | None = None, *, timeout: float | None = None) -> Expanded:
    """The text that xacro makes of a file of unknown origin, which can do nothing but be read.

    It is expanded in a child process behind `dh2urdf.isolation`, within `timeout` [s]. Expressions are checked before
    they are evaluated, and files are read from the folder of the file, or of its ROS package, and from those of the
    packages that are named. Variables of the environment are not given. A `ProofError` says where something is refused.
    """
    tell_of_missing_wall()
    limit = EXPANSION if timeout is None else timeout
    given = expansion or Expansion()
    packages = packages_in(given.package_paths)
    try:
        text, found, failure = run_in_child(
            _expanded, path, dict(given.arguments), packages, limit, timeout=limit, who="xacro", encoding=_RESULT
        ).value
    except TimeLimitError:
        raise _failure(path, f"it did not finish within {limit:g} s") from None
    except CrashError as error:
        raise _failure(path, f"it ended without a result: {error.problems[0].message}") from error
    if failure is not None:
        refuse_other_kind(path.read_bytes(), str(path), ProofError, "a robot description", "a xacro file")
        raise _failure(path, failure, *found)
    return Expanded(text, [place and _named(path, place) for place in found])


def _failure(path: Path, reason: str, place: Place | None = None) -> ProofError:
    mark = mark_of(_named(path, place)) if place else Mark(file=str(path))
    if missing := re.fullmatch(_NOT_THERE, reason):
        return ProofError(say("xacro-file-missing", mark, file=missing[1]))
    return ProofError(say("xacro-unexpandable", mark, reason=reason))


def mark_of(place: Place) -> Mark:
    """A place as findings and problems have it."""
    return Mark(file=place.file, line=place.line, column=place.column)


def _named(path: Path, place: Place) -> Place:
    """A place whose file is named as the user named the first one."""
    file = str(path) if place.file == path.name else os.path.normpath(path.absolute().parent / place.file)
    if not path.is_absolute() and Path(file).is_absolute() and Path(file).is_relative_to(Path.cwd()):
        file = str(Path(file).relative_to(Path.cwd()))
    return place._replace(file=file, calls=tuple(_named(path, call) for call in place.calls))


def _expanded(path: Path, arguments: dict[str, str], packages: dict[str, Path], seconds: float) -> _Result:
    """Expands a file in the child; its process is good for nothing else afterwards.

    It returns what was wrong beside one place at most; or the text, the places of its elements, and None.
    """
    import xacro

    files = Files(path, packages)
    _close(files)
    _warm_up()
    keep_places(xacro)
    os.chdir(path.absolute().parent)  # where names relative to the file are looked for, those of YAML too
    enter(files.roots, seconds)
    try:
        document: Document = xacro.process_file(path.name, mappings=arguments)
        text: bytes = document.documentElement.toprettyxml(indent="  ", encoding="utf-8")  # type: ignore[union-attr]
        if len(text) > MAX_OUTPUT:
            return b"", [], f"it becomes a text of {len(text)} bytes, more than {MAX_OUTPUT}"
        return text, places(document), None
    except Exception as error:  # noqa: BLE001 - it evaluates what a stranger wrote: anything may come out
        return b"", [place_of_failure(error)], _reason(error)


def _reason(error: Exception) -> str:
    """What was wrong, and with which expression."""
    suffix = ""
    while (inner := getattr(error, "exc", None)) is not None:  # xacro wraps what it catches, at every level
        suffix = suffix or " ".join((getattr(error, "suffix", None) or "").split())
        error = inner
    if type(error).__name__ == "ArgException":  # of xacro's own, which says no more than the name
        reason = f"the argument {str(error)!r} has no value: give it one, {error}:=VALUE"
    elif isinstance(error, MemoryError):
        reason = "it needs too much memory"
    elif isinstance(error, RecursionError):
        reason = "a macro, a file or an expression goes into itself without end (recursion)"
    else:
        reason = " ".join(str(error).split()) or repr(error)
    return f"{reason} {suffix}".strip()


def _close(files: Files) -> None:
    """Has xacro evaluate, open and look up by functions of ours alone; in this process, for good."""
    from xml.dom import expatbuilder

    import xacro
    from xacro import substitution_args

    from dh2urdf_plugins.xacro_fence.interpreter import ExpressionError, Work, evaluate

    def no_environment(name: str) -> str:
        raise ExpressionError(f"$(env {name}): a file of unknown origin is not given the environment")

    def counted(*args: Any) -> Any:  # noqa: ANN401
        work.spend(STEPS_OF_MACRO)
        return expand_macro(*args)

    def no_document_type(_self: Any, *_declared: Any) -> None:  # noqa: ANN401 - a builder
        raise ExpressionError(DOCUMENT_TYPE)

    def known_encoding(self: Any, version: str, encoding: str | None, standalone: int) -> None:  # noqa: ANN401 - a builder
        check_encoding(encoding)
        declared(self, version, encoding, standalone)

    # The parser of xacro refuses what `dh2urdf.documents.xml_elements` refuses.
    builder: Any = expatbuilder.ExpatBuilderNS
    declared = builder.xml_decl_handler
    builder.start_doctype_decl_handler, builder.xml_decl_handler = no_document_type, known_encoding
    work, builtins, expand_macro = Work(), xacro._global_symbols["python"], xacro.resolve_macro  # noqa: SLF001
    xacro.resolve_macro = counted
    xacro.safe_eval = lambda text, names, _local=None: evaluate(text, names, work)
    xacro.open = files.open  # comes before the built-in one in that module
    xacro.glob = types.SimpleNamespace(glob=files.glob)
    substitution_args.eval = lambda text, _no_names, names: evaluate(text, ChainMap(names, builtins), work)
    of_system: dict[str, Any] = {
        "env": no_environment,
        "optenv": lambda _name, default="": default,
        "find": files.package,
    }
    substitution_args._eval_dict.update(of_system)  # noqa: SLF001
    vars(substitution_args).update({f"_eval_{name}": function for name, function in of_system.items()})


def _warm_up() -> None:
    """Imports what would be imported on the way: behind the fence, no module can be read."""
    import codecs
    import pyexpat  # noqa: F401
    import traceback  # noqa: F401
    import xml.dom.expatbuilder
    import xml.dom.minidom

    import yaml

    for encoding in ("ascii", "latin-1", "iso8859-15", "cp1252", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"):
        codecs.lookup(encoding)
    xml.dom.minidom.parseString("<a/>").toprettyxml(encoding="utf-8")  # noqa: S318 - our own text
    yaml.safe_load("{a: [1, 2.5, true, text]}")
