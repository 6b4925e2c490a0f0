"""A number that is added to rows and joints is in everything that has to do with rows: nothing else lists them.

The sources are copied, a gear ratio is added in six files, wear of rows alone in two of them, and the copy is used in a
process of its own.
"""

import shutil
from pathlib import Path

import pytest
from child_python import python

ROOT = Path(__file__).parents[1]
OLD = "    armature: float | None = None\n"
NEW = f"{OLD}    gear_ratio: float | None = None\n"
GEAR_RATIO = '    "gear_ratio": RowField(Dimension.NUMBER, types=_MOVING, positive=True),\n'
WEAR = '    "wear": RowField(Dimension.NUMBER, negative=False),\n'
ADDED = {
    "pipeline/dh2urdf/manipulator.py": (OLD, f"{NEW}    wear: float | None = None\n"),
    "pipeline/dh2urdf/robot.py": (OLD, NEW),
    "pipeline/dh2urdf/columns.py": ("    **dict.fromkeys(COM,", f"{GEAR_RATIO}{WEAR}    **dict.fromkeys(COM,"),
    "plugins/dh2urdf_plugins/formats/urdf/writer.py": (
        '("friction", joint.friction))',
        '("friction", joint.friction), ("gear", joint.gear_ratio))',
    ),
    "plugins/dh2urdf_plugins/formats/sdf/writer.py": (
        'for name in ("damping", "friction")]',
        'for name in ("damping", "gear_ratio")]',
    ),
    "plugins/dh2urdf_plugins/formats/mjcf/writer.py": (
        '("armature", armature))',
        '("armature", armature), ("user", joint.gear_ratio))',
    ),
}
"""By file: a text of it, and what is in its place."""
assert len(ADDED) <= 6

TABLES = {
    "arm.csv": "# convention: standard\na,alpha,d,theta,gear_ratio,wear\n0.3,0,0,0,100,0.5\n0.2,0,0,0,50,0\n",
    "arm.yaml": "convention: standard\njoints:\n  - {a: 0.3, alpha: 0, d: 0, gear_ratio: 100, wear: 0.5}\n"
    "  - {a: 0.2, alpha: 0, d: 0, gear_ratio: 50, wear: 0}\n",
}
CHECKS = {
    "columns": """
        other = replace(arm, rows=tuple(replace(row, gear_ratio=row.gear_ratio + 1) for row in arm.rows))
        worn = replace(arm, rows=tuple(replace(row, wear=row.wear + 1) for row in arm.rows))
        ((places, columns),) = in_columns([arm, other, worn])
        assert [columns.pick(place).rows for place in places] == [arm.rows, other.rows, worn.rows]
    """,
    "keys of --resume": """
        other = replace(arm, rows=tuple(replace(row, gear_ratio=row.gear_ratio + 1) for row in arm.rows))
        worn = replace(arm, rows=tuple(replace(row, wear=row.wear + 1) for row in arm.rows))
        ((_, columns),) = in_columns([arm, other, worn])
        assert len(set(column_keys(columns, "recipe", ["", "", ""]))) == 3
    """,
    "texts": """
        assert dh2urdf.read(Path(sys.argv[1]) / "arm.yaml").rows[1].gear_ratio == 50.0
        for written in (arm.to_yaml(), arm.to_csv()):
            assert "gear_ratio" in written and "wear" in written
        (Path(sys.argv[1]) / "again.yaml").write_text(arm.to_yaml())
        assert dh2urdf.read(Path(sys.argv[1]) / "again.yaml").rows == arm.rows
    """,
    "variations and resumed runs": """
        vary = [{"joints": "all", "field": "gear_ratio", "uniform": [80, 120]}]
        vary += [{"joints": [1], "field": "wear", "uniform": [0, 1]}]
        config = {
            "inputs": str(Path(sys.argv[1]) / "arm.csv"),
            "emitters": ["urdf", "sdf", "mjcf"],
            "output": {"directory": str(Path(sys.argv[1]) / "out")},
            "variations": [{"of": "arm", "count": 40, "seed": 1, "vary": vary}],
            "report": {"html": False},
        }
        report = dh2urdf.run(config)
        assert report["exit_status"] == 0, report
        drawn = [entry["drawn"]["gear_ratio_1"] for entry in report["manipulators"] if entry.get("drawn")]
        assert len(set(drawn)) == 40
        assert len({entry["drawn"]["wear_1"] for entry in report["manipulators"] if entry.get("drawn")}) == 40
        for seed, resume in ((1, False), (2, True)):
            config["variations"][0]["seed"] = seed
            for entry in dh2urdf.run(config, resume=resume)["manipulators"]:
                ratio = repr(entry["drawn"]["gear_ratio_1"]) if entry.get("drawn") else "100"
                for suffix in ("urdf", "sdf", "xml"):
                    text = (Path(sys.argv[1]) / "out" / f"{entry['name']}.{suffix}").read_text()
                    assert ratio in text, (entry["name"], seed, suffix, ratio)
    """,
    "schemas": """
        assert "gear_ratio" in json.dumps(run_schema(load()))
        assert "gear_ratio" in json.dumps(load().get("reader", "yaml").can(HasSchema).schema())
    """,
    "info": """
        done = subprocess.run(
            [sys.executable, "-m", "dh2urdf", "info", Path(sys.argv[1]) / "arm.csv", "--json"], capture_output=True
        )
        assert b"gear_ratio" in done.stdout and b"wear" in done.stdout, done
    """,
    "rules": """
        try:
            dh2urdf.convert(replace(arm, rows=(replace(arm.rows[0], gear_ratio=math.inf), arm.rows[1])))
        except dh2urdf.Dh2UrdfError as error:
            assert "gear_ratio" in str(error)
        else:
            raise AssertionError("an infinite gear ratio passed")
    """,
}


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sources")
    for name in ("pipeline", "plugins"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name, (old, new) in ADDED.items():
        text = (folder / name).read_text("utf-8")
        assert text.count(old) == 1, (name, old)
        (folder / name).write_text(text.replace(old, new), "utf-8")
    return folder


@pytest.mark.parametrize("what", CHECKS)
def test_it_is_in(what: str, sources: Path, tmp_path: Path) -> None:
    for name, text in TABLES.items():
        (tmp_path / name).write_text(text)
    program = (
        "import json, math, subprocess, sys\nfrom dataclasses import replace\nfrom pathlib import Path\nimport dh2urdf\n"
        "from dh2urdf.columns import in_columns\nfrom dh2urdf.conversion.keys import column_keys\n"
        "from dh2urdf.plugin_system.catalog import load\nfrom dh2urdf.run_file.schema import run_schema\nfrom dh2urdf.stages import HasSchema\n"
        "assert dh2urdf.__file__.startswith(sys.argv[2])\n"
        "arm = dh2urdf.read(Path(sys.argv[1]) / 'arm.csv')\n"
        "assert [(row.gear_ratio, row.wear) for row in arm.rows] == [(100.0, 0.5), (50.0, 0.0)]\n"
    ) + "\n".join(line[8:] for line in CHECKS[what].splitlines())
    path = (sources / "pipeline", sources / "plugins")
    done = python("-c", program, tmp_path, sources, folder=tmp_path, path=path)
    assert done.returncode == 0, done.stderr[-3000:]
