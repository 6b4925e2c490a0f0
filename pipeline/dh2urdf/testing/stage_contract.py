"""The clauses that every kind of stage has to keep."""

from __future__ import annotations

import dataclasses
import json
import pickle
import re
import sys
from contextlib import suppress
from functools import cache
from importlib.metadata import EntryPoint
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

from dh2urdf.errors import CrashError, Dh2UrdfError, PluginError
from dh2urdf.hookspecs import PROJECT
from dh2urdf.isolation.child_process import ChildFailure
from dh2urdf.plugin_system.catalog import RECORDS, Catalog, Plugin, load
from dh2urdf.plugin_system.option_types import describe_options, measures_of
from dh2urdf.plugin_system.options import make_options
from dh2urdf.quantities import Dimension
from dh2urdf.testing.breach import breach
from dh2urdf.testing.catalogs import catalog_of
from dh2urdf.testing.children.forks import LIGHT_HOST
from dh2urdf.testing.children.witness import witnessed
from dh2urdf.testing.comparing import difference

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.stages import Kind

LIGHT = frozenset({"click", "dh2urdf", "dh2urdf_check", "dh2urdf_plugins", "lxml", "orjson", "pluggy", "yaml"})
"""What registering a plugin may import besides the standard library and its own package: it is there anyway."""
WORK: dict[Kind, tuple[str, ...]] = {
    "reader": ("read",),
    "transform": ("transform",),
    "edit": ("edit_table", "edit_robot"),
    "emitter": ("emit",),
    "loader": ("open", "load"),
    "executor": ("map", "pool"),
}
"""The fields of a record one of which has the function that does the work, by kind."""
_NAME = re.compile(r"[a-z0-9]+([-_.][a-z0-9]+)*")
_FRAMES = 7
"""Lines of a traceback that are repeated: the last frames and the error."""
_SEEDS = (1, 2, 3, 4)
"""Seeds for the hashes of texts: two texts in a set have one order with all of them in one of eight cases."""


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

    # --- The clauses

    def test_record(self) -> None:
        """The record is of its kind, and a person can name the stage and knows what it does."""
        record, stage = RECORDS[self.kind], self.stage
        if not isinstance(stage, record):
            self.breach(
                self.test_record,
                found=f"{type(stage).__name__} {stage!r}",
                accepted=f"a dh2urdf.stages.{record.__name__}",
                remedy=f"set `stage` of the test to the {record.__name__} that the hook dh2urdf_{self.kind}s gives",
            )
        if not _NAME.fullmatch(stage.name):
            self.breach(
                self.test_record,
                found=f"the name {stage.name!r}",
                accepted="lower-case letters, digits, and single - _ or . between them, as in 'alpha-swap'",
                remedy="choose such a name: people type it into run files and on command lines",
            )
        if not stage.summary.strip() or "\n" in stage.summary:
            self.breach(
                self.test_record,
                found=f"the summary {stage.summary!r}",
                accepted="one line of text that is not empty",
                remedy="say in the record's `summary` what the stage does: `dh2urdf plugins` lists it",
            )
        for suffix in getattr(stage, "suffixes", ()):
            if not suffix.startswith(".") or suffix != suffix.lower():
                self.breach(
                    self.test_record,
                    found=f"the suffix {suffix!r}",
                    accepted="lower case, with the dot: '.csv'",
                    remedy="write it so: names of files are compared in lower case",
                )

    def test_options_are_explained(self) -> None:
        """Every option has a default and a description."""
        self._require_dataclass(self.test_options_are_explained)
        described = describe_options(self.stage.options)
        for name, _, default, text in described:
            if default == "required":
                self.breach(
                    self.test_options_are_explained,
                    found=f"the option {name!r} has no default",
                    accepted="a default for every option: a stage is used by its name alone",
                    remedy=f"write `{name}: … = field(default=…, metadata={{'help': '…'}})`",
                )
            if not text.strip():
                self.breach(
                    self.test_options_are_explained,
                    found=f"the option {name!r} has no description",
                    accepted="a text in the field's metadata, under 'help'",
                    remedy=f"write `{name}: … = field(default=…, metadata={{'help': 'what it is for [unit]'}})`",
                )

        for name, word in measures_of(self.stage.options).items():
            if word not in (words := [each.plain for each in Dimension]):
                self.breach(
                    self.test_options_are_explained,
                    found=f"the option {name!r} measures {word!r}",
                    accepted=", ".join(words),
                    remedy="write one of these under 'measures' in the field's metadata",
                )

    def test_options_are_frozen(self) -> None:
        """Options cannot be changed: they are a frozen dataclass of values that cannot be changed either."""
        self._require_dataclass(self.test_options_are_frozen)
        if not self.stage.options.__dataclass_params__.frozen:
            self.breach(
                self.test_options_are_frozen,
                found=f"{self.stage.options.__name__} is a dataclass that can be changed",
                accepted="@dataclass(frozen=True, slots=True, kw_only=True)",
                remedy="freeze it: all manipulators of a run share one object of options",
            )
        try:
            hash(self.given())
        except TypeError as error:
            self.breach(
                self.test_options_are_frozen,
                found=f"a value that can be changed ({error})",
                accepted="numbers, texts, enumerations, tuples, frozen dataclasses",
                remedy="take a tuple in place of a list or set, and a tuple of pairs in place of a mapping",
            )

    def test_options_come_from_a_run_file(self) -> None:
        """Nothing said gives the defaults, and options survive the way to a worker."""
        self._require_dataclass(self.test_options_come_from_a_run_file)
        options = self.given()
        try:
            made = make_options(self.stage.options, {}, where=f"{self.kind} {self.stage.name!r}")
            sent = pickle.loads(pickle.dumps(options))  # noqa: S301 - made in the same line
        except Exception as error:  # noqa: BLE001 - whatever an author's type raises
            self.breach(
                self.test_options_come_from_a_run_file,
                found=f"{type(error).__name__}: {error}",
                accepted="options that can be made of a run file, and pickled",
                remedy="give fields the types of numbers, texts, Literal, tuples and dataclasses; "
                "let the type be at the top level of a module",
            )
        if sent != options or made != self.stage.options():
            self.breach(
                self.test_options_come_from_a_run_file,
                found=f"{sent!r} and {made!r}",
                accepted=f"{options!r}, and the defaults",
                remedy="let the dataclass compare its fields, and change none of them in __post_init__",
            )

    def test_schema(self) -> None:
        """The JSON Schema of its options, and of its files where it has one, is valid, and takes the defaults."""
        from jsonschema import Draft202012Validator
        from jsonschema.exceptions import SchemaError, ValidationError

        from dh2urdf.run_file.schema import DIALECT, run_schema

        self._require_dataclass(self.test_schema)
        name = f"{self.kind}.{self.stage.name}"
        definitions = run_schema(catalog_of(self.stage))["$defs"]
        schema = {"$schema": DIALECT, "$defs": definitions, "$ref": f"#/$defs/{name}"}
        own_files = [self.stage.schema()] if getattr(self.stage, "schema", None) else []
        try:
            for each in (schema, *own_files):
                Draft202012Validator.check_schema(each)
            if "properties" not in definitions[name]:
                raise SchemaError("pydantic cannot say what its options are")
            options = definitions[name]["properties"]
            defaults = {key: value["default"] for key, value in options.items() if "default" in value}
            json.dumps(defaults, allow_nan=False)
            Draft202012Validator(schema).validate(defaults)
        except (SchemaError, ValidationError, TypeError, ValueError) as error:
            self.breach(
                self.test_schema,
                found=str(error).partition("\n")[0],
                accepted="JSON Schema, version 2020-12, with which the defaults agree",
                remedy="give every option a type that JSON can hold and a default of that type",
            )

    def test_registering_imports_nothing_heavy(self) -> None:
        """Registering the plugin imports nothing heavy, nor does asking whether the stage can work."""
        place = self.plugin or self._installed_as()
        try:
            options = pickle.dumps(self.given())  # Pickled here: the child is to see what their module imports.
            loaded = witnessed(_registered, place, self.kind, self.stage.name, options, modules=LIGHT_HOST).value
        except Exception as error:  # noqa: BLE001 - whatever an author's module raises
            self.breach(
                self.test_registering_imports_nothing_heavy,
                found=f"{place} cannot be registered: {error}",
                accepted=f"a module with the hook dh2urdf_{self.kind}s, which gives the stage {self.stage.name!r}",
                remedy="set `plugin` of the test to that module, and let stage functions be at a module's top level",
            )
        own = {re.split("[.:]", module)[0] for module in (place, _home(self.kind, self.stage))}
        heavy = sorted(loaded - own - LIGHT - sys.stdlib_module_names)
        if heavy:
            self.breach(
                self.test_registering_imports_nothing_heavy,
                found=f"registering {place} imported {', '.join(heavy)}",
                accepted=f"the standard library, {', '.join(sorted(LIGHT))}, and the plugin itself",
                remedy="import it inside the function that uses it: every command of every user registers every plugin",
            )

    # --- What the clauses of all kinds use

    @classmethod
    def breach(cls, clause: Callable[..., Any], *, found: str, accepted: str, remedy: str) -> NoReturn:
        """Fail a test: say which clause is broken, what was found, what is accepted and what to do."""
        breach(cls.stage, clause, found=found, accepted=accepted, remedy=remedy)

    @classmethod
    def given(cls) -> Any:  # noqa: ANN401 - the stage's own options
        """The options that the stage is tested with."""
        if cls.options is not None:
            return cls.options
        try:
            return cls.stage.options()
        except Exception as error:  # noqa: BLE001 - whatever an author's type raises
            reason = f"{type(error).__name__}: {error}"
        breach(
            cls.stage,
            cls.test_options_are_explained,
            found=f"its options cannot be made without arguments: {reason}",
            accepted="a default for every option, and no refusal of the defaults",
            remedy="give every field a default that __post_init__ accepts",
        )

    def same(self, clause: Callable[..., Any], first: Any, second: Any, *, whole: bool = True) -> None:  # noqa: ANN401
        """Fail where two results of the same input differ; unless `whole`, only in what `==` compares."""
        if differs := difference(first, second, whole=whole):
            self.breach(
                clause,
                found=differs,
                accepted="the same result of the same input, in every process and on every machine",
                remedy="use no clock, no random numbers without a fixed seed, no id() or hash() of a text, "
                "and sort what comes out of a set or a folder",
            )

    def unchanged(self, clause: Callable[..., Any], before: Any, after: Any) -> None:  # noqa: ANN401 - any records
        """Fail where a stage has changed what it was given."""
        if differs := difference(before, after):
            self.breach(
                clause,
                found=differs,
                accepted="an input that is after the call as it was before",
                remedy="make a new record with dataclasses.replace; other stages are given the same one",
            )

    def in_child(self, clause: Callable[..., Any], function: Callable[..., Any], *args: Any, seed: int = 0) -> Any:  # noqa: ANN401
        """What was seen of a call in a child process; where it cannot be made there, the clause is broken."""
        accepted = "a result: what the contract gives it is good"
        remedy = "fix what raises this"
        try:
            return witnessed(function, *args, seed=seed)
        except PluginError:
            raise
        except CrashError as error:
            found = str(error)
            accepted = "functions that a worker can import by their names, and results that can be pickled"
            remedy = (
                "let the stage's functions be at the top level of an importable module, and end no process; "
                "a record that a stage makes holds plain values"
            )
        except Exception as error:  # noqa: BLE001 - whatever an author's code raises
            told = error.__cause__.traceback if isinstance(error.__cause__, ChildFailure) else ""
            found = "\n".join([f"{type(error).__name__}: {error}", *told.splitlines()[-_FRAMES:]])
        return self.breach(clause, found=found, accepted=accepted, remedy=remedy)

    def same_in_every_process(self, clause: Callable[..., Any], function: Callable[..., Any], *args: Any) -> None:  # noqa: ANN401 - any arguments
        """Fail where a call has another result in another process, with another seed for the hashes of texts."""
        here = function(*args)
        first, *others = [self.in_child(clause, function, *args, seed=seed).value for seed in _SEEDS]
        for other in (*others, here):
            self.same(clause, first, other)

    def _require_dataclass(self, clause: Callable[..., Any]) -> None:
        kind = self.stage.options
        if not (isinstance(kind, type) and dataclasses.is_dataclass(kind)):
            self.breach(
                clause,
                found=f"{kind!r} as the type of its options",
                accepted="a dataclass; dh2urdf.stages.NoOptions for a stage without options",
                remedy="put @dataclass(frozen=True, slots=True, kw_only=True) above the class",
            )

    def _installed_as(self) -> str:
        """The entry point of the installed plugin that provides the stage."""
        kind, home = self.kind, _home(self.kind, self.stage)
        for entry, stages in _installed(kind):
            if any(stage.name == self.stage.name and _home(kind, stage) == home for stage in stages):
                return entry
        return self.breach(
            self.test_registering_imports_nothing_heavy,
            found=f"no installed plugin provides the {self.kind} {self.stage.name!r}",
            accepted=f"a distribution with an entry point of the group {PROJECT!r}",
            remedy="`pip install -e .` the plugin, or set `plugin = 'its_module'` in the test",
        )


