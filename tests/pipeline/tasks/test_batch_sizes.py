"""How many manipulators a worker takes at once: few at first and at the end, and never part of a shard."""

from collections.abc import Callable
from itertools import accumulate
from pathlib import Path

import pytest
from command_line import Cli

import dh2urdf
from dh2urdf.plugin_system import load
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.tasks.batch import LARGE, Expected, batches

VARIED = "variations: [{of: arm, count: %d, vary: [{field: d, joints: 1, uniform: [0, 1]}]}]\n"


@pytest.fixture
def sizes(tmp_path: Path) -> Callable[..., list[int]]:
    """The sizes of the batches of an arm of so many joints and of its variants."""

    def of(count: int, more: str = "", joints: int = 6, workers: int | str = 1) -> list[int]:
        (tmp_path / "arm.csv").write_text("# convention: standard\na,alpha,d\n" + "0.1,0,0\n" * joints)
        execution = f"execution: {{options: {{workers: {workers}}}}}\n"
        (tmp_path / "run.yaml").write_text("inputs: arm.csv\n" + VARIED % (count - 1) + execution + more)
        plan = make_plan(load_config(tmp_path / "run.yaml"), load())
        return [len(batch) for batch in batches(plan, Expected(plan))]

    return of


def shards(size: int) -> str:
    return f"output: {{layout: shards, size: {size}}}\n"


@pytest.mark.parametrize("workers", [1, 2, "auto"])
@pytest.mark.parametrize("size", [0, 7, 100, 1000])
def test_batches_end_where_shards_end(sizes: Callable[..., list[int]], size: int, workers: int | str) -> None:
    """All manipulators are in one batch each, and all of a shard in the same one."""
    found = sizes(20_000, shards(size) if size else "", workers=workers)
    assert sum(found) == 20_000
    assert not size or {end % size for end in accumulate(found[:-1])} <= {0}


def test_batches_are_large_where_one_worker_does_all(sizes: Callable[..., list[int]]) -> None:
    """They grow from one manipulator, or one shard, to what a worker can hold."""
    assert sizes(20_000, shards(1000)) == [1000, 1000, 2000, 4000, 4000, 4000, 4000]
    assert sizes(10_000) == [1, 1, *(2**power for power in range(1, 12)), 4000, 1904]


@pytest.mark.parametrize("workers", [2, 3])
def test_workers_end_together(sizes: Callable[..., list[int]], workers: int) -> None:
    """No batch is more than half of a worker's part of what is left, but for one shard: nobody waits long at the end."""
    found = sizes(40_000, shards(100), workers=workers)
    left = [40_000 - done for done in (0, *accumulate(found))]
    assert all(size <= max(LARGE, rest / (2 * workers)) for size, rest in zip(found, left, strict=False))
    assert max(found) == 4000


@pytest.mark.parametrize("workers", [1, 2])
def test_shards_are_the_same_in_whatever_batches(tmp_path: Path, workers: int) -> None:
    """Those of a batch each, and those of twenty: every byte of them and of the manifest."""
    (tmp_path / "arm.csv").write_text("# convention: standard\na,alpha,d\n0.1,pi/2,0\n0.2,0,0.3\n")
    (tmp_path / "run.yaml").write_text("inputs: arm.csv\n" + VARIED % 499 + shards(20))
    for name, asked in (("one", workers), ("each", "auto")):
        settings = {"execution.options.workers": asked, "report.html": False}
        dh2urdf.run(tmp_path / "run.yaml", tmp_path / name, settings=settings)
    names = sorted(path.name for path in (tmp_path / "each").glob("*.tar"))
    assert len(names) == 25
    for name in (*names, "manifest.jsonl", "report.json"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "each" / name).read_bytes()


def test_a_batch_that_is_broken_off_keeps_its_shards(tmp_path: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """What stood whole before something else was in the way is not made again."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.csv").write_text("# convention: standard\na,alpha,d\n0.1,pi/2,0\n0.2,0,0.3\n")
    (tmp_path / "run.yaml").write_text("inputs: arm.csv\n" + VARIED % 99 + shards(10))
    words = ("run", "run.yaml", "--workers", 1, "--set", "report.html=false")
    obstacle = tmp_path / "out/000005.tar"  # in the middle of the third batch, which has four
    obstacle.mkdir(parents=True)
    assert "000005.tar" in cli(*words, "-o", "out", status=2).stderr
    obstacle.rmdir()
    assert "50 made, 50 unchanged" in cli(*words, "-o", "out", "--resume").stdout
    cli(*words, "-o", "fresh")
    for path in (tmp_path / "fresh").glob("*.tar"):
        assert path.read_bytes() == (tmp_path / "out" / path.name).read_bytes()
