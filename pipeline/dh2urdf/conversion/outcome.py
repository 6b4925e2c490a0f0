"""What became of one manipulator, and its row in the manifest."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass, field
from hashlib import sha256
from math import isfinite
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import orjson

from dh2urdf.conversion.one_manipulator import Written
from dh2urdf.manipulator import MeshFile
from dh2urdf.meshes.files import copy_path
from dh2urdf.source import Problem
from dh2urdf.stages import LoadReport
from dh2urdf.variations.laws import DrawnValue

if TYPE_CHECKING:
    from dh2urdf.kinematics.proof import Proof
    from dh2urdf.results import FileEntry, LoadEntry, ManipulatorEntry, ProofEntry

ManifestRow: TypeAlias = "ManipulatorEntry"
"""A row of the manifest."""
_LINE = orjson.OPT_APPEND_NEWLINE | orjson.OPT_NON_STR_KEYS
Status: TypeAlias = Literal["ok", "failed", "planned"]
NotLoaded: TypeAlias = Literal["not in the sample", "no file"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What came of a loader.

    Attributes:
        report: what the simulator says; without any measurement where it failed.
        status: passed, failed, or missing where it is not installed.
        optional: whether a failure of it is a notice.
        errors: why it failed.
    """

    report: LoadReport
    status: Literal["passed", "failed", "missing"] = "passed"
    optional: bool = False
    errors: tuple[Problem, ...] = ()

    def entry(self) -> LoadEntry:
        """It as plain data."""
        told = {"verdict": self.status, "optional": self.optional}
        problems = {"errors": [error.as_json() for error in self.errors]}
        findings = {"findings": [finding.as_json() for finding in self.report.findings]}
        entry: Any = {**told, **problems, **asdict(self.report), **findings}
        facts: LoadEntry = orjson.loads(to_line(entry))  # A loader may have put anything in there.
        return facts  # `test_a_loaders_report_is_described_as_it_is` compares the fields.


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of one manipulator, cell or variant.

    Attributes:
        name: its name.
        status: ok, failed, or planned where the run only looked.
        source: the file it comes from.
        kind: of what kind its failure is, such as ``proof``.
        drawn: what was drawn for it, by field and joint: ``a_2`` [SI].
        was_read: whether there was a manipulator at all.
        keeps_kinematics: whether its transform keeps T(q).
        written: what each emitter made.
        loads: what came of each loader that was asked, by its name.
        not_loaded: why others were not, by their names.
        pictures: the pictures that simulators took, by their names.
        meshes: the mesh files that its files name by their copies.
        tools: the links of attachments that are tools in place of tool0.
        notices: what a careful person would want to know.
        errors: why it failed.
        traceback: where a stage failed, for ``--debug``.
        seconds: how long each step took [s].
    """

    name: str
    status: Status
    source: str
    kind: str | None = None
    drawn: dict[str, DrawnValue] = field(default_factory=dict)
    was_read: bool = True
    keeps_kinematics: bool = True
    written: tuple[Written, ...] = ()
    loads: dict[str, Verdict] = field(default_factory=dict)
    not_loaded: dict[str, NotLoaded] = field(default_factory=dict)
    pictures: dict[str, bytes] = field(default_factory=dict)
    meshes: tuple[MeshFile, ...] = ()
    tools: tuple[str, ...] = ()
    notices: tuple[Problem, ...] = ()
    errors: tuple[Problem, ...] = ()
    traceback: str = ""
    seconds: dict[str, float] = field(default_factory=dict)

    def row(self, key: str, files: list[FileEntry]) -> ManifestRow:
        """Its row in the manifest: all that is known of it, and no duration.

        Args:
            key: what its files depend on, as a hash.
            files: where its files are.
        """
        row: ManifestRow = {
            "name": self.name,
            "status": self.status,
            "kind": self.kind,
            "source": self.source,
            "key": key,
            "drawn": self.drawn,
            "keeps_kinematics": self.keeps_kinematics,
            "files": files,
            "proof": {each.stage: proof_facts(each.proof) if each.proof else None for each in self.written},
            "loaders": {name: verdict.entry() for name, verdict in self.loads.items()},
            "notices": [problem.as_json() for problem in self.notices],
            "errors": [problem.as_json() for problem in self.errors],
        }
        if self.meshes:
            row["meshes"] = [{"path": copy_path(file), "sha256": file.sha256} for file in self.meshes]
        if self.tools:
            row["tools"] = [*self.tools]
        if self.pictures:
            row["pictures"] = {name: sha256(picture).hexdigest() for name, picture in self.pictures.items()}
        if self.not_loaded:
            row["not_loaded"] = self.not_loaded
        return row


def kind_of(error: Exception) -> str:
    """Of what kind a failure is: the words of its class, such as ``time limit`` of `TimeLimitError`."""
    words = re.findall("[A-Z][a-z0-9]*", type(error).__name__.removesuffix("Error"))
    return " ".join(words).lower()


def to_line(data: Any) -> bytes:  # noqa: ANN401 - plain data
    """Return plain data as one line of JSON."""
    return _encoded(data, _LINE)


def to_text(data: Any) -> bytes:  # noqa: ANN401 - plain data
    """Return plain data as indented JSON with a newline at its end."""
    return _encoded(data, _LINE | orjson.OPT_INDENT_2)


def _encoded(data: Any, option: int) -> bytes:  # noqa: ANN401 - plain data
    try:
        return orjson.dumps(data, option=option)
    except orjson.JSONEncodeError:
        return orjson.dumps(_in_utf_8(data), option=option)


def _in_utf_8(value: Any) -> Any:  # noqa: ANN401 - plain data
    """Return the same data, lone surrogates spelled out: the name of a file may hold bytes that are no UTF-8."""
    if isinstance(value, str):
        return value.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(value, dict):
        return {_in_utf_8(key): _in_utf_8(entry) for key, entry in value.items()}
    return [_in_utf_8(entry) for entry in value] if isinstance(value, (list, tuple)) else value


def proof_facts(proof: Proof) -> ProofEntry:
    """What a manifest declares about a proof."""
    row: ProofEntry = {
        "position_error": _finite(proof.position_error),
        "angle_error": _finite(proof.angle_error),
        "q": list(proof.q),
        "tolerance": proof.tolerance,
        "poses": proof.poses,
    }
    if len(proof.tips) > 1:  # a cell
        row["tip"], row["tips"] = proof.tip, {tip: _finite(error) for tip, error in proof.tips.items()}
    return row


def _finite(number: float) -> float | None:
    return number if isfinite(number) else None
