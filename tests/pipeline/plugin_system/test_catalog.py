import json
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path
from subprocess import CompletedProcess
from threading import Event
from types import ModuleType
from typing import Any, cast

import pytest
from other_fields import with_field

from dh2urdf.errors import BrokenPluginError, InputError, StageConflictError, UnknownStageError
from dh2urdf.hookspecs import hookimpl
from dh2urdf.plugin_system import Catalog, load
from dh2urdf.plugin_system.catalog import Plugin
from dh2urdf.plugin_system.discovery import installed
from dh2urdf.stages import Emitter, NoOptions, Reader, Traces


def reader(name: str, *suffixes: str) -> Reader[Any]:
    return Reader(
        name=name, summary="reads", read=lambda _path, _options: iter(()), options=NoOptions, suffixes=suffixes
    )


def emitter(name: str, *suffixes: str) -> Emitter[Any]:
    return Emitter(name=name, summary="writes", emit=lambda *_: (), options=NoOptions, suffixes=suffixes)


def plugin(distribution: str, **hooks: Callable[[], Any]) -> Plugin:
    """A plugin whose module has these hooks, as an entry point of a distribution would give it."""
    module = ModuleType(distribution)
    for name, hook in hooks.items():
        hook.__name__ = name
        setattr(module, name, hookimpl(hook))
    return Plugin(name=f"{distribution} = {distribution}", distribution=f"{distribution} 1.0", module=module)


def readers(distribution: str, *stages: Reader[Any]) -> Plugin:
    return plugin(distribution, dh2urdf_readers=lambda: stages)


def names(catalog: Catalog, kind: Any) -> list[str]:
    return [item.stage.name for item in catalog.provided(kind)]


GOOD = readers("good", reader("table", ".tab"))


def failing() -> Iterable[Any]:
    raise RuntimeError("the moon is in the wrong phase")


def half_way() -> Iterable[Any]:
    yield reader("half")
    raise KeyError("gone")


def leaving() -> Iterable[Any]:
    raise SystemExit("this plugin thinks that it is a program")


class TestWhatIsProvided:
    def test_stages_are_listed_by_kind_and_name(self) -> None:
        """Every plugin's stages are in the catalog, by name, each with the distribution that provides it."""
        catalog = Catalog([readers("b", reader("z"), reader("y")), readers("a", reader("x"))])
        provided = [(item.stage.name, item.plugin.distribution) for item in catalog.provided("reader")]
        assert provided == [("x", "a 1.0"), ("y", "b 1.0"), ("z", "b 1.0")]
        assert names(catalog, "emitter") == []

    def test_a_hook_is_called_once_and_only_when_its_kind_is_asked_for(self) -> None:
        """A run that needs no simulator does not even ask for one."""
        calls: list[str] = []

        def counted(kind: str) -> Callable[[], Any]:
            return lambda: calls.append(kind) or ()

        catalog = Catalog([plugin("p", dh2urdf_readers=counted("reader"), dh2urdf_loaders=counted("loader"))])
        assert calls == []
        for _ in range(3):
            catalog.provided("reader")
        assert calls == ["reader"]


HOOKS = (
    "the hooks are dh2urdf_readers, dh2urdf_transforms, dh2urdf_edits, dh2urdf_emitters, dh2urdf_loaders, "
    "dh2urdf_executors, dh2urdf_commands"
)


def test_threads_find_what_one_finds() -> None:
    """While one thread imports a plugin for its readers, another asks for its emitters, and waits for them."""
    importing, asked = Event(), Event()
    given = plugin("both", dh2urdf_readers=lambda: [reader("r", ".r")], dh2urdf_emitters=lambda: [emitter("e", ".e")])

    class Slow:
        def load(self) -> ModuleType:
            importing.set()
            asked.wait(0.1)
            return given.module  # type: ignore[no-any-return]

    catalog = Catalog([Plugin(name="both = both", distribution="both 1.0", point=cast("EntryPoint", Slow()))])
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(names, catalog, "reader")
        importing.wait()
        second = pool.submit(names, catalog, "emitter")
        found = second.result()
        asked.set()
    assert (first.result(), found) == (["r"], ["e"])


