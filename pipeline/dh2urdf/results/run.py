"""What `dh2urdf.run` returns and reports contain, as plain data.

`dh2urdf.report.schema` makes the JSON Schemas of these types, where a text in an annotation describes the key.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, NotRequired, TypeAlias, TypedDict

from dh2urdf.late_tuples import NamedTuple


class Keyword(NamedTuple):
    """In an annotation: a keyword of the JSON Schema of a value."""

    name: str
    value: Any


class Along(NamedTuple):
    """In an annotation: the key is there only together with another one."""

    key: str


Count: TypeAlias = Annotated[int, Keyword("minimum", 0)]
Size: TypeAlias = Annotated[float, Keyword("minimum", 0)]
Sha256: TypeAlias = Annotated[str, Keyword("pattern", "^[0-9a-f]{64}$"), "the hash of its bytes"]
ConventionName: TypeAlias = Literal["standard", "modified"]
JointTypeName: TypeAlias = Literal["revolute", "continuous", "prismatic", "fixed"]
KindName: TypeAlias = Literal["reader", "transform", "edit", "emitter", "loader", "executor"]
StageKind: TypeAlias = Annotated[KindName, "the kind of stage"]
KeepsKinematics: TypeAlias = Annotated[
    bool, "whether the transform keeps T(q): where it does not, differences fail nothing"
]


class ProblemEntry(TypedDict):
    """An error or a notice, and its place."""

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

    position_error: Annotated[Size | None, "largest distance of a tool0 from the DH product [m]; null: not finite"]
    angle_error: Annotated[Size | None, "largest angle between them [rad]; null: not finite"]
    q: Annotated[list[float], "the joint vector of the largest position error [rad or m]"]
    tolerance: Annotated[Size, "what the position error may be [m]"]
    poses: Annotated[Count, "joint vectors that were compared"]
    tip: NotRequired[Annotated[str, "of a cell: the frame of the largest position error"]]
    tips: NotRequired[
        Annotated[dict[str, float | None], "of a cell: the largest position error of every arm's tool0 [m]"]
    ]


# --- A run ------------------------------------------------------------------------------------------------------------


class FileEntry(TypedDict):
    """A file that was written: its place in the output, the emitter, and its size [B]."""

    path: Annotated[str, "its name in the output, or in its shard"]
    stage: Annotated[str, "the emitter"]
    bytes: Annotated[Count, "its size [B]"]
    sha256: Sha256
    shard: NotRequired[Annotated[str, "the tar file that it is in", Along("offset")]]
    offset: NotRequired[Annotated[Count, "where its bytes begin in the tar file [B]", Along("shard")]]


class MeshEntry(TypedDict):
    """A copy of a mesh that the files name."""

    path: Annotated[str, "its name in the output"]
    sha256: Sha256


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
    mass_error: Annotated[Size | None, "largest difference of one link's mass [kg]"]
    inertia_error: Annotated[Size | None, "largest difference of an element of one link's inertia [kg·m²]"]
    position_error: Annotated[Size | None, "largest distance of a tool0 from the DH product [m]"]
    angle_error: Annotated[Size | None, "largest angle between them [rad]"]
    tolerance: Annotated[Size | None, "what the position error may be: the simulator's arithmetic [m]"]
    angle_tolerance: Annotated[Size | None, "what the angle error may be [rad]"]
    q: Annotated[list[float], "the joint vector of the largest position error [rad or m]"]
    poses: Annotated[Count, "joint vectors that were measured"]
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
    status: Annotated[Literal["ok", "failed", "skipped"], "skipped where a run only looked"]
    kind: Annotated[str | None, "of what kind the failure is: table, manipulator, transform, proof, loader, …"]
    source: Annotated[str, "the file it comes from; of a cell or variant the run file"]
    key: Annotated[str, "a hash of what its files depend on, by which a resumed run knows them"]
    drawn: Annotated[dict[str, float | str], "what was drawn for a variant [SI], by field and number of the joint: a_2"]
    keeps_kinematics: KeepsKinematics
    files: Annotated[list[FileEntry], "the files that were written"]
    proof: Annotated[
        dict[str, ProofEntry | None],
        "by emitter, how far its main file is from the DH product; null where nobody looked",
    ]
    loaders: Annotated[dict[str, LoadEntry], "by loader, what the simulator says"]
    notices: Annotated[list[ProblemEntry], "what a careful person would want to know"]
    errors: Annotated[list[ProblemEntry], "why it failed"]
    meshes: NotRequired[Annotated[list[MeshEntry], "the copies of meshes that its files name"]]
    pictures: NotRequired[Annotated[dict[str, Sha256], "the pictures that simulators took, by their names"]]
    not_loaded: NotRequired[
        Annotated[
            dict[str, Literal["not in the sample", "no file"]],
            "the loaders of the run that it did not go through, and why",
        ]
    ]


class CoverageEntry(TypedDict):
    """How many manipulators of a run a loader was given, and what came of it."""

    simulator: Annotated[str | None, "name and version of the simulator; null where it judged none"]
    of: Annotated[Count, "manipulators of the run"]
    passed: Annotated[Count, "whose file the simulator loaded as the arm that was written"]
    failed: Annotated[Count, "whose file it refused, or holds as another arm, or that ended it"]
    missing: Annotated[Count, "for which it was not installed"]
    not_in_sample: Annotated[Count, "which the sample of the run left out"]
    no_file: Annotated[Count, "which failed before there was a file"]
    optional: Annotated[bool, "whether its failures are notices"]


class SimulatorNotice(TypedDict):
    """What one loader reports about several manipulators, as it says it of the first of them."""

    loader: Annotated[str, "the loader"]
    manipulators: Annotated[Count, "how many manipulators have the finding"]
    first: Annotated[str, "the first of these"]
    place: Annotated[str | None, "the place in a file that it is about, of the first"]
    joint: Annotated[str | None, "the joint that it is about, of the first"]
    message: Annotated[str, "the message about the first; of the others it names other joints and numbers"]


class InputEntry(TypedDict):
    """A file that a run read, and the hash of its bytes; None where it could not be read."""

    path: Annotated[str, "a file that the run read: its run file, or a table"]
    sha256: Sha256 | None


class VariationEntry(TypedDict):
    """What a run drew: of which manipulator, how many, by which seed and sampling."""

    name: Annotated[str, "what the names of its variants begin with"]
    of: Annotated[str, "the manipulator that is varied"]
    count: Annotated[Count | None, "how many variants; null for as many as its grids have points"]
    seed: Annotated[int, "which of all samples"]
    sampling: Annotated[str, "how the sample spreads"]


class StageCallEntry(TypedDict):
    """A stage of a run, with all of its options."""

    kind: StageKind
    stage: Annotated[str, "the stage's name"]
    options: Annotated[dict[str, Any], "all options of the stage, with their defaults"]


class Reproduction(TypedDict):
    """What is needed to do a run again."""

    command: Annotated[str | None, "the command that makes the same files; null where a program began the run"]
    inputs: Annotated[list[InputEntry], "the run file and the tables, the first thousand"]
    inputs_left_out: Annotated[Count, "how many more there are"]
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


JointName: TypeAlias = Annotated[str, "a joint"]


class AxesEntry(TypedDict):
    """What the axes of an arm declare about its kinematics, by the names of the joints."""

    parallel: Annotated[
        list[Annotated[list[JointName], "joints in a row whose axes are parallel"]],
        "all of them",
    ]
    spherical_wrist: Annotated[list[JointName], "the last three joints, where their axes meet in one point"]
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
    left_out: Annotated[Count, "how many more rows the manifest has"]
    axes: Annotated[list[ArmAxes], "what the axes of the tables of these manipulators declare about their kinematics"]
