"""Inspects a package of ROS 2 of any origin: what colcon, launch files and MoveIt will do with it."""

from __future__ import annotations

import re
from contextlib import suppress
from functools import cache, cached_property, partial
from itertools import islice
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, NamedTuple

from lxml import etree

from dh2urdf.documents import is_file, is_there, load_yaml, read_bytes, xml_root
from dh2urdf.errors import Dh2UrdfError, InputError
from dh2urdf.meshes import PACKAGE, own_folder, packages_in, with_its_own
from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Messages, shown
from dh2urdf.stages import PACKAGE_FILE, Expansion, Finding, Inspection
from dh2urdf_check.files import files_in, urdfs, xacros
from dh2urdf_check.finders import Document, numbers_of, text_of
from dh2urdf_check.rules import Rule, rules_of
from dh2urdf_plugins.descriptions.description import describe
from dh2urdf_plugins.formats.xml_files import FILE, mark_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from dh2urdf.documents import Node
    from dh2urdf.robot import Joint

say = Messages(__file__)

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
    return package_rules()[rule].finding(message, mark)


def parsed(content: bytes, path: Path) -> etree._Element:
    """The outermost element of a file of a package."""
    root = xml_root(content)
    root.set(FILE, str(path))
    return root


@cache
def package_rules() -> dict[str, Rule]:
    """The rules of packages by name, in the order of their table."""
    return rules_of("packages", CONSUMERS)


def of_document(document: Document, mark: Callable[[Any], Mark] = mark_of) -> Iterator[Finding]:
    """The places of a file of a package where it breaks rules that are data; `mark` is where its elements are."""
    for hit in document.hits(package_rules().values()):
        yield broken(hit.rule, mark(hit.at), hit.message)


class Package:
    """A package of ROS 2, whose package.xml has the outermost element `root`; `known` are the folders of packages."""

    def __init__(self, folder: Path, root: etree._Element, known: Mapping[str, Path]) -> None:
        self.folder, self.root = folder, root
        self.name = (root.findtext("name") or "").strip()
        self.known = {**{name: each for name, each in known.items() if each != folder.resolve()}, self.name: folder}

    @cached_property
    def files(self) -> tuple[Path, ...]:
        """Its files, without hidden folders and packages inside."""
        own = files_in(self.folder, [], lambda inner: not is_there(inner / PACKAGE_FILE))
        return tuple(islice(own, MOST_FILES))

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
        if not found:
            with suppress(InputError, KeyError, TypeError, AttributeError):
                content = self.content(self.folder / ".setup_assistant") or b""
                settings = load_yaml(content, ".setup_assistant", InputError).plain()["moveit_setup_assistant_config"]
                urdf = settings.get("urdf") or settings["URDF"]
                found = [each for each in [self.known[urdf["package"]] / urdf["relative_path"]] if is_file(each)]
        for path in found:
            form, packages = path.suffix.removeprefix("."), tuple(self.known.values())
            expansion = Expansion(package_paths=packages) if form == "xacro" else Expansion()
            with suppress(Dh2UrdfError):  # The check of the description itself reports it.
                robots.append(describe(form if form == "xacro" else "urdf", path, expansion).robot)
        return tuple(filter(None, robots))


# --- What is reported of a package ------------------------------------------------------------------------------------


def packages(roots: Mapping[Path, str]) -> Iterator[Path]:
    """The package.xml of each package among the files of a folder."""
    return (path for path in roots if path.name == PACKAGE_FILE)


def inspect_package(path: Path, expansion: Expansion) -> Inspection:
    """What there is to report of the package that a file is in, which may use those of an expansion."""
    folder = own_folder(path)
    if not is_file(folder / PACKAGE_FILE):
        raise InputError(say("file-of-no-package", Mark(file=str(path))))
    place = path if path.name == PACKAGE_FILE else folder / PACKAGE_FILE
    content = read_bytes(place, InputError, limit=LONGEST)
    line, fault, found = 1, "", list[Finding]()
    try:
        root = parsed(content, place)
        fault = "" if root.tag == "package" else f"the outermost element is {root.tag}, not package"
    except etree.XMLSyntaxError as error:
        line, fault = max(error.position[0], 1), f"this is not XML: {error.msg}"
    if fault:
        found.append(broken("package-not-xml", Mark(file=str(place), line=line), fault))
    else:
        package = Package(place.parent, root, with_its_own(path, packages_in(expansion.package_paths)))
        found += [*of_document(Document(root, place)), *_paths(package), *_names(package)]
    return Inspection(consumers=CONSUMERS, findings=tuple(found))


