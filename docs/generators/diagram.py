"""The diagram of the pipeline for docs/concepts.md: what goes from stage to stage, and what each stage makes of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drawing import FAINT, INK, Camera, Drawing, svg

if TYPE_CHECKING:
    from collections.abc import Sequence

WIDTH, HEIGHT = 860, 330
BOX = (112, 58)
"""Width and height of a stage [px]."""
TOP, STEP, LEFT = 120, 142, 20
STAGE, PROOF, DATA = "#e4edf8", "#e5f3e8", "#f4f1e8"
"""Fills: a stage that plugins can be, the proof that is always the host's, and an input."""

STAGES = (
    ("reader", "csv, xlsx, urdf, …"),
    ("edits", "calibrate, limits, …"),
    ("transform", "alpha-swap"),
    ("edits", "payload, mount, …"),
    ("emitters", "urdf, sdf, mjcf, …"),
    ("loaders", "pybullet, mujoco, …"),
)
HANDED_OVER = ("manipulator", "manipulator", "robot", "robot", "files")
"""What goes from each stage to the next."""


def pipeline() -> str:
    """The stages from left to right, the proof below them, and what is handed over."""
    sheet = Drawing(Camera(0.0, 0.0, 1.0))
    for number, (name, examples) in enumerate(STAGES):
        x = LEFT + number * STEP
        _box(sheet, (x, TOP), name, examples, STAGE)
        if number < len(HANDED_OVER):
            _arrow(sheet, ((x + BOX[0], TOP + BOX[1] / 2), (x + STEP, TOP + BOX[1] / 2)))
            sheet.words((x + BOX[0] + (STEP - BOX[0]) / 2, TOP - 10), HANDED_OVER[number], size=12, colour=INK)
    _box(sheet, (LEFT, 24), "table", "or description", DATA)
    _arrow(sheet, ((LEFT + BOX[0] / 2, 24 + BOX[1]), (LEFT + BOX[0] / 2, TOP)))
    emitters = LEFT + 4 * STEP
    _box(sheet, (emitters, 216), "proof", "T(q) = DH product?", PROOF)
    _arrow(sheet, ((emitters + BOX[0] / 2, TOP + BOX[1]), (emitters + BOX[0] / 2, 216)))
    sheet.words((emitters + BOX[0] / 2 + 10, 202), "read back", size=12, colour=INK, anchor="start")
    corner = LEFT + STEP + BOX[0] / 2
    _arrow(sheet, ((corner, TOP + BOX[1]), (corner, 245), (emitters, 245)))
    sheet.words((corner + 10, 236), "edited table", size=12, colour=INK, anchor="start")
    _arrow(sheet, ((emitters + BOX[0], 245), (emitters + BOX[0] + 24, 245)))
    sheet.words((emitters + BOX[0] + 32, 242), "the file is written", size=12, colour=INK, anchor="start")
    sheet.words((emitters + BOX[0] + 32, 258), "if it is the same arm", size=12, colour=INK, anchor="start")
    left, right = LEFT, LEFT + 5 * STEP + BOX[0]
    sheet.area([(left, 294), (right, 294), (right, 318), (left, 318)], fill=STAGE)
    words = "executor: runs all of this for each table, in local processes or on a Dask cluster"
    sheet.words(((left + right) / 2, 311), words, size=13, colour=INK)
    return svg([sheet], (0, 0, WIDTH, HEIGHT), "The pipeline: from a table through the stages to files and loaders")


def _box(sheet: Drawing, place: tuple[float, float], title: str, words: str, fill: str) -> None:
    x, y = place
    width, height = BOX
    sheet.area([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], fill=fill)
    sheet.words((x + width / 2, y + 25), title, size=15, colour=INK)
    sheet.words((x + width / 2, y + 44), words, size=10.5, colour="#57606a")


def _arrow(sheet: Drawing, points: Sequence[tuple[float, float]]) -> None:
    """An arrow through points of the picture; its last piece is level or upright."""
    (x0, y0), (x1, y1) = points[-2:]
    length = max(abs(x1 - x0), abs(y1 - y0))
    towards = ((x1 - x0) / length, (y1 - y0) / length)
    end = (x1 - 5 * towards[0], y1 - 5 * towards[1])
    sheet.path([*points[:-1], end], colour=FAINT, width=2)
    sheet.head((x1, y1), towards, FAINT, 9)
