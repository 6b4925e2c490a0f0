"""What became of conversions: one line for a person, plain data for a program; and what `--json` prints of an error."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final

from dh2urdf._version import __version__
from dh2urdf.errors import ConfigError, PluginError
from dh2urdf.manipulator import BASE as BASE_LINK, JointType
from dh2urdf.source import Messages, Problem, printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from dh2urdf.commands.convert import Conversion
    from dh2urdf.errors import Dh2UrdfError
    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.results import ConversionEntry, ConversionsReport, ErrorReport
    from dh2urdf.robot import Robot

say = Messages(__file__)

SCHEMA: Final = "dh2urdf-conversions/1"
ERROR_SCHEMA: Final = "dh2urdf-error/1"
BASE = "the base"
FILLED_IN = {
    "types": "type",
    "masses": "mass",
    "centres of mass": "centre of mass",
    "inertias": "inertia",
    "limits": "limits",
    "velocities": "velocity",
    "efforts": "effort",
}
"""What may be filled in where a table says nothing, and the word for one of them."""
_LIMITS = {"limits": ("lower", "upper"), "velocities": ("velocity",), "efforts": ("effort",)}


def _filled_in(conversion: Conversion) -> dict[str, tuple[str, ...]]:
    """What was filled in of a conversion, where its table says nothing after the edits."""
    robot = conversion.robot
    return filled_in(robot.manipulator or conversion.manipulator, robot, conversion.untyped)


def filled_in(manipulator: Manipulator, robot: Robot, untyped: Sequence[str] = ()) -> dict[str, tuple[str, ...]]:
    """The joints or links for which the table says nothing, by what was filled in; `untyped` joints have no type."""
    bodies = {link.name for link in robot.links if link.inertial}
    weighs = {link.name for link in robot.links if link.inertial and link.inertial.mass}
    rows = [row for row in manipulator.rows if row.link in bodies]
    weighed = [row for row in rows if row.mass is not None]
    joints = {joint.name: joint for joint in robot.joints}
    moving = [(row, joints[row.joint]) for row in manipulator.moving_rows if row.joint in joints]
    base = [BASE] if manipulator.base_mass is None and not weighs.isdisjoint((robot.root, BASE_LINK)) else []
    found = {
        "types": list(untyped),
        "masses": [*(row.link for row in rows if row.mass is None), *base],
        # What goes with a mass that was filled in is not told again.
        "centres of mass": [row.link for row in weighed if row.com is None],
        "inertias": [row.link for row in weighed if row.inertia is None],
    }
    for what, bounds in _LIMITS.items():
        found[what] = [
            row.joint
            for row, joint in moving
            if any(getattr(row.limits, each) is None and getattr(joint.limits, each) is not None for each in bounds)
        ]
    return {what: tuple(names) for what, names in found.items() if names}


def closing_line(conversion: Conversion, place: str) -> str:
    """One line about a conversion to a place: the arm, its joints, the proof, and what was filled in."""
    manipulator, robot = conversion.manipulator, conversion.robot
    proofs = [written.proof for written in conversion.written if written.proof]
    proved = "not proved: the format cannot be read back"
    if proofs:
        worst = max(proofs, key=attrgetter("position_error", "angle_error"))
        error = f"{worst.position_error:.2g} m and {max(proof.angle_error for proof in proofs):.2g} rad"
        proved = f"proved at {counted(worst.poses, 'pose')}, largest error {error}"
        if not conversion.keeps_kinematics:
            proved = f"up to {error} from the table: this transform does not keep the kinematics"
    parts = [f"{manipulator.name}: {joints_in_words(manipulator.rows)}", proved]
    words = []
    for what, names in _filled_in(conversion).items():
        of = "link" if what in ("masses", "centres of mass", "inertias") else "joint"
        count = len([name for name in names if name != BASE])
        whose = [*([counted(count, of)] if count else []), *([BASE] if BASE in names else [])]
        travels: dict[str, None] = {}
        if what == "limits":  # The limits of those that slide: each arm has others.
            slides = [each.limits for each in robot.joints if each.type is JointType.PRISMATIC and each.name in names]
            travels = dict.fromkeys(f"{limits.lower:.9g} to {limits.upper:.9g} m" for limits in slides)
        told = f" (prismatic: {', '.join(travels)})" if travels else ""
        words.append(f"{FILLED_IN[what] if len(names) == 1 else what} of {' and '.join(whose)}{told}")
    if words:
        parts.append(f"filled in: {', '.join(words)}")
    return printable(f"{'; '.join(parts)}; written to {place}")


def joints_in_words(rows: Sequence[DHRow]) -> str:
    """How many joints some rows are, and of which types, such as ``4 joints (3 revolute, 1 prismatic)``."""
    counts = Counter(row.type for row in rows)
    if len(counts) == 1:
        return counted(len(rows), f"{rows[0].type} joint")
    kinds = ", ".join(f"{counts[kind]} {kind}" for kind in JointType if counts[kind])
    return f"{counted(len(rows), 'joint')} ({kinds})"


def counted(count: int, noun: str) -> str:
    """A number of things, such as ``1 joint`` and ``2 joints``."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


