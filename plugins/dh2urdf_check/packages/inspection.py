"""Inspects a package of ROS 2 of any origin: what colcon, launch files and MoveIt will do with it."""

from __future__ import annotations

import re
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.documents import is_file, is_there, load_yaml, read_bytes
from dh2urdf.errors import InputError
from dh2urdf.meshes import PACKAGE, own_folder, packages_in, with_its_own
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.stages import PACKAGE_FILE, Finding, Inspection
from dh2urdf_check.packages.package import CONSUMERS, LONGEST, Package, broken, of_document, parsed
from dh2urdf_plugins.formats.xml_files import mark_of
from dh2urdf_plugins.ros_conventions import CONTROLLER_MANAGER

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from dh2urdf.documents import Node
    from dh2urdf.robot import Joint
    from dh2urdf.stages import Expansion, Finding

_PROJECT = re.compile(r"^[ \t]*project\s*\(\s*([^\s)]+)", re.IGNORECASE | re.MULTILINE)


def packages(roots: Mapping[Path, str]) -> Iterator[Path]:
    """The package.xml of each package among the files of a folder."""
    return (path for path in roots if path.name == PACKAGE_FILE)


def inspect_package(path: Path, expansion: Expansion) -> Inspection:
    """What there is to report of the package that a file is in, which may use those of an expansion.

    Raises:
        InputError: the file is in no package, or a folder of packages is none.
    """
    folder = own_folder(path)
    if not is_file(folder / PACKAGE_FILE):
        message, accepted = "this file is in no package of ROS", f"a folder with {PACKAGE_FILE}, or a file below it"
        raise InputError(Problem(message=message, mark=Mark(file=str(path)), accepted=accepted))
    place = path if path.name == PACKAGE_FILE else folder / PACKAGE_FILE
    content = read_bytes(place, InputError, limit=LONGEST)
    try:
        root = parsed(content, place)
    except etree.XMLSyntaxError as error:
        mark = Mark(file=str(place), line=max(error.position[0], 1))
        return _inspection([broken("package-not-xml", mark, f"this is not XML: {error.msg}")])
    if root.tag != "package":
        message = f"the outermost element is {root.tag}, not package"
        return _inspection([broken("package-not-xml", Mark(file=str(place), line=1), message)])
    package = Package(place.parent, root, with_its_own(path, packages_in(expansion.package_paths)))
    return _inspection([*of_document(root, place), *_project(package), *_paths(package), *_names(package)])


def _project(package: Package) -> Iterator[Finding]:
    path = package.folder / "CMakeLists.txt"
    text = (package.content(path) or b"").decode("utf-8", "replace")
    match = _PROJECT.search(text)
    if match and "$" not in match[1] and match[1].strip('"') != package.name:
        mark = Mark(file=str(path), line=text.count("\n", 0, match.start(1)) + 1)
        yield broken(
            "package-project-name", mark, f"the project is {shown(match[1])}, the package {shown(package.name)}"
        )


def _inspection(findings: Iterable[Finding]) -> Inspection:
    return Inspection(consumers=CONSUMERS, findings=tuple(findings))


# --- Packages and paths that xacros, descriptions and launch files name -----------------------------------------------


_IN_XML = re.compile(
    r"(?:\$\((?:find|find-pkg-share) +|package://)([A-Za-z0-9_-]+)\)?((?:/[A-Za-z0-9_.+-]+)*)(?![\w/${.+-])"
)
_MARKUP = {".xacro", ".urdf", ".srdf", ".launch", ".xml"}
_DECLARED = ("depend", "exec_depend", "run_depend")
_TEXT = r"[\"']([^\"'\n]+)[\"']"
_SHARE = rf"(?:FindPackageShare|get_package_share_(?:directory|path))\(\s*(?:package(?:_name)?\s*=\s*)?{_TEXT}\s*\)"
"""How Python names the folder of a package."""
_INSTALL = re.compile(
    r"install\s*\(\s*(?:DIRECTORY|FILES|PROGRAMS)\s+([^)]*?)\s+DESTINATION\b|INSTALL_TO_SHARE\s+([^)]*)\)",
    re.IGNORECASE,
)


