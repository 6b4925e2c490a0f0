"""Every URDF of the packages that are installed, with all its leaves: a table, or a reason in words."""

import os
import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf_plugins.descriptions.readers import URDF, DescriptionOptions

REASONS = (
    *("no joint moves between link", "the chain holds '", "is above upper", "this is not XML", "joint type '"),
    *("of origin is '", "the description has no links"),
    *("several joints hold the link", "the outermost element is", "lacks", "no link is the root", "have no parent"),
)
FARTHEST = 1e-12
"""How far a table may be from its chain, of arms of a few metres [m, rad]."""


def files() -> dict[str, list[Path]]:
    """By package, its descriptions; the larger packages are thinned out, beginning elsewhere in each run of the CI."""
    found: dict[str, list[Path]] = {}
    start = int(os.environ.get("GITHUB_RUN_NUMBER", "0"))
    for package, inner in (("example_robot_data", ""), ("pybullet_data", ""), ("pydrake", "share")):
        spec = find_spec(package)
        roots = [Path(place) / inner for place in (spec.submodule_search_locations or ())] if spec else []
        if package == "example_robot_data":  # its data lies beside the modules of all packages of its kind
            cmeel = find_spec("cmeel")
            places = (cmeel.submodule_search_locations or ()) if cmeel else ()
            roots = [Path(place).parent / "cmeel.prefix" / "share" / "example-robot-data" for place in places]
        paths = sorted(path for root in roots for path in root.rglob("*.urdf") if path.is_file())
        step = max(1, len(paths) // 60)
        found[package] = paths[start % step :: step]
    return found


@pytest.mark.long
@pytest.mark.parametrize("package", ["example_robot_data", "pybullet_data", "pydrake"])
def test_each_is_a_table_or_says_why_not(package: str) -> None:
    paths = files()[package]
    if not paths:
        pytest.skip(f"{package} is not installed")
    tables = 0
    for path in paths:
        for convention in Convention:
            options = DescriptionOptions(convention=convention.value, tip_link="*", tolerance=FARTHEST)
            try:
                items = list(URDF.read(path, options))
            except TableError as error:
                assert any(reason in str(error) for reason in REASONS), error
                continue
            for item in items:
                if isinstance(item, Manipulator):
                    tables += 1
                    found = re.search(r"within (\S+) m and (\S+) rad", item.notices[0].message)
                    assert found
                    assert max(map(float, found.groups())) <= FARTHEST, f"{path}: {item.notices[0]}"
                else:
                    assert any(reason in str(item.problems[0]) for reason in REASONS), f"{path}: {item.problems[0]}"
    assert tables or package != "example_robot_data"