class TestRecords:
    """Entry points that name a record, such as ``"reader.acme" = "acme:READER"``."""

    @pytest.mark.parametrize("entry", ["reader.acme", "acme"])
    def test_a_record_is_a_stage(self, entry: str) -> None:
        """It needs no hook, and is of its own kind only."""
        acme = Plugin(
            name=f"{entry} = acme:READER", distribution="acme 1.0", module=(record := reader("acme", ".acme"))
        )
        catalog = Catalog([acme, GOOD])
        assert catalog.get("reader", "acme") is record
        assert catalog.reader_for(Path("arm.acme")) is record
        assert catalog.plugin_of(record) is acme
        assert names(catalog, "emitter") == []
        assert catalog.broken == ()

    @pytest.mark.parametrize(
        ("record", "reason"),
        [
            (emitter("acme"), "TypeError: the entry point 'reader.acme' gave Emitter"),
            (
                reader("other"),
                "LookupError: its entry point 'reader.acme' names the reader 'acme', and the entry point",
            ),
            ("acme", "TypeError: it is no record of dh2urdf.stages, and has no hook of dh2urdf"),
            (replace(reader("acme"), capabilities=("fast",)), "TypeError: the capabilities of the reader 'acme' are"),
            (replace(reader("acme"), capabilities=(Traces(len),) * 2), "have one twice"),
        ],
        ids=["of another kind", "of another name", "no record", "no capability", "a capability twice"],
    )
    def test_another_record_breaks_its_plugin(self, record: Any, reason: str) -> None:
        """With the reason; others work."""
        catalog = Catalog([Plugin(name="reader.acme = acme:READER", distribution="acme 1.0", module=record), GOOD])
        assert names(catalog, "reader") == ["table"]
        (broken,) = catalog.broken
        assert reason in broken.reason


class TestBrokenPlugins:
    @pytest.mark.parametrize(
        ("hook", "reason"),
        [
            (failing, "RuntimeError: the moon is in the wrong phase"),
            (half_way, "KeyError: 'gone'"),
            (leaving, "SystemExit: this plugin thinks that it is a program"),
            (lambda: [emitter("urdf")], "TypeError: the hook dh2urdf_readers gave Emitter"),
            (lambda: ["table"], "TypeError: the hook dh2urdf_readers gave str 'table', not a dh2urdf.stages.Reader"),
            (lambda: None, "TypeError: the hook dh2urdf_readers gave None, not a list of dh2urdf.stages.Reader"),
        ],
        ids=["raises", "raises half way", "leaves", "a record of another kind", "no record", "nothing"],
    )
    def test_when_its_hook_is_called(self, hook: Callable[[], Any], reason: str) -> None:
        """A plugin whose hook fails, or gives what is no record of its kind, provides nothing; others do."""
        catalog = Catalog([plugin("bad", dh2urdf_readers=hook), GOOD])
        assert catalog.broken == ()
        assert names(catalog, "reader") == ["table"]
        (broken,) = catalog.broken
        assert broken.plugin == "bad = bad"
        assert reason in broken.reason

    def test_one_bad_hook_does_not_take_the_others_of_its_plugin_along(self) -> None:
        """A plugin whose readers fail still provides its emitters."""
        catalog = Catalog([plugin("half", dh2urdf_readers=failing, dh2urdf_emitters=lambda: [emitter("dot")])])
        assert names(catalog, "reader") == []
        assert names(catalog, "emitter") == ["dot"]

    def test_a_stage_that_a_broken_plugin_may_provide(self) -> None:
        """An unknown stage is blamed on the broken plugin that may provide it, with its reason: the run needs it."""
        catalog = Catalog([plugin("bad", dh2urdf_readers=failing), GOOD])
        with pytest.raises(BrokenPluginError) as caught:
            catalog.get("reader", "tabel")
        assert caught.value.exit_status == 3
        assert "plugin 'bad = bad' of bad 1.0 is broken: RuntimeError" in str(caught.value)
        assert "no other plugin provides the reader 'tabel'" in str(caught.value)
        assert "did you mean 'table'?" in str(caught.value)


class TestUsual:
    def test_the_built_in_one_goes_first(self) -> None:
        """What a record calls usual is taken where none is named; a plugin's where dh2urdf's own are left out."""
        other = replace(load().usual("emitter"), name="other")
        there = Catalog([*installed().plugins, plugin("lab", dh2urdf_emitters=lambda: [other])])
        assert there.usual("emitter").name == load().usual("emitter").name == "urdf"
        assert Catalog([plugin("lab", dh2urdf_emitters=lambda: [other])]).usual("emitter") is other
        with pytest.raises(UnknownStageError, match="that is taken where none is named"):
            Catalog([plugin("lab", dh2urdf_emitters=lambda: [replace(other, capabilities=())])]).usual("emitter")

    def test_a_transform_compares_choices_of_its_own(self) -> None:
        """Another name breaks its plugin, with the reason."""
        odd = with_field(replace(load().usual("transform"), name="odd"), "option", "colour")
        there = Catalog([plugin("lab", dh2urdf_transforms=lambda: [odd])])
        assert there.provided("transform") == ()
        assert "is 'colour', which is none of its options" in there.broken[0].reason


