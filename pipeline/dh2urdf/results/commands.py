"""What commands print with `--json`, as plain data."""

from __future__ import annotations

from typing import Any, Literal, NotRequired, TypedDict

from dh2urdf.results.run import AxesEntry, ConventionName, JointTypeName, KindName, ProblemEntry, ProofEntry


class ErrorReport(TypedDict):
    """What a command with ``--json`` prints where it fails."""

    schema: Literal["dh2urdf-error/1"]
    version: str
    exit_status: int
    kind: str
    errors: list[ProblemEntry]
    notices: list[ProblemEntry]


class JointEntry(TypedDict):
    """A joint of a table."""

    name: str
    type: JointTypeName


class ConvertedFileEntry(TypedDict):
    """A file of a conversion; its text where it was not written."""

    path: str
    stage: str
    bytes: int
    sha256: str
    content: NotRequired[str]


class FilledInEntry(TypedDict):
    """The joints and links for which the table says nothing, by what was filled in."""

    types: NotRequired[list[str]]
    masses: NotRequired[list[str]]
    centres_of_mass: NotRequired[list[str]]
    inertias: NotRequired[list[str]]
    limits: NotRequired[list[str]]
    velocities: NotRequired[list[str]]
    efforts: NotRequired[list[str]]


class ConversionEntry(TypedDict):
    """What became of one table."""

    source: str
    status: Literal["ok", "failed"]
    kind: str | None
    name: str | None
    convention: ConventionName | None
    joints: list[JointEntry]
    files: list[ConvertedFileEntry]
    keeps_kinematics: bool
    proof: dict[str, ProofEntry | None]
    filled_in: FilledInEntry
    notices: list[ProblemEntry]
    errors: list[ProblemEntry]


class ConversionsReport(TypedDict):
    """What ``dh2urdf convert --json`` prints."""

    schema: Literal["dh2urdf-conversions/1"]
    version: str
    exit_status: Literal[0, 1]
    conversions: list[ConversionEntry]


class BriefEntry(TypedDict):
    """A manipulator of a table, in short."""

    name: str
    place: str | None
    convention: ConventionName | None
    joints: int | None
    moving: int | None
    notices: list[ProblemEntry]
    errors: list[ProblemEntry]


class StatedConvention(TypedDict):
    """The convention, and the place that states it."""

    value: ConventionName
    place: str | None


class StatedValue(TypedDict):
    """A value of the whole arm in SI units, and the place that states it."""

    value: Any
    place: str | None


class UnitEntry(TypedDict):
    """A unit that the table states for all rows."""

    of: str
    unit: str
    place: str | None


Placement = TypedDict(
    "Placement",
    {"xyz": list[float], "rpy": list[float], "from": Literal["cell", "default"], "place": str | None},
)
"""The base or the tool: translation [m], roll, pitch and yaw [rad]."""


FieldEntry = TypedDict(
    "FieldEntry",
    {
        "field": str,
        "value": float | str,
        "unit": str,
        "from": Literal["cell", "default", "computed"],
        "typed": str | None,
        "read_in": str | None,
        "place": str | None,
    },
)
"""A field of a row: its value in SI units, where the value is from, and what the cell holds."""


class JointDetail(TypedDict):
    """A row of a table with every field that has a value."""

    name: str
    link: str
    type: JointTypeName
    place: str | None
    fields: list[FieldEntry]


class DistanceEntry(TypedDict):
    """A bound of the distance of tool0 from the origin of the first DH frame [m]."""

    bound: float | None
    unit: Literal["m"]
    of: str
    without_limits: list[str]


class MassEntry(TypedDict):
    """The mass of the robot [kg], and the links whose mass is computed."""

    total: float | None
    unit: Literal["kg"]
    computed: list[str]


class Detail(TypedDict):
    """All that was understood of one manipulator."""

    name: str
    place: str | None
    convention: StatedConvention
    base: Placement
    tool: Placement
    units: list[UnitEntry]
    stated: dict[str, StatedValue]
    joints: list[JointDetail]
    pose_at_zero: list[list[float]]
    largest_distance: DistanceEntry
    axes: AxesEntry
    mass: MassEntry
    notices: list[ProblemEntry]
    errors: list[ProblemEntry]


class InfoReport(TypedDict):
    """What ``dh2urdf info --json`` prints."""

    schema: Literal["dh2urdf-info/1"]
    version: str
    exit_status: Literal[0, 1]
    source: str
    manipulators: list[BriefEntry]
    detail: Detail | None


class OptionEntry(TypedDict):
    """An option of a stage, in words."""

    name: str
    type: str
    default: str
    help: str


class StageEntry(TypedDict):
    """An installed stage, and the plugin that provides it."""

    kind: KindName
    name: str
    summary: str
    plugin: str
    distribution: str
    options: list[OptionEntry]


class ClashEntry(TypedDict):
    """A name that several plugins claim."""

    kind: KindName
    name: str
    distributions: list[str]
    choices: list[str]


class PluginEntry(TypedDict):
    """A plugin, and the distribution that provides it."""

    plugin: str
    distribution: str


class ShadowedEntry(PluginEntry):
    """A stage whose name alone means another plugin's stage."""

    kind: KindName
    name: str
    winner: str
    choice: str


class RefusedPluginEntry(PluginEntry):
    """A plugin that cannot be used."""

    reason: str


class BrokenPluginEntry(RefusedPluginEntry):
    """A plugin that failed."""

    traceback: str


class PluginsReport(TypedDict):
    """What ``dh2urdf plugins --json`` prints."""

    schema: Literal["dh2urdf-plugins/1"]
    version: str
    interface: str
    stages: list[StageEntry]
    clashes: list[ClashEntry]
    shadowed: list[ShadowedEntry]
    broken: list[BrokenPluginEntry]
    incompatible: list[RefusedPluginEntry]
    left_out: list[PluginEntry]
