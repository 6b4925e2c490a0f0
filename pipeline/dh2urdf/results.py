"""The types of plain data: what `dh2urdf.run` returns, and what commands print with ``--json``.

Each class describes an object of a JSON Schema, which `dh2urdf schema` prints::

    from dh2urdf.results import RunReport

    report: RunReport = dh2urdf.run("ur5.yaml")
    for entry in report["manipulators"]:
        print(entry["name"], entry["status"])

A key that is not always there is `NotRequired`, as in the schema.
"""

from __future__ import annotations

from typing import Any, Literal, NotRequired, TypeAlias, TypedDict

ConventionName: TypeAlias = Literal["standard", "modified"]
JointTypeName: TypeAlias = Literal["revolute", "continuous", "prismatic", "fixed"]
KindName: TypeAlias = Literal["reader", "transform", "emitter", "loader", "executor"]


class ProblemEntry(TypedDict):
    """An error or a notice, and its place."""

    file: str | None
    line: int | None
    column: int | None
    place: str | None
    joint: str | None
    field: str | None
    found: str | None
    accepted: str | None
    message: str


class ProofEntry(TypedDict):
    """How far a file is from the DH product: errors in m and rad; None where they are not finite."""

    position_error: float | None
    angle_error: float | None
    q: list[float]
    tolerance: float
    poses: int
    tip: NotRequired[str]
    tips: NotRequired[dict[str, float | None]]


class ErrorReport(TypedDict):
    """What a command with ``--json`` prints where it fails."""

    schema: Literal["dh2urdf-error/1"]
    version: str
    exit_status: int
    kind: str
    errors: list[ProblemEntry]
    notices: list[ProblemEntry]


# --- A run ------------------------------------------------------------------------------------------------------------


class FileEntry(TypedDict):
    """A file that was written: its place in the output, the emitter, and its size [B]."""

    path: str
    stage: str
    bytes: int
    sha256: str
    shard: NotRequired[str]
    offset: NotRequired[int]


class MeshEntry(TypedDict):
    """A copy of a mesh that the files name."""

    path: str
    sha256: str


class LoadEntry(TypedDict):
    """What came of a loader: its verdict, and `dh2urdf.stages.LoadReport` as plain data.

    Of a loader that failed nothing is measured, and `errors` says why.
    """

    verdict: Literal["passed", "failed", "missing"]
    optional: bool
    errors: list[ProblemEntry]
    simulator: str
    version: str
    joints: list[dict[str, Any]]
    mass: float | None
    mass_error: float | None
    inertia_error: float | None
    position_error: float | None
    angle_error: float | None
    tolerance: float | None
    angle_tolerance: float | None
    q: list[float]
    poses: int
    hold: dict[str, Any]
    findings: list[ProblemEntry]
    output: str
    picture: str | None


class ManipulatorEntry(TypedDict):
    """What became of one manipulator, cell or variant: a line of ``manifest.jsonl``."""

    name: str
    status: Literal["ok", "failed", "skipped"]
    kind: str | None
    source: str
    key: str
    drawn: dict[str, float | str]
    keeps_kinematics: bool
    files: list[FileEntry]
    proof: dict[str, ProofEntry | None]
    loaders: dict[str, LoadEntry]
    notices: list[ProblemEntry]
    errors: list[ProblemEntry]
    meshes: NotRequired[list[MeshEntry]]
    not_loaded: NotRequired[dict[str, Literal["not in the sample", "no file"]]]


class CoverageEntry(TypedDict):
    """How many manipulators of a run a loader was given, and what came of it."""

    simulator: str | None
    of: int
    passed: int
    failed: int
    missing: int
    not_in_sample: int
    no_file: int
    optional: bool


class SimulatorNotice(TypedDict):
    """What one loader has to say of several manipulators, as it says it of the first of them."""

    loader: str
    manipulators: int
    first: str
    place: str | None
    joint: str | None
    message: str


class InputEntry(TypedDict):
    """A file that a run read, and the hash of its bytes; None where it could not be read."""

    path: str
    sha256: str | None


class VariationEntry(TypedDict):
    """What a run drew: of which manipulator, how many, by which seed and sampling."""

    name: str
    of: str
    count: int | None
    seed: int
    sampling: str


class Reproduction(TypedDict):
    """What is needed to do a run again."""

    command: str | None
    inputs: list[InputEntry]
    inputs_left_out: int
    versions: dict[str, str]
    variations: list[VariationEntry]
    joint_vectors: str
    citation: str


class RunReport(TypedDict):
    """The content of ``report.json``, which `dh2urdf.run` returns."""

    schema: Literal["dh2urdf-report/1"]
    version: str
    exit_status: Literal[0, 1]
    reproduction: Reproduction
    coverage: dict[str, CoverageEntry]
    simulator_notices: list[SimulatorNotice]
    manipulators: list[ManipulatorEntry]
    left_out: int


# --- Conversions ------------------------------------------------------------------------------------------------------


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


# --- What was understood of a table -----------------------------------------------------------------------------------


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


# --- Plugins ----------------------------------------------------------------------------------------------------------


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
