"""What a run file asks for, as records: stages, inputs, and the whole of it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

from dh2urdf.cells.cell import CellCall
from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.documents.document import Node
from dh2urdf.meshes.files import RELATIVE, prefix_of
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.output.layouts import Layout
from dh2urdf.run_file.mesh_section import MeshCall
from dh2urdf.run_file.sections import DEFAULT_SAMPLE, DEFAULT_TIME_LIMIT, ProofSection, ReportSection
from dh2urdf.source import Mark, Problem
from dh2urdf.variations.variation import VariationCall


@dataclass(frozen=True, slots=True, kw_only=True)
class StageCall:
    """A stage as a run file asks for it.

    Attributes:
        stage: its name; None for the usual one of its kind.
        options: its options as they are written; `dh2urdf.plugin_system.options.make_options` checks them.
        mark: where the stage is named.
        optional: of a loader, whether what it refuses is a notice and fails nothing.
        time_limit: of an executor, how long one manipulator may take, simulators aside [s].
    """

    stage: str | None = None
    options: Node | None = None
    mark: Mark | None = None
    optional: bool = False
    time_limit: float = DEFAULT_TIME_LIMIT


@dataclass(frozen=True, slots=True, kw_only=True)
class InputCall:
    """Files that one reader reads with the same options.

    Attributes:
        paths: the files, in the order of their names where they come from a pattern.
        stage: name of the reader; None leaves it to each file's suffix.
        options: the reader's options as they are written.
        mark: where the input stands.
        notices: the findings about the pattern.
        pattern: what matches the files; None where a path names one.
    """

    paths: tuple[Path, ...]
    stage: str | None = None
    options: Node | None = None
    mark: Mark | None = None
    notices: tuple[Problem, ...] = ()
    pattern: str | None = None

    def read_by(self, reader: str) -> StageCall:
        """The call of a reader with the options of this input."""
        return StageCall(stage=reader, options=self.options, mark=self.mark)


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputSection:
    """Where the output goes, and how it lies there.

    Attributes:
        directory: a folder, or an address such as ``s3://bucket/prefix``; None for ``build/`` beside the run file.
        layout: how the files lie there.
        mesh_prefix: what descriptions write before the name of a copied mesh; None where none is copied.
        mesh_conversion: what becomes of meshes.
    """

    directory: Path | str | None = None
    layout: Layout = Layout()
    mesh_prefix: str | None = prefix_of(RELATIVE)
    mesh_conversion: MeshConversion = MeshConversion.NEVER


@dataclass(frozen=True, slots=True, kw_only=True)
class RunConfig:
    """A run file.

    Attributes:
        inputs: what is read.
        transform: what makes robots of manipulators.
        edits: what changes manipulators before, and robots after, in this order.
        emitters: what writes files.
        loaders: what loads the files into simulators.
        execution: what does the work.
        output: where the output goes, and how it lies there.
        cells: robots of several arms that are made besides.
        variations: manipulators whose tables are drawn, that are made besides.
        meshes: mesh files that links are drawn and touched as.
        proof: how much is compared with the tables.
        sample: whose files go through what is slow: expansion of xacro, and simulators.
        report: what is reported of the run.
        report_directory: where report, manifest and index go, where the file names a place.
        folder: the folder of the run file, which paths in options of stages are relative to.
        problems: what is wrong with the file; nothing may start while there is any.
    """

    inputs: tuple[InputCall, ...] = ()
    transform: StageCall = field(default_factory=StageCall)
    emitters: tuple[StageCall, ...] = ()
    loaders: tuple[StageCall, ...] = ()
    execution: StageCall = field(default_factory=StageCall)
    output: OutputSection = field(default_factory=OutputSection)
    edits: tuple[StageCall, ...] = ()
    cells: tuple[CellCall, ...] = ()
    variations: tuple[VariationCall, ...] = ()
    meshes: tuple[MeshCall, ...] = ()
    proof: ProofSection = ProofSection()
    sample: Sample = DEFAULT_SAMPLE
    report: ReportSection = ReportSection()
    report_directory: Path | str | None = None
    folder: Path = Path()
    problems: tuple[Problem, ...] = ()

    def written_to(self, directory: Path | str) -> RunConfig:
        """The same with another place for its output."""
        return replace(self, output=replace(self.output, directory=directory))
