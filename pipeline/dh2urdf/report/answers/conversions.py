"""What became of conversions: one line for a person, plain data for a program."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Final

from dh2urdf._version import __version__
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import BASE as BASE_LINK, JointType
from dh2urdf.source import Problem, printable

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from dh2urdf.commands.convert import Conversion
    from dh2urdf.errors import Dh2UrdfError
    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.results import ConversionEntry, ConversionsReport, ConvertedFileEntry
    from dh2urdf.robot import Robot

SCHEMA: Final = "dh2urdf-conversions/1"
"""Name and version of the form of what `dh2urdf convert --json` prints."""
BASE = "the base"
FILLED_IN = ("types", "masses", "centres of mass", "inertias", "limits", "velocities", "efforts")
"""What may be filled in where a table says nothing."""
_LIMITS = {"limits": ("lower", "upper"), "velocities": ("velocity",), "efforts": ("effort",)}
_ONE = {
    "types": "type",
    "masses": "mass",
    "centres of mass": "centre of mass",
    "inertias": "inertia",
    "velocities": "velocity",
    "efforts": "effort",
}


def filled_in(manipulator: Manipulator, robot: Robot, untyped: Sequence[str] = ()) -> dict[str, tuple[str, ...]]:
    """What was filled in where the table says nothing: the joints or links concerned, by what it is.

    A centre of mass and an inertia that go with a mass that was filled in are not told again.

    Args:
        manipulator: the table.
        robot: what was made of it.
        untyped: names of joints whose type the table does not say.
    """
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
        "centres of mass": [row.link for row in weighed if row.com is None],
        "inertias": [row.link for row in weighed if row.inertia is None],
    }
    for what, bounds in _LIMITS.items():
        found[what] = [
            row.joint
            for row, joint in moving
            if any(getattr(row.limits, each) is None and getattr(joint.limits, each) is not None for each in bounds)
        ]
    return {what: tuple(found[what]) for what in FILLED_IN if found[what]}


def closing_line(conversion: Conversion, place: str) -> str:
    """One line about a conversion: the arm, its joints, the largest error of the proof, and what was filled in.

    Args:
        conversion: what became of the table.
        place: where the description is.
    """
    manipulator = conversion.manipulator
    parts = [f"{manipulator.name}: {joints_in_words(manipulator.rows)}", _proof_in_words(conversion)]
    if filled := _filled(conversion):
        parts.append(f"filled in: {_filled_in_words(filled, conversion.robot)}")
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


def _proof_in_words(conversion: Conversion) -> str:
    proofs = [proof for proof in conversion.proofs.values() if proof]
    if not proofs:
        return "not proved: the format cannot be read back"
    worst = max(proofs, key=lambda proof: (proof.position_error, proof.angle_error))
    angle = max(proof.angle_error for proof in proofs)
    error = f"{worst.position_error:.2g} m and {angle:.2g} rad"
    if not conversion.keeps_kinematics:
        return f"up to {error} from the table: this transform does not keep the kinematics"
    return f"proved at {counted(worst.poses, 'pose')}, largest error {error}"


def _filled_in_words(filled: Mapping[str, Sequence[str]], robot: Robot) -> str:
    words = []
    for what, names in filled.items():
        of = "link" if what in ("masses", "centres of mass", "inertias") else "joint"
        count = len([name for name in names if name != BASE])
        whose = [counted(count, of)] if count else []
        whose += [BASE] if BASE in names else []
        travels = _travels(robot, names) if what == "limits" else ""
        words.append(f"{_ONE.get(what, what) if len(names) == 1 else what} of {' and '.join(whose)}{travels}")
    return ", ".join(words)


def _travels(robot: Robot, names: Sequence[str]) -> str:
    """The limits of those of some joints that are prismatic: each arm has others."""
    slides = [joint.limits for joint in robot.joints if joint.type is JointType.PRISMATIC and joint.name in names]
    found = dict.fromkeys(f"{limits.lower:.9g} to {limits.upper:.9g} m" for limits in slides)
    return f" (prismatic: {', '.join(found)})" if found else ""


# --- For programs -----------------------------------------------------------------------------------------------------


def conversions_report(rows: Sequence[ConversionEntry]) -> ConversionsReport:
    """What `dh2urdf convert --json` prints, of one table or several."""
    failed = any(row["status"] == "failed" for row in rows)
    return {"schema": SCHEMA, "version": __version__, "exit_status": 1 if failed else 0, "conversions": list(rows)}


def conversion_row(conversion: Conversion, source: str, directory: Path | None) -> ConversionEntry:
    """What became of a table that was converted.

    Args:
        conversion: what became of it.
        source: the table.
        directory: the folder of the files; None where they were not written, and their contents are in the answer.

    Raises:
        ConfigError: a file that was not written is no text.
    """
    from hashlib import sha256

    from dh2urdf.conversion.outcome import proof_facts

    manipulator = conversion.manipulator
    files: list[ConvertedFileEntry] = []
    for written in conversion.written:
        for file in written.files:
            entry: ConvertedFileEntry = {
                "path": file.name if directory is None else str(directory / file.name),
                "stage": written.stage,
                "bytes": len(file.content),
                "sha256": sha256(file.content).hexdigest(),
            }
            if directory is None:
                entry["content"] = _text_of(file.content, written.stage)
            files.append(entry)
    filled: Any = {what.replace(" ", "_"): list(names) for what, names in _filled(conversion).items()}
    return {
        "source": source,
        "status": "ok",
        "kind": None,
        "name": manipulator.name,
        "convention": manipulator.convention.value,
        "joints": [{"name": row.joint, "type": row.type.value} for row in manipulator.rows],
        "files": files,
        "keeps_kinematics": conversion.keeps_kinematics,
        "proof": {stage: proof_facts(proof) if proof else None for stage, proof in conversion.proofs.items()},
        "filled_in": filled,
        "notices": [notice.as_json() for notice in conversion.notices],
        "errors": [],
    }


def _text_of(content: bytes, stage: str) -> str:
    try:
        return content.decode()
    except UnicodeDecodeError:
        message = f"the files of the emitter {stage!r} are no text, which JSON cannot hold"
        raise ConfigError(Problem(message=message, accepted="-o FILE, beside --json")) from None


def _filled(conversion: Conversion) -> dict[str, tuple[str, ...]]:
    return filled_in(conversion.manipulator, conversion.robot, conversion.untyped)


def failed_row(source: str, kind: str, error: Dh2UrdfError) -> ConversionEntry:
    """What became of a table that could not be converted.

    Args:
        source: the table.
        kind: of what kind the failure is.
        error: what was raised.
    """
    return {
        "source": source,
        "status": "failed",
        "kind": kind,
        "name": None,
        "convention": None,
        "joints": [],
        "files": [],
        "keeps_kinematics": True,
        "proof": {},
        "filled_in": {},
        "notices": [notice.as_json() for notice in getattr(error, "notices", ())],
        "errors": [problem.as_json() for problem in getattr(error, "problems", ())],
    }
