"""mypy --strict has nothing to report about the Python in the README and in docs/: every block is checked as a module."""

import re
import textwrap
from pathlib import Path

import pytest
from child_python import python

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r'^ *```python(?: title="(?P<title>[^"]+)")?[^\n]*\n(?P<body>.*?)^ *```$', re.MULTILINE | re.DOTALL)
ELSEWHERE = ("first-plugin.md", "plugins.md", "plugin-contract.md")
"""Pages whose blocks are files of a distribution that the page makes: their own tests check them."""


def blocks() -> dict[str, str]:
    """Every block by its place."""
    found = {}
    for page in PAGES:
        text = page.read_text("utf-8")
        for match in BLOCK.finditer(text):
            if match["title"] is None and page.name not in ELSEWHERE:
                line = text[: match.start()].count("\n") + 2
                found[f"{page.relative_to(ROOT).as_posix()}:{line}"] = textwrap.dedent(match["body"])
    return found


@pytest.mark.long
def test_the_python_of_the_docs_is_typed(tmp_path: Path, types_cache: Path) -> None:
    """No block needs a cast, an ignored line or a name that is not there."""
    places = {}
    for number, (place, body) in enumerate(blocks().items()):
        places[f"block_{number}.py"] = place
        (tmp_path / f"block_{number}.py").write_text(body, "utf-8")
    assert len(places) > 10
    config = tmp_path / "mypy.ini"
    others = "coppeliasim_zmqremoteapi_client,dask_jobqueue,distributed.*,mujoco,pandas,pinocchio,pyarrow.*,pybullet,pydrake.*,rclpy,sensor_msgs.*"
    options = "ignore_missing_imports = true\nfollow_imports = skip\nfollow_imports_for_stubs = true\n"
    # The types of other people's packages, and whether they are installed, are not what is tested.
    sections = "".join(f"[mypy-{module}]\n{options}" for module in others.split(","))
    # For the blocks alone: what mypy keeps of dh2urdf is of use where its modules have the same options.
    ours = f"[mypy]\nstrict = true\n[mypy-{','.join(Path(name).stem for name in places)}]\ndisallow_untyped_calls = false\n"
    config.write_text(f"{ours}{sections}", "utf-8")
    command = ["-m", "mypy", "--config-file", str(config), "--cache-dir", str(types_cache), *places]
    checked = python(*command, folder=tmp_path)
    told = re.sub(r"block_\d+\.py", lambda name: places[name[0]], checked.stdout)
    assert checked.returncode == 0, f"{told}{checked.stderr}"
