"""What `dh2urdf.run` returns and reports contain, as plain data."""

from __future__ import annotations

from typing import Any, Literal, NotRequired, TypeAlias, TypedDict

ConventionName: TypeAlias = Literal["standard", "modified"]
JointTypeName: TypeAlias = Literal["revolute", "continuous", "prismatic", "fixed"]
KindName: TypeAlias = Literal["reader", "transform", "edit", "emitter", "loader", "executor"]


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


class StageCallEntry(TypedDict):
    """A stage of a run, with all of its options."""

    kind: KindName
    stage: str
    options: dict[str, Any]


class Reproduction(TypedDict):
    """What is needed to do a run again."""

    command: str | None
    inputs: list[InputEntry]
    inputs_left_out: int
    versions: dict[str, str]
    variations: list[VariationEntry]
    stages: list[StageCallEntry]
    joint_vectors: str
    citation: str


class OpwEntry(TypedDict):
    """The parameters of an arm with an ortho-parallel basis and a spherical wrist [m, rad]."""

    a1: float
    a2: float
    b: float
    c1: float
    c2: float
    c3: float
    c4: float
    offsets: list[float]
    signs: list[int]


class AxesEntry(TypedDict):
    """What the axes of an arm say of its kinematics, by the names of the joints."""

    parallel: list[list[str]]
    spherical_wrist: list[str]
    opw: OpwEntry | None


class ArmAxes(AxesEntry):
    """What the axes of a table say of its kinematics.

    `name` is the manipulator or cell; `arms` are the arms of the cell that have the table.
    """

    name: str
    arms: list[str]


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
    axes: list[ArmAxes]


# --- Conversions ------------------------------------------------------------------------------------------------------


# --- What was understood of a table -----------------------------------------------------------------------------------


# --- Plugins ----------------------------------------------------------------------------------------------------------
