"""The run file: what goes in, which stages do what, where the output goes.

Only the structure of the file is checked here. Whether a stage exists and takes its options is known where the catalog
of stages is (`dh2urdf.run_file.plan.make_plan`), so a `RunConfig` carries its problems along, and all of them, of both
kinds, are reported at once.
"""

from __future__ import annotations

import glob
import os
import re
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.documents.document import Node, expect_mapping, load_yaml, read_yaml
from dh2urdf.documents.text_files import LONG_PATH, check_file, read_bytes, tidy_path
from dh2urdf.errors import ConfigError
from dh2urdf.output.file_patterns import matching
from dh2urdf.run_file.cell_section import CellsReader
from dh2urdf.run_file.mesh_section import MeshesReader
from dh2urdf.run_file.overrides import ON_THE_COMMAND_LINE, Asked, with_setting
from dh2urdf.run_file.records import DEFAULT_POSES, InputCall, RunConfig, StageCall
from dh2urdf.run_file.settings import DEFAULT_SAMPLE, SettingsReader
from dh2urdf.run_file.variation_section import VariationsReader
from dh2urdf.source import Mark, Problem, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

SECTIONS = (
    "inputs",
    "cells",
    "variations",
    "meshes",
    "transform",
    "edits",
    "emitters",
    "loaders",
    "output",
    "execution",
    "proof",
    "sample",
    "report",
)
MAX_POSES = 1_000_000
"""Random joint vectors of one proof."""
_SHELL = re.compile(r"~(?=/|$)|~[A-Za-z]\w*(?=/)|\$[A-Za-z_]\w*|\$\{\w+\}")
"""What a shell would put something else in place of."""


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
        asked: where the changes are said.

    Returns:
        The run file; `RunConfig.problems` says what is wrong with its structure.

    Raises:
        ConfigError: the file cannot be read, is not a YAML mapping, or has nothing of a run file.
    """
    root = root or read_yaml(path)
    keys = expect_mapping(root, "a run file").keys()
    if keys and not any(get_close_matches(key, SECTIONS, cutoff=0.75) for key in keys):
        raise ConfigError(
            Problem(
                message="this is no run file: it has none of its sections",
                mark=root.mark,
                found=", ".join(keys),
                accepted=", ".join(SECTIONS),
                suggestion="if it is a table, `dh2urdf convert` takes it, or `inputs:` of a run file",
            )
        )
    problems: list[Problem] = []
    for setting in overrides:
        try:
            root = with_setting(_written_out(root), setting, SECTIONS, asked)
        except ConfigError as error:
            problems.extend(error.problems)
    return _Sections(_written_out(root), path, problems, asked.mark.file).config()


# --- One form for what may be written in two -------------------------------------------------------------------------


def _written_out(root: Node) -> Node:
    """The run file with every list and mapping written out: `emitters: urdf` is `emitters: [{stage: urdf}]`.

    Sections that are absent or empty get their defaults, so that `--set` finds them.
    """
    given = {key: node for key, node in expect_mapping(root, "a run file").items() if node.value is not None}
    sections = {
        **given,
        "inputs": _list_of(given.get("inputs"), "path", root),
        "cells": _list_of(given.get("cells"), "name", root),
        "variations": _list_of(given.get("variations"), "of", root),
        "meshes": _list_of(given.get("meshes"), "of", root),
        "transform": _mapping_of(given.get("transform", _mapping({}, root)), "stage"),
        "edits": _list_of(given.get("edits"), "stage", root),
        "emitters": _list_of(given.get("emitters", _mapping({}, root)), "stage", root),
        "loaders": _list_of(given.get("loaders"), "stage", root),
        "execution": _mapping_of(given.get("execution", _mapping({}, root)), "stage"),
        "output": _output_of(_mapping_of(given.get("output", _mapping({}, root)), "directory")),
        "proof": given.get("proof", _mapping({}, root)),
        "sample": given.get("sample", _mapping({}, root)),
        "report": given.get("report", _mapping({}, root)),
    }
    return _mapping(sections, root)


def _mapping(entries: dict[str, Node], at: Node) -> Node:
    return Node(entries, at.file, at.line, at.column, key_places=at.key_places)


def _list_of(node: Node | None, key: str, root: Node) -> Node:
    entries = [] if node is None else node.value if isinstance(node.value, list) else [node]
    at = node or root
    return Node([_mapping_of(entry, key) for entry in entries], at.file, at.line, at.column)


def _mapping_of(node: Node, key: str) -> Node:
    return node if isinstance(node.value, (dict, list)) or node.value is None else _mapping({key: node}, node)


def _output_of(output: Node) -> Node:
    """The section `output`, in which `meshes: relative` is `meshes: {names: relative}`."""
    if not isinstance(output.value, dict) or "meshes" not in output.value:
        return output
    meshes = _mapping_of(output.value["meshes"], "names")
    return _mapping({**output.value, "meshes": meshes}, output)


# --- The sections -----------------------------------------------------------------------------------------------------


class _Sections(SettingsReader):
    """Reads the sections of a run file and gathers what is wrong with them."""

    def __init__(self, root: Node, path: Path, problems: list[Problem], changes: str) -> None:
        super().__init__(problems)
        self.root = root
        self.path = path
        self.changes = changes  # the file that marks name where a value is a change of the run file

    def config(self) -> RunConfig:
        """The run file."""
        sections = self.entries(self.root, SECTIONS, "")
        output = self.entries(sections["output"], ("directory", "layout", "size", "meshes"), "output")
        proof = self.entries(sections["proof"], ("poses", "first", "every"), "proof")
        sample = self.entries(sections["sample"], ("first", "every"), "sample")
        report = self.entries(sections["report"], ("html", "directory"), "report")
        layout = self.layout(output)
        mesh_prefix, mesh_conversion = self.mesh_copies(output.get("meshes"), layout)
        return RunConfig(
            inputs=tuple(self._inputs(sections["inputs"])),
            transform=self._call(sections["transform"], "transform") or StageCall(),
            edits=tuple(self._calls(sections["edits"], "edits", is_named=True, repeats=True)),
            emitters=tuple(self._calls(sections["emitters"], "emitters", needed="something must be written")),
            loaders=tuple(self._calls(sections["loaders"], "loaders", ("optional",), is_named=True)),
            execution=self._call(sections["execution"], "execution", ("time_limit",)) or StageCall(),
            output=self._place(output.get("directory"), "output.directory") or self._usual_output(),
            layout=layout,
            cells=CellsReader(self.problems).read(sections["cells"]),
            variations=VariationsReader(self.problems).read(sections["variations"]),
            meshes=MeshesReader(self.problems, self._folder(sections["meshes"])).read(sections["meshes"]),
            mesh_prefix=mesh_prefix,
            mesh_conversion=mesh_conversion,
            poses=self.whole(proof.get("poses"), "proof.poses", 1, MAX_POSES, DEFAULT_POSES),
            proved=self.sample(proof, "proof", Sample()),
            sample=self.sample(sample, "sample", DEFAULT_SAMPLE),
            time_limit=self.seconds(sections["execution"]),
            html=self.switch(report.get("html"), "report.html", default=True),
            folder=self.path.parent,
            reports=self._place(report.get("directory"), "report.directory"),
            problems=tuple(self.problems),
        )

    def _inputs(self, section: Node) -> Iterator[InputCall]:
        entries = section.value if isinstance(section.value, list) else []
        if not entries:
            self.say(
                "there is nothing to read",
                section,
                "inputs",
                accepted="at least one table, such as `inputs: [{path: tables/ur5.csv}]`",
            )
        for index, node in enumerate(entries):
            field = f"inputs.{index}"
            given = self.entries(node, ("path", "stage", "options", "calibration"), field)
            path = self._path_text(given.get("path"), f"{field}.path")
            if "path" not in given and isinstance(node.value, dict):
                self.say("this input has no path", node, field, accepted="`path: FILE`, where FILE may be a pattern")
            if path is None:
                continue
            notices: list[Problem] = []
            yield InputCall(
                paths=tuple(self._files(*path, f"{field}.path", notices)),
                stage=self.name(given.get("stage"), f"{field}.stage"),
                options=self._input_options(given, field),
                mark=given.get("stage", given["path"]).mark,
                notices=tuple(notices),
            )

    def _input_options(self, given: dict[str, Node], field: str) -> Node | None:
        """The options of an input's reader, with its calibration among them."""
        options = self._options(given.get("options"), f"{field}.options")
        if (node := given.get("calibration")) is None:
            return options
        if self._path_text(node, f"{field}.calibration") is None:
            return options
        others = options.value if options and isinstance(options.value, dict) else {}
        if "calibration" in others:
            self.say("the calibration is given twice, here and among the options", node, f"{field}.calibration")
        return _mapping({**others, "calibration": node}, options or node)

    def _calls(
        self,
        section: Node,
        field: str,
        others: tuple[str, ...] = (),
        *,
        needed: str = "",
        is_named: bool = False,
        repeats: bool = False,
    ) -> Iterator[StageCall]:
        """The stages of a list; `repeats` says that one may be in it several times, with other options."""
        entries = section.value if isinstance(section.value, list) else []
        if needed and not entries:
            self.say(f"the list is empty, and {needed}", section, field, accepted="at least one stage")
        seen: dict[str, Mark | None] = {}
        for index, node in enumerate(entries):
            call = self._call(node, f"{field}.{index}", others, is_named=is_named)
            if call is None:
                continue
            if call.stage is None or repeats:
                yield call
                continue
            if call.stage in seen:
                self.say(
                    f"the stage {shown(call.stage)} stands twice: both would make the same files",
                    node,
                    field,
                    accepted="each stage once",
                    suggestion=f"it stands first at {seen[call.stage]}",
                )
                continue
            seen[call.stage] = call.mark
            yield call

    def _call(
        self, node: Node, field: str, others: tuple[str, ...] = (), *, is_named: bool = False
    ) -> StageCall | None:
        """One stage and its options; None where something is wrong with what says which."""
        before = len(self.problems)
        given = self.entries(node, ("stage", "options", *others), field)
        if is_named and "stage" not in given and len(self.problems) == before:
            self.say("it is not said which stage is meant", node, field, accepted="`stage: NAME`")
        name = self.name(given.get("stage"), f"{field}.stage")
        is_clear = name is not None or not (is_named or "stage" in given)
        options = self._options(given.get("options"), f"{field}.options")
        optional = self.switch(given.get("optional"), f"{field}.optional", default=False)
        mark = given.get("stage", node).mark
        return StageCall(stage=name, options=options, mark=mark, optional=optional) if is_clear else None

    def _options(self, node: Node | None, field: str) -> Node | None:
        if node is None or node.value is None:
            return None
        if isinstance(node.value, dict):
            return node
        self.say(f"options cannot be {node.describe()}", node, field, accepted="a mapping such as {frames: dh}")
        return None

    # --- Paths

    def _path_text(self, node: Node | None, field: str) -> tuple[str, Node] | None:
        text = self.name(node, field)
        if node is None or text is None:
            return None
        if "\0" in text:
            self.say("a path cannot hold the character U+0000", node, field)
            return None
        if (found := _SHELL.search(text)) and (found.start() == 0 or found[0].startswith("$")):
            self.say(
                f"nothing takes the place of {shown(found[0])} in a path of a run file",
                node,
                field,
                accepted="an absolute path, or one from the run file's folder",
            )
            return None
        return text, node

    def _usual_output(self) -> Path:
        return self.path.parent / "build" / self.path.stem

    def _place(self, node: Node | None, field: str) -> Path | str | None:
        """A folder or an address, where one is given."""
        directory = self._path_text(node, field)
        if directory is None:
            return None
        return directory[0] if "://" in directory[0] else self._resolved(*directory)

    def _resolved(self, text: str, node: Node) -> Path:
        """A path of the run file is relative to it, one of a change to the working directory."""
        return tidy_path(self._folder(node) / text)

    def _folder(self, node: Node) -> Path:
        return Path() if node.file == self.changes else self.path.parent

    def _files(self, text: str, node: Node, field: str, notices: list[Problem]) -> Iterator[Path]:
        """The files of a path or pattern, in the order of their names."""
        path = self._resolved(text, node)
        if not glob.has_magic(text) or os.path.exists(path):  # noqa: PTH110 - it takes any text; Path.exists raises
            paths = [path]
        else:
            try:
                found = matching(self._folder(node), text)
            except ConfigError as error:
                why = error.problems[0]
                self.say(why.message, node, field, accepted=why.accepted, suggestion=why.suggestion)
                return
            paths = [tidy_path(path) for path in found.paths]
            if found.notice:
                notices.append(found.notice.about(mark=node.mark))
        for file in paths:
            try:
                check_file(file)
            except ConfigError as error:
                why = error.problems[0]
                self.say(f"{shown(str(file), LONG_PATH)}: {why.message}", node, field, suggestion=why.suggestion)
            else:
                yield file
