"""The sections of a run file as people write them: what pydantic checks, and what the JSON Schema is made of.

A list or a mapping may be written in a short form: `emitters: urdf` is `emitters: [{stage: urdf}]`. `written_out` has
it in the long form, which these records are of.
"""

from __future__ import annotations

from dataclasses import MISSING, dataclass, field
from types import NoneType
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, get_args, get_origin

from pydantic import Field, WithJsonSchema  # noqa: TID253 - this module is imported where a run file is read

from dh2urdf.cells.cell import PLACES, TRIPLES, Combine
from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.documents.document import Node, expect_mapping
from dh2urdf.manipulator import WORLD
from dh2urdf.meshes.conversion import ACCEPTED
from dh2urdf.meshes.files import FILE, RELATIVE
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.output.layouts import DEFAULT_SIZE, LARGEST, Form
from dh2urdf.plugin_system.option_types import NUMBER, Words, keys_of, members, records_of
from dh2urdf.rotations import ZERO
from dh2urdf.variations.sampling import MOST_POINTS, Sampling
from dh2urdf.variations.variation import AXES, FIELDS

DEFAULT_SAMPLE = Sample(first=1000, every=50)
"""What goes through xacro expansion and simulators: all of a run of up to 1,000, of a longer one a sample."""
DEFAULT_TIME_LIMIT = 300.0  # how long one manipulator may take, simulators aside [s]
MOST = 10**9  # largest whole number of a setting that counts manipulators
MAX_POSES = 1_000_000  # random joint vectors of one proof
MOST_VALUES = 10**4  # values of one evenly spaced grid: every chunk of tasks carries them
MOST_SEED = 2**64
PAIR = {"type": "array", "items": NUMBER, "minItems": 2, "maxItems": 2}
_JOINT = {"type": ["integer", "string"], "minimum": 1, "minLength": 1}
_JOINTS = {"anyOf": [_JOINT, {"type": "array", "items": _JOINT, "minItems": 1}]}

Text: TypeAlias = Annotated[str, Field(min_length=1), Words("a text, not empty")]
AnyText: TypeAlias = Annotated[str, Words('a text, also ""')]
FirstOnes: TypeAlias = Annotated[int, Field(ge=0, le=MOST)]
Stride: TypeAlias = Annotated[int, Field(ge=1, le=MOST)]
Triple: TypeAlias = Annotated[
    tuple[float, float, float],
    Words("a list of three numbers"),
    WithJsonSchema({"type": "array", "items": NUMBER, "minItems": 3, "maxItems": 3}),
]
Seconds: TypeAlias = Annotated[
    float, Field(gt=0, lt=MOST), Words("seconds that one manipulator may take, a number greater than 0")
]
MeshNames: TypeAlias = Annotated[
    str, WithJsonSchema({"type": "string", "pattern": f"^({RELATIVE}|{FILE}|package://.+)$"})
]
Options: TypeAlias = Annotated[dict[str, Any], Words("a mapping such as {frames: dh}"), WithJsonSchema({})]
"""The options of a stage; `dh2urdf.plugin_system.options.make_options` checks them."""
AnyNumber: TypeAlias = Annotated[Any, Words("a number"), WithJsonSchema(NUMBER)]
"""A number in the unit of the field that varies, which is not known here."""
Pair: TypeAlias = Annotated[Any, Words("a range: [LOW, HIGH]"), WithJsonSchema(PAIR)]
Values: TypeAlias = Annotated[Any, WithJsonSchema({"type": "array", "items": NUMBER, "minItems": 1})]
SampleSize: TypeAlias = Annotated[int, Field(ge=1, le=MOST_POINTS)]
Seed: TypeAlias = Annotated[int, Field(ge=0, le=MOST_SEED - 1)]
if TYPE_CHECKING:
    Varied: TypeAlias = str
    Placed: TypeAlias = str
else:
    Varied = Literal[tuple(FIELDS)]
    Placed = Literal[(*TRIPLES, *PLACES)]


def key(text: str, default: Any = MISSING, *, measures: str | None = None) -> Any:  # noqa: ANN401 - a field
    """A key of a section: what it is for, and what its numbers measure that may have units."""
    return field(default=default, metadata={"help": text, "measures": measures})