# --- Packages and paths that xacros, descriptions and launch files name -----------------------------------------------


_IN_XML = re.compile(
    r"(?:\$\((?:find|find-pkg-share) +|package://)([A-Za-z0-9_-]+)\)?((?:/[A-Za-z0-9_.+-]+)*)(?![\w/${.+-])"
)
_MARKUP = {".xacro", ".urdf", ".srdf", ".launch", ".xml"}
_DECLARED = ("depend", "exec_depend", "run_depend")
_TEXT = r"[\"']([^\"'\n]+)[\"']"
_SHARE = rf"(?:FindPackageShare|get_package_share_(?:directory|path))\(\s*(?:package(?:_name)?\s*=\s*)?{_TEXT}\s*\)"
"""How Python names the folder of a package."""
_PROJECT = re.compile(r"^[ \t]*project\s*\(\s*([^\s)]+)", re.IGNORECASE | re.MULTILINE)
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
    """What there is to report of them, and of what CMakeLists.txt has of the package."""
    path = package.folder / "CMakeLists.txt"
    content = package.content(path)
    text = (content or b"").decode("utf-8", "replace")
    match = _PROJECT.search(text)
    if match and "$" not in match[1] and match[1].strip('"') != package.name:
        mark = Mark(file=str(path), line=text.count("\n", 0, match.start(1)) + 1)
        message = f"the project is {shown(match[1])}, the package {shown(package.name)}"
        yield broken("package-project-name", mark, message)
    found = [match[1] or match[2] or "" for match in _INSTALL.finditer(re.sub(r"#[^\n]*", "", text))]
    # What it installs; None where there is no such file, or where variables name it.
    words = [word.strip('"') for names in found for word in names.split()]
    installed = None if content is None or "$" in "".join(words) else words
    declared = {(element.text or "").strip() for tag in _DECLARED for element in package.root.findall(tag)}
    declared.add(package.name)
    for use in _uses(package):
        if use.package not in declared:
            declared.add(use.package)  # It is reported once.
            yield broken("package-undeclared", use.mark, f"the package {shown(use.package)} is not in package.xml")
        folder = package.known.get(use.package)
        if folder is None or not use.path:
            continue
        if not is_there(folder / use.path):
            if not use.is_mesh:
                yield broken("package-missing-file", use.mark, f"{shown(use.path)} is not in the package {use.package}")
        elif use.package != package.name or installed is None:
            continue
        elif not any(PurePosixPath(use.path).is_relative_to(each) for each in installed):
            yield broken("package-not-installed", use.mark, f"{shown(use.path)} is not installed")


def _uses(package: Package) -> Iterator[Use]:
    for path in package.files:
        inside, content = path.relative_to(package.folder).parts, package.content
        if path == package.folder / PACKAGE_FILE or "test" in inside:
            continue
        if path.suffix in _MARKUP:
            with suppress(etree.XMLSyntaxError):  # The rules of descriptions report it.
                for element in parsed(content(path) or b"", path).iter(etree.Element):
                    for text in (*map(str, element.attrib.values()), element.text or ""):
                        for match in _IN_XML.finditer(text):
                            is_mesh = match[0].startswith(PACKAGE)
                            yield Use(match[1], match[2].strip("/"), mark_of(element), is_mesh)
        elif path.suffix == ".py" and ("launch" in path.name or "launch" in inside):
            yield from _in_launch(path, content(path) or b"")


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


# --- Joints, links and limits in files of parameters and SRDFs --------------------------------------------------------


_TAG = re.compile(rb"(?:^|[\s\[{,:])![A-Za-z!<]")
"""A tag, such as xacro's `!degrees`, whose file is for xacro alone."""
_PLAIN = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_DEEPEST = 6
"""Mappings and lists inside each other that rules look into."""
_ROS2_CONTROLLERS = "/yaml/controller_manager/ros__parameters/*[type]/@key"
_FOR_PLANNING = "/yaml/joint_limits[*/has_velocity_limits or */has_acceleration_limits or */max_acceleration]"
_NEAR = 1e-6
"""How far a number may be outside a limit that was rounded."""


