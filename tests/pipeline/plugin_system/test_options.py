from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from annotated_types import Gt
from hypothesis import given, strategies as st

from dh2urdf.documents import load_yaml
from dh2urdf.errors import BrokenPluginError, ConfigError, TableError
from dh2urdf.plugin_system import describe_options
from dh2urdf.plugin_system.options import COMMAND_LINE, make_options, word_node
from dh2urdf.source import Problem


class Colour(StrEnum):
    ORANGE = "orange"
    GREY = "grey"


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    radius: float = 0.04
    shape: Literal["box", "cylinder"] = "box"


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    frames: Literal["aligned", "dh"] = field(default="aligned", metadata={"help": "which frames links have"})
    workers: Literal["auto"] | int = "auto"
    prefix: str | None = None
    picture: bool = False
    gravity: float = 9.81
    size: tuple[int, int] = (640, 480)
    joints: tuple[str, ...] = ()
    colour: Colour = Colour.GREY
    log: Path | None = None
    body: Body = Body()
    bodies: tuple[Body, ...] = ()
    base: str | dict[str, Any] | list[Any] | None = None
    height: Annotated[float, Gt(0)] = 1.0

    def __post_init__(self) -> None:
        if self.gravity < 0:
            raise ValueError("gravity points down: give a number from 0 on")
        if self.prefix == "bad":
            raise TableError(Problem(message="the prefix is bad", accepted="a good one"))
        if self.prefix == "worse":
            raise TableError(Problem(message="the prefix is bad", field="prefix"))
        if self.prefix == "crash":
            raise KeyError("oops")


@dataclass(frozen=True)
class Needy:
    port: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizes:
    length: float | None = field(default=None, metadata={"measures": "length"})
    turns: tuple[float, float, float] = field(default=(0.0, 0.0, 0.0), metadata={"measures": "angle"})
    inertia: tuple[float, ...] = field(default=(), metadata={"measures": "moment of inertia"})


def of(text: str) -> Options:
    return make_options(Options, load_yaml(text, "run.yaml"), where="loader 'x'")


def test_without_options_the_type_itself_is_made() -> None:
    """No options, none written down and an empty mapping are the defaults."""
    assert make_options(Options, where="x") == make_options(Options, {}, where="x") == of("{}") == Options()