class TestNames:
    def test_two_plugins_with_one_name(self) -> None:
        """A name that two distributions claim is an error that names both, when the name is asked for."""
        catalog = Catalog([readers("one", reader("table")), readers("two", reader("table"), reader("other"))])
        assert catalog.get("reader", "other").name == "other"
        with pytest.raises(StageConflictError) as caught:
            catalog.get("reader", "table")
        assert caught.value.exit_status == 3
        assert caught.value.distributions == ("one 1.0", "two 1.0")
        assert "reader 'table' is claimed by one 1.0 and by two 1.0" in str(caught.value)


class TestSuffixes:
    CATALOG = Catalog(
        [
            readers("r", reader("csv", ".csv", ".tsv"), reader("yaml", ".yaml")),
            plugin("e", dh2urdf_emitters=lambda: [emitter("urdf", ".urdf", ".xml"), emitter("xacro", ".urdf.xacro")]),
            plugin("f", dh2urdf_emitters=lambda: [emitter("plain", ".xacro")]),
        ]
    )

    @pytest.mark.parametrize(
        ("file", "stage"), [("a.csv", "csv"), ("A.TSV", "csv"), ("x/a.b.yaml", "yaml"), (".hidden.csv", "csv")]
    )
    def test_a_reader_is_chosen_by_suffix(self, file: str, stage: str) -> None:
        """The suffix chooses the reader; capitals do not matter."""
        assert self.CATALOG.reader_for(Path(file)).name == stage

    @pytest.mark.parametrize(
        ("file", "stage"), [("a.urdf", "urdf"), ("a.urdf.xacro", "xacro"), ("a.xacro", "plain"), ("a.XML", "urdf")]
    )
    def test_the_longest_suffix_wins(self, file: str, stage: str) -> None:
        """Of several suffixes that a name has, the longest chooses the emitter."""
        assert self.CATALOG.emitter_for(Path(file)).name == stage

    @pytest.mark.parametrize("file", ["a.xls", ".csv", "a.csv.txt", "a"])
    def test_a_suffix_has_one_reader(self, file: str) -> None:
        """A suffix that no reader takes is an error, and so is one that two take."""
        twice = Catalog([readers("one", reader("mine", ".csv")), readers("two", reader("yours", ".csv"))])
        for catalog, path, code in (
            (self.CATALOG, file, "no-stage-for-file"),
            (twice, "a.csv", "several-stages-for-file"),
        ):
            with pytest.raises(InputError) as caught:
                catalog.reader_for(Path("folder", path))
            assert caught.value.problems[0].code == code


BROKEN = {
    "at_import": "raise OSError('the licence server does not answer')",
    "at_import_too": "import no_such_package_of_ours",
    "at_exit": "import sys; sys.exit('give me arguments')",
    "at_registration": "from dh2urdf.hookspecs import hookimpl\n@hookimpl\ndef dh2urdf_writers(): return ()",
    "at_call": "from dh2urdf.hookspecs import hookimpl\n@hookimpl\ndef dh2urdf_emitters(): return 1 / 0",
    "no_syntax": "def def",
    "no_hook": "",
    "parameter": "from dh2urdf.hookspecs import hookimpl\n@hookimpl\ndef dh2urdf_readers(_color): return ()",
}
REASONS = {
    "at_import": "OSError: the licence server does not answer",
    "at_import_too": "ModuleNotFoundError: No module named 'no_such_package_of_ours'",
    "at_exit": "SystemExit: give me arguments",
    "at_registration": "PluginValidationError: unknown hook 'dh2urdf_writers'",
    "at_call": "ZeroDivisionError: division by zero",
    "no_syntax": "SyntaxError: ",
    "no_hook": f"with the decorator dh2urdf.hookspecs.hookimpl; {HOOKS}",
    "parameter": "_color",
}


@pytest.fixture
def broken_plugins(tmp_path: Path, install: Callable[..., None]) -> Path:
    folder = tmp_path / "site"
    for distribution, source in BROKEN.items():
        install(folder, distribution, source)
    return folder


class TestInstalledPluginsThatAreBroken:
    def test_they_are_listed_with_their_reasons(
        self, dh2urdf: Callable[..., CompletedProcess[str]], broken_plugins: Path
    ) -> None:
        """`dh2urdf plugins` lists every broken plugin with its distribution and reason, and ends well."""
        listed = json.loads(dh2urdf("plugins", "--json", path=[broken_plugins]).stdout)
        found = {entry["distribution"]: entry["reason"] for entry in listed["broken"]}
        assert set(found) == {f"{distribution} 1.0" for distribution in BROKEN}
        for distribution, reason in REASONS.items():
            assert reason in found[f"{distribution} 1.0"]
        assert {"csv", "urdf"} <= {stage["name"] for stage in listed["stages"]}
        printed = dh2urdf("plugins", path=[broken_plugins]).stdout
        assert "lab = at_import_lab of at_import 1.0: OSError: the licence server does not answer" in printed