def each(function: Callable[..., Any], items: Sequence[Any], *args: Any) -> list[Any]:  # noqa: ANN401 - any function
    """What a function returns of each item: in a child process, all in one."""
    return [function(item, *args) for item in items]


def each_outcome(function: Callable[..., Any], items: Sequence[Any], *args: Any) -> list[Any]:  # noqa: ANN401 - any function
    """What comes of each item."""
    return [outcome(function, item, *args) for item in items]


def outcome(function: Callable[..., Any], *args: Any) -> Any:  # noqa: ANN401 - any function
    """What a function returns, or the text of the error by which it refuses; of a foreign error its kind."""
    try:
        return function(*args)
    except Dh2UrdfError as error:
        return str(error)
    except (Exception, SystemExit) as error:  # noqa: BLE001 - another clause is about them
        return type(error).__name__


def _home(kind: Kind, stage: Any) -> str:  # noqa: ANN401 - a record of the kind
    """The module of the function that does a stage's work."""
    return str(next(filter(None, (getattr(stage, name) for name in WORK[kind]))).__module__)


@cache
def _installed(kind: Kind) -> tuple[tuple[str, tuple[Any, ...]], ...]:
    """Every installed plugin, by the value of its entry point, with its stages of a kind."""
    found: dict[str, list[Any]] = {}
    for item in load().provided(kind):
        found.setdefault(item.plugin.name.partition(" = ")[2], []).append(item.stage)
    return tuple((place, tuple(stages)) for place, stages in found.items())


def _registered(place: str, kind: Kind, name: str, options: bytes) -> set[str]:
    """In a fresh process: the packages that registering a plugin, and asking whether its stage can work, import."""
    before = set(sys.modules)
    plugin = Plugin(name=place, module=EntryPoint("contract", place, PROJECT).load(), distribution="a test")
    stage = Catalog([plugin]).get(kind, name)
    if require := getattr(stage, "require", None):
        with suppress(PluginError):  # It is not installed: then it was not imported either.
            require(pickle.loads(options))  # noqa: S301 - our own parent made them
    loaded = {name: sys.modules[name] for name in set(sys.modules) - before}
    return {name.partition(".")[0] for name, module in loaded.items() if getattr(module, "__spec__", None)}
