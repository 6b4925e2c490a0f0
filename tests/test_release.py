"""`.ci/release --dry-run` names everything that keeps a version from being released."""

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = (".ci/release", "pipeline/dh2urdf/_version.py", "CITATION.cff", "pyproject.toml")


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository on main that may be released as 0.1.0, with nothing but what the script looks at."""
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "pipeline/dh2urdf/_version.py").write_text('__version__ = "0.1.0"\n')
    (tmp_path / "CITATION.cff").write_text("version: 0.1.0\n")
    (tmp_path / "CHANGELOG.md").write_text("# Changelog\n\n## 0.1.0 (2026-12-01)\n")
    git(tmp_path, "init", "--quiet", "--initial-branch=main")
    commit(tmp_path)
    return tmp_path


def git(folder: Path, *words: str) -> None:
    who = ("-c", "user.name=tests", "-c", "user.email=tests@example.org")
    subprocess.run(["git", *who, *words], cwd=folder, check=True, capture_output=True)  # noqa: S607 - git is where PATH has it


def commit(folder: Path) -> None:
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--allow-empty", "--message", "all")


def looked_at(folder: Path) -> tuple[int, list[str]]:
    """The exit status, and what is wrong."""
    done = subprocess.run(
        ["/bin/bash", ".ci/release", "0.1.0", "--dry-run"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.stdout.splitlines()[-1].startswith("next: .ci/run")
    return done.returncode, [line.removeprefix("wrong: ") for line in done.stderr.splitlines()]


def test_a_version_that_can_be_released(repository: Path) -> None:
    assert looked_at(repository) == (0, [])


def test_everything_wrong_is_listed(repository: Path) -> None:
    """Branch, version, citation, changelog, tag and what is not committed, all at once."""
    (repository / "pipeline/dh2urdf/_version.py").write_text('__version__ = "0.2.0"\n')
    (repository / "CITATION.cff").write_text("version: 0.2.0\n")
    (repository / "CHANGELOG.md").write_text("# Changelog\n\n## 0.1.0 (unreleased)\n")
    commit(repository)
    git(repository, "tag", "v0.1.0")
    git(repository, "checkout", "--quiet", "-b", "other")
    (repository / "new").touch()
    status, wrong = looked_at(repository)
    assert status == 1
    assert [line.split(" ")[0] for line in wrong] == [
        "there",
        "this",
        "the",
        "pipeline/dh2urdf/_version.py",
        "CITATION.cff",
        "CHANGELOG.md",
    ]
