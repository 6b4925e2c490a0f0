import json
import tarfile
from pathlib import Path
from typing import Any

from command_line import Cli

TABLE = "# convention: standard\nrobot,a,alpha,d\n"


def run(cli: Cli, folder: Path, *settings: str, out: str = "out") -> list[dict[str, Any]]:
    """The manifest of a run over five arms, the third of which is refused."""
    rows = [f"arm.{number},0.{number},0,{'x' if number == 3 else 0}\n" for number in range(1, 6)]
    (folder / "arms.csv").write_text(TABLE + "".join(rows))
    (folder / "run.yaml").write_text("inputs: arms.csv\nemitters: [urdf, xacro]\n")
    words = [word for setting in settings for word in ("--set", setting)]
    cli("run", "run.yaml", "-o", out, *words, status=1)
    return [json.loads(line) for line in (folder / out / "manifest.jsonl").open("rb")]


def test_a_run_into_shards(cli: Cli, tmp_path: Path, reports: frozenset[str]) -> None:
    """Tar files of so many manipulators, with the same descriptions as in files of their own, but for their names."""
    rows = run(cli, tmp_path, "output.layout=shards", "output.size=2")
    shards = {"000000.tar", "000001.tar", "000002.tar"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == {*shards, *reports}
    found: dict[str, list[str]] = {}
    for shard in sorted(shards):
        with tarfile.open(tmp_path / "out" / shard) as archive:
            found[shard] = archive.getnames()
    names = [[f"arm_{n}.urdf", f"arm_{n}.urdf.xacro", f"arm_{n}_macro.xacro"] for n in range(1, 6)]
    assert found == {"000000.tar": names[0] + names[1], "000001.tar": names[3], "000002.tar": names[4]}
    plain = run(cli, tmp_path, out="plain")
    for row, other in zip(rows, plain, strict=True):
        assert row["status"] == other["status"] == ("failed" if row["name"] == "arm.3" else "ok")
        assert [file["path"].replace("arm_", "arm.", 1) for file in row["files"]] == [
            file["path"] for file in other["files"]
        ]
        for file in row["files"]:
            with (tmp_path / "out" / file["shard"]).open("rb") as shard:
                shard.seek(file["offset"])
                content = shard.read(file["bytes"])
            if file["stage"] == "urdf":
                assert content == (tmp_path / "plain" / other["files"][0]["path"]).read_bytes()
