"""Everything that fuzzing started from and found, through the targets again: it needs no fuzzer."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from types import ModuleType

FUZZ = Path(__file__).parents[1] / "fuzz"
REFERENCE = Path(__file__).parent / "reference" / "inputs"


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, FUZZ / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


targets, fuzz = load("targets"), load("fuzz")
KEPT = sorted(path for path in (FUZZ / "corpus").glob("*/*"))


@pytest.mark.parametrize("path", KEPT, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_what_fuzzing_found_stays_mended(path: Path) -> None:
    """An input is refused with an error of dh2urdf, or is what it claims to be: no traceback, no other arm."""
    targets.TARGETS[path.parent.name](path.read_bytes())


@pytest.mark.parametrize("path", sorted(REFERENCE.glob("*.[cy]*")), ids=lambda path: path.name)
def test_the_reference_tables_pass_the_same_oracle(path: Path) -> None:
    """The tables of the reference do, each through the reader that its suffix asks for."""
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
        ("expression", b"pi/2 + 1"),
        ("csv", b"# convention: standard\na,alpha,d\n0.1,pi/2,0.2\n"),
        ("yaml", b"convention: standard\njoints: [{a: 0.1, alpha: pi/2, d: 0.2}]\n"),
    ],
)
def test_the_oracle_notices(target: str, content: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """An arm whose description is another one, and a sum that is another one, are findings."""

    def a_millimetre_off(number: float) -> float:
        return number + 0.001

    evaluate, proof = targets.evaluate, targets.prove

    def wrong_evaluate(*arguments: Any, **options: Any) -> Any:
        quantity = evaluate(*arguments, **options)
        return type(quantity)(a_millimetre_off(quantity.value), quantity.has_unit, quantity.variable, quantity.sign)

    def wrong_prove(arm: Any, robot: Any, poses: Any) -> Any:
        long = type(arm.rows[0])(joint="joint_1", link="link_1", a=a_millimetre_off(arm.rows[0].a), alpha=0, d=0)
        return proof(type(arm)(name="x", convention=arm.convention, rows=(long,)), robot, poses)

    targets.TARGETS[target](content)
    if target == "expression":
        monkeypatch.setattr(targets, "evaluate", wrong_evaluate)
        content = b"1 + 2"
    else:
        monkeypatch.setattr(targets, "prove", wrong_prove)
    with pytest.raises(targets.Broken):
        targets.TARGETS[target](content)


def test_an_unknown_target_is_told() -> None:
    """The script names its targets; it needs no fuzzer for that."""
    result = subprocess.run(
        [sys.executable, FUZZ / "fuzz.py", "xml"], capture_output=True, text=True, check=False, timeout=60
    )
    assert result.returncode == 2
    assert "the targets are csv, yaml, expression, urdf, run_file" in result.stderr
