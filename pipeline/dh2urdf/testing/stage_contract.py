"""The clauses that every kind of stage has to keep.

A contract is a class of clauses: functions that yield what is wrong. `clauses.toml` has what is accepted instead and
what to do about it.
"""

from __future__ import annotations

import functools
import inspect
import json
import pickle
import re
import sys
import tomllib
import traceback
from contextlib import suppress
from copy import deepcopy
from dataclasses import fields, is_dataclass
from importlib.metadata import EntryPoint
from importlib.resources import files
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import pytest

from dh2urdf.errors import Dh2UrdfError, MissingDependencyError, MissingProgramError, PluginError
from dh2urdf.hookspecs import PROJECT
from dh2urdf.plugin_system.catalog import Catalog, Plugin, load
from dh2urdf.plugin_system.option_types import describe_options, keys_of
from dh2urdf.plugin_system.options import make_options
from dh2urdf.plugin_system.records import RECORDS
from dh2urdf.quantities import Dimension
from dh2urdf.stages import HasSchema
from dh2urdf.testing.catalogs import catalog_of
from dh2urdf.testing.child import in_child

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from dh2urdf.stages import Kind

    Found = Iterator[str]

LIGHT = frozenset({"click", "dh2urdf", "dh2urdf_plugins", "lxml", "orjson", "pluggy", "yaml"})
"""Packages that registering a plugin may import besides the standard library and its own package."""
MISSING = (MissingDependencyError, MissingProgramError)
_NAME = re.compile(r"[a-z0-9]+([-_.][a-z0-9]+)*")
_SHOWN, _FRAMES = 1200, 7
"""Characters of what was found that a message repeats, and lines of a traceback."""
_SEEDS = (1, 2, 3)
"""Seeds for the hashes of texts: two texts in a set have one order with these and here in one of eight cases."""


def clause(check: Callable[..., Found]) -> Callable[..., None]:
    """Make a test of a check: it fails with the first thing that is wrong, or with what the stage raises."""

    @functools.wraps(check)
    def test(self: StageContract, *args: Any, **fixtures: Any) -> None:  # noqa: ANN401 - fixtures of pytest
        try:
            found = next(check(self, *args, **fixtures), None)
        except MISSING as error:
            pytest.skip(str(error))
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
            told = getattr(error, "__notes__", None) or traceback.format_exception(error)
            found = "\n".join([f"{type(error).__name__}: {error}", *"".join(told).splitlines()[-_FRAMES:]])
        if found is None:
            return
        kinds = (kind for kind, record in RECORDS.items() if isinstance(self.stage, record))
        named = f"{next(kinds, type(self.stage).__name__)} {getattr(self.stage, 'name', '?')!r}"
        sentence = (inspect.getdoc(check) or "").partition("\n")[0]
        table = tomllib.loads(files("dh2urdf.testing").joinpath("clauses.toml").read_text("utf-8"))
        contract, _, name = check.__qualname__.partition(".")
        accepted, remedy = table[contract][name]
        found = (found if len(found) <= _SHOWN else f"{found[:_SHOWN]} …").replace("\n", "\n        ")
        raise pytest.fail.Exception(
            f"{named} breaks the contract, clause {check.__name__}: {sentence}\n"
            f"    found: {found}\n    accepted: {accepted}\n    what to do: {remedy}",
            pytrace=False,
        ) from None

    return test


