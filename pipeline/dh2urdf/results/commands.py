"""What commands print with `--json`, as plain data."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NotRequired, TypeAlias, TypedDict

from dh2urdf.results.run import (
    AxesEntry,
    ConventionName,
    Count,
    JointTypeName,
    KeepsKinematics,
    ProblemEntry,
    ProofEntry,
    Sha256,
    StageKind,
)

Version: TypeAlias = Annotated[str, "version of dh2urdf"]
Notices: TypeAlias = Annotated[list[ProblemEntry], "what a careful person would want to know"]
PlaceText: TypeAlias = Annotated[str | None, "the cell, such as arm.csv:4:12; null where the table does not say it"]
ArmName: TypeAlias = Annotated[str, "the manipulator's name"]
BeginsAt: TypeAlias = Annotated[str | None, "where it begins"]


class ErrorReport(TypedDict):
    """What a command with ``--json`` prints where it fails."""

    schema: Annotated[Literal["dh2urdf-error/1"], "name and version of this form"]
    version: Version
    exit_status: Annotated[Count, "the status with which the command ends"]
    kind: Annotated[str, "of what kind the failure is: table, config, usage, output, interrupted, …"]
    errors: Annotated[list[ProblemEntry], "what is wrong"]
    notices: Annotated[list[ProblemEntry], "what a careful person would look at besides"]


class JointEntry(TypedDict):
    """A joint of a table."""

    name: Annotated[str, "the joint's name"]
    type: JointTypeName


class ConvertedFileEntry(TypedDict):
    """A file of a conversion; its text where it was not written."""

    path: Annotated[str, "the file"]
    stage: Annotated[str, "the emitter"]
    bytes: Annotated[Count, "its size [B]"]
    sha256: Sha256
    content: NotRequired[Annotated[str, "the text of the file, where it was not written"]]


class FilledInEntry(TypedDict):
    """The joints and links for which the table says nothing, by what was filled in."""

    types: NotRequired[Annotated[list[str], "whose types"]]
    masses: NotRequired[Annotated[list[str], "whose masses"]]
    centres_of_mass: NotRequired[Annotated[list[str], "whose centres of mass"]]
    inertias: NotRequired[Annotated[list[str], "whose inertias"]]
    limits: NotRequired[Annotated[list[str], "whose limits"]]
    velocities: NotRequired[Annotated[list[str], "whose velocities"]]
    efforts: NotRequired[Annotated[list[str], "whose efforts"]]


class ConversionEntry(TypedDict):
    """What became of one table."""

    source: Annotated[str, "the table"]
    status: Literal["ok", "failed"]
    kind: Annotated[str | None, "of what kind the failure is, such as table or proof"]
    name: ArmName | None
    convention: ConventionName | None
    joints: Annotated[list[JointEntry], "the joints, from the base outwards"]
    files: Annotated[list[ConvertedFileEntry], "the files that were written; the first one is the description"]
    keeps_kinematics: KeepsKinematics
    proof: Annotated[
        dict[str, ProofEntry | None],
        "by emitter, how far the file is from the DH product; null where it cannot be read back",
    ]
    filled_in: Annotated[FilledInEntry, "the joints or links for which the table says nothing, by what was filled in"]
    notices: Notices
    errors: Annotated[list[ProblemEntry], "why it failed"]


class ConversionsReport(TypedDict):
    """What ``dh2urdf convert --json`` prints."""

    schema: Annotated[Literal["dh2urdf-conversions/1"], "name and version of this form"]
    version: Version
    exit_status: Annotated[Literal[0, 1], "0 where all is done, 1 where a table failed"]
    conversions: Annotated[list[ConversionEntry], "what became of each table, in the order of the command line"]


class BriefEntry(TypedDict):
    """A manipulator of a table, in short."""

    name: ArmName
    place: BeginsAt
    convention: ConventionName | None
    joints: Annotated[Count | None, "its rows"]
    moving: Annotated[Count | None, "its joints that move"]
    notices: Notices
    errors: Annotated[list[ProblemEntry], "why it cannot be read"]


class StatedConvention(TypedDict):
    """The convention, and the place that states it."""

    value: ConventionName
    place: PlaceText


class StatedValue(TypedDict):
    """A value of the whole arm in SI units, and the place that states it."""

    value: Any
    place: PlaceText


class UnitEntry(TypedDict):
    """A unit that the table states for all rows."""

    of: Annotated[str, "what it measures"]
    unit: Annotated[str, "the unit"]
    place: PlaceText


Placement = TypedDict(
    "Placement",
    {
        "xyz": Annotated[list[float], "translation [m]"],
        "rpy": Annotated[list[float], "roll, pitch and yaw [rad]"],
        "from": Literal["cell", "default", "read"],
        "place": PlaceText,
    },
)
"""The base or the tool: translation [m], roll, pitch and yaw [rad]."""


FieldEntry = TypedDict(
    "FieldEntry",
    {
        "field": Annotated[str, "what the project calls the field: a, alpha, lower, com_x, ixx, …"],
        "value": Annotated[float | str, "the value in SI units, or a word"],
        "unit": Annotated[str, "the unit of the value; empty for words and plain numbers"],
        "from": Annotated[
            Literal["cell", "default", "computed", "read"],
            "whether the table says it, it is a default, the transform computes it, or it is from a reader that does "
            "not tell cells from defaults",
        ],
        "typed": Annotated[str | None, "the cell as it is typed"],
        "read_in": Annotated[str | None, "the unit in which a number without a unit is read"],
        "place": PlaceText,
    },
)
"""A field of a row: its value in SI units, where the value is from, and what the cell holds."""


class JointDetail(TypedDict):
    """A row of a table with every field that has a value."""

    name: Annotated[str, "the joint's name"]
    link: Annotated[str, "the link that it moves"]
    type: JointTypeName
    place: Annotated[str | None, "the row"]
    fields: Annotated[list[FieldEntry], "every field that has a value"]


class DistanceEntry(TypedDict):
    """A bound of the distance of tool0 from the origin of the first DH frame [m]."""

    bound: Annotated[float | None, "no joint values within the limits lead further"]
    unit: Literal["m"]
    of: Annotated[str, "of what from what"]
    without_limits: Annotated[list[str], "prismatic joints without limits: there is no bound"]


class MassEntry(TypedDict):
    """The mass of the robot [kg], and the links whose mass is computed."""

    total: Annotated[float | None, "mass of the robot"]
    unit: Literal["kg"]
    computed: Annotated[list[str], "links whose mass is computed from their shapes"]


class Detail(TypedDict):
    """All that was understood of one manipulator."""

    name: ArmName
    place: BeginsAt
    convention: StatedConvention
    base: Placement
    tool: Placement
    units: Annotated[list[UnitEntry], "the units that the table states for all rows"]
    stated: Annotated[dict[str, StatedValue], "what else the table declares about the whole arm, by key [SI]"]
    joints: Annotated[list[JointDetail], "the joints, from the base outwards"]
    pose_at_zero: Annotated[list[Annotated[list[float], "a row"]], "T(base_link to tool0) where every joint value is 0"]
    largest_distance: DistanceEntry
    axes: AxesEntry
    mass: MassEntry
    notices: Notices
    errors: Annotated[list[ProblemEntry], "why no robot can be made of it"]


class InfoReport(TypedDict):
    """What ``dh2urdf info --json`` prints."""

    schema: Annotated[Literal["dh2urdf-info/1"], "name and version of this form"]
    version: Version
    exit_status: Annotated[Literal[0, 1], "0 where all is well, 1 where an arm is refused"]
    source: Annotated[str, "the table"]
    manipulators: Annotated[list[BriefEntry], "the manipulators of the table, in short; only the one that is shown"]
    detail: Detail | None


class OptionEntry(TypedDict):
    """An option of a stage, in words."""

    name: Annotated[str, "the option's name in a run file"]
    type: Annotated[str, "what it takes, in words"]
    default: Annotated[str, "the default, in words"]
    help: Annotated[str, "what it is for"]


DistributionName: TypeAlias = Annotated[str, "name and version of the distribution that provides it"]
PluginName: TypeAlias = Annotated[str, "the plugin's entry point, such as my_lab = my_lab.plugin"]


class StageEntry(TypedDict):
    """An installed stage, and the plugin that provides it."""

    kind: StageKind
    name: Annotated[str, "the stage's name in a run file"]
    summary: Annotated[str, "what it does, in one line"]
    plugin: PluginName
    distribution: DistributionName
    options: Annotated[list[OptionEntry], "its options"]


class ClashEntry(TypedDict):
    """A name that several plugins claim."""

    kind: StageKind
    name: Annotated[str, "a name that several plugins claim"]
    distributions: Annotated[list[str], "who claims it: name and version of each distribution"]
    choices: Annotated[list[str], "the unambiguous name of each: distribution:name"]


class PluginEntry(TypedDict):
    """A plugin, and the distribution that provides it."""

    plugin: PluginName
    distribution: DistributionName


class ShadowedEntry(PluginEntry):
    """A stage whose name alone means another plugin's stage."""

    kind: StageKind
    name: Annotated[str, "a name that means another plugin's stage"]
    winner: Annotated[str, "name and version of the distribution whose stage the name means"]
    choice: Annotated[str, "the unambiguous name of this stage: distribution:name"]


class RefusedPluginEntry(PluginEntry):
    """A plugin that cannot be used."""

    reason: Annotated[str, "why it cannot be used"]


class BrokenPluginEntry(RefusedPluginEntry):
    """A plugin that failed."""

    traceback: Annotated[str, "where it failed"]


class PluginsReport(TypedDict):
    """What ``dh2urdf plugins --json`` prints."""

    schema: Annotated[Literal["dh2urdf-plugins/1"], "name and version of this form"]
    version: Annotated[str, "version of dh2urdf that wrote it"]
    interface: Annotated[str, "version of the plugin interface, major.minor"]
    stages: Annotated[list[StageEntry], "every stage that is installed, by kind and name"]
    clashes: Annotated[list[ClashEntry], "names that are no use without the distribution before them"]
    shadowed: Annotated[list[ShadowedEntry], "stages whose names alone mean the stages of other plugins"]
    broken: Annotated[list[BrokenPluginEntry], "plugins, or parts of plugins, that failed"]
    incompatible: Annotated[list[RefusedPluginEntry], "plugins for another version of the interface"]
    left_out: Annotated[list[PluginEntry], "plugins that the command line leaves out"]
