"""The run file: what goes in, which stages do what, where the output goes.

Only the structure of the file is checked here. Whether a stage exists and takes its options is known where the catalog
of stages is (`dh2urdf.run_file.plan.make_plan`), so a `RunConfig` carries its problems along, and all of them, of both
kinds, are reported at once.
"""

from __future__ import annotations

from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.documents.document import Node, expect_mapping, load_yaml, read_yaml
from dh2urdf.documents.text_files import read_bytes
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import MeshShape
from dh2urdf.meshes.conversion import conversion_of
from dh2urdf.meshes.files import find_mesh, prefix_of
from dh2urdf.output.layouts import Form, Layout
from dh2urdf.plugin_system.validator import unknown_key
from dh2urdf.rotations import RigidTransform
from dh2urdf.run_file import sections as keys
from dh2urdf.run_file.cell_section import read_cells
from dh2urdf.run_file.mesh_section import MeshCall, Shapes
from dh2urdf.run_file.overrides import ON_THE_COMMAND_LINE, Asked, with_setting
from dh2urdf.run_file.reading import Reading
from dh2urdf.run_file.records import InputCall, OutputSection, RunConfig, StageCall
from dh2urdf.run_file.sections import SECTIONS, written_out
from dh2urdf.run_file.variation_section import read_variations
from dh2urdf.source import Problem, did_you_mean, in_file_order

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path


RUN_SUFFIXES = (".yaml", ".yml", ".json")
"""How the names of run files end."""
LIKELY_BYTES = 2**20
"""Size of a file that may be a run file [B]: a table may be a thousand times larger."""


def is_run_file(path: Path) -> bool:
    """Whether a file has a run file's sections, right or wrong; one of more than `LIKELY_BYTES` has not."""
    try:
        root = load_yaml(read_bytes(path, limit=LIKELY_BYTES), str(path))
    except ConfigError:
        return False
    return isinstance(root.value, dict) and not root.value.keys().isdisjoint(SECTIONS)


def load_config(
    path: Path, overrides: Sequence[str] = (), root: Node | None = None, asked: Asked = ON_THE_COMMAND_LINE
) -> RunConfig:
    """A run file with changes from the command line.

    Args:
        path: the run file.
        overrides: changes as ``--set`` takes them: ``transform.options.frames=dh``.
        root: what the run file says, where it is not in the file.
        asked: where the changes are given.

    Returns:
        The run file; `RunConfig.problems` says what is wrong with its structure.

    Raises:
        ConfigError: the file cannot be read, is not a YAML mapping, or has nothing of a run file.
    """
    root = root or read_yaml(path)
    names = expect_mapping(root, "a run file").keys()
    if names and not any(get_close_matches(name, SECTIONS, cutoff=0.75) for name in names):
        raise ConfigError(
            Problem(
                message="this is no run file: it has none of its sections",
                mark=root.mark,
                found=", ".join(names),
                accepted=", ".join(SECTIONS),
                suggestion="if it is a table, `dh2urdf convert` takes it, or `inputs:` of a run file",
            )
        )
    to = Reading(folder=path.parent, changes=asked.mark.file)
    for setting in overrides:
        try:
            root = with_setting(written_out(root), setting, tuple(SECTIONS), asked)
        except ConfigError as error:
            to.problems.extend(error.problems)
    config = _Sections(written_out(root, deep=True), to).config()
    directory = config.output.directory or path.parent / "build" / path.stem
    return replace(config.written_to(directory), folder=path.parent, problems=tuple(in_file_order(to.problems)))


