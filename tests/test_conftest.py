import json
import re
import shutil
import tomllib
from pathlib import Path

import yaml
from child_python import python

ROOT = Path(__file__).parents[1]
MODULES = (ROOT / "docs" / "generators", ROOT / "tests" / "shared")
"""The folders of modules that conftest.py imports."""

UNKNOWN = ("-W", "ignore::pytest.PytestUnknownMarkWarning")
"""Only pyproject.toml registers the marks of kinds.yaml, and the folder of the tests has none."""

SKIPPING = {
    "skip": "def test_it():\n    pytest.skip('no such tool')",
    "fixture": "@pytest.fixture\ndef tool():\n    pytest.skip('no such tool')\ndef test_it(tool): ...",
    "mark": "@pytest.mark.skipif(True, reason='no such tool')\ndef test_it(): ...",
    "package": "def test_it():\n    pytest.importorskip('no_such_package', reason='no such tool')",
    "module": "pytest.importorskip('no_such_package', reason='no such tool')\ndef test_it(): ...",
}


def run_tests(tests: dict[str, str], folder: Path, *options: str, require_all: bool) -> str:
    """What pytest prints about tests, one per file, under the project's conftest.py."""
    shutil.copy(Path(__file__).with_name("conftest.py"), folder)
    if not (folder / "kinds.yaml").exists():
        (folder / "kinds.yaml").write_text("arm: [.]\n")
    for name, test in tests.items():
        (folder / f"test_{name}.py").write_text(f"import pytest\n{test}\n")
    words = ("-m", "pytest", "-ra", "-p", "no:cacheprovider", *UNKNOWN, *options, "--rootdir", folder, folder)
    all_of_it = {"DH2URDF_REQUIRE_ALL": "1" if require_all else "", "PYTEST_ADDOPTS": "", "COLUMNS": "200"}
    return python(*words, folder=folder, path=MODULES, **all_of_it).stdout


def test_a_skip_is_a_failure_where_everything_has_to_be_there(tmp_path: Path) -> None:
    """With DH2URDF_REQUIRE_ALL=1 no test is skipped, however it asks for it, and the failure says why; elsewhere it is."""
    assert "5 skipped in" in run_tests(SKIPPING, tmp_path, require_all=False)
    (tmp_path / "test_module.py").unlink()
    (tmp_path / "module").mkdir()
    for tests, folder, ends in (
        ({name: test for name, test in SKIPPING.items() if name != "module"}, tmp_path, "2 failed, 2 errors in"),
        ({"module": SKIPPING["module"]}, tmp_path / "module", "1 error in"),  # what fails before a test begins
    ):
        printed = run_tests(tests, folder, require_all=True)
        assert ends in printed
        assert printed.count("DH2URDF_REQUIRE_ALL=1 allows no skipped test: ") >= len(tests)
        assert printed.count("no such tool") >= len(tests)


def test_ci_runs_the_long_tests_that_others_leave_out(tmp_path: Path) -> None:
    """`pytest` deselects them, as pyproject.toml has it, and `.ci/run` has options that select every test again."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["pytest"]["ini_options"]
    addopts = [word for word in settings["addopts"] if word != "--dist=worksteal"]
    (tmp_path / "pyproject.toml").write_text(
        f"[tool.pytest.ini_options]\naddopts = {json.dumps(addopts)}\nmarkers = {json.dumps(settings['markers'])}\n"
    )
    (tmp_path / "test_it.py").write_text("import pytest\ndef test_it(): ...\n@pytest.mark.long\ndef test_long(): ...\n")
    ci = re.search(r'PYTEST_ADDOPTS="([^"]*)" run_block 2', (ROOT / ".ci" / "run").read_text("utf-8"))
    assert ci is not None
    for more, ends in (("", "1 passed, 1 deselected in"), (ci[1], "2 passed in")):
        words = ("-m", "pytest", "-p", "no:cacheprovider", tmp_path)
        printed = python(*words, folder=tmp_path, PYTEST_ADDOPTS=more).stdout
        assert ends in printed, printed


def test_a_test_without_a_kind_fails(tmp_path: Path) -> None:
    """Each test is of one kind: by the nearest entry of kinds.yaml, or by a mark. With none or two it fails in every lane.

    A long test is in none of the lanes of the three kinds: `-m long` has it.
    """
    (tmp_path / "kinds.yaml").write_text(
        "arm: [test_known.py]\nwords: ['test_known.py::test_said']\nlong: ['test_known.py::test_slow']\n"
    )
    tests = {
        "known": "def test_it(): ...\ndef test_slow(): ...\ndef test_said(): ...\n@pytest.mark.speed\ndef test_quick(): ...",
        "none": "def test_it(): ...",
        "two": "@pytest.mark.arm\n@pytest.mark.words\ndef test_it(): ...",
    }
    for kind in ("arm", "words", "speed"):
        printed = run_tests(tests, tmp_path, "-m", kind, require_all=False)
        assert "1 passed, 3 deselected, 2 errors in" in printed
        assert printed.count("arm, words or speed? Mark it, or name it in tests/kinds.yaml") >= 2


def test_every_entry_of_kinds_names_something() -> None:
    """What tests/kinds.yaml names is a folder, a file or a test that is there."""
    kinds = yaml.safe_load((ROOT / "tests" / "kinds.yaml").read_text("utf-8"))
    places = [place for kind in ("arm", "words", "speed") for place in kinds[kind]]
    assert len(places) == len(set(places))
    places += kinds["long"]
    inherited = "".join(path.read_text("utf-8") for path in sorted((ROOT / "pipeline/dh2urdf/testing").glob("*.py")))
    gone = []
    for place in places:
        path, _, test = place.partition("[")[0].partition("::")
        name = test.rpartition("::")[2]
        if not (ROOT / path).exists() or (
            name and f"def {name}(" not in (ROOT / path).read_text("utf-8") + ("::" in test) * inherited
        ):
            gone.append(place)
    assert gone == []


def test_with_other_words_messages_are_other_ones(tmp_path: Path) -> None:
    """`--other-words` changes what is said and not what is quoted, so that a test of words fails with it."""
    quoting = """
from dh2urdf.errors import TableError
from dh2urdf.source import Problem
def test_said():
    assert str(TableError(Problem(message="no column is called 'alpha'", found="a1", accepted="a number"))) == (
        "error: no column is called 'alpha'\\n    accepted: a number")
def test_found():
    assert "'alpha'" in str(TableError("no column is called 'alpha'"))
"""
    assert "2 passed in" in run_tests({"words": quoting}, tmp_path, require_all=False)
    assert "1 failed, 1 passed in" in run_tests({"words": quoting}, tmp_path, "--other-words", require_all=False)