def _names(package: Package) -> Iterator[Finding]:
    """What there is to report of them; of joints only where a description can be read."""
    files: list[tuple[Document, dict[object, Mark]]] = []
    joints = {joint.name: joint for robot in package.robots for joint in robot.moving_joints}
    controllers = set[str]()  # of ros2_control, in any of the files
    functions = {**_functions(joints), "has-controllers": lambda _: bool(controllers)}
    for path in package.files:
        content = package.content(path) if path.suffix in {".yaml", ".yml"} else None
        if content is None or _TAG.search(content):
            continue
        try:
            node, marks = load_yaml(content, str(path), InputError), dict[object, Mark]()
            root = _tree(node, "yaml", node.mark, marks, _DEEPEST)
        except InputError as error:
            problem = error.problems[0]
            yield broken("package-not-yaml", problem.mark or Mark(file=str(path)), problem.message)
            continue
        document = Document(root, path, functions)
        document.sets |= {"$joints": joints, "$controllers": controllers}
        controllers.update(document.select(_ROS2_CONTROLLERS))
        files.append((document, marks))
    for document, marks in files:
        yield from of_document(document, marks.__getitem__)
        for limits in document.select(_FOR_PLANNING):
            entries = {entry.get("key"): entry for entry in limits}
            for name in joints:
                entry = entries.get(name, limits)
                if entry.findtext("has_acceleration_limits") != "True" or entry.find("max_acceleration") is None:
                    yield broken("package-missing-limits", marks[entry], f"the joint {shown(name)} has no acceleration")
    for path in package.files:
        if path.suffix == ".srdf":
            yield from _srdf(path, package)


def _tree(node: Node, key: str, mark: Mark, marks: dict[object, Mark], depth: int) -> etree._Element:
    """A file of parameters as rules see it: an element for each entry, called as its `key` is, and for each `item`."""
    element = etree.Element(key if _PLAIN.fullmatch(key) else "entry", key=key if key.isprintable() else "")
    value = node.value if depth else None
    element.set("type", type(value).__name__)
    marks[element] = mark
    if isinstance(value, dict):
        for name, each in value.items():
            place = node.key_mark(name) if isinstance(each.value, dict) else each.mark
            element.append(_tree(each, name, place, marks, depth - 1))
    elif isinstance(value, list):
        element.extend(_tree(each, "item", each.mark, marks, depth - 1) for each in value)
    elif str(value).isprintable():
        element.text = str(value)
    return element


def _functions(joints: Mapping[str, Joint]) -> dict[str, Callable[..., Any]]:
    """The functions of XPath in rules about the joints of a description."""

    def missing(_: object, found: Any, *, prefixed: bool = False) -> str:  # noqa: ANN401 - what XPath has
        """A name that no joint has; empty where one has it, where a launch file fills it in, or no joint is known."""
        name = text_of(found)
        is_known = name in joints or (prefixed and any(each.endswith(name) for each in joints))
        return "" if not joints or is_known or "$(" in name else name

    def faster(_: object, found: Any, name: Any) -> str:  # noqa: ANN401
        """By how much a velocity is higher than that of a joint, as a sentence; empty where it is not."""
        joint, velocity = joints.get(text_of(name)), numbers_of(text_of(found), 1)
        highest = joint.limits.velocity if joint else None
        if highest is None or not velocity or velocity[0] <= highest * (1.0 + _NEAR):
            return ""
        return f"is {velocity[0]:.9g}, in the description {highest:.9g}"

    def outside(_: object, found: Any, name: Any) -> str:  # noqa: ANN401
        """How a position is outside the limits of a joint, as a sentence; empty where it is not."""
        joint, value = joints.get(text_of(name)), numbers_of(text_of(found), 1)
        lower, upper = (joint.limits.lower, joint.limits.upper) if joint else (None, None)
        if lower is None or upper is None or not value or lower - _NEAR <= value[0] <= upper + _NEAR:
            return ""
        return f"is {value[0]:.9g}, its limits are {lower:.9g} and {upper:.9g}"

    return {
        "missing": missing,
        "missing-suffix": partial(missing, prefixed=True),  # A macro reads the name and puts its prefix before it.
        "faster": faster,
        "outside": outside,
    }


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
    document = Document(root, path, _functions({joint.name: joint for joint in robot.moving_joints}))
    virtual = [each.get("name") or "" for each in root.iterfind("virtual_joint")]
    joints = [*(joint.name for joint in robot.joints), *virtual]
    document.sets |= {"$links": [link.name for link in robot.links], "$joints": joints}
    yield from of_document(document)
