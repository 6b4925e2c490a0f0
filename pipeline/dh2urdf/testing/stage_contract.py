"""The clauses that every kind of stage has to keep.

A contract is a class of clauses, each a function that yields what is wrong. What is accepted instead and what to do
about it is in `clauses.toml`.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import json
import pickle
import re
import sys
import tomllib
import traceback
from copy import deepcopy
from importlib.resources import files
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import pytest

from dh2urdf.errors import Dh2UrdfError, MissingDependencyError, MissingProgramError
from dh2urdf.plugin_system.catalog import RECORDS, load
from dh2urdf.plugin_system.option_types import describe_options, keys_of
from dh2urdf.plugin_system.options import make_options
from dh2urdf.quantities import Dimension
from dh2urdf.stages import HasSchema
from dh2urdf.testing.catalogs import catalog_of
from dh2urdf.testing.child import in_child, registered
from dh2urdf.testing.comparing import difference

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.stages import Kind

    Found = Iterator[str]

T = TypeVar("T")

LIGHT = frozenset({"click", "dh2urdf", "dh2urdf_plugins", "lxml", "orjson", "pluggy", "yaml"})
"""What registering a plugin may import besides the standard library and its own package: it is there anyway."""
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
        except (MissingDependencyError, MissingProgramError) as error:
            pytest.skip(str(error))
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
            told = getattr(error, "__notes__", None) or traceback.format_exception(error)
            found = "\n".join([f"{type(error).__name__}: {error}", *"".join(told).splitlines()[-_FRAMES:]])
        if found is not None:
            _fail(self.stage, check, found)

    return test


def _fail(stage: Any, check: Callable[..., Found], found: str) -> None:  # noqa: ANN401 - any author's object
    kind = next((kind for kind, record in RECORDS.items() if isinstance(stage, record)), type(stage).__name__)
    sentence = (inspect.getdoc(check) or "").partition("\n")[0]
    accepted, remedy = advice(check)
    found = (found if len(found) <= _SHOWN else f"{found[:_SHOWN]} …").replace("\n", "\n        ")
    raise pytest.fail.Exception(
        f"{kind} {getattr(stage, 'name', '?')!r} breaks the contract, clause {check.__name__}: {sentence}\n"
        f"    found: {found}\n    accepted: {accepted}\n    what to do: {remedy}",
        pytrace=False,
    ) from None


def advice(check: Callable[..., Any]) -> tuple[str, str]:
    """What a clause accepts, and what to do where it is broken."""
    table = tomllib.loads(files("dh2urdf.testing").joinpath("clauses.toml").read_text("utf-8"))
    contract, _, name = check.__qualname__.partition(".")
    accepted, remedy = table[contract].get(name) or table["any"][name]
    return accepted, remedy


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
    def test_options_are_explained(self) -> Found:
        """Every option has a default and a description."""
        for name, _, default, text in describe_options(self.stage.options):
            if default == "required":
                yield f"the option {name!r} has no default"
            if not text.strip():
                yield f"the option {name!r} has no description"
        words = [each.plain for each in Dimension]
        for name, key in keys_of(self.stage.options).items():
            if key.measures not in (None, *words):
                yield f"the option {name!r} measures {key.measures!r}, which is none of {', '.join(words)}"

    @clause
    def test_options_are_frozen(self) -> Found:
        """Options cannot be changed: they are a frozen dataclass of values that cannot be changed either."""
        kind = self.stage.options
        if not dataclasses.is_dataclass(kind) or not getattr(kind, "__dataclass_params__").frozen:  # noqa: B009 - no type has it
            yield f"{kind.__name__} is a dataclass that can be changed"
        try:
            hash(self.given())
        except TypeError as error:
            yield f"a value that can be changed ({error})"

    @clause
    def test_options_come_from_a_run_file(self) -> Found:
        """Nothing said gives the defaults, and options survive the way to a worker."""
        made = make_options(self.stage.options, {}, where=f"{self.kind} {self.stage.name!r}")
        sent = pickle.loads(pickle.dumps(self.given()))  # noqa: S301 - made in the same line
        if sent != self.given() or made != self.stage.options():
            yield f"{sent!r} and {made!r}"

    @clause
    def test_schema(self) -> Found:
        """The JSON Schema of its options, and of its files where it has one, is valid, and takes the defaults."""
        from jsonschema import Draft202012Validator

        from dh2urdf.run_file.schema import DIALECT, run_schema

        definitions = run_schema(catalog_of(self.stage))["$defs"]
        name = f"{self.kind}.{self.stage.name}"
        schema = {"$schema": DIALECT, "$defs": definitions, "$ref": f"#/$defs/{name}"}
        Draft202012Validator.check_schema(schema)
        if its := self.stage.can(HasSchema):
            Draft202012Validator.check_schema(its.schema())
        if "properties" not in definitions[name]:
            yield "pydantic cannot say what its options are"
        options = definitions[name]["properties"]
        defaults = {key: value["default"] for key, value in options.items() if "default" in value}
        json.dumps(defaults, allow_nan=False)
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
        loaded = in_child(registered, place, self.kind, self.stage.name, pickle.dumps(self.given())).value
        own = {re.split("[.:]", module)[0] for module in (place or "", home)}
        if heavy := sorted(loaded - own - LIGHT - sys.stdlib_module_names):
            yield f"registering {place} imported {', '.join(heavy)}"

    # --- What the clauses of all kinds use

    @classmethod
    def given(cls) -> Any:  # noqa: ANN401 - the stage's own options
        """The options that the stage is tested with."""
        return cls.stage.options() if cls.options is None else cls.options

    def same_in_every_process(self, function: Callable[..., Any], items: Sequence[Any], *args: Any) -> Found:  # noqa: ANN401 - any arguments
        """Where a call of each item has another result in another process with another seed for hashes of texts."""
        others = [in_child(outcomes, function, items, *args, seed=seed).value for seed in _SEEDS]
        for first, second in zip(others, [*others[1:], outcomes(function, items, *args)], strict=True):
            if differs := difference(first, second):
                yield differs

    def refuses_with(self, errors: tuple[type[Exception], ...], function: Callable[..., Any], *args: Any) -> Found:  # noqa: ANN401
        """What a call raises that is none of the documented errors."""
        documented: tuple[type[Exception], ...] = (*errors, MissingDependencyError, MissingProgramError)
        try:
            function(*args)
        except documented:
            return
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
            yield f"{type(error).__name__}: {error}"


def results(function: Callable[..., Any], items: Sequence[Any], *args: Any) -> list[Any]:  # noqa: ANN401 - any function
    """What a function returns of each item: in a child process, all in one."""
    return [function(item, *args) for item in items]


def outcomes(function: Callable[..., Any], items: Sequence[Any], *args: Any) -> list[Any]:  # noqa: ANN401 - any function
    """What a function returns of each item, or the text of the error by which it refuses; of others their kind."""
    found: list[Any] = []
    for item in items:
        try:
            found.append(function(item, *args))
        except Dh2UrdfError as error:
            found.append(str(error))
        except (Exception, SystemExit) as error:  # noqa: BLE001 - another clause is about them
            found.append(type(error).__name__)
    return found


def changed_by(function: Callable[..., Any], items: Sequence[Any], *args: Any) -> Found:  # noqa: ANN401 - any function
    """Where a function changes what it is given."""
    for item in items:
        before = deepcopy(item)
        function(item, *args)
        if differs := difference(before, item):
            yield differs


def _home(stage: Any) -> str:  # noqa: ANN401 - a record of any kind
    """The module of the function that does a stage's work."""
    names = ("read", "transform", "edit_table", "edit_robot", "emit", "open", "map", "pool")
    return str(next(filter(None, (getattr(stage, name, None) for name in names))).__module__)
