"""Everything that fuzzing started from and found, through the targets again: it needs no fuzzer."""

import importlib.util
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from dh2urdf.quantities import Quantity
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.formats.urdf import EMITTER as URDF

FUZZ = Path(__file__).parents[1] / "fuzz"
REFERENCE = Path(__file__).parent / "reference" / "inputs"


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, FUZZ / f"{name}.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


targets, fuzz = load("targets"), load("fuzz")
KEPT = sorted(path for path in (FUZZ / "corpus").glob("*/*"))


@pytest.mark.parametrize("target", sorted(targets.TARGETS))
def test_what_fuzzing_found_stays_mended(target: str) -> None:
    """An input is refused with an error of dh2urdf, or is what it claims to be: no traceback, no other arm."""
    for path in (FUZZ / "corpus" / target).iterdir():
        targets.TARGETS[target](path.read_bytes())


def test_the_reference_tables_pass_the_same_oracle() -> None:
    """The tables of the reference do, each through the reader that its suffix asks for."""
    for path in REFERENCE.glob("*.[cy]*"):
        targets.TARGETS[path.suffix[1:]](path.read_bytes())


def test_every_target_has_a_corpus_and_words() -> None:
    """A target without either would begin at nothing; and the script knows the same targets."""
    names = set(targets.TARGETS)
    assert set(fuzz.TARGETS) == names
    assert {path.name for path in (FUZZ / "corpus").iterdir()} == names
    assert {path.stem for path in (FUZZ / "words").iterdir()} == names
    assert all(path.stat().st_size <= fuzz.LONGEST for path in KEPT)


@pytest.mark.parametrize(
    ("target", "content"),
    [
        ("csv", b"# convention: standard\na,alpha,d\n0,0,0.125\n0,0,0\n"),
        ("yaml", b"convention: standard\njoints: [{a: 0, alpha: 0, d: 0.125}, {a: 0, alpha: 0, d: 0}]\n"),
    ],
)
def test_the_oracle_notices_another_arm(target: str, content: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """A description that is a millimetre off is a finding."""
    targets.TARGETS[target](content)

    def a_millimetre_off(robot: Any, stem: str, options: Any) -> tuple[EmittedFile]:
        (file,) = URDF.emit(robot, stem, options)
        joints, _, tool = file.content.rpartition(b'<origin xyz="0 0 0.125"')
        return (replace(file, content=joints + b'<origin xyz="0 0 0.126"' + tool),)

    monkeypatch.setattr(targets, "URDF", replace(URDF, emit=a_millimetre_off))
    with pytest.raises(targets.Broken, match="the description is another arm"):
        targets.TARGETS[target](content)


def test_the_oracle_notices_another_sum(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sum that is not what arithmetic makes of it is a finding."""
    monkeypatch.setattr(targets, "evaluate", lambda *_arguments, **_options: Quantity(3.0000000000000004))
    with pytest.raises(targets.Broken, match="and Python says 3"):
        targets.TARGETS["expression"](b"1 + 2")


def test_every_group_of_mutants_has_modules_and_tests() -> None:
    """What `fuzz/mutants.py` changes, and what is to notice it, is there."""
    mutants = load("mutants")
    for group in mutants.GROUPS.values():
        assert group.modules
        assert all((mutants.ROOT / test).exists() for test in group.tests)
