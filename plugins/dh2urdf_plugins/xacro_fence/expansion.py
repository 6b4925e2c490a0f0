"""Expands a stranger's xacro in a child process, by the real xacro whose ways out are closed."""

from __future__ import annotations

import itertools
import os
import types
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.documents import DOCUMENT_TYPE, check_encoding, refuse_other_kind
from dh2urdf.errors import CrashError, ProofError, TimeLimitError
from dh2urdf.isolation import Data, enter, run_in_child, tell_of_missing_wall
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.meshes import packages_in
from dh2urdf.patterns import late_pattern
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Expansion
from dh2urdf_plugins.xacro_fence.expressions import BOUNDED, REFUSED, ExpressionError, evaluate
from dh2urdf_plugins.xacro_fence.files import Files
from dh2urdf_plugins.xacro_fence.places import Place, keep_places, place_of_failure, places

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from xml.dom.minidom import Document

_Result = tuple[bytes, list[Place | None], str | None]
_NOT_THERE = late_pattern(r"\[Errno 2\] No such file or directory: (.*)")
EXPANSION = 30.0
"""How long an expansion may take [s]: it computes whatever the file asks for."""
MAX_OUTPUT = 2**26
"""Size of what comes out [B]."""
_RESULT: Data[_Result] = Data(_Result)
MAX_MACROS = 50_000
"""How often macros are expanded in all."""


class Expanded(NamedTuple):
    """What xacro made of a file.

    Attributes:
        content: the text.
        places: where each element of it comes from, in the order of the text; None where xacro has made it. The first
            file is named as it was given; others are relative to the current folder where they are in it and the first
            is, and absolute otherwise.
    """

    content: bytes
    places: list[Place | None]


def expand_foreign(
    path: Path,
    expansion: Expansion | None = None,
    *,
    timeout: float | None = None,
) -> Expanded:
    """The text that xacro makes of a file of unknown origin, which can do nothing but be read.

    It is expanded in a child process behind `dh2urdf.isolation`. Expressions are checked before they are evaluated, and
    files are read from the folder of the file, or of its ROS package, and from those of the packages that are named.
    Variables of the environment are not given.

    Args:
        path: the file.
        expansion: values of its ``xacro:arg`` elements, and the folders of further packages.
        timeout: how long it may take [s]; `EXPANSION` by default.

    Raises:
        ProofError: xacro cannot expand the file, or something in it is refused; with the place where that is.
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
    advice = None
    if missing := _NOT_THERE.fullmatch(reason):
        reason = f"it names the file {missing[1]}, which is not there"
        advice = (
            "keep the files that it names where it names them; where one file alone is given, as to the studio, give "
            "the URDF that xacro makes of it: `xacro FILE > robot.urdf`"
        )
    return ProofError(Problem(message=f"xacro cannot expand it: {reason}", mark=mark, suggestion=advice))


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

    Returns:
        The text, the places of its elements, and None; or what was wrong, with one place at most.
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


def closed_symbols(xacro: types.ModuleType) -> dict[str, Any]:
    """The names that xacro gives to expressions, without what shows more, and with bounds."""
    symbols: dict[str, Any] = xacro.create_global_symbols()
    for space in _spaces(symbols):
        for name in REFUSED:
            dict.pop(space, name, None)
        for name, function in BOUNDED.items():
            if dict.__contains__(space, name):
                dict.__setitem__(space, name, function)
    return symbols


def callables(symbols: dict[str, Any]) -> dict[int, Callable[..., Any]]:
    """What expressions may call, by `id`."""
    return {id(value): value for space in _spaces(symbols) for value in dict.values(space) if callable(value)}


def _spaces(symbols: dict[str, Any]) -> list[dict[str, Any]]:
    return [symbols, *(space for space in symbols.values() if isinstance(space, dict))]


def _close(files: Files) -> None:
    """Has xacro evaluate, open and look up by functions of ours alone; in this process, for good."""
    import xacro
    from xacro import substitution_args

    symbols = xacro._global_symbols = closed_symbols(xacro)  # noqa: SLF001
    calls = callables(symbols)

    def safe_eval(text: str, names: dict[str, Any], local: Mapping[str, object] | None = None) -> Any:  # noqa: ANN401
        return evaluate(text, names, local, calls)

    def no_environment(name: str) -> str:
        raise ExpressionError(f"$(env {name}): a file of unknown origin is not given the environment")

    def nothing_from_environment(name: str, default: str = "") -> str:  # noqa: ARG001 - as xacro calls it
        return default

    def counted(*args: Any) -> Any:  # noqa: ANN401
        if next(expanded) > MAX_MACROS:
            raise ExpressionError(f"macros are expanded more than {MAX_MACROS} times")
        return expand_macro(*args)

    expanded, expand_macro = itertools.count(1), xacro.resolve_macro
    xacro.resolve_macro = counted
    xacro.safe_eval = safe_eval
    _refuse_declarations()
    xacro.open = files.open  # comes before the built-in one in that module
    xacro.glob = types.SimpleNamespace(glob=files.glob)
    substitution_args._eval_env = no_environment  # noqa: SLF001
    substitution_args._eval_optenv = nothing_from_environment  # noqa: SLF001
    substitution_args._eval_find = files.package  # noqa: SLF001
    substitution_args._eval = _evaluation(calls, files, no_environment, nothing_from_environment)  # noqa: SLF001


def _refuse_declarations() -> None:
    """Has the parser of xacro refuse what `dh2urdf.documents.xml_elements` refuses."""
    from xml.dom import expatbuilder

    builder: Any = expatbuilder.ExpatBuilderNS

    def no_document_type(_self: Any, *_declared: Any) -> None:  # noqa: ANN401 - a builder
        raise ExpressionError(DOCUMENT_TYPE)

    def known_encoding(self: Any, version: str, encoding: str | None, standalone: int) -> None:  # noqa: ANN401 - a builder
        check_encoding(encoding)
        declared(self, version, encoding, standalone)

    declared = builder.xml_decl_handler
    builder.start_doctype_decl_handler, builder.xml_decl_handler = no_document_type, known_encoding


def _evaluation(
    calls: Mapping[int, Callable[..., Any]], files: Files, *environment: Callable[..., str]
) -> Callable[[str, dict[str, Any]], str]:
    """What takes the place of xacro's ``$(eval …)``."""
    import math

    from xacro import substitution_args

    env, optenv = environment
    plain = {name: value for name, value in vars(math).items() if not name.startswith("_") and name not in BOUNDED}
    kinds = {kind.__name__: kind for kind in (list, dict, map, str, float, int)}
    words = {"true": True, "false": False, "True": True, "False": False}

    def evaluated(text: str, context: dict[str, Any]) -> str:
        given = context.setdefault("arg", {})

        def argument(name: str) -> Any:  # noqa: ANN401 - of the type that its text has
            return substitution_args.convert_value(given[name], "auto")

        own = {"arg": argument, "env": env, "optenv": optenv, "find": files.package}
        functions = {**plain, **kinds, **own}
        values = {name: argument(name) for name in given}
        allowed = {**calls, **{id(value): value for value in functions.values() if callable(value)}}
        return str(evaluate(text, {**values, **words, **functions}, None, allowed))

    return evaluated


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
