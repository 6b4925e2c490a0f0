"""The README that a package index shows: no link in it needs a file beside it."""

import re
from pathlib import Path

import pytest
from hatchling.metadata.core import ProjectMetadata
from hatchling.plugin.manager import PluginManager

ROOT = Path(__file__).parents[1]
TARGET = re.compile(r"\]\((?P<target>[^)]+)\)")
SOURCE = "https://example.org/dh2urdf/blob/main"


@pytest.mark.parametrize("urls", [{}, {"Source": SOURCE}], ids=["no address", "an address"])
def test_every_link_of_the_package_has_a_host(urls: dict[str, str]) -> None:
    """With an address of the source there are as many links as in the README; without, no link and no picture."""
    written = (ROOT / "README.md").read_text("utf-8")
    metadata = ProjectMetadata(str(ROOT), PluginManager())
    metadata.config["project"]["urls"] = urls
    shown = metadata.core.readme
    assert metadata.core.readme_content_type == "text/markdown"
    targets = TARGET.findall(shown)
    assert len(targets) == (len(TARGET.findall(written)) if urls else 0)
    assert all(target.startswith(f"{SOURCE}/docs/") for target in targets)
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", shown)
    assert pictures == ([f"{SOURCE}/docs/pictures/readme.svg?raw=true"] if urls else [])
    # Nothing else is another: all words of the links are there.
    words = re.sub(r"(?<!!)\[([^\]]*)\]\([^)]+\)", r"\1", re.sub(r"!\[[^\]]*\]\([^)]+\)", "", written))
    assert (
        re.sub(r"!?\[([^\]]*)\]\([^)]+\)", lambda link: "" if link[0][0] == "!" else link[1], shown).split()
        == words.split()
    )


def test_the_sdist_has_the_hook() -> None:
    """A wheel is made from the sdist, too."""
    assert '"/hatch_build.py"' in (ROOT / "pyproject.toml").read_text("utf-8")
