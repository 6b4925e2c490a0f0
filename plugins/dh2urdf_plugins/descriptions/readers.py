"""The readers of robot descriptions: each chain becomes the table that an engineer would have written."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.errors import InputError, TableError
from dh2urdf.source import Mark, Messages
from dh2urdf.stages import Reader, ReadsDescriptions, Rejected
from dh2urdf_plugins.extraction import TOLERANCE
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.descriptions.description import Description

say = Messages(__file__)

# What reads and what computes is imported where a description is read: a run of tables pays for none of it.

_FINEST, _COARSEST = 1e-14, 1e-2


@dataclass(frozen=True, slots=True, kw_only=True)
class DescriptionOptions:
    """What is left open by a robot description: which chain, and how its table is written."""

    convention: Literal["standard", "modified"] = option(
        "standard (classic, distal) or modified (Craig, proximal)", "standard", flag="C"
    )
    base_link: str | None = option("where the chain begins; the root by default", None, flag="LINK")
    tip_link: str | None = option(
        "where it ends; * for every leaf; tool0, tcp, flange, ee_link, *_tool0, *_tcp, or the only leaf by default",
        None,
        flag="LINK",
    )
    tolerance: float = option(
        "how far the tip of the table may be from the file's [m, rad]", TOLERANCE, flag="T", commands=("extract",)
    )
    near_parallel: Literal["auto", "dh", "split"] = option(
        "of nearly parallel axes: dh (a large d), split (a fixed row), auto (dh up to 1000 arms)",
        "auto",
        flag="N",
        commands=("extract",),
    )
    rounded_pi: Literal["keep", "repair"] = option(
        "repair reads 1.5708 in an orientation as pi/2", "keep", flag="R", commands=("extract",)
    )
    origins: Literal["fewest", "file"] = option(
        "d of parallel axes: fewest that are not 0, or as the file's origins", "fewest", flag="O", commands=("extract",)
    )
    package_paths: tuple[str, ...] = option("ROS packages, or folders of some, with meshes and included files", ())

    def __post_init__(self) -> None:
        if not _FINEST <= self.tolerance <= _COARSEST:
            found = f"{self.tolerance:.9g}"
            raise TableError(say("tolerance-wrong", field="tolerance", found=found, least=_FINEST, most=_COARSEST))


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroOptions(DescriptionOptions):
    """The same of a description with macros, and the values of its arguments."""

    arguments: dict[str, str] | None = option("values of the file's arguments", None)


def _described(form: str, path: Path, options: DescriptionOptions) -> Description:
    """The description of a file, by the reader of its form; no other reader is imported."""
    if form == "screws":
        from dh2urdf_plugins.descriptions.screws import screws_description

        return screws_description(path)
    if form.endswith("-kinematics"):
        from dh2urdf_plugins.descriptions.origin_files import origins_description

        return origins_description(path, form)
    from dh2urdf.stages import Expansion
    from dh2urdf_plugins.descriptions.description import describe

    arguments = options.arguments if isinstance(options, XacroOptions) else None
    packages = tuple(map(Path, options.package_paths))
    return describe(form, path, Expansion(arguments=arguments or {}, package_paths=packages))


def _leaves(form: str, path: Path, options: DescriptionOptions) -> Mapping[str, int]:
    """The ends of a description's chains, with the counts of their joints."""
    from dh2urdf_plugins.descriptions.trees import Tree

    return Tree(_described(form, path, options), options.base_link).leaves()


def _arms(form: str, path: Path, options: DescriptionOptions) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a file, one for each tip link that is asked for, or why there is none."""
    from dh2urdf.manipulator import Convention
    from dh2urdf.meshes import mesh_finder, packages_in, with_its_own
    from dh2urdf_plugins.descriptions.arms import manipulator_of
    from dh2urdf_plugins.descriptions.trees import Tree
    from dh2urdf_plugins.extraction.solving import Choices

    try:
        description = _described(form, path, options)
        packages = with_its_own(path, packages_in(map(Path, options.package_paths)))
    except TableError:
        raise
    except InputError as error:  # of the packages
        raise TableError(problem.about(mark=Mark(file=str(path))) for problem in error.problems) from error
    repair = options.rounded_pi == "repair"
    if repair and description.repaired is not None:
        description.robot, description.repaired = description.repaired, description.robot
    tree = Tree(description, options.base_link)
    tips = tree.tips(options.tip_link)
    name = description.robot.name.strip() or path.stem
    choices = Choices(
        convention=Convention(options.convention),
        tolerance=options.tolerance,
        near_parallel=options.near_parallel,
        origins=options.origins,
    )
    find = mesh_finder(description.folder, packages)
    for tip in tips:
        own = name if len(tips) == 1 else f"{name}_{tip}"
        try:
            yield manipulator_of(tree, tip, own, choices, find, repair=repair)
        except TableError as error:
            yield Rejected(name=own, problems=error.problems, mark=Mark(file=str(path)))


def _reader(
    name: str, summary: str, *suffixes: str, options: type[DescriptionOptions] = DescriptionOptions
) -> Reader[Any]:
    return Reader(
        name=name,
        summary=summary,
        read=partial(_arms, name),
        options=options,
        suffixes=suffixes,
        capabilities=(ReadsDescriptions(partial(_leaves, name)),),
    )


URDF = _reader("urdf", "URDF: the DH table of a chain, with its limits, masses and meshes", ".urdf")
XACRO = _reader(
    "xacro",
    "xacro: the DH table of a chain, of a file that is expanded where it can do no harm",
    *(".urdf.xacro", ".xacro"),
    options=XacroOptions,
)
SDF = _reader("sdf", "SDF: the DH table of a chain of the first model", ".sdf")
MJCF = _reader("mjcf", "MJCF: the DH table of a chain of a MuJoCo model", ".xml", ".mjcf")
UR_KINEMATICS = _reader(
    "ur-kinematics", "*_calibration.yaml of Universal Robots' ROS packages: the DH table of one calibrated arm"
)
FRANKA_KINEMATICS = _reader(
    "franka-kinematics", "kinematics.yaml of Franka's ROS package: the DH table of one of its arms"
)
SCREWS = _reader("screws", "screw axes in YAML or JSON: Slist and M, Blist and M, or H and P")
