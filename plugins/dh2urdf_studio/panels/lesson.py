"""The panel that explains the picked row: its matrices, and its four motions one after the other."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf.kinematics.chain import dh_frames, dh_transform, joint_variables, reach, row_transform
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities.units import UNITS
from dh2urdf_studio.drawing.strokes import NAMES, ORDER, where_x_is
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.panels.poses import TICK
from dh2urdf_studio.widgets import Panel, row_of, small_button
from dh2urdf_studio.words import decimals, matrix

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.quantities.units import Unit
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.session import OpenArm

_STEP = 0.04  # of a motion in a tick: a motion takes 1.25 s
_ALL = 4.0
_DIGITS = 4
_MOST_FACTORS = 3


class LessonPanel(Panel):
    """Explains the picked row beside the arm, and moves a frame through it."""

    ICON, TITLE, NAME = "school", "explain the picked row", "the picked row"

    def _lay_out(self) -> None:
        self._until = _ALL
        self._panel.classes("studio-lesson")
        with row_of():
            self._title = ui.label().classes("studio-caption")
            small_button("play", lambda: self._start(0.0, _ALL), "play_arrow")
            plays = [partial(self._start, float(number), number + 1.0) for number in range(int(_ALL))]
            self._steps = [ui.button(on_click=play).props("flat dense no-caps size=sm") for play in plays]
        self._text = ui.html(sanitize=False).classes("studio-lesson-text")
        self._timer = ui.timer(TICK, self._go_on, active=False)

    def switch(self) -> None:
        """Open it, or close it."""
        self._session.lesson = _ALL if self._session.lesson is None else None
        self._timer.deactivate()
        self._on_move()

    def show(self) -> None:
        """Show the picked row as it is now."""
        self._is_open = self._session.lesson is not None
        super().show()

    def _show_arm(self, arm: OpenArm) -> None:
        session, row = self._session, self._session.drawn_row
        self._panel.props(f"data-progress={session.lesson:.2f}")
        pairs = zip(self._steps, ORDER[arm.manipulator.convention], strict=True)
        for number, (button, field) in enumerate(pairs, start=1):
            button.set_text(f"{number} {NAMES[field]}")
            button.set_enabled(row is not None)
        if row is None:
            self._title.set_text("Pick a row of the table, or a link of the arm.")
            self._text.set_content("")
        else:
            keys = session.history.keys  # the arm may be that of an earlier table, with other numbers
            self._title.set_text(f"row {keys.index(session.picked) + 1 if session.picked in keys else 1}")
            self._text.set_content(explained(arm.manipulator, row, session.q, session.table))

    def _start(self, progress: float, until: float) -> None:
        self._session.lesson, self._until = progress, until
        self._timer.activate()
        self._on_move()

    def _go_on(self) -> None:
        session = self._session
        if session.lesson is not None:
            session.lesson = min(session.lesson + _STEP, self._until)
            self._on_move()
        if session.lesson is None or session.lesson >= self._until:
            self._timer.deactivate()


def explained(table: Manipulator, number: int, q: Mapping[str, float], typed: TableText) -> str:
    """The transform of a row and that of all rows up to it, at the pose on the screen, as HTML."""
    row, value = table.rows[number], q.get(table.rows[number].joint, 0.0)
    length, angle, far = UNITS[typed.length_unit], UNITS[typed.angle_unit], reach(table)
    theta, d = joint_variables(row, value)
    moves = {JointType.PRISMATIC: "d", JointType.FIXED: ""}.get(row.type, "θ")
    told = []
    for symbol, size in {"θ": theta, "d": d, "a": row.a, "α": row.alpha}.items():
        unit = angle if symbol in "θα" else length
        sign = "°" if unit.degrees else f" {unit.symbol}"
        told.append(f"{symbol} = {unit.number(size):.6g}{sign}{' (moves)' if symbol == moves else ''}")
    index, is_standard = number + 1, table.convention is Convention.STANDARD
    other, neighbour = (Convention.MODIFIED, number - 1) if is_standard else (Convention.STANDARD, number + 1)
    whose, a, alpha = "a = 0 and α = 0", 0.0, 0.0
    if 0 <= neighbour < len(table.rows):
        whose, a, alpha = f"a and α of row {neighbour + 1}", table.rows[neighbour].a, table.rows[neighbour].alpha
    there = dh_transform(other, a=a, alpha=alpha, d=d, theta=theta)
    frame = dh_frames(table, [q.get(each.joint, 0.0) for each in table.actuated_rows])[index]
    factors = [f"A<sub>{each}</sub>" for each in range(1, index + 1)]
    product = " ".join(["base", *(factors if index <= _MOST_FACTORS else (factors[0], "…", factors[-1]))])
    here = row_transform(table.convention, row, value)
    own, others = (PAGE["conventions"][each] for each in (table.convention, other))
    return (
        f"<div>{', '.join(told)}</div>"
        f"<div><b>A<sub>{index}</sub> = {_product(table.convention)}</b></div>"
        f"{_equal(_matrix(PAGE['conventions'][table.convention]['symbols']), here, length, far)}"
        f"{_equal(f'<b>T<sub>0{index}</sub> = {product}</b>', frame, length, far)}"
        f"<div>{own['means']}</div><div>{where_x_is(table, q, number)}</div>"
        f"<details><summary>The {other} convention</summary><div>A = {_product(other)}</div>"
        f"{_equal(_matrix(PAGE['conventions'][other]['symbols']), there, length, far)}"
        f"<div>The same arm has d and θ of this row there, and {whose}.</div><div>{others['means']}</div></details>"
    )


def _product(convention: Convention) -> str:
    return " ".join(NAMES[field] for field in ORDER[convention])


def _equal(left: str, transform: RigidTransform, length: Unit, reach: float) -> str:
    """An equation with a transform in numbers on its right side."""
    rows = matrix(transform, length, max(_DIGITS, decimals(length, reach)))
    numbers = [[text.replace("-", "−") for text in row] for row in rows]
    return f'<div class="studio-matrices">{left}<span>=</span>{_matrix(numbers)}</div>'


def _matrix(rows: Iterable[Sequence[str]]) -> str:
    cells = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return f'<table class="studio-table-matrix">{cells}</table>'