class _Sections:
    """The sections of a run file, written out, on their way to its records. One that is wrong has its defaults."""

    def __init__(self, root: Node, to: Reading) -> None:
        self.root, self.to = root, to

    def config(self) -> RunConfig:
        """The records of all sections."""
        to = self.to
        unknown = [name for name in expect_mapping(self.root, "a run file") if name not in keys.SECTIONS]
        to.problems += [unknown_key(self.root, name, keys.SECTIONS, "a run file", "key") for name in unknown]
        inputs = [self._input(node, field) for node, field in self._entries("inputs")]
        if not inputs and not any(did_you_mean(name, ["inputs"]) for name in unknown):
            accepted = "at least one table, such as `inputs: [{path: tables/ur5.csv}]`"
            to.add_problem("there is nothing to read", self._at("inputs"), "inputs", accepted=accepted)
        if not self._entries("emitters"):
            message = "the list is empty, and something must be written"
            to.add_problem(message, self._at("emitters"), "emitters", accepted="at least one stage")
        proof = to.record(keys.ProofSection, self._at("proof"), "proof") or keys.ProofSection()
        sample = to.record(keys.SampleSection, self._at("sample"), "sample") or keys.SampleSection()
        report = to.record(keys.ReportSection, self._at("report"), "report") or keys.ReportSection()
        return RunConfig(
            inputs=tuple(each for each in inputs if each),
            transform=self._stage(keys.StageSection, self._at("transform"), "transform") or StageCall(),
            emitters=self._stages("emitters", keys.StageSection),
            loaders=self._stages("loaders", keys.LoaderSection),
            execution=self._stage(keys.ExecutionSection, self._at("execution"), "execution") or StageCall(),
            output=self._output(self._at("output")),
            edits=self._stages("edits", keys.NamedStageSection),
            cells=read_cells(self._entries("cells"), to),
            variations=read_variations(self._entries("variations"), to),
            meshes=read_meshes(self._entries("meshes"), to),
            proof=proof,
            sample=Sample(first=sample.first, every=sample.every),
            report=report,
            report_directory=to.directory(self._at("report").entry("directory"), "report.directory"),
        )

    def _at(self, section: str) -> Node:
        return expect_mapping(self.root, "a run file")[section]

    def _entries(self, section: str) -> list[tuple[Node, str]]:
        """The entries of a section that is a list, each with its place."""
        return [(node, f"{section}.{index}") for index, node in enumerate(self.root.entries(section))]

    def _stage(self, kind: type[Any], node: Node, field: str) -> StageCall | None:
        """A stage with its options; where these cannot be used, the stage alone."""
        named = node.entry("stage")
        mark = (named or node).mark
        given = self.to.record(kind, node, field)
        if given is None:
            name = named.text if named else None
            return StageCall(stage=name, mark=mark) if name else None
        others = {name: getattr(given, name) for name in ("optional", "time_limit") if hasattr(given, name)}
        return StageCall(stage=given.stage, options=node.entry("options"), mark=mark, **others)

    def _stages(self, section: str, kind: type[Any]) -> tuple[StageCall, ...]:
        calls = [self._stage(kind, node, field) for node, field in self._entries(section)]
        return tuple([call for call in calls if call])

    def _input(self, node: Node, field: str) -> InputCall | None:
        """An input, with its calibration among the options of its reader."""
        given = self.to.record(keys.InputSection, node, field)
        options, calibration, path = (node.entry(key) for key in ("options", "calibration", "path"))
        if given is None or path is None:
            return None
        found = self.to.files(path, f"{field}.path")
        if calibration is not None and self.to.is_path(calibration, f"{field}.calibration"):
            others = expect_mapping(options, "options") if options else {}
            if "calibration" in others:
                message = "the calibration is given twice, here and among the options"
                self.to.add_problem(message, calibration, f"{field}.calibration")
            options = keys.mapping_node({**others, "calibration": calibration}, options or calibration)
        return InputCall(
            paths=found.paths,
            stage=given.stage,
            options=options,
            mark=(node.entry("stage") or path).mark,
            notices=found.notices,
            pattern=found.pattern,
        )

    def _output(self, node: Node) -> OutputSection:
        given = self.to.record(keys.OutputKeys, node, "output")
        directory = self.to.directory(node.entry("directory"), "output.directory")
        if given is None:
            return OutputSection(directory=directory)
        names, convert = given.meshes.names, given.meshes.convert
        meshes = node.entry("meshes") or node
        if given.layout is Form.FILES and (size := node.entry("size")):
            message = "all files go into one folder, which has no size"
            accepted = f"a size with layout: {Form.FOLDERS} or layout: {Form.SHARDS}"
            self.to.add_problem(message, size, "output.size", accepted=accepted)
        with self.to.noting(meshes.entry("names") or meshes, "output.meshes.names"):
            prefix = prefix_of(names)
            with self.to.noting(meshes.entry("convert") or meshes, "output.meshes.convert"):
                return OutputSection(
                    directory=directory,
                    layout=Layout(form=given.layout, size=given.size),
                    mesh_prefix=prefix_of(names, in_folders=given.layout is Form.FOLDERS),
                    mesh_conversion=conversion_of(convert, prefix),
                )
        return OutputSection(directory=directory)


def read_meshes(entries: Iterable[tuple[Node, str]], to: Reading) -> tuple[MeshCall, ...]:
    """The meshes of manipulators, each in its node at its place."""
    found = []
    for node, place in entries:
        before = len(to.problems)
        if (given := to.record(keys.MeshesSection, node, place)) is None:
            continue
        base = _shapes(given.base, node.entry("base"), f"{place}.base", to)
        joints, by_joint = [], node.entry("joints")
        for joint, shapes in (given.joints or {}).items():
            entry = by_joint.entry(joint) if by_joint else None
            read = _shapes(shapes, entry, f"{place}.joints.{joint}", to)
            joints.append((joint, replace(read, mark=by_joint.key_mark(joint) if by_joint else None)))
        if len(to.problems) == before:
            mark = (node.entry("of") or node).mark
            found.append(MeshCall(of=given.of, base=base, joints=tuple(joints), mark=mark))
    return tuple(found)


def _shapes(given: keys.ShapesSection | None, node: Node | None, place: str, to: Reading) -> Shapes:
    """The meshes of a link: `mesh` is both."""
    made: dict[str, MeshShape] = {}
    for name in ("visual", "collision", "mesh") if given and node else ():
        mesh, entry = getattr(given, name), node.entry(name) if node else None
        file = entry.entry("file") if entry else None
        if mesh is None or file is None:
            continue
        with to.noting(file, f"{place}.{name}.file"):
            made[name] = MeshShape(
                file=find_mesh(mesh.file, to.folder_of(file), links=True),  # A run file is the user's own.
                pose=RigidTransform.from_xyz_rpy(mesh.xyz, mesh.rpy),
                scale=mesh.scale if isinstance(mesh.scale, tuple) else (mesh.scale,) * 3,
                mark=file.mark,
            )
    both = made.get("mesh")
    return Shapes(visual=made.get("visual", both), collision=made.get("collision", both))
