"""The run file: what goes in, which stages do what, where the output goes.

Only the structure of the file is checked here. Whether a stage exists and takes its options is known where the catalog
of stages is (`dh2urdf.run_file.plan.make_plan`), so a `RunConfig` carries its problems along, and all of them, of both
kinds, are reported at once.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.cells.cell import CellCall
from dh2urdf.conversion.one_manipulator import Only, Sample
from dh2urdf.documents.document import Node, expect_mapping, load_yaml, read_yaml
from dh2urdf.documents.text_files import is_file, read_bytes
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import Manipulator
from dh2urdf.meshes.conversion import conversion_of
from dh2urdf.meshes.files import RELATIVE, prefix_of
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.output.layouts import Form, Layout
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.plugin_system.validator import unknown_key
from dh2urdf.run_file import sections as keys
from dh2urdf.run_file.cell_section import read_cells
from dh2urdf.run_file.mesh_section import MeshCall, read_meshes
from dh2urdf.run_file.part_section import PartCall, read_parts
from dh2urdf.run_file.reading import Reading, with_setting
from dh2urdf.run_file.variation_section import read_variations
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, in_file_order
from dh2urdf.variations.variation import VariationCall

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.plugin_system.catalog import Catalog

say = Messages(__file__)

RUN_SUFFIXES = (".yaml", ".yml", ".json")  # how the names of run files end
LIKELY_BYTES = 2**20  # size of a file that may be a run file [B]: a table may be a thousand times larger


@dataclass(frozen=True, slots=True, kw_only=True)
class StageCall:
    """A stage as a run file asks for it; `dh2urdf.plugin_system.options.make_options` checks its options."""

    stage: str | None = None  # None is the usual one of its kind
    options: Node | None = None
    mark: Mark | None = None
    only: Only | None = None  # of an emitter: whether it writes only arms by themselves, or only cells
    optional: bool = False  # of a loader: whether what it refuses is a notice and fails nothing
    time_limit: float = keys.DEFAULT_TIME_LIMIT  # of an executor: for one manipulator, simulators aside [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class InputCall(StageCall):
    """Files that one reader reads with the same options; without its name each file's suffix says it."""

    paths: tuple[Path, ...]  # in the order of their names where they come from a pattern
    notices: tuple[Problem, ...] = ()  # the findings about the pattern
    pattern: str | None = None  # what matches the files; None where a path names one


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputSection:
    """Where the output goes, and how it lies there."""

    directory: Path | str | None = None  # a folder or an address; None is ``build/`` beside the run file
    layout: Layout = Layout()
    mesh_prefix: str | None = prefix_of(RELATIVE)  # before the name of a copied mesh; None where none is copied
    mesh_conversion: MeshConversion = MeshConversion.NEVER


@dataclass(frozen=True, slots=True, kw_only=True)
class RunConfig:
    """A run file; each section is an attribute."""

    inputs: tuple[InputCall, ...] = ()
    transform: StageCall = field(default_factory=StageCall)
    emitters: tuple[StageCall, ...] = ()
    loaders: tuple[StageCall, ...] = ()
    execution: StageCall = field(default_factory=StageCall)
    output: OutputSection = field(default_factory=OutputSection)
    edits: tuple[StageCall, ...] = ()
    parts: tuple[PartCall, ...] = ()
    cells: tuple[CellCall, ...] = ()
    variations: tuple[VariationCall, ...] = ()
    meshes: tuple[MeshCall, ...] = ()
    proof: keys.ProofSection = keys.ProofSection()
    sample: Sample = keys.DEFAULT_SAMPLE
    report: keys.ReportSection = keys.ReportSection()
    report_directory: Path | str | None = None  # where report, manifest and index go
    folder: Path = Path()  # the folder of the run file, which paths in options of stages are relative to
    problems: tuple[Problem, ...] = ()  # what is wrong with the file; nothing may start while there is any

    def written_to(self, directory: Path | str) -> RunConfig:
        """The same with another place for its output."""
        return replace(self, output=replace(self.output, directory=directory))


def is_run_file(path: Path) -> bool:
    """Whether a file has a run file's sections, right or wrong; one of more than `LIKELY_BYTES` has not."""
    try:
        root = load_yaml(read_bytes(path, limit=LIKELY_BYTES), str(path))
    except ConfigError:
        return False
    return isinstance(root.value, dict) and not root.value.keys().isdisjoint(keys.SECTIONS)


def refuse_table(path: Path, catalog: Catalog) -> None:
    """Refuses a table where a run file is expected: a file that only readers take, or that can be read as it is."""
    is_table = False
    with suppress(Exception):  # Whatever it is instead, it is no table.
        reader = catalog.reader_for(path)
        if path.name.lower().endswith(RUN_SUFFIXES):
            is_table = isinstance(next(iter(reader.read(path, reader.options())), None), Manipulator)
        else:
            is_table = is_file(path)
    if is_table:
        raise ConfigError(say("table-for-run-file", Mark(file=str(path)), name=path.name))


