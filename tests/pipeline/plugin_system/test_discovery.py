import json
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.discovery import installed

Command = Callable[..., CompletedProcess[str]]

READER = """
from dh2urdf.hookspecs import hookimpl
from dh2urdf.stages import NoOptions, Reader

@hookimpl
def dh2urdf_readers():
    yield Reader(name="lab-table", summary="s", read=lambda *_: iter(()), options=NoOptions, suffixes=(".lab",))
"""
NEVER = "from pathlib import Path\nPath('imported').touch()\nfrom dh2urdf.hookspecs import hookimpl_of_the_future\n"
TABLE = "# convention: standard\na, alpha, d\n0.4, pi/2, 0.1\n0.3, 0, 0\n"


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for further distributions, which this process sees, too."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)
    return folder


@pytest.fixture
def future(site: Path, install: Callable[..., None]) -> Path:
    """A plugin that is made for interface 2 is installed; an import of it leaves a file."""
    install(site, "lab-formats", NEVER, group="dh2urdf.v2")
    return site


class TestVersionsOfTheInterface:
    def test_it_is_listed_with_the_reason(self, dh2urdf: Command, future: Path, tmp_path: Path) -> None:
        """As `incompatible`, not as broken; for people and for scripts; other stages work."""
        listed = json.loads(dh2urdf("plugins", "--json", path=[future]).stdout)
        assert listed["broken"] == []
        (entry,) = listed["incompatible"]
        assert entry["distribution"] == "lab-formats 1.0"
        assert (
            "incompatible: lab = lab_formats_lab of lab-formats 1.0: it is made for version 2"
            in dh2urdf("plugins", path=[future]).stdout
        )
        (tmp_path / "arm.csv").write_text(TABLE)
        dh2urdf("convert", "arm.csv", "-o", "arm.urdf", path=[future])
        assert not (tmp_path / "imported").exists()

    def test_a_run_that_may_need_it_says_so(self, dh2urdf: Command, future: Path, tmp_path: Path) -> None:
        """A stage that nobody else has may be its: status 3, with the plugin, the reason, and what is missing."""
        (tmp_path / "arm.csv").write_text(TABLE)
        (tmp_path / "run.yaml").write_text("inputs: arm.csv\nemitters: [usd]\noutput: {directory: out}\n")
        failed = dh2urdf("run", "run.yaml", path=[future], status=3).stderr
        assert "plugin 'lab = lab_formats_lab' of lab-formats 1.0 is not loaded: it is made for version 2" in failed
        assert "no other plugin provides the emitter 'usd'" in failed
        assert not (tmp_path / "imported").exists()

    def test_a_distribution_for_two_versions(self, site: Path, install: Callable[..., None]) -> None:
        """One that has an entry point for this version, too, is no trouble."""
        install(site, "both", READER, plugin="old")
        install(site, "both", NEVER, plugin="new", group="dh2urdf.v2")
        found = installed()
        assert found.incompatible == ()
        assert [plugin.entry for plugin in found.plugins if plugin.is_of("both")] == ["old"]


class TestLeavingOut:
    @pytest.mark.parametrize("name", ["lab-tools", "Lab_Tools", "first", "first = lab_tools_first"])
    def test_by_any_of_its_names(self, site: Path, install: Callable[..., None], name: str) -> None:
        """By the distribution's name, spelled as pip allows, all of its plugins; by the plugin's, that one."""
        install(site, "lab-tools", READER, plugin="first")
        install(site, "lab-tools", READER, plugin="second")
        install(site, "other", READER)
        found = installed([name])
        left_out = ["first"] if "first" in name else ["first", "second"]
        assert [plugin.entry for plugin in found.left_out] == left_out
        assert {"first", "second"} - set(left_out) <= {plugin.entry for plugin in found.plugins}
        assert any(plugin.is_of("other") for plugin in found.plugins)

    def test_a_name_that_nobody_has(self, site: Path, install: Callable[..., None]) -> None:
        """All such names are reported at once."""
        install(site, "lab-tools", READER, plugin="first")
        with pytest.raises(ConfigError) as caught:
            installed(["lab-tool", "zzz"])
        assert [problem.found for problem in caught.value.problems] == ["lab-tool", "zzz"]
