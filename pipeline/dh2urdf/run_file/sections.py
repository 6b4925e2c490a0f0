"""The sections of a run file and their keys, each declared once: what reads it, and what its JSON Schema is made of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.documents.document import Node, expect_mapping
from dh2urdf.errors import ConfigError
from dh2urdf.meshes.conversion import ACCEPTED, conversion_of
from dh2urdf.meshes.files import FILE, RELATIVE, prefix_of
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.output.layouts import DEFAULT_SIZE, LARGEST, Form, Layout
from dh2urdf.run_file.cell_section import CELLS
from dh2urdf.run_file.mesh_section import MESHES
from dh2urdf.run_file.records import (
    DEFAULT_POSES,
    DEFAULT_SAMPLE,
    OutputSection,
    ProofSection,
    ReportSection,
    RunConfig,
)
from dh2urdf.run_file.stage_records import InputRecord, StageRecord
from dh2urdf.run_file.validator import Distinct, Key, Many, Record, mapping_node, naming
from dh2urdf.run_file.value_types import DIRECTORY, MOST, SWITCH, seconds, text, whole, word
from dh2urdf.run_file.variation_section import VARIATIONS
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.source import Mark


MAX_POSES = 1_000_000
"""Random joint vectors of one proof."""
NO_INPUT = ("there is nothing to read", "at least one table, such as `inputs: [{path: tables/ur5.csv}]`")
NO_EMITTER = ("the list is empty, and something must be written", "at least one stage")
ONCE = Distinct("stage", "the stage {} stands twice: both would make the same files", "each stage once")


# --- Output -----------------------------------------------------------------------------------------------------------


def _mesh_output(names: str = RELATIVE, convert: str = MeshConversion.NEVER) -> tuple[str, MeshConversion]:
    """How descriptions name meshes, and what becomes of these."""
    with naming("names"):
        prefix = prefix_of(names)
    with naming("convert"):
        return names, conversion_of(convert, prefix)


def _output(
    directory: Path | str | None = None,
    layout: str = Form.FILES,
    size: int = DEFAULT_SIZE,
    meshes: tuple[str, MeshConversion] = (RELATIVE, MeshConversion.NEVER),
    *,
    size_mark: Mark | None = None,
) -> OutputSection:
    form = Form(layout)
    if size_mark and form is Form.FILES:
        message = "all files go into one folder, which has no size"
        accepted = f"a size with layout: {Form.FOLDERS} or layout: {Form.SHARDS}"
        raise ConfigError(Problem(message=message, field="size", accepted=accepted))
    return OutputSection(
        directory=directory,
        layout=Layout(form=form, size=size),
        mesh_prefix=prefix_of(meshes[0], in_folders=form is Form.FOLDERS),
        mesh_conversion=meshes[1],
    )


OUTPUT = Record(
    _output,
    {
        "directory": Key(DIRECTORY, "a folder, from that of the run file, or an address such as s3://bucket/prefix"),
        "layout": Key(word(*Form), "one folder, folders of `size` manipulators, or tar shards of as many"),
        "size": Key(whole(1, LARGEST), "manipulators in one folder or shard"),
        "meshes": Key(
            Record(
                _mesh_output,
                {
                    "names": Key(
                        text(pattern=f"^({RELATIVE}|{FILE}|package://.+)$", null_is_absent=True),
                        "how descriptions name mesh files: relative, file or package://NAME",
                    ),
                    "convert": Key(text(enum=list(MeshConversion), null_is_absent=True), ACCEPTED),
                },
                short="names",
                null_is_absent=True,
            )
        ),
    },
    short="directory",
    marks={"size_mark": ("size",)},
)


# --- How much ---------------------------------------------------------------------------------------------------------


def _proof(poses: int = DEFAULT_POSES, first: int = Sample().first, every: int = Sample().every) -> ProofSection:
    return ProofSection(poses=poses, proved=Sample(first=first, every=every))


def _sample(first: int = DEFAULT_SAMPLE.first, every: int = DEFAULT_SAMPLE.every) -> Sample:
    return Sample(first=first, every=every)


def _sample_keys(what: str) -> dict[str, Key]:
    """The keys of a sample: the first manipulators of the run, and some of the rest."""
    return {
        "first": Key(whole(0, MOST), f"so many manipulators at the beginning of the run {what}"),
        "every": Key(whole(1, MOST), f"n, for every n-th of the other {what}"),
    }


PROOF = Record(
    _proof,
    {
        "poses": Key(whole(1, MAX_POSES), "random joint vectors at which each file is compared with its table"),
        **_sample_keys("are compared with their tables"),
    },
)
SAMPLE = Record(_sample, _sample_keys("go through expansion of xacro and simulators"))
REPORT = Record(
    ReportSection,
    {
        "html": Key(SWITCH, "whether report.html is written, where jinja2 and matplotlib are installed"),
        "directory": Key(
            DIRECTORY,
            "where report, manifest and index go: a folder or an address; by default that of the output, or "
            "one beside it where the output is folders of packages",
        ),
    },
)


# --- The run file -----------------------------------------------------------------------------------------------------

TRANSFORM = StageRecord("transform", "what makes a robot of a table")
EDIT = StageRecord("edit", "what changes the tables before, or the robots after", is_named=True)
EMITTER = StageRecord("emitter", "what writes files")
LOADER = StageRecord(
    "loader",
    "what loads the files",
    is_named=True,
    optional=Key(SWITCH, "whether a refusal, or a missing program, is a notice and fails nothing", is_vital=False),
)
EXECUTION = StageRecord(
    "executor",
    "what does the work",
    time_limit=Key(
        seconds("seconds that one manipulator may take"),
        "seconds that one manipulator may take, simulators aside",
        is_vital=False,
    ),
)
_SECTIONS = {
    "inputs": Key(Many(InputRecord(), empty=NO_INPUT), "the tables that are read", missing=NO_INPUT),
    "cells": Key(CELLS, "robots of several arms, with one root; none by default"),
    "variations": Key(VARIATIONS, "manipulators drawn from others; none by default"),
    "meshes": Key(MESHES, "mesh files that links are seen as and touch with; none by default"),
    "transform": Key(TRANSFORM, "what makes a robot of a table"),
    "edits": Key(
        Many(EDIT),
        "what changes the tables before the transform, or the robots after it, in order; none by default",
    ),
    "emitters": Key(Many(EMITTER, empty=NO_EMITTER, distinct=ONCE), "what writes files"),
    "loaders": Key(Many(LOADER, distinct=ONCE), "what loads the files; none by default"),
    "output": Key(OUTPUT, "where the output goes: a folder or an address, alone or with its layout"),
    "execution": Key(EXECUTION, "what does the work"),
    "proof": Key(PROOF, "how much is compared with the tables; all by default"),
    "sample": Key(SAMPLE, "how much goes through what is slow"),
    "report": Key(REPORT, "what is reported of the run"),
}
RUN_FILE = Record(RunConfig, {name: section._replace(is_vital=False) for name, section in _SECTIONS.items()})
"""The whole file. A section that is wrong has its defaults, so that the stages of the others are looked at too."""
SECTIONS = tuple(RUN_FILE.keys)


def written_out(root: Node) -> Node:
    """A run file with every list and mapping written out: `emitters: urdf` is `emitters: [{stage: urdf}]`.

    Sections that are absent or empty get their defaults, so that `--set` finds them.
    """
    given = {key: node for key, node in expect_mapping(root, "a run file").items() if node.value is not None}
    for name, key in RUN_FILE.keys.items():
        may_be_empty = isinstance(key.kind, Many) and name != "emitters"
        default = Node([], root.file, root.line, root.column) if may_be_empty else mapping_node({}, root)
        given[name] = key.kind.long_form(given.get(name, default))
    return mapping_node(given, root)
