"""A package as its rules see it: its folder, its files, and the robots that its descriptions are."""

from __future__ import annotations

import os
from contextlib import suppress
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.documents import is_file, is_there, load_yaml, read_bytes, xml_root
from dh2urdf.errors import Dh2UrdfError, InputError
from dh2urdf.robot import Robot
from dh2urdf.stages import PACKAGE_FILE, Expansion
from dh2urdf_check.files import urdfs, xacros
from dh2urdf_check.finders import Document
from dh2urdf_check.rules import Rule, rules_of
from dh2urdf_plugins.descriptions.description import describe
from dh2urdf_plugins.formats.xml_files import FILE, mark_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from lxml import etree

    from dh2urdf.robot import Joint
    from dh2urdf.source import Mark
    from dh2urdf.stages import Finding

CONSUMERS = {
    "colcon": "colcon and rosdep",
    "ros2": "ROS 2: launch files, xacro and ros2_control",
    "moveit": "MoveIt",
}
"""The readers of packages that the rules speak of, by the names that ``--for`` takes."""
LONGEST = 2**24
"""Size of a file of a package that is read [B]."""
MOST_FILES = 10_000
_DESCRIPTIONS = {".urdf", ".xacro"}


def broken(rule: str, mark: Mark, message: str) -> Finding:
    """The finding that a rule is broken at a place."""
    known = package_rules()[rule]
    return known.finding(message, known.outcomes, mark)


def parsed(content: bytes, path: Path) -> etree._Element:
    """The outermost element of a file of a package.

    Raises:
        etree.XMLSyntaxError: it is not well-formed XML, or XML that `xml_root` refuses.
    """
    root = xml_root(content)
    root.set(FILE, str(path))
    return root


@cache
def package_rules() -> dict[str, Rule]:
    """The rules of packages by name, in the order of their table."""
    return rules_of("packages", CONSUMERS)


def of_document(
    root: etree._Element, path: Path, sets: Mapping[str, Collection[str]] | None = None
) -> Iterator[Finding]:
    """The places of a file of a package where it breaks rules that are data, which know `sets` of names by a word."""
    document = Document(root, path)
    document.sets |= sets or {}
    for hit in document.hits(package_rules().values()):
        yield broken(hit.rule, mark_of(hit.at), hit.message)  # type: ignore[arg-type]  # no rule is of the text


class Package:
    """A package of ROS 2, whose package.xml has the outermost element `root`; `known` are the folders of packages."""

    def __init__(self, folder: Path, root: etree._Element, known: Mapping[str, Path]) -> None:
        self.folder, self.root, self.manifest = folder, root, folder / PACKAGE_FILE
        self.name = (root.findtext("name") or "").strip()
        self.known = {**{name: each for name, each in known.items() if each != folder.resolve()}, self.name: folder}

    @cached_property
    def files(self) -> tuple[Path, ...]:
        """Its files, without hidden folders and packages inside."""
        found: list[Path] = []
        for inner, folders, names in os.walk(self.folder):
            here = Path(inner)
            folders[:] = sorted(
                name for name in folders if not name.startswith(".") and not is_there(here / name / PACKAGE_FILE)
            )
            found += [here / name for name in sorted(names)]
            if len(found) > MOST_FILES:
                break
        return tuple(found[:MOST_FILES])

    def content(self, path: Path) -> bytes | None:
        """The content of a file; None where it cannot be read, which other rules report."""
        try:
            return read_bytes(path, InputError, limit=LONGEST)
        except InputError:
            return None

    @cached_property
    def robots(self) -> tuple[Robot, ...]:
        """The robots of the descriptions that the package has, or that its `.setup_assistant` names."""
        roots = {path: "robot" for path in self.files if path.suffix in _DESCRIPTIONS}
        found, robots = [*urdfs(roots), *xacros(roots)], list[Robot | None]()
        for path in found or self._of_the_setup_assistant():
            form, packages = path.suffix.removeprefix("."), tuple(self.known.values())
            expansion = Expansion(package_paths=packages) if form == "xacro" else Expansion()
            with suppress(Dh2UrdfError):  # The check of the description itself reports it.
                robots.append(describe(form if form == "xacro" else "urdf", path, expansion).robot)
        return tuple(filter(None, robots))

    @cached_property
    def joints(self) -> dict[str, Joint]:
        """The joints of all these robots that move."""
        return {joint.name: joint for robot in self.robots for joint in robot.moving_joints}

    def _of_the_setup_assistant(self) -> list[Path]:
        content = self.content(self.folder / ".setup_assistant") or b""
        with suppress(InputError, KeyError, TypeError, AttributeError):
            settings = load_yaml(content, ".setup_assistant", InputError).plain()["moveit_setup_assistant_config"]
            urdf = settings.get("urdf") or settings["URDF"]
            path = self.known[urdf["package"]] / urdf["relative_path"]
            return [path] if is_file(path) else []
        return []
