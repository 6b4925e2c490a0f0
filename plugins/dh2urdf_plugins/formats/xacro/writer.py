"""xacro: a macro that a person can edit, and a thin file that calls it.

``<stem>_macro.xacro`` holds one macro. Inside it, and never at the file's scope, where two macros would overwrite each
other's, stand the numbers of the table as properties; origins and shapes are formulas over them. The macro prefixes
every link, joint and material, and mounts the arm on a link of the caller's, or on none where ``parent`` is empty.
A second macro is for calls without an origin block, which xacro cannot leave out. ``<stem>.urdf.xacro`` calls the
first with its arguments, by default with no parent. Expanded, that is the URDF of the same robot, element by element.

Of a cell, ``<stem>_macro.xacro`` holds one macro for every kind of arm, and ``<stem>.urdf.xacro`` the root link and one
call for every arm, with its prefix, its parent and its origin.

What is attached to an arm or to a cell has a macro of its own in ``<stem>_parts.xacro``, with the numbers of its
own file. The macro of its arm calls it, or the file to open.
"""

from __future__ import annotations

import glob
import math
import re
from dataclasses import replace
from itertools import groupby
from keyword import iskeyword
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.cells.floating import without_world
from dh2urdf.errors import EmitterError
from dh2urdf.fields import replace_unchecked
from dh2urdf.meshes import has_meshes
from dh2urdf.quantities import format_number
from dh2urdf.robot import Arm, Inertial
from dh2urdf.source import Messages, shown
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.formats import numbered_name
from dh2urdf_plugins.formats.urdf.profiles import PROFILES, Profile, adapted, append_transmissions
from dh2urdf_plugins.formats.urdf.writer import (
    Notation,
    append_comment,
    append_inertial,
    append_mujoco,
    append_robot,
    materials_of,
    serialise,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping, Sequence, Set as AbstractSet

    from dh2urdf.manipulator import Limits
    from dh2urdf.robot import Attachment, Parameter, Robot
    from dh2urdf_plugins.formats.urdf import UrdfVersion
    from dh2urdf_plugins.formats.xacro import XacroOptions

say = Messages(__file__)

NAMESPACE = "http://www.ros.org/wiki/xacro"
MACRO_PARAMETERS = "prefix:='' parent:='' *origin"
PLACEMENT = {"prefix": "", "parent": "", "xyz": "0 0 0", "rpy": "0 0 0"}
"""The arguments of a file for one arm, with their defaults."""

NAMES = ("prefix", "parent")
"""Those of them that are names, or the beginning of names."""

_IDENTIFIER = re.compile(r"[^\W\d]\w*")
_MACRO_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
# The xacro elements that a call of a macro of the same name would be taken for.
_XACRO_ELEMENTS = frozenset(
    {"arg", "attribute", "call", "element", "if", "include", "insert_block", "macro", "property", "unless"}
)
# What formulas and the macro itself mean by these words; a property of that name would hide it.
_WORDS_IN_USE = frozenset({"prefix", "parent", "origin", "pi", "abs", "fabs", "max", "sin", "cos", "atan2"})


class XacroNotation(Notation):
    """Names carry the prefix; numbers that follow the table are formulas over the macro's properties."""

    def __init__(self, parameters: Sequence[Parameter] = (), version: UrdfVersion = "1.0") -> None:
        super().__init__(version)
        self._parameters = frozenset(parameter.name for parameter in parameters)

    def text(self, text: str) -> str:
        """A text in which xacro finds nothing to evaluate: it reads ``${'$'}`` as a dollar sign, and no doubled one."""
        return self.verbatim(super().text(text))

    def verbatim(self, text: str) -> str:
        """A text of another program, which xacro evaluates as little."""
        return text.replace("$", "${'$'}")

    def name(self, name: str) -> str:
        """A name with the macro's prefix."""
        return "${prefix}" + self.text(name)

    def lengths(self, lengths: Sequence[float], formulas: Sequence[str] | None = None) -> str:
        """Lengths [m], as formulas where they follow the table."""
        return self._formulas(lengths, formulas) or self.numbers(lengths)

    def angles(self, angles: Sequence[float], formulas: Sequence[str] | None = None) -> str:
        """Angles [rad], as formulas where they follow the table, multiples of π written as such."""
        return self._formulas(angles, formulas, angle_text) or " ".join(map(angle_text, angles))

    def _formulas(
        self,
        numbers: Sequence[float],
        formulas: Sequence[str] | None,
        number_text: Callable[[float], str] = format_number,
    ) -> str | None:
        if not formulas:
            return None
        return " ".join(
            # xacro knows abs as python.abs only, and not in every version; fabs is math's and everywhere.
            "${" + re.sub(r"\babs\b", "fabs", formula) + "}"
            if self._parameters.intersection(_IDENTIFIER.findall(formula))
            else number_text(number)
            for number, formula in zip(numbers, formulas, strict=True)
        )


def angle_text(angle: float) -> str:
    """An angle [rad] for xacro: ``${-pi/2}`` where that is the very same double, the number elsewhere."""
    # Beyond 20 π the doubles are so far apart, in the end, that every one is some multiple of π/12.
    if angle and abs(angle) <= 20 * math.pi:
        for denominator in (1, 2, 3, 4, 6, 12):
            numerator = round(angle * denominator / math.pi)
            if numerator * math.pi / denominator == angle:
                factor = {1: "", -1: "-"}.get(numerator, f"{numerator}*")
                return f"${{{factor}pi}}" if denominator == 1 else f"${{{factor}pi/{denominator}}}"
    return format_number(angle)


def macro_name(robot_name: str, stem: str) -> str:
    """The macro's name: the robot's where xacro and XML can take it, else the file's with ``_`` for what they cannot.

    A name that every XML parser reads as a tag has ASCII letters, digits, ``_`` and ``-``, and begins with a letter or
    ``_``; xacro takes a dot for a namespace, and its own elements for themselves.
    """
    if _MACRO_NAME.fullmatch(robot_name) and robot_name not in _XACRO_ELEMENTS:
        return robot_name
    name = re.sub(r"[^A-Za-z0-9_-]", "_", stem)
    return name if _MACRO_NAME.fullmatch(name) and name not in _XACRO_ELEMENTS else f"_{name}"


def xacro_files(robot: Robot, stem: str, options: XacroOptions) -> tuple[EmittedFile, ...]:
    """The macro of a robot and the file that calls it; the latter comes first, for it is the one to open."""
    notation, profile = XacroNotation(version=options.version), PROFILES[options.profile]
    single_file = options.single_file
    robot = without_world(adapted(with_laden_kinds(robot), profile))
    macros = macros_of(robot, stem)
    parts = PartMacros(robot, profile, options.version, macros)
    top = notation.robot(notation.text(robot.name), nsmap={"xacro": NAMESPACE})
    if not robot.arms:
        append_arguments(top, PLACEMENT)
    if profile.mujoco_element:
        append_mujoco(top, robot, notation)
    place, library = len(top), etree.Element("robot", nsmap={"xacro": NAMESPACE})
    if not single_file:
        # xacro takes a file name for a pattern.
        append_element(top, "include", filename=notation.text(glob.escape(f"{stem}_macro.xacro")))
        if robot.attachments:
            append_element(library, "include", filename=notation.text(glob.escape(f"{stem}_parts.xacro")))
    for name, kind in macros.items():
        _append_macro(library, kind, name, profile, parts)
        if f"{name}_at" not in macros:
            append_placed_macro(library, name)
    append_calls(top, robot, macros, parts)
    trees = {"_macro.xacro": library} | ({"_parts.xacro": parts.library()} if robot.attachments else {})
    if single_file:  # A macro comes before its calls.
        top[place:place] = [each for tree in reversed(trees.values()) for each in tree]
    trees = {".urdf.xacro": top} | ({} if single_file else trees)
    contents = {f"{stem}{ending}": serialise(tree, robot.comment) for ending, tree in trees.items()}
    return tuple([EmittedFile(name=name, content=content) for name, content in contents.items()])


def macros_of(robot: Robot, stem: str) -> dict[str, Robot]:
    """The macros that a robot needs, by their names: its own, or one for every kind of its arms."""
    if not robot.arms:
        return {macro_name(robot.name, stem): robot}
    macros: dict[str, Robot] = {}
    for arm in robot.arms:
        if not any(kind is arm.kind for kind in macros.values()):
            macros[numbered_name(macro_name(arm.kind.name, arm.kind.name), macros)] = arm.kind
    return macros


def with_laden_kinds(robot: Robot) -> Robot:
    """A cell in which an arm that bears more than others of its kind is a kind of its own, with the efforts for it."""
    if not robot.attachments:
        return robot
    limits = {joint.name: joint.limits for joint in robot.joints}
    kinds: dict[tuple[int, tuple[Limits, ...]], Robot] = {}
    arms = []
    for arm in robot.arms:
        own = tuple([limits[arm.prefix + joint.name] for joint in arm.kind.joints])
        joints = [replace(joint, limits=each) for joint, each in zip(arm.kind.joints, own, strict=True)]
        laden = arm.kind if tuple(joints) == arm.kind.joints else replace(arm.kind, joints=tuple(joints))
        arms.append(replace(arm, kind=kinds.setdefault((id(arm.kind), own), laden)))
    return replace(robot, arms=tuple(arms))


def append_element(parent: etree._Element, tag: str, /, **attributes: str) -> etree._Element:
    """Appends an element of xacro's."""
    return etree.SubElement(parent, f"{{{NAMESPACE}}}{tag}", attributes)


def append_arguments(top: etree._Element, defaults: Mapping[str, str]) -> None:
    """Appends the arguments of a file."""
    for name, default in defaults.items():
        append_element(top, "arg", name=name, default=default)


def append_calls(
    top: etree._Element, robot: Robot, macros: Mapping[str, Robot], parts: PartMacros, files: Iterable[str] = ()
) -> None:
    """Appends the calls of a file to open.

    They are that of its one macro, with the arguments of the file, also `files`, and the link that the arm is on; or,
    below the root of a cell, those of its arms and of the attachments that no arm brings, as their links come.
    """
    if not robot.arms:
        mounted = append_element(top, "unless", value="${'$(arg parent)' == ''}")
        etree.SubElement(mounted, "link", {"name": "$(arg parent)"})
        call = append_element(top, next(iter(macros)), **_passed_on("$(arg {})", files))
        etree.SubElement(call, "origin", {"xyz": "$(arg xyz)", "rpy": "$(arg rpy)"})
        return
    notation = XacroNotation()
    if robot.root not in robot.floating:  # What floats is a root itself.
        etree.SubElement(top, "link", {"name": notation.text(robot.root)})
    roots: dict[str, Arm | Attachment] = {each.prefix + each.robot.root: each for each in robot.attachments}
    for arm in robot.arms:
        roots |= {arm.prefix + arm.kind.root: arm}
        for own in arm.kind.attachments:
            roots.pop(arm.prefix + own.prefix + own.robot.root, None)
    for each in (roots[link.name] for link in robot.links if link.name in roots):
        if isinstance(each, Arm):
            name = next(name for name, kind in macros.items() if kind is each.kind)
            words = {"prefix": as_text(notation.text(each.prefix)), "parent": as_text(notation.text(each.parent))}
            origin = {"xyz": notation.lengths(each.placement.xyz), "rpy": notation.angles(each.placement.rpy)}
            etree.SubElement(append_element(top, name, **words), "origin", origin)
        else:
            parts.append_call(top, robot, each, notation.text)


def append_placed_macro(parent: etree._Element, macro: str, files: Mapping[str, str] | None = None) -> None:
    """Appends a second macro of the same arm, for a call without a block; `files` are further parameters."""
    files, example = files or {}, f'<xacro:{macro}_at parent="world" xyz="0 0 1"/>'
    append_comment(parent, f"The same without a block, which xacro cannot leave out: {example}.")
    defaults = [f"{name}:='{default}'" for name, default in {**PLACEMENT, **files}.items()]
    placed = append_element(parent, "macro", name=f"{macro}_at", params=" ".join(defaults))
    call = append_element(placed, macro, **_passed_on("${{{}}}", files))
    etree.SubElement(call, "origin", {"xyz": "${xyz}", "rpy": "${rpy}"})


def _passed_on(form: str, files: Iterable[str]) -> dict[str, str]:
    """What one macro or file passes on to a macro. Names are in quotes: of `01`, xacro would make 1."""
    return {**{name: f"'{form.format(name)}'" for name in NAMES}, **{name: form.format(name) for name in files}}


def as_text(text: str) -> str:
    """A text as the value of a macro's parameter, where xacro makes numbers and truth values of what looks like them.

    It does so unless there is a ``_`` in it, or quotes around it, which it takes off.
    """
    return text if "_" in text.strip("'") or text == "world" else f"'{text}'"


def append_macro(library: etree._Element, name: str, parameters: str = "") -> etree._Element:
    """Appends a macro of an arm, which is empty so far, below a comment with a call; it may have more parameters."""
    append_comment(
        library,
        f'Call it as <xacro:{name} prefix="left_" parent="world"><origin xyz="0 0 0" rpy="0 0 0"/></xacro:{name}>; '
        "without a parent the arm is mounted on nothing, and origin is not used.",
    )
    return append_element(library, "macro", name=name, params=f"{MACRO_PARAMETERS} {parameters}".strip())


def _append_macro(parent: etree._Element, whole: Robot, name: str, profile: Profile, parts: PartMacros) -> None:
    notation, robot = XacroNotation(whole.parameters, parts.version), without_attachments(whole)
    macro = append_macro(parent, name)
    has_meshes_too = ", meshes" if has_meshes(robot) else ""
    if robot.parameters:
        append_comment(
            macro,
            "The table: edit the arm here. Origins and shapes follow these properties; "
            f"axes, limits, masses{has_meshes_too} and inertias are numbers that do not.",
        )
    for joint, group in groupby(robot.parameters, key=lambda parameter: parameter.joint):
        row = list(group)
        units = dict.fromkeys(parameter.unit for parameter in row)
        listed = "; ".join(f"{', '.join(p.name for p in row if p.unit == unit)} [{unit}]" for unit in units)
        append_comment(macro, f"joint {shown(joint)}: {listed}")
        for parameter in row:
            value = angle_text(parameter.value) if parameter.unit == "rad" else format_number(parameter.value)
            append_element(macro, "property", name=property_name(parameter), value=value)
    append_mounting(macro, notation.name(robot.mounting), notation.name(robot.root))
    append_robot(macro, robot, notation, shared_materials=profile.shared_materials)
    if profile.transmissions:
        append_transmissions(macro, robot, notation)
    if robot.links[0].inertial is None and profile.frame_inertials:
        # A link without an inertial weighs 1 kg in PyBullet, unless it is the root, and KDL warns of a root with one.
        mounted = etree.Element(f"{{{NAMESPACE}}}unless", {"value": "${parent == ''}"})
        append_inertial(mounted, robot.root, Inertial(mass=0.0), notation)
        next(macro.iterchildren("link")).insert(0, mounted)
    for attachment in whole.attachments:
        parts.append_call(macro, whole, attachment, notation.name)


def property_name(parameter: Parameter) -> str:
    """The name of a parameter, where xacro may have a property of it and no formula means something else by it."""
    name = parameter.name
    if not name.isidentifier() or iskeyword(name) or name.startswith("__") or name in _WORDS_IN_USE:
        words = sorted(_WORDS_IN_USE)
        raise EmitterError(say("xacro-property-wrong", joint=parameter.joint, found=name, words=words))
    return name


def append_mounting(macro: etree._Element, name: str, root: str) -> None:
    """Appends the joint between the caller's link and a root, which is written where there is a parent."""
    condition = append_element(macro, "unless", value="${parent == ''}")
    joint = etree.SubElement(condition, "joint", {"name": name, "type": "fixed"})
    append_element(joint, "insert_block", name="origin")
    etree.SubElement(joint, "parent", {"link": "${parent}"})
    etree.SubElement(joint, "child", {"link": root})


# --- What is attached -------------------------------------------------------------------------------------------------


def without_attachments(robot: Robot) -> Robot:
    """A robot without what is attached to it."""
    return _within(robot, {link.name for link in robot.links} - robot.foreign_names)


def _within(robot: Robot, names: AbstractSet[str], *attachments: Attachment) -> Robot:
    """Some links of a robot with the joints between them, and attachments."""
    links = tuple([link for link in robot.links if link.name in names])
    joints = tuple([joint for joint in robot.joints if {joint.parent, joint.child} <= names])
    return replace_unchecked(robot, links=links, joints=joints, attachments=attachments)


class _PartNotation(XacroNotation):
    """The prefix of a macro takes the place of an attachment's; numbers are those of its own file."""

    def __init__(self, prefix: str, version: UrdfVersion) -> None:
        super().__init__(version=version)
        self._prefix = prefix

    def name(self, name: str) -> str:
        return super().name(name.removeprefix(self._prefix))

    def angles(self, angles: Sequence[float], _formulas: Sequence[str] | None = None) -> str:
        return self.numbers(angles)


class PartMacros:
    """The macros of what is attached to a robot or to the arms of a cell; equal ones are one."""

    def __init__(self, robot: Robot, profile: Profile, version: UrdfVersion, taken: Collection[str]) -> None:
        """Takes the names of other macros, and refuses what no xacro can hold."""
        self.version = version
        self._profile, self._taken = profile, [*taken, *(f"{name}_at" for name in taken)]
        self._macros: dict[str, tuple[bytes, etree._Element]] = {}
        materials_of(robot)
        for attachment in robot.attachments:
            for element in (
                each for text in attachment.elements for each in etree.fromstring(text).iter(etree.Element)
            ):
                if element.prefix == "xacro" or etree.QName(element).namespace == NAMESPACE:
                    tag = etree.QName(element).localname
                    raise EmitterError(say("attached-with-macros", robot=robot.name, name=attachment.name, tag=tag))

    def append_call(
        self, parent: etree._Element, robot: Robot, attachment: Attachment, name: Callable[[str], str]
    ) -> None:
        """Appends the call of an attachment of a robot, whose names are written as `name` has it."""
        root = attachment.prefix + attachment.robot.root
        held = next((joint for joint in robot.joints if joint.child == root), None)
        words = {"prefix": attachment.prefix, "parent": attachment.parent, "joint": held.name if held else ""}
        quoted = {word: f"'{name(text)}'" for word, text in words.items()}  # Of `01`, xacro would make 1.
        call = append_element(parent, self.macro_of(robot, attachment), **quoted)
        notation, (xyz, rpy) = XacroNotation(), (attachment.placement.xyz, attachment.placement.rpy)
        place = {"xyz": notation.numbers(xyz), "rpy": notation.numbers(rpy)}
        etree.SubElement(call, "origin", place)

    def library(self) -> etree._Element:
        """A file of the macros, each below a comment with a call."""
        library = etree.Element("robot", nsmap={"xacro": NAMESPACE})
        for name, (_, macro) in self._macros.items():
            call = f'<xacro:{name} prefix="left_" parent="left_tool0"><origin xyz="0 0 0" rpy="0 0 0"/></xacro:{name}>'
            append_comment(
                library, f"Call it as {call}; the joint that holds it is left_joint, or has the name `joint`."
            )
            library.append(macro)
        return library

    def macro_of(self, robot: Robot, attachment: Attachment) -> str:
        """The name of the macro of an attachment."""
        notation = _PartNotation(attachment.prefix, self.version)
        part = _within(robot, {attachment.prefix + name for name in attachment.names}, attachment)
        macro = etree.Element(f"{{{NAMESPACE}}}macro", {"name": "", "params": "prefix:='' parent joint:='' *origin"})
        append_mounting(macro, "${joint or prefix + 'joint'}", notation.name(part.root))
        # A material that other links of the robot have, too, is defined by them: a second definition is an error.
        own = {link.name for link in part.links}
        others = replace_unchecked(robot, links=tuple([link for link in robot.links if link.name not in own]))
        is_shared = materials_of(part).keys().isdisjoint(materials_of(others))
        append_robot(macro, part, notation, shared_materials=self._profile.shared_materials and is_shared)
        if self._profile.transmissions:
            append_transmissions(macro, part, notation)
        content = etree.tostring(macro)
        wanted = f"part_{attachment.robot.name}"
        for name, (known, _) in self._macros.items():
            if known == content:
                return name
        name = numbered_name(macro_name(wanted, wanted), {*self._taken, *self._macros})
        macro.set("name", name)
        self._macros[name] = content, macro
        return name