def load_config(
    path: Path, overrides: Sequence[str] = (), root: Node | None = None, mark: Mark = COMMAND_LINE
) -> RunConfig:
    """A run file with changes from the command line, as ``--set`` takes them: ``transform.options.frames=dh``.

    `root` is what the run file says, where it is not in the file, and `mark` where the changes are given.
    `RunConfig.problems` says what is wrong with its structure; a ConfigError is raised for what is no run file.
    """
    root = root or read_yaml(path)
    names = expect_mapping(root, "a run file").keys()
    if names and not any(get_close_matches(name, keys.SECTIONS, cutoff=0.75) for name in names):
        raise ConfigError(say("no-run-file", root.mark, found=", ".join(names), sections=[*keys.SECTIONS]))
    to = Reading(folder=path.parent, changes=mark.file)
    for setting in overrides:
        try:
            root = with_setting(keys.written_out(root), setting, tuple(keys.SECTIONS), mark)
        except ConfigError as error:
            to.problems.extend(error.problems)
    config = _config(keys.written_out(root, deep=True), to)
    directory = config.output.directory or path.parent / "build" / path.stem
    return replace(config.written_to(directory), folder=path.parent, problems=tuple(in_file_order(to.problems)))


def _config(root: Node, to: Reading) -> RunConfig:
    """The records of all sections, which are written out; a section that is wrong has its defaults."""
    given = expect_mapping(root, "a run file")
    entries = {
        name: [(entry, f"{name}.{index}") for index, entry in enumerate(root.entries(name))] for name in keys.SECTIONS
    }

    def stages(section: str, kind: type[Any]) -> tuple[StageCall, ...]:
        calls = [_stage(kind, node, field, to) for node, field in entries[section]]
        return tuple([call for call in calls if call])

    unknown = [name for name in given if name not in keys.SECTIONS]
    to.problems += [unknown_key(root, name, keys.SECTIONS, "a run file", "key") for name in unknown]
    inputs = [_input(node, field, to) for node, field in entries["inputs"]]
    if not inputs and not any(did_you_mean(name, ["inputs"]) for name in unknown):
        to.note("no-inputs", given["inputs"], "inputs")
    if not entries["emitters"]:
        to.note("no-emitters", given["emitters"], "emitters")
    emitters = stages("emitters", keys.EmitterSection)
    for node, place in entries["emitters"] if not entries["cells"] else ():
        if (only := node.entry("only")) and only.value == "cells":
            to.note("emitter-without-cells", only, f"{place}.only")
    sample = to.record(keys.SampleSection, given["sample"], "sample") or keys.SampleSection()
    return RunConfig(
        inputs=tuple(each for each in inputs if each),
        transform=_stage(keys.StageSection, given["transform"], "transform", to) or StageCall(),
        emitters=emitters,
        loaders=stages("loaders", keys.LoaderSection),
        execution=_stage(keys.ExecutionSection, given["execution"], "execution", to) or StageCall(),
        output=_output(given["output"], to),
        edits=stages("edits", keys.NamedStageSection),
        parts=read_parts(entries["parts"], to),
        cells=read_cells(entries["cells"], to),
        variations=read_variations(entries["variations"], to),
        meshes=read_meshes(entries["meshes"], to),
        proof=to.record(keys.ProofSection, given["proof"], "proof") or keys.ProofSection(),
        sample=Sample(first=sample.first, every=sample.every),
        report=to.record(keys.ReportSection, given["report"], "report") or keys.ReportSection(),
        report_directory=to.directory(given["report"].entry("directory"), "report.directory"),
    )


def _stage(kind: type[Any], node: Node, field: str, to: Reading) -> StageCall | None:
    """A stage with its options; where these cannot be used, the stage alone."""
    named = node.entry("stage")
    mark = (named or node).mark
    given = to.record(kind, node, field)
    if given is None:
        name = named.text if named else None
        return StageCall(stage=name, mark=mark) if name else None
    others = {name: getattr(given, name) for name in ("only", "optional", "time_limit") if hasattr(given, name)}
    return StageCall(stage=given.stage, options=node.entry("options"), mark=mark, **others)


def _input(node: Node, field: str, to: Reading) -> InputCall | None:
    """An input, with its calibration among the options of its reader."""
    given = to.record(keys.InputSection, node, field)
    options, calibration, path = (node.entry(key) for key in ("options", "calibration", "path"))
    if given is None or path is None:
        return None
    paths, notices, pattern = to.files(path, f"{field}.path")
    if calibration is not None and to.is_path(calibration, f"{field}.calibration"):
        others = expect_mapping(options, "options") if options else {}
        if "calibration" in others:
            to.note("calibration-twice", calibration, f"{field}.calibration")
        options = keys.mapping_node({**others, "calibration": calibration}, options or calibration)
    mark = (node.entry("stage") or path).mark
    return InputCall(paths=paths, notices=notices, pattern=pattern, stage=given.stage, options=options, mark=mark)


def _output(node: Node, to: Reading) -> OutputSection:
    output = OutputSection(directory=to.directory(node.entry("directory"), "output.directory"))
    if (given := to.record(keys.OutputKeys, node, "output")) is None:
        return output
    meshes = node.entry("meshes") or node
    if given.layout is Form.FILES and (size := node.entry("size")):
        to.note("size-without-folders", size, "output.size", layouts=[Form.FOLDERS, Form.SHARDS])
    with to.noting(meshes.entry("names") or meshes, "output.meshes.names"):
        prefix = prefix_of(given.meshes.names)
        with to.noting(meshes.entry("convert") or meshes, "output.meshes.convert"):
            return replace(
                output,
                layout=Layout(form=given.layout, size=given.size),
                mesh_prefix=prefix_of(given.meshes.names, in_folders=given.layout is Form.FOLDERS),
                mesh_conversion=conversion_of(given.meshes.convert, prefix),
            )
    return output