# --- Stages -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class StageSection:
    """A stage with its options; the usual one of its kind where none is named."""

    stage: Text | None = None
    options: Options | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedStageSection:
    """A stage that must be named, for none is usual."""

    stage: Text = key("the name of the stage")
    options: Options | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class EmitterSection(StageSection):
    """An emitter."""

    only: Literal["arms", "cells"] | None = key(
        "whether it writes only arms by themselves, or only cells; both by default", None
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class LoaderSection(NamedStageSection):
    """A loader."""

    optional: bool = key("whether a refusal, or a missing program, is a notice and fails nothing", False)


@dataclass(frozen=True, slots=True, kw_only=True)
class ExecutionSection(StageSection):
    """An executor."""

    time_limit: Seconds = key("seconds that one manipulator may take, simulators aside", DEFAULT_TIME_LIMIT)


@dataclass(frozen=True, slots=True, kw_only=True)
class InputSection:
    """Files that one reader reads: it is named, or goes by the suffix of the path."""

    path: Text = key("a table, or a pattern such as tables/*.csv")
    stage: Text | None = key("the reader; by the path's suffix if absent", None)
    options: Options | None = None
    calibration: Text | None = key(
        "differences that are added to the rows: a calibration.conf, or a table of them", None
    )


# --- Cells, parts, meshes, variations ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmSection:
    """An arm of a cell."""

    name: Text = key("the arm's name in the cell")
    of: Text = key("the manipulator or the part that it is, or a variation: then each of its variants has its own cell")
    prefix: AnyText | None = key("before the names of its links and joints; NAME_ by default", None)
    parent: Text = key("world, or a link of another arm, such as left/tool0", WORLD)
    xyz: Triple = key("where it stands on its parent [m]", ZERO, measures="length")
    rpy: Triple = key("its orientation there: roll, pitch, yaw [rad]", ZERO, measures="angle")
    floating: bool = key("whether nothing holds it in the world; where it stands is where it begins", False)


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshSection:
    """A mesh file and where it is on its link."""

    file: Text = key("a file in STL, OBJ or DAE, from the folder of the run file")
    xyz: Triple = key("where it is in the DH frame after the row [m]", ZERO, measures="length")
    rpy: Triple = key("its orientation there: roll, pitch, yaw [rad]", ZERO, measures="angle")
    scale: float | Triple = key("a factor, or one for each axis", 1.0, measures="bare number")


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapesSection:
    """The meshes of a link: `mesh` is both."""

    visual: MeshSection | None = None
    collision: MeshSection | None = None
    mesh: MeshSection | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshesSection:
    """The meshes of some manipulators."""

    of: Text = key("the manipulator of this run that has them; * stands for any text")
    base: ShapesSection | None = None
    joints: dict[str, ShapesSection] | None = key("by the names of the joints", None)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepSection:
    """What is kept of a part's file as it is."""

    elements: Literal["all", "none"] = key("elements for other programs, such as ros2_control", "all")
    inertia: Literal["keep", "repair"] = key("repair: the nearest inertia that a body can have", "keep")
    missing_meshes: bool = key("whether meshes that are not there stay as addresses", False)


@dataclass(frozen=True, slots=True, kw_only=True)
class PartSection:
    """A robot description that cells may have beside manipulators: a gripper, a base, a camera."""

    name: Text = key("what `of` of an arm of a cell calls it")
    file: Text = key("its URDF or xacro, from the folder of the run file")
    args: dict[str, Any] | None = key("arguments of a xacro, by name", None)
    packages: dict[str, Text] | None = key("folders of ROS packages, by the names in package:// addresses", None)
    root: Text | None = key("its link that is held; by default the one that nothing holds in its file", None)
    tip: Text | None = key("its link that takes the place of tool0 as the tool of its arm", None)
    srdf: Text | None = key("its SRDF, from the folder of the run file", None)
    keep: Literal["none"] | KeepSection = key("none: nothing beside links and joints", KeepSection())
    mesh_links: bool = key("whether symbolic links to meshes may lead out of the folders that name them", False)


@dataclass(frozen=True, slots=True, kw_only=True)
class SpacedSection:
    """An evenly spaced grid."""

    start: Annotated[AnyNumber, Field(alias="from")]
    to: AnyNumber
    points: Annotated[int, Field(ge=2, le=MOST_VALUES)]


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalSection:
    """A normal distribution; its mean is the nominal value where none is given."""

    mean: AnyNumber = None
    deviation: AnyNumber
    bounds: Pair


@dataclass(frozen=True, slots=True, kw_only=True)
class LawSection:
    """How something varies. What a law accepts depends on what varies, so that its values are looked at later."""

    choices: Values = key("one of these, all equally likely", None)
    grid: Values = key("each of these, with each of all other grids", None)
    uniform: Pair = key("any value of this range", None)
    log_uniform: Annotated[Pair, Field(alias="log-uniform")] = key(
        "any value of this range, all orders of magnitude equally likely", None
    )
    normal: Annotated[Any, WithJsonSchema({})] = key(
        "a normal distribution, about the nominal value unless it has a mean, cut at its bounds", None
    )
    scale: Pair = key("the nominal value times a factor of this range", None)
    offset: Pair = key("the nominal value plus a number of this range", None)


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleSection(LawSection):
    """How a field varies."""

    joints: Annotated[Any, WithJsonSchema(_JOINTS)] = key(
        "of which joints: all, numbers from 1, or names; the number of axes has none", None
    )
    field: Varied = key("what varies")


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacementSection(LawSection):
    """How the placement of an arm varies."""

    arm: Text = key("the arm of the cell")
    field: Placed = key("what varies; xyz and rpy are three numbers, each with a value of its own")


LAWS = ("choices", "grid", "uniform", "log-uniform", "normal", "scale", "offset")  # how values are drawn
LAW_ALSO: dict[str, Any] = {"oneOf": [{"required": [law]} for law in LAWS]}
"""More keywords of the JSON Schema of a law."""
RULE_ALSO: dict[str, Any] = {
    "if": {"properties": {"field": {"const": AXES}}, "required": ["field"]},
    "then": {"properties": {"joints": False}},
    "else": {"required": ["joints"]},
}
"""More keywords of the JSON Schema of a rule."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VariationSection:
    """Manipulators drawn from another one."""

    name: Text | None = key("what the names of the variants begin with; that of the manipulator by default", None)
    of: Text = key("the manipulator of this run that is varied")
    count: SampleSize | None = key("how many variants; the points of its grids by default", None)
    seed: Seed = key("which of all samples", 0)
    sampling: Sampling = key("how the sample spreads", Sampling.RANDOM)
    vary: Annotated[
        tuple[RuleSection, ...],
        Field(min_length=1),
        Words("a list of rules, each a mapping such as {joints: [2, 3], field: a, scale: [0.8, 1.2]}"),
    ] = key("what varies")


@dataclass(frozen=True, slots=True, kw_only=True)
class CellSection:
    """Several arms in one robot description, or numbered cells of such arms."""

    name: Text = key("the cell's name, after which its files are named")
    arms: Annotated[
        tuple[ArmSection, ...],
        Field(min_length=1),
        Words("a list such as [{name: left, of: ur5}, {name: right, of: ur5, xyz: [0, -0.5, 0]}]"),
    ]
    combine: Combine = key(
        "how the variants of several arms come together: by their numbers, or all with all", Combine.PAIRS
    )
    vary: tuple[PlacementSection, ...] = key("how placements vary from cell to cell", ())
    count: SampleSize | None = key("how many cells, where none of its arms is a variation", None)
    seed: Seed = key("which of all samples of placements", 0)
    sampling: Sampling = key("how this sample spreads", Sampling.RANDOM)


# --- Output, and how much ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshOutputSection:
    """How descriptions name meshes, and what becomes of these."""

    names: MeshNames = key("how descriptions name mesh files: relative, file or package://NAME", RELATIVE)
    convert: MeshConversion = key(ACCEPTED, MeshConversion.NEVER)


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputKeys:
    """Where the output goes, and how it lies there."""

    directory: Text | None = key("a folder, from that of the run file, or an address such as s3://bucket/prefix", None)
    layout: Form = key("one folder, folders of `size` manipulators, or tar shards of as many", Form.FILES)
    size: Annotated[int, Field(ge=1, le=LARGEST)] = key("manipulators in one folder or shard", DEFAULT_SIZE)
    meshes: MeshOutputSection = MeshOutputSection()


@dataclass(frozen=True, slots=True, kw_only=True)
class ProofSection:
    """How much is compared with the tables."""

    poses: Annotated[int, Field(ge=1, le=MAX_POSES)] = key(
        "random joint vectors at which each file is compared with its table", 32
    )
    first: FirstOnes = key(
        "so many manipulators at the beginning of the run are compared with their tables", Sample().first
    )
    every: Stride = key("n, for every n-th of the other are compared with their tables", Sample().every)

    @property
    def proved(self) -> Sample:
        """Whose files are compared."""
        return Sample(first=self.first, every=self.every)


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleSection:
    """How much goes through what is slow."""

    first: FirstOnes = key(
        "so many manipulators at the beginning of the run go through expansion of xacro and simulators",
        DEFAULT_SAMPLE.first,
    )
    every: Stride = key(
        "n, for every n-th of the other go through expansion of xacro and simulators", DEFAULT_SAMPLE.every
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportSection:
    """What is reported of the run."""

    html: bool = key("whether report.html is written, where jinja2 and matplotlib are installed", True)
    directory: Text | None = key(
        "where report, manifest and index go: a folder or an address; by default that of the output, or "
        "one beside it where the output is folders of packages",
        None,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RunFile:
    """The whole file."""

    inputs: Annotated[tuple[InputSection, ...], Field(min_length=1)] = key("the tables that are read")
    parts: tuple[PartSection, ...] = key("robot descriptions that cells have beside manipulators; none by default", ())
    cells: tuple[CellSection, ...] = key("robots of several arms, with one root; none by default", ())
    variations: tuple[VariationSection, ...] = key("manipulators drawn from others; none by default", ())
    meshes: tuple[MeshesSection, ...] = key("mesh files that links are seen as and touch with; none by default", ())
    transform: StageSection = key("what makes a robot of a table", StageSection())
    edits: tuple[NamedStageSection, ...] = key(
        "what changes the tables before the transform, or the robots after it, in order; none by default", ()
    )
    emitters: Annotated[tuple[EmitterSection, ...], Field(min_length=1)] = key("what writes files", (EmitterSection(),))
    loaders: tuple[LoaderSection, ...] = key("what loads the files; none by default", ())
    output: OutputKeys = key("where the output goes: a folder or an address, alone or with its layout", OutputKeys())
    execution: ExecutionSection = key("what does the work", ExecutionSection())
    proof: ProofSection = key("how much is compared with the tables; all by default", ProofSection())
    sample: SampleSection = key("how much goes through what is slow", SampleSection())
    report: ReportSection = key("what is reported of the run", ReportSection())


SHORT_FORMS: dict[type[Any], str] = {
    **dict.fromkeys((StageSection, NamedStageSection, EmitterSection, LoaderSection, ExecutionSection), "stage"),
    InputSection: "path",
    MeshSection: "file",
    MeshOutputSection: "names",
    OutputKeys: "directory",
}
"""The key that a text alone is the value of."""
SECTIONS = keys_of(RunFile)  # the keys of a run file


def written_out(root: Node, *, deep: bool = False) -> Node:
    """A run file with lists and mappings written out: `emitters: urdf` is `emitters: [{stage: urdf}]`.

    Sections that are absent or empty get their defaults, so that `--set` finds them; lists in sections are written out
    too where it is `deep`.
    """
    given = {key: node for key, node in expect_mapping(root, "a run file").items() if node.value is not None}
    for name, section in SECTIONS.items():
        default = mapping_node({}, root)
        if get_origin(members(section.hint)[0]) is tuple and name != "emitters":
            default = Node([], root.file, root.line, root.column)
        given[name] = long_form(given.get(name, default), section.hint, deep)
    return mapping_node(given, root)


def long_form(node: Node, hint: Any, deep: bool, *, inside: bool = False) -> Node:  # noqa: ANN401, FBT001 - a type
    """A value with its lists and mappings written out, without the keys whose values are empty."""
    kind = next(member for member in members(hint) if member is not NoneType)
    inner = get_args(kind)
    if get_origin(kind) is tuple and records_of(inner[0]) and (deep or not inside):
        entries = node.value if isinstance(node.value, list) else [node]
        return Node([long_form(entry, inner[0], deep) for entry in entries], node.file, node.line, node.column)
    if kind in SHORT_FORMS and node.value is not None and not isinstance(node.value, (dict, list)):
        return mapping_node({SHORT_FORMS[kind]: node}, node)
    if not isinstance(node.value, dict) or kind is Any:
        return node
    if get_origin(kind) is dict and records_of(inner[1]):
        hints = dict.fromkeys(node.value, inner[1])
    else:
        hints = {name: key.hint for record in records_of(kind) for name, key in keys_of(record).items()}
    made = {}
    for name, entry in node.value.items():
        if name not in hints:
            made[name] = entry
        elif entry.value is not None or str in members(hints[name]):
            made[name] = long_form(entry, hints[name], deep, inside=True)
    return mapping_node(made, node)


def mapping_node(entries: dict[str, Node], at: Node) -> Node:
    """A mapping that stands where another value does."""
    return Node(entries, at.file, at.line, at.column, key_places=at.key_places)