def test_defaults_do_not_import_pydantic() -> None:
    """The import that costs most is for options that are given."""
    code = (
        "import sys; from dh2urdf.plugin_system.options import make_options; from dh2urdf_plugins.formats.urdf import UrdfOptions;"
        "make_options(UrdfOptions, where='x'); sys.exit('pydantic' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_every_kind_of_option_is_read() -> None:
    """Numbers, lists, enumerations, paths and options within options become what their types say."""
    found = of(
        "{frames: dh, workers: 3, prefix: a_, picture: true, gravity: 2, size: [1, 2], joints: [a, b], colour: orange, "
        "log: x/y, body: {radius: 1}, bodies: [{shape: cylinder}], base: {xyz: [0, 0, pi]}, height: 2}"
    )
    assert found == Options(
        frames="dh",
        workers=3,
        prefix="a_",
        picture=True,
        gravity=2.0,
        size=(1, 2),
        joints=("a", "b"),
        colour=Colour.ORANGE,
        log=Path("x/y"),
        body=Body(radius=1.0),
        bodies=(Body(shape="cylinder"),),
        base={"xyz": [0, 0, "pi"]},
        height=2.0,
    )
    assert type(found.gravity) is float


def test_where_a_text_is_wanted_a_number_is_its_text() -> None:
    """Names that look like numbers or truth values keep what was written."""
    assert of("{prefix: 007, joints: [1, 2e3, true, 0x1F, .inf]}") == Options(
        prefix="007", joints=("1", "2e3", "true", "0x1F", ".inf")
    )


@pytest.mark.parametrize(
    ("kind", "text", "problem"),
    [
        (Options, "gravity: true", "1:10 gravity value-of-other-kind"),
        (Options, "gravity: 1" + "0" * 350, "1:10 gravity value-of-other-kind"),
        (Options, "workers: all", "1:10 workers value-of-other-kind"),
        (Options, "size: [1, x]", "1:11 size.1 value-of-other-kind"),
        (Options, "bodies: [{}, {radius: x}]", "1:23 bodies.1.radius value-of-other-kind"),
        (Options, "frmaes: dh", "1:1 frmaes key-unknown"),
        (Options, "bodies: [{}, {y: 2}]", "1:15 bodies.1.y key-unknown"),
        (Options, "{prefix: a, gravity: -1}", "1:22 gravity value-refused"),
        (Options, "prefix: worse", "1:9 prefix None"),
        (Needy, "{}", "1:1 port key-missing"),
        (Sizes, "length: 2 kg", "1:9 length quantity-refused"),
        (Sizes, "length: -2*300", "1:9 length quantity-refused"),
        (Sizes, "turns: [0, 1]", "1:8 turns value-of-other-kind"),
    ],
)
def test_what_is_wrong_is_told_at_its_place(kind: type[Any], text: str, problem: str) -> None:
    """A bare length above 10 m is never taken for metres in silence; what the type itself refuses is at the option."""
    with pytest.raises(ConfigError) as caught:
        make_options(kind, load_yaml(text, "run.yaml"), where="loader 'x'")
    (found,) = caught.value.problems
    assert found.mark is not None
    assert f"{found.mark.line}:{found.mark.column} {found.field} {found.code}" == problem


@pytest.mark.parametrize("more", ["", ", gravity: 1"])
def test_a_crash_of_the_type_blames_the_plugin(more: str) -> None:
    """Any other exception is the plugin's fault, and reported as one, with its traceback kept."""
    with pytest.raises(BrokenPluginError, match="Options of the loader 'x' does not work: KeyError: 'oops'") as caught:
        of("{prefix: crash" + more + "}")
    assert "__post_init__" in caught.value.traceback


def test_a_type_that_pydantic_cannot_check_blames_the_plugin() -> None:
    """An annotation that cannot be resolved is a fault of the plugin, not of the user."""

    @dataclass(frozen=True)
    class Unresolvable:
        x: Missing = 0  # type: ignore[name-defined] # noqa: F821 - that is the point

    assert make_options(Unresolvable, where="x") == Unresolvable()
    with pytest.raises(BrokenPluginError, match=r"Unresolvable of the x does not work: .*not fully defined"):
        make_options(Unresolvable, {"x": "1"}, where="x")
    assert describe_options(Unresolvable) == [("x", "Missing", "0", "")]


# --- The command line -------------------------------------------------------------------------------------------------


def test_words_of_the_command_line_go_through_the_same_door() -> None:
    """A word is read as YAML: numbers, lists and mappings can be given."""
    words = {"gravity": "1e-3", "size": "[1, 2]", "picture": "true", "prefix": "@x", "base": "{xyz: [0, 0, pi/2]}"}
    assert make_options(Options, words, where="x") == Options(
        gravity=0.001, size=(1, 2), picture=True, prefix="@x", base={"xyz": [0, 0, "pi/2"]}
    )


@given(st.text())
def test_any_word_is_a_value(word: str) -> None:
    """What is no YAML is taken as the text it is; nothing is raised."""
    node = word_node(word)
    assert node.mark == COMMAND_LINE
    node.plain()


# --- Quantities -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "sizes"),
    [
        ("{length: 40 mm}", Sizes(length=0.04)),
        ("{length: 300 m}", Sizes(length=300.0)),
        ("{turns: [0, 1, 6.28]}", Sizes(turns=(0.0, 1.0, 6.28))),
        ("{inertia: [1 kg cm^2, 0.5]}", Sizes(inertia=(1e-4, 0.5))),
    ],
)
def test_options_that_measure_something_take_units(text: str, sizes: Sizes) -> None:
    """Bare numbers are in SI units, as in the rest of a run file; words of the command line are no other."""
    node = load_yaml(text, "run.yaml")
    assert make_options(Sizes, node, where="x") == sizes
    assert isinstance(node.value, dict)
    words = {key: json.dumps(each.plain()) if each.text is None else each.text for key, each in node.value.items()}
    assert make_options(Sizes, words, where="x") == sizes


def test_a_measure_that_there_is_not_blames_the_plugin() -> None:
    """It is a slip of the author, and of no user."""

    @dataclass(frozen=True)
    class Slip:
        length: float = field(default=0.0, metadata={"measures": "lenght"})

    with pytest.raises(BrokenPluginError, match="lenght"):
        make_options(Slip, {"length": "3 mm"}, where="edit 'x'")


# --- Descriptions -----------------------------------------------------------------------------------------------------


def test_options_are_described_in_words() -> None:
    """Name, type, default and help of every option, as a listing shows them."""
    described = {name: (kind, default, text) for name, kind, default, text in describe_options(Options)}
    assert described == {
        "frames": ("aligned or dh", "aligned", "which frames links have"),
        "workers": ("auto or a whole number", "auto", ""),
        "prefix": ("a text", "none", ""),
        "picture": ("true or false", "false", ""),
        "gravity": ("a number", "9.81", ""),
        "size": ("a list of 2, each a whole number", "[640, 480]", ""),
        "joints": ("a list, each entry a text", "[]", ""),
        "colour": ("orange or grey", "grey", ""),
        "log": ("a path", "none", ""),
        "body": ("a mapping of radius, shape", '{"radius": 0.04, "shape": "box"}', ""),
        "bodies": ("a list, each entry a mapping of radius, shape", "[]", ""),
        "base": ("a text, a mapping or a list", "none", ""),
        "height": ("a number greater than 0", "1", ""),
    }
    assert describe_options(Needy) == [("port", "a whole number", "required", "")]
