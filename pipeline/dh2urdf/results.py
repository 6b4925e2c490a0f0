"""The types of plain data: what `dh2urdf.run` returns, and what commands print with ``--json``.

Each class describes an object of a JSON Schema, which `dh2urdf schema` prints::

    from dh2urdf.results import RunReport

    report: RunReport = dh2urdf.run("ur5.yaml")
    for entry in report["manipulators"]:
        print(entry["name"], entry["status"])

A key that is not always there is `NotRequired`, as in the schema.
`dh2urdf.report.schema` makes the schemas of these types, where a text in an annotation describes the key.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple, NotRequired, TypeAlias, TypedDict

DIALECT = "https://json-schema.org/draft/2020-12/schema"
"""The version of JSON Schema in which these documents are described."""


class Keyword(NamedTuple):
    """In an annotation: a keyword of the JSON Schema of a value."""

    name: str
    value: Any


class Along(NamedTuple):
    """In an annotation: the key is there only together with another one."""

    key: str


_Count: TypeAlias = Annotated[int, Keyword("minimum", 0)]
_Size: TypeAlias = Annotated[float, Keyword("minimum", 0)]
_Sha256: TypeAlias = Annotated[str, Keyword("pattern", "^[0-9a-f]{64}$"), "the hash of its bytes"]
ConventionName: TypeAlias = Literal["standard", "modified"]
JointTypeName: TypeAlias = Literal["revolute", "continuous", "prismatic", "fixed"]
KindName: TypeAlias = Literal["reader", "transform", "edit", "emitter", "loader", "executor"]
_StageKind: TypeAlias = Annotated[KindName, "the kind of stage"]
_Kept: TypeAlias = Annotated[bool, "whether the transform keeps T(q): where it does not, differences fail nothing"]


class ProblemEntry(TypedDict):
    """An error or a notice, and its place."""

    code: Annotated[str | None, "the kind of message, such as unit-twice; its words may change, the code stays"]
    file: Annotated[str | None, "the file that it was read from"]
    line: Annotated[int | None, Keyword("minimum", 1)]
    column: Annotated[int | None, Keyword("minimum", 1)]
    place: Annotated[str | None, "the place as the file's format names it, such as Sheet2!C4"]
    joint: Annotated[str | None, "the joint concerned"]
    field: Annotated[str | None, "the field concerned, such as alpha"]
    found: Annotated[str | None, "the text that was found"]
    accepted: Annotated[str | None, "what is accepted in its place"]
    message: Annotated[str, "what is wrong, and what to do"]


class ProofEntry(TypedDict):
    """How far a file is from the DH product: errors in m and rad; None where they are not finite."""

    position_error: Annotated[_Size | None, "largest distance of a tool0 from the DH product [m]; null: not finite"]
    angle_error: Annotated[_Size | None, "largest angle between them [rad]; null: not finite"]
    q: Annotated[list[float], "the joint vector of the largest position error [rad or m]"]
    tolerance: Annotated[_Size, "what the position error may be [m]"]
    poses: Annotated[_Count, "joint vectors that were compared"]
    tip: NotRequired[Annotated[str, "of a cell: the frame of the largest position error"]]
    tips: NotRequired[
        Annotated[dict[str, float | None], "of a cell: the largest position error of every arm's tool0 [m]"]
    ]


# --- A run ------------------------------------------------------------------------------------------------------------


class FileEntry(TypedDict):
    """A file that was written: its place in the output, the emitter, and its size [B]."""

    path: Annotated[str, "its name in the output, or in its shard"]
    stage: Annotated[str, "the emitter"]
    bytes: Annotated[_Count, "its size [B]"]
    sha256: _Sha256
    shard: NotRequired[Annotated[str, "the tar file that it is in", Along("offset")]]
    offset: NotRequired[Annotated[_Count, "where its bytes begin in the tar file [B]", Along("shard")]]


class MeshEntry(TypedDict):
    """A copy of a mesh that the files name."""

    path: Annotated[str, "its name in the output"]
    sha256: _Sha256


class LoadEntry(TypedDict):
    """What came of a loader: its verdict, and `dh2urdf.stages.LoadReport` as plain data.

    Of a loader that failed nothing is measured, and `errors` says why.
    """

    verdict: Annotated[
        Literal["passed", "failed", "missing"],
        "failed: it refused the file, holds another arm or crashed; missing: not installed",
    ]
    optional: Annotated[bool, "whether a failure of the loader is a notice"]
    errors: Annotated[list[ProblemEntry], "why it failed; nothing is measured then"]
    simulator: Annotated[str, "its name; of a loader that failed the loader's"]
    version: Annotated[str, "its version; empty where the loader failed"]
    joints: Annotated[list[dict[str, Any]], "the moving joints it found: name, type, axis, limits, as it has them"]
    mass: Annotated[float | None, "mass of the arm as it holds it [kg]"]
    mass_error: Annotated[_Size | None, "largest difference of one link's mass [kg]"]
    inertia_error: Annotated[_Size | None, "largest difference of an element of one link's inertia [kg·m²]"]
    position_error: Annotated[_Size | None, "largest distance of a tool0 from the DH product [m]"]
    angle_error: Annotated[_Size | None, "largest angle between them [rad]"]
    tolerance: Annotated[_Size | None, "what the position error may be: the simulator's arithmetic [m]"]
    angle_tolerance: Annotated[_Size | None, "what the angle error may be [rad]"]
    q: Annotated[list[float], "the joint vector of the largest position error [rad or m]"]
    poses: Annotated[_Count, "joint vectors that were measured"]
    hold: Annotated[
        dict[str, Any],
        Keyword("properties", {"stayed": {"type": "boolean", "description": "whether the arm stayed in place"}}),
        "the hold test under gravity: seconds, largest displacement, contacts within the arm; "
        "empty where there was none",
    ]
    findings: Annotated[list[ProblemEntry], "what a person should know"]
    output: Annotated[str, "what the simulator printed"]
    picture: Annotated[str | None, "name of the picture that it took"]


class ManipulatorEntry(TypedDict):
    """What became of one manipulator, cell or variant: a line of ``manifest.jsonl``."""

    name: Annotated[str, "the manipulator's, the cell's or the variant's name"]
    status: Annotated[Literal["ok", "failed", "planned"], "planned where a run only looked"]
    kind: Annotated[str | None, "of what kind the failure is: table, manipulator, transform, proof, loader, …"]
    source: Annotated[str, "the file it comes from; of a cell or variant the run file"]
    key: Annotated[str, "a hash of what its files depend on, by which a resumed run knows them"]
    drawn: Annotated[
        dict[str, float | str],
        "what was drawn [SI]: a_2, by field and number of the joint; in a cell left/a_2, left/x, with the arm",
    ]
    keeps_kinematics: _Kept
    files: Annotated[list[FileEntry], "the files that were written"]
    proof: Annotated[
        dict[str, ProofEntry | None],
        "by emitter, how far its main file is from the DH product; null where nobody looked",
    ]
    loaders: Annotated[dict[str, LoadEntry], "by loader, what the simulator says"]
    notices: Annotated[list[ProblemEntry], "what a careful person would want to know"]
    errors: Annotated[list[ProblemEntry], "why it failed"]
    meshes: NotRequired[Annotated[list[MeshEntry], "the copies of meshes that its files name"]]
    tools: NotRequired[
        Annotated[list[str], "links of attachments that are tools in place of tool0; of several on an arm the last"]
    ]
    pictures: NotRequired[Annotated[dict[str, _Sha256], "the pictures that simulators took, by their names"]]
    not_loaded: NotRequired[
        Annotated[
            dict[str, Literal["not in the sample", "no file"]],
            "the loaders of the run that it did not go through, and why",
        ]
    ]


class CoverageEntry(TypedDict):
    """How many manipulators of a run a loader was given, and what came of it."""

    simulator: Annotated[str | None, "name and version of the simulator; null where it judged none"]
    of: Annotated[_Count, "manipulators of the run"]
    passed: Annotated[_Count, "whose file the simulator loaded as the arm that was written"]
    failed: Annotated[_Count, "whose file it refused, or holds as another arm, or that ended it"]
    missing: Annotated[_Count, "for which it was not installed"]
    not_in_sample: Annotated[_Count, "which the sample of the run left out"]
    no_file: Annotated[_Count, "which failed before there was a file"]
    optional: Annotated[bool, "whether its failures are notices"]


class SimulatorNotice(TypedDict):
    """What one loader reports about several manipulators, as it says it of the first of them."""

    loader: Annotated[str, "the loader"]
    manipulators: Annotated[_Count, "how many manipulators have the finding"]
    first: Annotated[str, "the first of these"]
    place: Annotated[str | None, "the place in a file that it is about, of the first"]
    joint: Annotated[str | None, "the joint that it is about, of the first"]
    message: Annotated[str, "the message about the first; of the others it names other joints and numbers"]


class InputEntry(TypedDict):
    """A file that a run read, and the hash of its bytes; None where it could not be read."""

    path: Annotated[str, "a file that the run read: its run file, or a table"]
    sha256: _Sha256 | None


class VariationEntry(TypedDict):
    """What a run drew: of which manipulator, how many, by which seed and sampling."""

    name: Annotated[str, "what the names of its variants begin with"]
    of: Annotated[str, "the manipulator that is varied"]
    count: Annotated[_Count | None, "how many variants; null for as many as its grids have points"]
    seed: Annotated[int, "which of all samples"]
    sampling: Annotated[str, "how the sample spreads"]


class StageCallEntry(TypedDict):
    """A stage of a run, with all of its options."""

    kind: _StageKind
    stage: Annotated[str, "the stage's name"]
    options: Annotated[dict[str, Any], "all options of the stage, with their defaults"]


class Reproduction(TypedDict):
    """What is needed to do a run again."""

    command: Annotated[str | None, "the command that makes the same files; null where a program began the run"]
    inputs: Annotated[list[InputEntry], "the run file and the tables, the first thousand"]
    inputs_left_out: Annotated[_Count, "how many more there are"]
    versions: Annotated[dict[str, str], "of all that had a part"]
    variations: Annotated[list[VariationEntry], "what was drawn"]
    stages: Annotated[list[StageCallEntry], "transform, edits, emitters and loaders, in their order"]
    joint_vectors: Annotated[str, "at which joint vectors files and simulators were compared with the tables"]
    citation: Annotated[str, "how to cite dh2urdf"]


class OpwEntry(TypedDict):
    """The parameters of an arm with an ortho-parallel basis and a spherical wrist [m, rad]."""

    a1: float
    a2: float
    b: float
    c1: float
    c2: float
    c3: float
    c4: float
    offsets: Annotated[list[float], "of the joints [rad]"]
    signs: Annotated[list[int], "of the joints, 1 or -1"]


_JointName: TypeAlias = Annotated[str, "a joint"]


class AxesEntry(TypedDict):
    """What the axes of an arm declare about its kinematics, by the names of the joints."""

    parallel: Annotated[list[Annotated[list[_JointName], "joints in a row whose axes are parallel"]], "all of them"]
    spherical_wrist: Annotated[list[_JointName], "the last three joints, where their axes meet in one point"]
    opw: OpwEntry | None


class ArmAxes(AxesEntry):
    """What the axes of a table declare about its kinematics."""

    name: Annotated[str, "the manipulator or cell"]
    arms: Annotated[list[Annotated[str, "an arm"]], "the arms of a cell that have this table"]


class RunReport(TypedDict):
    """The content of ``report.json``, which `dh2urdf.run` returns."""

    schema: Annotated[Literal["dh2urdf-report/1"], "name and version of this form"]
    version: Annotated[str, "version of dh2urdf that wrote it"]
    exit_status: Annotated[Literal[0, 1], "0 where all is done, 1 where a manipulator failed"]
    reproduction: Reproduction
    coverage: Annotated[
        dict[str, CoverageEntry], "by loader, how many manipulators of the run it was given, and what came of it"
    ]
    simulator_notices: Annotated[list[SimulatorNotice], "what loaders noticed, alike notices counted together"]
    manipulators: Annotated[list[ManipulatorEntry], "the first rows of the manifest, 1000 at most"]
    left_out: Annotated[_Count, "how many more rows the manifest has"]
    axes: Annotated[list[ArmAxes], "what the axes of the tables of these manipulators declare about their kinematics"]


# --- What commands print with --json ----------------------------------------------------------------------------------

_Version: TypeAlias = Annotated[str, "version of dh2urdf"]
_Notices: TypeAlias = Annotated[list[ProblemEntry], "what a careful person would want to know"]
_PlaceText: TypeAlias = Annotated[str | None, "the cell, such as arm.csv:4:12; null where the table does not say it"]
_ArmName: TypeAlias = Annotated[str, "the manipulator's name"]
_BeginsAt: TypeAlias = Annotated[str | None, "where it begins"]


class ErrorReport(TypedDict):
    """What a command with ``--json`` prints where it fails."""

    schema: Annotated[Literal["dh2urdf-error/1"], "name and version of this form"]
    version: _Version
    exit_status: Annotated[_Count, "the status with which the command ends"]
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
    bytes: Annotated[_Count, "its size [B]"]
    sha256: _Sha256
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
    name: _ArmName | None
    convention: ConventionName | None
    joints: Annotated[list[JointEntry], "the joints, from the base outwards"]
    files: Annotated[list[ConvertedFileEntry], "the files that were written; the first one is the description"]
    keeps_kinematics: _Kept
    proof: Annotated[
        dict[str, ProofEntry | None],
        "by emitter, how far the file is from the DH product; null where it cannot be read back",
    ]
    filled_in: Annotated[FilledInEntry, "the joints or links for which the table says nothing, by what was filled in"]
    notices: _Notices
    errors: Annotated[list[ProblemEntry], "why it failed"]


class ConversionsReport(TypedDict):
    """What ``dh2urdf convert --json`` prints."""

    schema: Annotated[Literal["dh2urdf-conversions/1"], "name and version of this form"]
    version: _Version
    exit_status: Annotated[Literal[0, 1], "0 where all is done, 1 where a table failed"]
    conversions: Annotated[list[ConversionEntry], "what became of each table, in the order of the command line"]


class BriefEntry(TypedDict):
    """A manipulator of a table, in short."""

    name: _ArmName
    place: _BeginsAt
    convention: ConventionName | None
    joints: Annotated[_Count | None, "its rows"]
    moving: Annotated[_Count | None, "its joints that move"]
    notices: _Notices
    errors: Annotated[list[ProblemEntry], "why it cannot be read"]


class StatedConvention(TypedDict):
    """The convention, and the place that states it."""

    value: ConventionName
    place: _PlaceText


class StatedValue(TypedDict):
    """A value of the whole arm in SI units, and the place that states it."""

    value: Any
    place: _PlaceText


class UnitEntry(TypedDict):
    """A unit that the table states for all rows."""

    of: Annotated[str, "what it measures"]
    unit: Annotated[str, "the unit"]
    place: _PlaceText


Placement = TypedDict(
    "Placement",
    {
        "xyz": Annotated[list[float], "translation [m]"],
        "rpy": Annotated[list[float], "roll, pitch and yaw [rad]"],
        "from": Literal["cell", "default", "read"],
        "place": _PlaceText,
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
        "place": _PlaceText,
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

    name: _ArmName
    place: _BeginsAt
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
    notices: _Notices
    errors: Annotated[list[ProblemEntry], "why no robot can be made of it"]


class InfoReport(TypedDict):
    """What ``dh2urdf info --json`` prints."""

    schema: Annotated[Literal["dh2urdf-info/1"], "name and version of this form"]
    version: _Version
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


_DistributionName: TypeAlias = Annotated[str, "name and version of the distribution that provides it"]
_PluginName: TypeAlias = Annotated[str, "the plugin's entry point, such as my_lab = my_lab.plugin"]


class StageEntry(TypedDict):
    """An installed stage, and the plugin that provides it."""

    kind: _StageKind
    name: Annotated[str, "the stage's name in a run file"]
    summary: Annotated[str, "what it does, in one line"]
    plugin: _PluginName
    distribution: _DistributionName
    options: Annotated[list[OptionEntry], "its options"]


class ClashEntry(TypedDict):
    """A name that several plugins claim."""

    kind: _StageKind
    name: Annotated[str, "a name that several plugins claim"]
    distributions: Annotated[list[str], "who claims it: name and version of each distribution"]
    choices: Annotated[list[str], "the unambiguous name of each: distribution:name"]


class PluginEntry(TypedDict):
    """A plugin, and the distribution that provides it."""

    plugin: _PluginName
    distribution: _DistributionName


class ShadowedEntry(PluginEntry):
    """A stage whose name alone means another plugin's stage."""

    kind: _StageKind
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