class Use(NamedTuple):
    """A place that names a package, and perhaps a file in it."""

    package: str
    path: str
    mark: Mark
    is_mesh: bool = False  # the rules of descriptions look for the file


def _paths(package: Package) -> Iterator[Finding]:
    """What there is to report of them."""
    declared = {(element.text or "").strip() for tag in _DECLARED for element in package.root.findall(tag)}
    declared.add(package.name)
    installed = _installed(package)
    reported: set[str] = set()
    for use in _uses(package):
        if use.package not in declared and use.package not in reported:
            reported.add(use.package)
            yield broken("package-undeclared", use.mark, f"the package {shown(use.package)} is not in package.xml")
        folder = package.known.get(use.package)
        if folder is None or not use.path:
            continue
        if not is_there(folder / use.path):
            if not use.is_mesh:
                yield broken("package-missing-file", use.mark, f"{shown(use.path)} is not in the package {use.package}")
        elif use.package == package.name and installed is not None and not _is_installed(use.path, installed):
            yield broken("package-not-installed", use.mark, f"{shown(use.path)} is not installed")


def _uses(package: Package) -> Iterator[Use]:
    for path in package.files:
        if path == package.manifest or "test" in path.relative_to(package.folder).parts:
            continue
        if path.suffix in _MARKUP:
            yield from _in_markup(path, package.content(path) or b"")
        elif path.suffix == ".py" and ("launch" in path.name or "launch" in path.relative_to(package.folder).parts):
            yield from _in_launch(path, package.content(path) or b"")


def _in_markup(path: Path, content: bytes) -> Iterator[Use]:
    try:
        root = parsed(content, path)
    except etree.XMLSyntaxError:  # The rules of descriptions report it.
        return
    for element in root.iter(etree.Element):
        mark = Mark(file=str(path), line=element.sourceline)  # type: ignore[arg-type]  # the stubs of lxml
        for text in (*map(str, element.attrib.values()), element.text or ""):
            for match in _IN_XML.finditer(text):
                yield Use(match[1], match[2].strip("/"), mark, is_mesh=match[0].startswith(PACKAGE))


def _in_launch(path: Path, content: bytes) -> Iterator[Use]:
    """The packages and paths of a launch file, as far as they are texts in it."""
    text = re.sub(r"(?m)^[ \t]*#.*$", "", content.decode("utf-8", "replace"))

    def use(match: re.Match[str], package: str, inside: str = "") -> Use:
        return Use(package, inside, Mark(file=str(path), line=text.count("\n", 0, match.start()) + 1))

    shares = {match[1]: match[2] for match in re.finditer(rf"(\w+)\s*=\s*{_SHARE}", text)}
    for match in re.finditer(_SHARE, text):
        yield use(match, match[1])
    for match in re.finditer(rf"(?:PathJoinSubstitution|join)\(\s*\[?\s*(?:{_SHARE}|(\w+))((?:\s*,\s*{_TEXT})+)", text):
        if (package := match[1] or shares.get(match[2])) and text[match.end() :].lstrip(" \n\t,")[:1] in {"]", ")"}:
            yield use(match, package, str(PurePosixPath(*re.findall(_TEXT, match[3]))))
    for match in re.finditer(rf"\bpackage\s*=\s*{_TEXT}", text):
        yield use(match, match[1])
    for match in re.finditer(rf"MoveItConfigsBuilder\(\s*(?:robot_name\s*=\s*)?{_TEXT}([^()]*)", text):
        named = re.search(rf"package_name\s*=\s*{_TEXT}", match[2])
        yield use(match, named[1] if named else f"{match[1]}_moveit_config")


def _installed(package: Package) -> list[PurePosixPath] | None:
    """What CMakeLists.txt installs; None where there is none, or where variables name it."""
    content = package.content(package.folder / "CMakeLists.txt")
    if content is None:
        return None
    text = re.sub(r"#[^\n]*", "", content.decode("utf-8", "replace"))
    words = [word.strip('"') for match in _INSTALL.finditer(text) for word in (match[1] or match[2] or "").split()]
    return None if any("$" in word for word in words) else [PurePosixPath(word) for word in words]


