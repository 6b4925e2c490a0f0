from __future__ import annotations

import ast
import sys
import warnings
from pathlib import Path
from types import ModuleType

import pytest

import dh2urdf
from dh2urdf.deprecation import warn_deprecated
from dh2urdf.hookspecs import INTERFACE_VERSION

HOST = Path(str(dh2urdf.__file__)).parent

OLD = """
from dataclasses import dataclass
from dh2urdf.deprecation import warn_deprecated

def old():
    helper()

def helper():
    warn_deprecated("old()", instead="new()", gone_in="2.0")

@dataclass
class Record:
    new: int = 0
    old: int | None = None

    def __post_init__(self):
        if self.old is not None:
            warn_deprecated("Record(old=…)", instead="Record(new=…)", gone_in="2.0")
"""


@pytest.fixture
def host(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A module of dh2urdf with something old in it."""
    module = ModuleType("dh2urdf.some_old_module")
    monkeypatch.setitem(sys.modules, module.__name__, module)  # Dataclasses look for their module there.
    exec(compile(OLD, "some_old_module.py", "exec"), vars(module))  # noqa: S102 - the text above
    return module


def line_of(text: str) -> int:
    """The line of this file that ends with a text."""
    lines = Path(__file__).read_text("utf-8").splitlines()
    return next(number for number, line in enumerate(lines, start=1) if line.endswith(f"  # {text}"))


def test_it_names_what_takes_its_place_and_when_it_goes(host: ModuleType) -> None:
    """One sentence, in Python's own class of such warnings."""
    sentence = r"^old\(\) is gone in version 2\.0 of dh2urdf's plugin interface: use new\(\)$"
    with pytest.warns(DeprecationWarning, match=sentence):
        host.old()


def test_it_points_to_the_line_that_uses_it(host: ModuleType) -> None:
    """Functions of dh2urdf between that line and the warning do not count, nor do those that Python makes."""
    with pytest.warns(DeprecationWarning, match=r"old\(\)") as warned:
        host.old()  # a call
    assert (warned[0].filename, warned[0].lineno) == (__file__, line_of("a call"))
    with pytest.warns(DeprecationWarning, match="Record") as warned:
        host.Record(old=1)  # a record
    assert (warned[0].filename, warned[0].lineno) == (__file__, line_of("a record"))


def test_who_does_not_use_it_hears_nothing(host: ModuleType) -> None:
    """A record without the old field is silent."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert host.Record(new=1).new == 1


def test_the_built_in_plugins_are_users_like_any() -> None:
    """A warning about them points into them: they are no part of the host."""
    plugin = ModuleType("dh2urdf_plugins.some_module")
    vars(plugin)["warn_deprecated"] = warn_deprecated
    with pytest.warns(DeprecationWarning, match="use y") as warned:
        exec(compile("\n\nwarn_deprecated('x', instead='y', gone_in='2.0')", "plugin.py", "exec"), vars(plugin))  # noqa: S102
    assert (warned[0].filename, warned[0].lineno) == ("plugin.py", 3)


def test_nothing_stays_longer_than_it_says() -> None:
    """What was to go in this version of the interface is gone."""
    present = [int(number) for number in INTERFACE_VERSION.split(".")]
    overdue = []
    for path in sorted(HOST.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "warn_deprecated":
                gone_in = next(word.value.value for word in node.keywords if word.arg == "gone_in")  # type: ignore[attr-defined]
                if [int(number) for number in gone_in.split(".")] <= present:
                    overdue.append(f"{path.name}:{node.lineno}")
    assert overdue == []
