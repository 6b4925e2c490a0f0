"""The pages for authors of plugins are true: their code is run, and their clauses are those of the contracts."""

import inspect
import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

import dh2urdf_plugins
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Reader, Rejected
from dh2urdf.testing import (
    EditContract,
    EmitterContract,
    ExecutorContract,
    LoaderContract,
    ReaderContract,
    TransformContract,
    catalog_of,
    do_run,
)
from dh2urdf.testing.stage_contract import InputContract, StageContract

DOCS = Path(__file__).parents[1] / "docs"
PAGE = DOCS / "plugins.md"
CONTRACT = DOCS / "plugin-contract.md"
COOKBOOK = DOCS / "plugin-cookbook.md"
CLAUSES = re.compile(r"(?<=<!-- clauses: )(?P<remark>[^>]*-->\n)(?P<lists>.*?)(?=<!-- /clauses -->)", re.DOTALL)
CONTRACTS = {
    "Every stage": StageContract,
    "Readers, transforms, edits and emitters": InputContract,
    "Readers": ReaderContract,
    "Transforms": TransformContract,
    "Edits": EditContract,
    "Emitters": EmitterContract,
    "Loaders": LoaderContract,
    "Executors": ExecutorContract,
}


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text("utf-8"), re.DOTALL | re.MULTILINE)


def clauses() -> str:
    """The clauses of every contract, as the page lists them."""
    lists = []
    for title, contract in CONTRACTS.items():
        tests = [value for name, value in vars(contract).items() if name.startswith("test_")]
        lines = [f"- `{test.__name__}`: {(inspect.getdoc(test) or '').partition(chr(10))[0]}" for test in tests]
        lists.append("\n".join([f"**{title}**", "", *lines, "", ""]))
    return "\n" + "".join(lists)


def test_the_clauses_are_those_of_the_contracts(*, renew: bool) -> None:
    """Every test of every contract is listed with what it says; `pytest --renew` writes them."""
    text = CONTRACT.read_text("utf-8")
    if renew:
        CONTRACT.write_text(CLAUSES.sub(lambda found: f"{found['remark']}{clauses()}", text), "utf-8")
        text = CONTRACT.read_text("utf-8")
    found = CLAUSES.search(text)
    assert found
    assert found["lists"] == clauses()


TABLE = """
    <table:table-row><table:table-cell><text:p># convention: standard</text:p></table:table-cell></table:table-row>
    <table:table-row table:number-rows-repeated="2"><table:table-cell table:number-columns-repeated="1024"/></table:table-row>
    <table:table-row>
      <table:table-cell office:value-type="string"><text:p>a [mm]</text:p></table:table-cell>
      <table:table-cell office:value-type="string"><text:p>alpha</text:p></table:table-cell>
      <table:table-cell office:value-type="string"><text:p>d [mm]</text:p></table:table-cell>
    </table:table-row>
    <table:table-row table:number-rows-repeated="2">
      <table:table-cell office:value-type="float" office:value="425"><text:p>425,00</text:p></table:table-cell>
      <table:table-cell table:number-columns-repeated="2" office:value-type="string"><text:p>0</text:p></table:table-cell>
    </table:table-row>
    """


def spreadsheet(path: Path, table: str) -> None:
    words = "urn:oasis:names:tc:opendocument:xmlns"
    spaces = " ".join(f'xmlns:{name}="{words}:{name}:1.0"' for name in ("office", "table", "text"))
    content = f'<office:document-content {spaces}><table:table table:name="Sheet1">{table}</table:table></office:document-content>'
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("content.xml", content)


@pytest.fixture
def ods() -> Reader[Any]:
    """The reader of the page."""
    (block,) = re.findall(
        r'^```python title="ods.py"\n(.*?)^```$', COOKBOOK.read_text("utf-8"), re.DOTALL | re.MULTILINE
    )
    assert len([line for line in block.splitlines() if line and not line.startswith(("import", "from"))]) <= 40
    space: dict[str, Any] = {}
    exec(block, space)  # noqa: S102 - a block of the page
    assert isinstance(space["READER"], Reader)
    return space["READER"]


