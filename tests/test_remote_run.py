"""Runs whose output goes to an object store: a real server on loopback."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from dh2urdf.output.store import Store, open_store

RUN = """\
inputs: arms.csv
output: {directory: ADDRESS, layout: LAYOUT}
emitters: EMITTERS
"""
DURATIONS = {"timing.json"}


@pytest.fixture
def arms(tmp_path: Path) -> Path:
    rows = [f"arm{k},j{j},0.{k + 1},pi/2,0.{j}" for k in range(30) for j in range(1, 4)]
    (tmp_path / "arms.csv").write_text("\n".join(["# convention: standard", "robot,joint,a,alpha,d", *rows, ""]))
    return tmp_path


def contents(store: Store) -> dict[str, str]:
    return {name: hashlib.sha256(store.read(name)).hexdigest() for name in store.names() if name not in DURATIONS}


@pytest.mark.long
@pytest.mark.parametrize(("layout", "emitters"), [("files", "[urdf, xacro]"), ("shards", "urdf")])
def test_an_object_store_holds_what_a_folder_would(
    arms: Path, bucket: str, dh2urdf: Callable[..., CompletedProcess[str]], layout: str, emitters: str
) -> None:
    """The same objects as files, byte for byte; a second run with --resume keeps them, and makes what is damaged."""
    text = RUN.replace("LAYOUT", layout).replace("EMITTERS", emitters)
    (arms / "far.yaml").write_text(text.replace("ADDRESS", f"{bucket}/arms"))
    dh2urdf("run", "far.yaml", "--workers", "2")
    dh2urdf("run", "far.yaml", "--workers", "1", "-o", "out")  # The report has the hash of the run file.
    far, near = open_store(f"{bucket}/arms"), open_store(arms / "out")
    assert contents(far) == contents(near)
    said = dh2urdf("run", "far.yaml", "--resume", "--workers", "1").stdout
    assert "30 unchanged" in said
    damaged = "arm7.urdf" if layout == "files" else "000000.tar"
    far.write(damaged, b"<robot")
    said = dh2urdf("run", "far.yaml", "--resume").stdout
    assert ("29 unchanged" if layout == "files" else "30 made") in said
    assert contents(far) == contents(near)
