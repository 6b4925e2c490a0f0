from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.output.layouts import DEFAULT_SIZE, Form, Layout
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.sections import DEFAULT_SAMPLE, DEFAULT_TIME_LIMIT

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.run_file.config import RunConfig


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "a.csv").write_text("a,alpha,d\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def config(folder: Path, text: str, *settings: str) -> RunConfig:
    (folder / "run.yaml").write_text(f"inputs: a.csv\n{text}\n")
    return load_config((folder / "run.yaml").relative_to(folder), settings)


def test_defaults(folder: Path) -> None:
    """One folder; all files proved; what is slow for a thousand and a sample of the rest; five minutes for each."""
    found = config(folder, "")
    assert found.output.layout == Layout(form=Form.FILES, size=DEFAULT_SIZE)
    assert found.proof.proved == Sample(first=0, every=1)
    assert found.sample == DEFAULT_SAMPLE == Sample(first=1000, every=50)
    assert found.execution.time_limit == DEFAULT_TIME_LIMIT == 300.0


def test_every_setting_is_read(folder: Path) -> None:
    """From the file, and from the command line in its place."""
    text = (
        "output: {directory: out, layout: shards, size: 500}\n"
        "proof: {poses: 8, first: 10, every: 3}\n"
        "sample: {first: 0, every: 1000}\n"
        "execution: {stage: local, time_limit: 0.5}"
    )
    found = config(folder, text)
    assert found.problems == ()
    assert found.output.layout == Layout(form=Form.SHARDS, size=500)
    assert (found.proof.proved, found.sample) == (Sample(first=10, every=3), Sample(first=0, every=1000))
    assert (found.execution.time_limit, found.proof.poses) == (0.5, 8)
    changed = config(
        folder, text, "output.layout=folders", "sample.every=7", "execution.time_limit=60", "proof.first=0"
    )
    assert changed.problems == ()
    assert changed.output.layout == Layout(form=Form.FOLDERS, size=500)
    assert (changed.sample.every, changed.execution.time_limit, changed.proof.proved.first) == (7, 60.0, 0)