class StageContract:
    """What holds for a stage of any kind.

    Attributes:
        kind: the kind of stage.
        stage: the stage that is tested.
        options: the options that it is tested with; by default its defaults. A second subclass tests others.
        plugin: the module that has its hooks; by default that of the installed plugin which provides the stage.
    """

    kind: ClassVar[Kind]
    stage: ClassVar[Any]
    options: ClassVar[Any] = None
    plugin: ClassVar[str | None] = None

    @classmethod
    def given(cls) -> Any:  # noqa: ANN401 - the stage's own options
        """The options that the stage is tested with."""
        return cls.stage.options() if cls.options is None else cls.options

    @clause
    def test_record(self) -> Found:
        """The record is of its kind, and a person can name the stage and knows what it does."""
        if not isinstance(self.stage, RECORDS[self.kind]):
            yield f"{type(self.stage).__name__} {self.stage!r}"
        if not _NAME.fullmatch(self.stage.name):
            yield f"the name {self.stage.name!r}"
        if not self.stage.summary.strip() or "\n" in self.stage.summary:
            yield f"the summary {self.stage.summary!r}"
        for suffix in getattr(self.stage, "suffixes", ()):
            if not suffix.startswith(".") or suffix != suffix.lower():
                yield f"the suffix {suffix!r}"

    @clause
    def test_options(self) -> Found:
        """Options are a frozen dataclass with defaults and help, which run files give and JSON Schema describes."""
        from jsonschema import Draft202012Validator

        from dh2urdf.results import DIALECT
        from dh2urdf.run_file.schema import run_schema

        for name, _, default, text in describe_options(self.stage.options):
            if default == "required" or not text.strip():
                yield f"the option {name!r} has no {'default' if default == 'required' else 'description'}"
        for name, key in keys_of(self.stage.options).items():
            if key.measures not in (None, *(words := [each.plain for each in Dimension])):
                yield f"the option {name!r} measures {key.measures!r}, which is none of {', '.join(words)}"
        kind, given = self.stage.options, self.given()
        if not is_dataclass(kind) or not getattr(kind, "__dataclass_params__").frozen:  # noqa: B009 - no type has it
            yield f"{kind.__name__} is a dataclass that can be changed"
        try:
            hash(given)
        except TypeError as error:
            yield f"a value that can be changed ({error})"
        made = make_options(kind, {}, where=f"{self.kind} {self.stage.name!r}")
        sent = pickle.loads(pickle.dumps(given))  # noqa: S301 - made in the same line
        if sent != given or made != kind():
            yield f"{sent!r} and {made!r}"
        definitions = run_schema(catalog_of(self.stage))["$defs"]
        name = f"{self.kind}.{self.stage.name}"
        if "properties" not in definitions[name]:
            yield "pydantic cannot say what its options are"
        options = definitions[name]["properties"]
        defaults = {key: value["default"] for key, value in options.items() if "default" in value}
        json.dumps(defaults, allow_nan=False)
        schema = {"$schema": DIALECT, "$defs": definitions, "$ref": f"#/$defs/{name}"}
        its = self.stage.can(HasSchema)
        for each in (schema, its.schema() if its else schema):
            Draft202012Validator.check_schema(each)
        Draft202012Validator(schema).validate(defaults)

    @clause
    def test_registering_imports_nothing_heavy(self) -> Found:
        """Registering the plugin imports nothing heavy, nor does asking whether the stage can work."""
        home = _home(self.stage)
        provided = [item for item in load().provided(self.kind) if item.stage.name == self.stage.name]
        places = [item.plugin.name.partition(" = ")[2] for item in provided if _home(item.stage) == home]
        if not (place := self.plugin or next(iter(places), None)):
            yield f"no installed plugin provides the {self.kind} {self.stage.name!r}"
        # The options are pickled here: the child is to see what their module imports.
        loaded = in_child(_registered, place, self.kind, self.stage.name, pickle.dumps(self.given())).value
        own = {re.split("[.:]", module)[0] for module in (place or "", home)}
        if heavy := sorted(loaded - own - LIGHT - sys.stdlib_module_names):
            yield f"registering {place} imported {', '.join(heavy)}"


def _home(stage: Any) -> str:  # noqa: ANN401 - a record of any kind
    """The module of the function that does a stage's work."""
    names = ("read", "transform", "edit_table", "edit_robot", "emit", "open", "map", "pool")
    return str(next(filter(None, (getattr(stage, name, None) for name in names))).__module__)


def _registered(place: str, kind: Any, name: str, options: bytes) -> set[str]:  # noqa: ANN401 - a kind
    """In a fresh process: the packages imported by registering a plugin and asking whether its stage can work."""
    before = set(sys.modules)
    plugin = Plugin(name=f"contract = {place}", module=EntryPoint("", place, PROJECT).load(), distribution="a test")
    stage = Catalog([plugin]).get(kind, name)
    with suppress(PluginError):  # It is not installed: then it was not imported either.
        stage.require(pickle.loads(options))  # noqa: S301 - our own parent made them
    modules = set(sys.modules) - before
    return {each.partition(".")[0] for each in modules if getattr(sys.modules[each], "__spec__", None)}


class Calls(NamedTuple):
    """A function of a stage, with what it is tested with.

    Attributes:
        function: at the top level of a module; called with each input and `arguments`.
        arguments: what follows the input.
        good: inputs that it accepts.
        odd: inputs that it may refuse.
        errors: what it may refuse them with.
    """

    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    good: list[Any]
    odd: list[Any]
    errors: tuple[type[Exception], ...]


