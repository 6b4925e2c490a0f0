"""Random variation sections through whole runs: a bounded part of `fuzz/variations.py`, and that it finds what is wrong."""

import random
import tempfile
from pathlib import Path
from typing import Any

import pytest
import variations
from hypothesis import given, settings, strategies as st
from variation_sections import make_rule, make_section
from variations import TOGETHER, Figures, WrongRunError, try_sections

from dh2urdf.run_file.variation_section import LAWS, WORD_LAWS
from dh2urdf.variations.sampling import Sampling
from dh2urdf.variations.variation import FIELDS

PAIRS = [(field, law) for field, what in FIELDS.items() for law in (WORD_LAWS if what.dimension is None else LAWS)]


@pytest.mark.parametrize("sampling", list(Sampling))
def test_every_field_varies_by_every_law(tmp_path: Path, sampling: Sampling) -> None:
    """One rule for each field, law and sampling, with random values: no section ends a run, and every variant has a row."""
    rng, figures = random.Random(f"all {sampling}"), Figures()  # noqa: S311 - examples
    sections: list[dict[str, Any]] = []
    for number, (field, law) in enumerate(PAIRS):
        rule = make_rule(rng, "ur5", field, law)
        name = f"v{number % TOGETHER:02d}"
        sections.append({"name": name, "of": "ur5", "vary": rule, "count": 2, "sampling": sampling.value})
    for start in range(0, len(sections), TOGETHER):
        try_sections(sections[start : start + TOGETHER], tmp_path, "files", figures)
    assert figures.pairs == {(field, law, sampling.value) for field, law in PAIRS}
    assert figures.variants > len(PAIRS)
    assert figures.variants > 2 * sum(figures.failed.values())


@settings(max_examples=20)
@given(seed=st.integers(0, 2**32), form=st.sampled_from(["files", "shards", "dry"]))
def test_no_section_ends_a_run(seed: int, form: str) -> None:
    """Several rules together, of any arm, right and wrong."""
    rng = random.Random(seed)  # noqa: S311 - examples
    with tempfile.TemporaryDirectory() as folder:
        try_sections([make_section(rng, f"v{place}") for place in range(4)], Path(folder), form, Figures())


@pytest.mark.parametrize("bounds", [[6.2, 7.2], [6.3, 7.2]], ids=["some", "none"])
def test_members_that_no_arm_can_be_fail_alone(tmp_path: Path, bounds: list[float]) -> None:
    """A lower bound beyond the upper one, of a few variants or of all: each has a row that says so."""
    figures = Figures()
    vary = {"field": "lower", "joints": "all", "uniform": bounds}
    try_sections([{"name": "v", "of": "ur5", "vary": [vary], "count": 40}], tmp_path, "files", figures)
    assert figures.variants == 40
    assert figures.failed == {"manipulator": 40}


def test_a_fault_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the loop is for: a stage that raises, and a run that does."""
    section = {"name": "v", "of": "ur5", "vary": [{"field": "a", "joints": 2, "scale": [0.9, 1.1]}], "count": 3}
    with monkeypatch.context() as patch:
        patch.setattr("dh2urdf.tasks.batch.made_variants", lambda *_: {}["nothing"])
        with pytest.raises(WrongRunError, match="the run raised KeyError"):
            try_sections([section], tmp_path, "files", Figures())
    with monkeypatch.context() as patch:
        patch.setattr(variations, "execute", lambda *_, **__: (None, {"manipulators": [], "left_out": 0}))
        with pytest.raises(WrongRunError, match="0 rows for 3 variants"):
            try_sections([section], tmp_path, "dry", Figures())
