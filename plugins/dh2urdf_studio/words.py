"""What the studio says: texts of a session for its page, and numbers with as many digits as count."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.quantities import UNITS, number_in
from dh2urdf.source import listed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.quantities.units import Unit
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.opening import Opened
    from dh2urdf_studio.editing.reading import CellProblem
    from dh2urdf_studio.editing.session import Session

MOST_LOST = 6  # what a table cannot hold, or what was lost, as far as it is reported
USUAL = 6  # digits behind the point of a number that a person reads or changes, where its arm is not small
_SMALL = 0.1  # of an arm that is smaller [m], lengths have more digits


def decimals(length: Unit, reach: float) -> int:
    """The digits behind the point of a length in a unit, for an arm with a reach [m]."""
    more = math.ceil(math.log10(_SMALL / reach)) if 0.0 < reach < _SMALL else 0
    return max(2, 5 + min(0, length.power) + more)


def plain(number: float, digits: int) -> str:
    """A number with some digits behind the point, and without a minus before a zero."""
    text = f"{number:.{digits}f}"
    return text.lstrip("-") if float(text) == 0 else text


def short(number: float, digits: int) -> str:
    """The same without zeros at its end; with more digits than is usual, as many as count."""
    text = plain(number, digits).rstrip("0").rstrip(".")
    return text if digits <= USUAL else f"{float(text):.{USUAL}g}"


def count(number: int, one: str, many: str) -> str:
    """A number of things."""
    return f"{number} {one if number == 1 else many}"


def unseen(files: Sequence[str], so: str = "") -> str:
    """The message about mesh files that are not there."""
    told = count(len(files), "mesh file was not found", "mesh files were not found")
    return f"{told}{so}: {listed(files, MOST_LOST)}"


def status(session: Session, errors: int) -> tuple[str, str]:
    """The state of the table in a line, and whether it is good or bad."""
    rows, waiting = len(session.table.rows), session.reading.waiting
    if errors:
        told = count(errors, "problem", "problems")
        return (f"{told}; the last good arm is shown" if session.arm else told), "bad"
    if not rows:
        return "choose the number of axes, or paste a table", ""
    if not session.table.convention and waiting == rows:
        return "choose the convention: standard (Denavit-Hartenberg, Spong) or modified (Craig)", ""
    if waiting:
        done = rows - waiting
        which = f"row {rows} is" if waiting == 1 else f"rows {done + 1} to {rows} are"
        shown = f"; the arm of the {'first row' if done == 1 else f'first {done} rows'} is shown" if done else ""
        return f"{which} still empty{shown}", ""
    moving = len(session.moving_rows)
    fixed = f" and {count(rows - moving, 'fixed joint', 'fixed joints')}" if rows > moving else ""
    edited = f" with {count(len(session.arm_edits), 'edit', 'edits')}" if session.arm_edits else ""
    return f"{count(moving, 'axis', 'axes')}{fixed}; the arm is the table's{edited}", "good"


def remarks(opened: Opened) -> list[str]:
    """What a person should know of a table that was opened."""
    lost = f"The studio's table has no place for {listed(opened.lost, MOST_LOST)}: what is made here is without."
    return [*([lost] if opened.lost else ()), *opened.notices]


def place(found: CellProblem, table: TableText) -> str:
    """Where a problem is, before its message."""
    field = f"{found.field}: " if found.field else ""
    if found.row is None:
        return field
    name = table.rows[found.row].get("joint", f"joint_{found.row + 1}") if found.row < len(table.rows) else ""
    return f"row {found.row + 1}, {name}, {field}" if field else f"row {found.row + 1}, {name}: "


def matrix(pose: RigidTransform, length: Unit, digits: int) -> list[list[str]]:
    """The 4x4 matrix of a pose, row by row, its lengths in a unit and with some digits behind the point."""
    r, t = pose
    rows = [[*(plain(x, 4) for x in r[3 * i : 3 * i + 3]), plain(length.number(t[i]), digits)] for i in range(3)]
    return [*rows, ["0", "0", "0", "1"]]


def numbers(pose: RigidTransform, table: TableText, reach: float) -> str:
    """T(base → tool0) and the reach as HTML; numbers only, nothing that a person has typed."""
    length, angle = UNITS[table.length_unit], UNITS[table.angle_unit]
    digits, t = decimals(length, reach), pose.translation
    lines = "\n".join(f"{x:>7} {y:>7} {z:>7} {far:>9}" for x, y, z, far in matrix(pose, length, digits))
    turn = ", ".join(plain(angle.number(x), 4) for x in pose.rpy)
    return (
        f'<div><b>T(base_link → tool0)</b></div><pre class="studio-matrix">{lines}</pre>'
        f"<div>rpy <b>{turn}</b>{'°' if angle.degrees else ' rad'}</div>"
        f"<div>distance <b>{plain(length.number(math.hypot(*t)), digits)}</b> {length.symbol}, "
        f"reach at most <b>{plain(float(number_in(reach, length)), digits)}</b> {length.symbol}</div>"
    )


def remark(session: Session) -> str:
    """The message about the variant on the screen."""
    if session.arm is None or session.variant == session.variants[0]:
        return ""
    name = session.variants[-1]
    if session.arm.other is None:
        told = "; ".join(found.text.partition("\n")[0] for found in session.arm.refusal[:3])
        return f"The variant {name} refuses this table: {told}"
    if (error := session.other_error) is None:
        return ""
    return (
        f"The variant {name} is not the arm of the table: at this pose its tool0 is {error[0]:.4g} m and "
        f"{math.degrees(error[1]):.4g}° from the table's."
    )