# --- For programs -----------------------------------------------------------------------------------------------------


def error_report(kind: str, exit_status: int, error: BaseException, message: str) -> ErrorReport:
    """What `--json` prints where a command fails; `message` is what is wrong where the error has no problems.

    The code of an error without problems is its kind; of one about the words of a command, click's name for it, such
    as ``no-such-option``.
    """
    from dh2urdf.conversion.outcome import kind_of

    problems: Sequence[Problem] = getattr(error, "problems", ())
    if not problems:
        code = (kind_of(error) if kind == "usage" and isinstance(error, Exception) else kind).replace(" ", "-")
        problem = error.problem if isinstance(error, PluginError) else Problem(message=message)
        problems = [replace(problem, code=code)]
    return {
        "schema": ERROR_SCHEMA,
        "version": __version__,
        "exit_status": exit_status,
        "kind": kind,
        "errors": [problem.as_json() for problem in problems],
        "notices": [notice.as_json() for notice in getattr(error, "notices", ())],
    }


def conversions_report(rows: Sequence[ConversionEntry]) -> ConversionsReport:
    """What `dh2urdf convert --json` prints, of one table or several."""
    failed = any(row["status"] == "failed" for row in rows)
    return {"schema": SCHEMA, "version": __version__, "exit_status": 1 if failed else 0, "conversions": list(rows)}


def conversion_row(conversion: Conversion, source: str, directory: Path | None) -> ConversionEntry:
    """What became of a table that was converted, with the contents of the files where there is no folder for them."""
    from hashlib import sha256

    from dh2urdf.conversion.outcome import proof_facts

    manipulator = conversion.manipulator
    files: list[Any] = []
    for stage, file in [(written.stage, file) for written in conversion.written for file in written.files]:
        name = file.name if directory is None else str(directory / file.name)
        digest = sha256(file.content).hexdigest()
        files.append({"path": name, "stage": stage, "bytes": len(file.content), "sha256": digest})
        if directory is None:
            try:
                files[-1]["content"] = file.content.decode()
            except UnicodeDecodeError:
                raise ConfigError(say("binary-in-json", emitter=stage)) from None
    told = _filled_in(conversion)
    filled: Any = {what.replace(" ", "_"): list(names) for what, names in told.items()}
    return {
        **_row(source, conversion.notices),
        "name": manipulator.name,
        "convention": manipulator.convention.value,
        "joints": [{"name": row.joint, "type": row.type.value} for row in manipulator.rows],
        "files": files,
        "keeps_kinematics": conversion.keeps_kinematics,
        "proof": {stage: proof_facts(proof) if proof else None for stage, proof in conversion.proofs.items()},
        "filled_in": filled,
    }


def failed_row(source: str, kind: str, error: Dh2UrdfError) -> ConversionEntry:
    """What became of a table that could not be converted, for a reason of some kind."""
    errors = [problem.as_json() for problem in getattr(error, "problems", ())]
    return {**_row(source, getattr(error, "notices", ())), "status": "failed", "kind": kind, "errors": errors}


def _row(source: str, notices: Iterable[Problem]) -> ConversionEntry:
    """What a table has of which nothing is known but notices."""
    return {
        "source": source,
        "status": "ok",
        "kind": None,
        "name": None,
        "convention": None,
        "joints": [],
        "files": [],
        "keeps_kinematics": True,
        "proof": {},
        "filled_in": {},
        "notices": [notice.as_json() for notice in notices],
        "errors": [],
    }