class InputContract(StageContract):
    """What holds for a stage that makes a result of an input: a reader, a transform, an edit, an emitter."""

    def calls(self, folder: Path) -> Iterable[Calls]:
        """The functions of the stage, with files of their inputs in a folder."""
        raise NotImplementedError

    @clause
    def test_is_deterministic(self, tmp_path: Path) -> Found:
        """The same input gives the same result, or the same refusal, in every process."""
        for function, arguments, good, odd, _ in self.calls(tmp_path):
            items = deepcopy([*good, *odd])
            found = [in_child(_outcomes, function, items, *arguments, seed=seed).value for seed in _SEEDS]
            for other in (*found[1:], _outcomes(function, items, *arguments)):
                if differs := difference(found[0], other):
                    yield differs

    @clause
    def test_keeps_its_input(self, tmp_path: Path) -> Found:
        """The input is after the call as it was before."""
        for function, arguments, good, _, _ in self.calls(tmp_path):
            for item in good:
                before = item.read_bytes() if isinstance(item, Path) else deepcopy(item)
                function(item, *arguments)
                if differs := difference(before, item.read_bytes() if isinstance(item, Path) else item):
                    yield differs

    @clause
    def test_does_nothing_else(self, tmp_path: Path) -> Found:
        """It writes no file, starts no process and leaves nothing running: the pipeline writes what it gives."""
        for function, arguments, good, _, _ in self.calls(tmp_path):
            seen = in_child(_results, function, good, *arguments)
            yield from (*seen.deeds, *(f"left {each}" for each in seen.left))

    @clause
    def test_raises_documented_errors_only(self, tmp_path: Path) -> Found:
        """An input that it refuses is an error of its kind, whatever is wrong with the input."""
        for function, arguments, _, odd, errors in self.calls(tmp_path):
            documented: tuple[type[Exception], ...] = (*errors, *MISSING)
            for item in odd:
                try:
                    function(item, *arguments)
                except documented:
                    continue
                except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
                    yield f"{type(error).__name__}: {error} at {getattr(item, 'name', item)}"


def _results(function: Callable[..., Any], items: Iterable[Any], *args: Any) -> list[Any]:  # noqa: ANN401 - any function
    return [function(item, *args) for item in items]


def _outcomes(function: Callable[..., Any], items: Iterable[Any], *args: Any) -> list[Any]:  # noqa: ANN401 - any function
    """What a function returns of each item, or the text of the error by which it refuses; of others their kind."""
    found: list[Any] = []
    for item in items:
        try:
            found.append(function(item, *args))
        except (Exception, SystemExit) as error:  # noqa: BLE001 - another clause is about them
            found.append(str(error) if isinstance(error, Dh2UrdfError) else type(error).__name__)
    return found


# --- Where two records differ -----------------------------------------------------------------------------------------


_PART = 200
"""Characters of a value that a difference repeats."""


def difference(first: Any, second: Any, *, whole: bool = True) -> str | None:  # noqa: ANN401 - any values
    """Where two values differ first, and by what; None where they are the same.

    `whole` is whether fields count that `==` leaves out, such as marks, notices and formulas.
    """
    both = leaves(first, whole=whole), leaves(second, whole=whole)
    for one, other in zip_longest(*both, fillvalue=("it", "nothing")):
        if one != other:
            (place, left), (_, right) = one, other
            start = next((i for i, (a, b) in enumerate(zip(left, right, strict=False)) if a != b), 0)
            cut = slice(max(0, start - _PART // 2), max(_PART, start + _PART // 2))
            return f"{place or 'it'} is once {left[cut]} and once {right[cut]}"
    return None


def leaves(value: Any, place: str = "", *, whole: bool = True) -> Iterator[tuple[str, str]]:  # noqa: ANN401 - any value
    """Every number and text in a value, as `repr` has it, with its place: ``rows[2].limits.lower``."""
    parts: list[tuple[str, Any]] = []
    if is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in fields(value) if whole or field.compare]
        parts = [(f"{place}.{name}".lstrip("."), getattr(value, name)) for name in names]
    elif isinstance(value, (list, tuple)):
        parts = [(f"{place}[{index}]", item) for index, item in enumerate(value)]
    elif isinstance(value, dict):
        parts = [(f"{place}[{key!r}]", item) for key, item in value.items()]
    else:
        yield place, repr(value)
        return
    yield place, f"a {type(value).__name__} of {len(parts)}"
    for inner, item in parts:
        yield from leaves(item, inner, whole=whole)