def _is_installed(path: str, installed: Iterable[PurePosixPath]) -> bool:
    return any(PurePosixPath(path).is_relative_to(each) for each in installed)


# --- Joints, links and limits in files of parameters and SRDFs --------------------------------------------------------


_TAG = re.compile(rb"(?:^|[\s\[{,:])![A-Za-z!<]")
"""A tag, such as xacro's `!degrees`, whose file is for xacro alone."""
_ROS = "ros__parameters"
_PLANNING = ("has_velocity_limits", "has_acceleration_limits", "max_acceleration")
_REALS = ("max_velocity", "max_acceleration", "max_jerk", "min_position", "max_position")
_NEAR = 1e-6
"""How far a number may be outside a limit that was rounded."""


def _names(package: Package) -> Iterator[Finding]:
    """What there is to report of them; of joints only where a description can be read."""
    files: list[Node] = []
    for path in package.files:
        if path.suffix not in {".yaml", ".yml"}:
            continue
        content = package.content(path)
        if content is None or _TAG.search(content):
            continue
        try:
            files.append(load_yaml(content, str(path), InputError))
        except InputError as error:
            problem = error.problems[0]
            yield broken("package-not-yaml", problem.mark or Mark(file=str(path)), problem.message)
    controllers = {name for file in files for name in _ros2_controllers(file)}
    for file in files:
        yield from _controllers(file, package, controllers)
        yield from _limits(file, package)
        positions = _entries(file).get("initial_positions")
        yield from _unknown(positions, package, "an initial position", prefixed=True)
        for name, entry in _entries(positions).items():
            if isinstance(entry.value, (int, float)) and name in package.joints:
                yield from _outside(entry.value, package.joints[name], entry.mark, "the initial position")
    for path in package.files:
        if path.suffix == ".srdf":
            yield from _srdf(path, package)


def _entries(node: Node | None, *keys: str) -> dict[str, Node]:
    """The entries of a mapping inside mappings; none where something else is there."""
    for key in keys:
        node = _entries(node).get(key)
    return node.value if node is not None and isinstance(node.value, dict) else {}


def _words(node: Node | None) -> list[Node]:
    """The names of a list that no launch file fills in."""
    items = node.value if node is not None and isinstance(node.value, list) else []
    return [item for item in items if isinstance(item.value, str) and "$(" not in item.value]


# --- Controllers ------------------------------------------------------------------------------------------------------


def _ros2_controllers(node: Node) -> set[str]:
    manager = _entries(node, "controller_manager", _ROS)
    return {name for name, entry in manager.items() if "type" in _entries(entry)}


def _controllers(node: Node, package: Package, known: set[str]) -> Iterator[Finding]:
    if "controller_manager" in _entries(node):
        for name in _ros2_controllers(node):
            yield from _controller_joints(_entries(node, name, _ROS).get("joints"), name, package)
    manager = _entries(node, CONTROLLER_MANAGER)
    for each in _words(manager.get("controller_names")):
        name = str(each.value)
        if known and name not in known:
            near = did_you_mean(name, known)
            message = f"no controller of ros2_control is called {shown(name)}"
            yield broken("package-unknown-controller", each.mark, f"{message}: {near}" if near else message)
        yield from _controller_joints(_entries(manager.get(name)).get("joints"), name, package)


def _controller_joints(joints: Node | None, controller: str, package: Package) -> Iterator[Finding]:
    for each in _words(joints):
        if missing := _missing(str(each.value), package.joints):
            yield broken("package-controller-joint", each.mark, f"the controller {shown(controller)} moves {missing}")


def _missing(name: str, joints: dict[str, Joint], *, prefixed: bool = False) -> str | None:
    """What is wrong with the name of a joint; None where it is right, or where no description can be read.

    A macro reads a `prefixed` name and puts its prefix before it.
    """
    if not joints or "$(" in name or name in joints or (prefixed and any(each.endswith(name) for each in joints)):
        return None
    near = did_you_mean(name, joints)
    message = f"the joint {shown(name)}, which the description does not have"
    return f"{message}: {near}" if near else message


