"""The plugins under examples/, used as anybody uses them: installed, listed, tested, and run from a run file.

What comes out of them is proved by their own tests.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path
from typing import NamedTuple

import pytest
from child_python import ADDOPTS

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[1]
EXAMPLES = {
    "cisst": {("reader", "cisst")},
    "graphviz": {("emitter", "dot")},
    "short": {("edit", "tool-load"), ("executor", "joblib"), ("loader", "yourdfpy"), ("reader", "workbook")},
    "threads": {("executor", "threads")},
}
RUN = "dh2urdf run run.yaml"


class Lab(NamedTuple):
    """A virtual environment with the examples in it.

    Attributes:
        folder: copies of the examples.
        commands: where the commands of the environment are.
    """

    folder: Path
    commands: Path

    def types(self, *words: str | Path, where: str, status: int = 0) -> str:
        """What a command of the environment prints in the folder of an example."""
        inherited = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        result = subprocess.run(
            words,
            env={**inherited, "PATH": f"{self.commands}{os.pathsep}{os.environ['PATH']}", "PYTEST_ADDOPTS": ADDOPTS},
            cwd=self.folder / where,
            capture_output=True,
            encoding="utf-8",
            check=False,
            timeout=600,
        )
        assert result.returncode == status, f"exit status {result.returncode}\n{result.stdout}\n{result.stderr}"
        return result.stdout


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Lab:
    """An environment into which pip has installed dh2urdf and the examples, without a network.

    What they depend on is seen in the environment of the tests.
    """
    folder = tmp_path_factory.mktemp("lab")
    for name in EXAMPLES:
        shutil.copytree(ROOT / "examples" / name, folder / name, ignore=shutil.ignore_patterns("build", "__pycache__"))
    venv.create(folder / "venv", with_pip=False)
    commands = folder / "venv" / ("Scripts" if os.name == "nt" else "bin")
    site = Path(sysconfig.get_path("purelib", vars={"base": str(folder / "venv")}))
    packages = sysconfig.get_path("purelib")
    site.joinpath("tests.pth").write_text(f"import site; site.addsitedir({packages!r})")
    offline = ("--no-index", "--no-deps", "--no-build-isolation", "--ignore-installed", "--quiet")
    pip = (sys.executable, "-m", "pip", "--python", str(commands / "python"), "--disable-pip-version-check")
    subprocess.run(
        [*pip, "install", *offline, ROOT, *(folder / name for name in EXAMPLES)],
        env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"},
        check=True,
    )
    return Lab(folder, commands)


def readme_block(name: str, language: str) -> str:
    text = (ROOT / "examples" / name / "README.md").read_text("utf-8")
    (block,) = re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    return str(block)


@pytest.mark.parametrize("name", EXAMPLES)
def test_it_is_listed(lab: Lab, name: str) -> None:
    """`dh2urdf plugins` shows the stage with its distribution and the help of its options; nothing is broken."""
    listed = json.loads(lab.types("dh2urdf", "plugins", "--json", where=name))
    assert listed["broken"] == []
    stages = [stage for stage in listed["stages"] if stage["distribution"] == f"dh2urdf-{name} 1.0.0"]
    assert {(stage["kind"], stage["name"]) for stage in stages} == EXAMPLES[name]
    assert all(option["help"] for stage in stages for option in stage["options"])


@pytest.mark.parametrize("name", EXAMPLES)
def test_its_own_tests_pass(lab: Lab, name: str) -> None:
    """The contract of its kind and what it declares itself, from its own folder."""
    told = lab.types("python", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:randomly", where=name)
    assert re.search(r"\d+ passed", told)
    assert " failed" not in told


@pytest.mark.parametrize("name", EXAMPLES)
def test_it_is_typed(lab: Lab, name: str) -> None:
    """mypy --strict accepts the stage and its tests; ruff checks it with the whole repository."""
    options = ("--strict", "--config-file=", "--cache-dir", lab.folder / ".mypy")  # of all examples
    lab.types("python", "-m", "mypy", *options, "src", "tests", where=name)


@pytest.mark.parametrize("name", EXAMPLES)
def test_its_readme_keeps_its_word(lab: Lab, name: str) -> None:
    """What is to be typed after the installation works in its folder, word for word, and its run file has no failure."""
    install, *commands = readme_block(name, "sh").splitlines()
    assert install == "pip install ."
    if any(command.startswith("dot ") for command in commands) and shutil.which("dot") is None:
        pytest.skip("Graphviz's command dot is not installed")
    if others := [command for command in commands if command != RUN]:
        lab.types("bash", "-euo", "pipefail", "-c", "\n".join(others), where=name)
    lab.types(*RUN.split(), where=name)
    arms = json.loads((lab.folder / name / "build" / "report.json").read_bytes())["manipulators"]
    assert {arm["status"] for arm in arms} == {"ok"}