def test_the_reader_of_another_container_reads(ods: Reader[Any], tmp_path: Path) -> None:
    """Its rows become the joints of an arm, with their places."""
    spreadsheet(tmp_path / "arm.ods", TABLE)
    (arm,) = ods.read(tmp_path / "arm.ods", ods.options())
    assert isinstance(arm, Manipulator)
    assert [(row.a, row.d) for row in arm.rows] == [(0.425, 0.0), (0.425, 0.0)]
    assert [row.mark.in_file for row in arm.rows if row.mark] == ["Sheet1, row 5, column 1", "Sheet1, row 6, column 1"]
    assert arm.notices == ()
    spreadsheet(tmp_path / "arm.ods", TABLE.replace('office:value="425"', 'office:value="nan"'))
    (rejected,) = ods.read(tmp_path / "arm.ods", ods.options())
    assert isinstance(rejected, Rejected)
    assert "Sheet1, row 5, column 1: error: joint 'joint_1', field 'a': 'nan'" in str(rejected.problems[0])


@pytest.mark.long
def test_the_gripper_keeps_the_contract_and_works_in_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Under sixty lines; every clause passes in a process of its own, and each arm of a run has the gripper at tool0."""
    (block,) = re.findall(
        r'^```python title="gripper.py"\n(.*?)^```$', COOKBOOK.read_text("utf-8"), re.DOTALL | re.MULTILINE
    )
    assert len(block.splitlines()) < 60
    (tmp_path / "gripper.py").write_text(block, "utf-8")
    (tmp_path / "test_gripper.py").write_text(
        "from dh2urdf.testing import EditContract\nfrom gripper import EDIT\n\n\n"
        "class TestContract(EditContract):\n    stage = EDIT\n    plugin = 'gripper'\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_gripper.py"]
    tested = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    clauses = sum(name.startswith("test_") for name in dir(EditContract))
    assert f"{clauses} passed" in tested.stdout, tested.stdout
    monkeypatch.syspath_prepend(tmp_path)
    catalog = catalog_of(import_module("gripper").EDIT, plugins=(dh2urdf_plugins,))
    run_file = "inputs: arm.csv\nedits: {stage: gripper, options: {length: 0.15}}\nemitters: [urdf, sdf]"
    arm = "# convention: standard\na, alpha, d\n0.4, 0, 0.1\n0.3, 0, 0\n"
    run = do_run(tmp_path, run_file, {"arm.csv": arm}, catalog)
    (row,) = run.report["manipulators"]
    assert row["proof"]["urdf"]["position_error"] < 1e-12
    robot = etree.parse(run.folder / "arm.urdf")
    assert robot.find("joint[@name='gripper_mount']/parent").get("link") == "tool0"
    mass = float(robot.find("link[@name='gripper']/inertial/mass").get("value"))
    assert mass == pytest.approx(0.08 * 0.03 * 0.15 * 1200.0)


def test_the_program_of_the_recipe_may_end(
    tmp_path: Path, install: Callable[..., None], dh2urdf: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """When it is asked: one message, with the exit status, and no fault of the plugin."""
    program = tmp_path / "bin" / "labsim"
    program.parent.mkdir()
    lines = "import os, sys, time\nprint('1.0 one two', flush=True)\nsys.stdin.readline(); sys.exit(4)\n"
    program.write_text(f"#!{sys.executable}\n{lines}")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(program.parent), prepend=os.pathsep)
    (recipe,) = [
        each for each in blocks(DOCS / "plugin-programs.md", r"python[^\n]*") if "The loader `lab-sim`" in each
    ]
    install(tmp_path / "site", "lab", recipe)
    rows = "".join(f"{name},0.4,0,0.1\n" for name in ("one", "two"))
    (tmp_path / "arm.csv").write_text(f"# convention: standard\njoint,a,alpha,d\n{rows}")
    (tmp_path / "run.yaml").write_text("inputs: arm.csv\nloaders: lab-sim\noutput: out\nreport: {html: false}\n")
    answer = dh2urdf("run", "run.yaml", path=[tmp_path / "site"], status=1)
    assert "lab-sim: labsim ended before the link tool0, with exit status 4" in answer.stderr
    assert "tell the authors" not in answer.stderr
