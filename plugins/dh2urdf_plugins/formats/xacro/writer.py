"""xacro: a macro that a person can edit, and a thin file that calls it.

``<stem>_macro.xacro`` holds one macro. Inside it, and never at the file's scope, where two macros would overwrite each
other's, stand the numbers of the table as properties; origins and shapes are formulas over them. The macro prefixes
every link, joint and material, and mounts the arm on a link of the caller's, or on none where ``parent`` is empty.
A second macro is for calls without an origin block, which xacro cannot leave out. ``<stem>.urdf.xacro`` calls the
first with its arguments, by default with no parent. Expanded, that is the URDF of the same robot, element by element.

Of a cell, ``<stem>_macro.xacro`` holds one macro for every kind of arm, and ``<stem>.urdf.xacro`` the root link and one
call for every arm, with its prefix, its parent and its origin.
"""

from __future__ import annotations

import glob
import math
import re
from itertools import groupby
from keyword import iskeyword
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.errors import EmitterError
from dh2urdf.meshes import has_meshes
from dh2urdf.quantities import format_number
from dh2urdf.robot import Inertial
from dh2urdf.source import Messages, shown
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.formats import numbered_name
from dh2urdf_plugins.formats.urdf.profiles import PROFILES, Profile, adapted, append_transmissions
from dh2urdf_plugins.formats.urdf.writer import (
    Notation,
    append_comment,
    append_inertial,
    append_mujoco_options,
    append_robot,
    serialise,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from dh2urdf.robot import Arm, Parameter, Robot
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
        return super().text(text).replace("$", "${'$'}")

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
    robot = adapted(robot, profile)
    macros = macros_of(robot, stem)
    top = notation.robot(notation.text(robot.name), nsmap={"xacro": NAMESPACE})
    if not robot.arms:
        append_arguments(top, PLACEMENT)
    append_mujoco_options(top, robot, own=profile.mujoco_element)
    library = top if single_file else etree.Element("robot", nsmap={"xacro": NAMESPACE})
    if not single_file:
        # xacro takes a file name for a pattern.
        append_element(top, "include", filename=notation.text(glob.escape(f"{stem}_macro.xacro")))
    for name, kind in macros.items():
        _append_macro(library, kind, name, profile, options.version)
        if f"{name}_at" not in macros:
            append_placed_macro(library, name)
    if robot.arms:
        etree.SubElement(top, "link", {"name": notation.text(robot.root)})
        for arm in robot.arms:
            name = next(name for name, kind in macros.items() if kind is arm.kind)
            append_call_of_arm(top, name, arm, notation)
    else:
        append_call(top, *macros)
    main = EmittedFile(name=f"{stem}.urdf.xacro", content=serialise(top, robot.comment))
    if single_file:
        return (main,)
    return main, EmittedFile(name=f"{stem}_macro.xacro", content=serialise(library, robot.comment))


def macros_of(robot: Robot, stem: str) -> dict[str, Robot]:
    """The macros that a robot needs, by their names: its own, or one for every kind of its arms."""
    if not robot.arms:
        return {macro_name(robot.name, stem): robot}
    macros: dict[str, Robot] = {}
    for arm in robot.arms:
        if not any(kind is arm.kind for kind in macros.values()):
            macros[numbered_name(macro_name(arm.kind.name, arm.kind.name), macros)] = arm.kind
    return macros


def append_element(parent: etree._Element, tag: str, /, **attributes: str) -> etree._Element:
    """Appends an element of xacro's."""
    return etree.SubElement(parent, f"{{{NAMESPACE}}}{tag}", attributes)


def append_arguments(top: etree._Element, defaults: Mapping[str, str]) -> None:
    """Appends the arguments of a file."""
    for name, default in defaults.items():
        append_element(top, "arg", name=name, default=default)


def append_call(top: etree._Element, macro: str, files: Iterable[str] = ()) -> None:
    """Appends the call of a macro with the arguments of the file, also `files`, and the link that the arm is on."""
    mounted = append_element(top, "unless", value="${'$(arg parent)' == ''}")
    etree.SubElement(mounted, "link", {"name": "$(arg parent)"})
    call = append_element(top, macro, **_passed_on("$(arg {})", files))
    etree.SubElement(call, "origin", {"xyz": "$(arg xyz)", "rpy": "$(arg rpy)"})


def append_call_of_arm(top: etree._Element, macro: str, arm: Arm, notation: Notation) -> None:
    """Appends the call of a macro for an arm of a cell."""
    words = {"prefix": as_text(notation.text(arm.prefix)), "parent": as_text(notation.text(arm.parent))}
    origin = {"xyz": notation.lengths(arm.placement.xyz), "rpy": notation.angles(arm.placement.rpy)}
    etree.SubElement(append_element(top, macro, **words), "origin", origin)


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


def _append_macro(parent: etree._Element, robot: Robot, name: str, profile: Profile, version: UrdfVersion) -> None:
    notation = XacroNotation(robot.parameters, version)
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
    append_mounting(macro, robot, notation)
    append_robot(macro, robot, notation, shared_materials=profile.shared_materials)
    if profile.transmissions:
        append_transmissions(macro, robot, notation)
    if robot.links[0].inertial is None and profile.frame_inertials:
        # A link without an inertial weighs 1 kg in PyBullet, unless it is the root, and KDL warns of a root with one.
        mounted = etree.Element(f"{{{NAMESPACE}}}unless", {"value": "${parent == ''}"})
        append_inertial(mounted, robot.root, Inertial(mass=0.0), notation)
        next(macro.iterchildren("link")).insert(0, mounted)


def property_name(parameter: Parameter) -> str:
    """The name of a parameter, where xacro may have a property of it and no formula means something else by it."""
    name = parameter.name
    if not name.isidentifier() or iskeyword(name) or name.startswith("__") or name in _WORDS_IN_USE:
        words = sorted(_WORDS_IN_USE)
        raise EmitterError(say("xacro-property-wrong", joint=parameter.joint, found=name, words=words))
    return name


def append_mounting(macro: etree._Element, robot: Robot, notation: XacroNotation) -> None:
    """Appends the joint between the caller's link and the arm, which is written where there is a parent."""
    condition = append_element(macro, "unless", value="${parent == ''}")
    joint = etree.SubElement(condition, "joint", {"name": notation.name(robot.mounting), "type": "fixed"})
    append_element(joint, "insert_block", name="origin")
    etree.SubElement(joint, "parent", {"link": "${parent}"})
    etree.SubElement(joint, "child", {"link": notation.name(robot.root)})