# --- Limits and positions ---------------------------------------------------------------------------------------------


def _limits(node: Node, package: Package) -> Iterator[Finding]:
    found = _entries(node).get("joint_limits")
    limits = _entries(found)
    is_for_planning = any(key in _entries(entry) for entry in limits.values() for key in _PLANNING)
    yield from _unknown(found, package, "limits", prefixed=not is_for_planning)
    if found is None or not is_for_planning:
        return
    for name, entry in limits.items():
        values, joint = _entries(entry), package.joints.get(name)
        for key in _REALS:
            if key in values and type(values[key].value) is int:
                message = f"{key} of the joint {shown(name)} is the whole number {values[key].value}"
                yield broken("package-whole-number", values[key].mark, message)
        velocity, highest = values.get("max_velocity"), joint.limits.velocity if joint else None
        if velocity is None or highest is None or not isinstance(velocity.value, (int, float)):
            continue
        if velocity.value > highest * (1.0 + _NEAR):
            numbers = f"is {velocity.value:.9g}, in the description {highest:.9g}"
            message = f"max_velocity of the joint {shown(name)} {numbers}"
            yield broken("package-higher-limit", velocity.mark, message)
    for name in package.joints:
        values = _entries(found, name)
        has = values.get("has_acceleration_limits")
        if has is None or has.value is not True or "max_acceleration" not in values:
            mark = found.key_mark(name) if name in limits else found.mark
            yield broken("package-missing-limits", mark, f"the joint {shown(name)} has no acceleration")


def _unknown(found: Node | None, package: Package, what: str, *, prefixed: bool) -> Iterator[Finding]:
    """The joints of a mapping that the descriptions do not have."""
    for name in _entries(found):
        missing = _missing(name, package.joints, prefixed=prefixed)
        if found is not None and missing:
            yield broken("package-unknown-joint", found.key_mark(name), f"{what} of {missing}")


def _outside(value: float, joint: Joint, mark: Mark, what: str) -> Iterator[Finding]:
    lower, upper = joint.limits.lower, joint.limits.upper
    if lower is not None and upper is not None and not lower - _NEAR <= value <= upper + _NEAR:
        message = f"{what} of the joint {shown(joint.name)} is {value:.9g}, its limits are {lower:.9g} and {upper:.9g}"
        yield broken("package-outside-limits", mark, message)


# --- SRDF -------------------------------------------------------------------------------------------------------------


def _srdf(path: Path, package: Package) -> Iterator[Finding]:
    try:
        root = parsed(package.content(path) or b"", path)
    except etree.XMLSyntaxError as error:
        mark = Mark(file=str(path), line=max(error.position[0], 1))
        yield broken("package-srdf-name", mark, f"this is not XML: {error.msg}")
        return
    name = root.get("name") or ""
    robot = next((each for each in package.robots if each.name == name), None)
    if robot is None:
        if len(package.robots) != 1:
            return
        (robot,) = package.robots
        message = f"the SRDF is of the robot {shown(name)}, the description of {shown(robot.name)}"
        yield broken("package-srdf-robot", mark_of(root), message)
    virtual = [each.get("name") or "" for each in root.iterfind("virtual_joint")]
    links, joints = [link.name for link in robot.links], [*(joint.name for joint in robot.joints), *virtual]
    yield from of_document(root, path, {"$links": links, "$joints": joints})
    moving = {joint.name: joint for joint in robot.moving_joints}
    for each in root.iterfind("group_state/joint"):
        joint, state = moving.get(each.get("name") or ""), each.getparent()
        try:
            value = float(each.get("value") or "")
        except ValueError:  # A joint of several values, or none that can be compared.
            continue
        if joint is not None and state is not None:
            yield from _outside(value, joint, mark_of(each), f"the state {shown(state.get('name') or '')}")
