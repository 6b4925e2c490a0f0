"""A tab of the studio: the table and its past, what the readers report about it, the arm on the screen and its pose."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.conversion.robots import edited_table
from dh2urdf.kinematics.chain import (
    KinematicChain,
    angle_error,
    dh_frames,
    forward_kinematics,
    link_poses,
    position_error,
)
from dh2urdf.kinematics.inverse import ATTEMPTS, InverseSolution, inverse_kinematics
from dh2urdf.manipulator import ROOT, TOOL, Convention, DHRow, JointType, Manipulator
from dh2urdf.plugin_system.calls import Call
from dh2urdf.robot import Joint, Robot
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf.source import Problem
from dh2urdf.stages import Edit
from dh2urdf.table_text import FIELDS, TableText
from dh2urdf.table_text.texts import table_text
from dh2urdf_studio import joints
from dh2urdf_studio.drawing.parts import PAPER
from dh2urdf_studio.drawing.scene import FRAME_SIZE, Drawing, Figure, extent
from dh2urdf_studio.drawing.strokes import Stroke, moving_frame
from dh2urdf_studio.editing import conversions, edits
from dh2urdf_studio.editing.comparing import Beside, beside
from dh2urdf_studio.editing.reading import (
    CellProblem,
    Reading,
    edit_call,
    made_edits,
    make,
    read,
    read_whole,
    transform_call,
    variants,
)
from dh2urdf_studio.tab import Tab

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf_studio.joints import Slider

BOTH = "both"  # the choice of both variants, side by side
COLUMNS = ("joint", "type", "a", "alpha", "d", "theta", "lower", "upper")
"""The columns of the paper's form, and limits; others are shown where the table uses them, or on request."""
LEAST_LENGTH = 1e-6  # what is drawn of a distance at least, in reaches


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenArm:
    """The last table that was right, as robots."""

    table: TableText
    keys: tuple[str, ...]  # of its rows; none where an edit has changed their number
    given: Manipulator  # the table
    manipulator: Manipulator  # the table after the edits
    robot: Robot  # of the exact variant, after the edits
    typed: TableText  # the texts of the table after the edits
    edits: tuple[Call[Edit[Any]], ...] = ()
    remarks: tuple[Problem, ...] = ()  # the notices of the edits
    other: Robot | None = None  # of the other variant; None where there is none, it is not shown, or it refuses
    refusal: tuple[CellProblem, ...] = ()  # why it does


class Session(Tab):
    """What a tab of the studio shows."""

    def __init__(
        self, catalog: Catalog, table: TableText | None = None, arm_edits: Sequence[str] = (), *, may_edit: bool = True
    ) -> None:
        super().__init__("links", "axes", "frames", "outlines")
        self.catalog = catalog
        self.history = edits.History.of(table or TableText(name="arm"), arm_edits)
        self.may_edit = may_edit  # whether a person may change the edits of the arm, which may name any file
        self._edits: dict[str, Call[Edit[Any]]] = {}  # those that can be made, by their texts
        self.arm: OpenArm | None = None  # the last one that could be made
        self.variants = variants(catalog)  # of the transform, the usual one first
        self.variant = self.variants[0]  # which of them is shown, or `BOTH`
        self.picked: str | None = None  # the key of the row that is picked, which the page knows
        self.confirmed: frozenset[str] = frozenset()  # notices that a person has answered: the unit is right
        self.all_columns = False  # whether columns are shown that are empty
        self.lesson: float | None = None  # how many motions of the picked row are done, where the row is explained
        self.poses: list[dict[str, float]] = []  # joint values that a person has stored, by name [rad or m]
        self.measured: tuple[str, str] | None = None  # the names of the two frames between which is measured
        self.beside: Beside | None = None  # the description that lies upon the arm, compared with it
        self._described: tuple[Figure, str, str] | None = None
        self.reading = Reading(table=self.table)
        self.problems_of_making: tuple[CellProblem, ...] = ()  # why no arm can be made of a table that can be read
        self._before_preview: tuple[OpenArm | None, dict[str, float], list[dict[str, float]], tuple[Slider, ...]] | None
        self._before_preview = None
        self.look()

    @property
    def table(self) -> TableText:
        """The table as it is typed."""
        return self.history.table

    @property
    def arm_edits(self) -> tuple[str, ...]:
        """What is changed in the arm of the table, in order: texts as `dh2urdf convert --edit` takes them."""
        return self.history.arm_edits

    @property
    def changes(self) -> tuple[Call[Edit[Any]], ...]:
        """The edits of the arm, as they were read when they were typed.

        Raises:
            InputError: one of them cannot be made.
        """
        return tuple([self._edits.get(text) or edit_call(text, self.catalog) for text in self.arm_edits])

    def edit_arm(self, texts: Sequence[str]) -> None:
        """Other edits of the arm, or the same in another order."""
        self._go_to(self.history.then(self.table, arm_edits=[each for text in texts if (each := edits.clean(text))]))

    @property
    def name(self) -> str:
        """The name of the arm."""
        return self.table.name

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns of the table on the screen."""
        used = {field for row in self.table.rows for field in row}
        return tuple(field for field in FIELDS if self.all_columns or field in used or field in COLUMNS)

    @property
    def moving_rows(self) -> list[int]:
        """The numbers of the rows that move, and so are axes."""
        made = zip(self.arm.table.rows, self.arm.given.rows, strict=False) if self.arm else ()
        # The last arm knows what fixed joints are called beside ``fixed``.
        names = {typed["type"] for typed, row in made if row.type is JointType.FIXED and "type" in typed}
        return [number for number, row in enumerate(self.table.rows) if row.get("type") not in {"fixed", *names}]

    # --- The table ----------------------------------------------------------------------------------------------------

    def put(self, table: TableText, keys: Sequence[str] = ()) -> None:
        """Another table takes the place of this one, with the same rows, and some more with these keys."""
        self._go_to(self.history.then(table, [*self.history.keys, *keys] if keys else None))

    def resize(self, axes: int, keys: Sequence[str] = ()) -> None:
        """So many rows that move: empty ones more, with these keys, or the last ones less, fixed rows among them."""
        moving = self.moving_rows
        count = len(self.table.rows) + axes - len(moving)
        if axes < len(moving):
            count = moving[axes - 1] + 1 if axes else 0
        self.put(edits.resized(self.table, count), keys)

    def finish_typing(self, left: object, kept: TableText | None, *, is_new: bool) -> None:
        """Takes the text that was being typed when the page lost the connection or was loaded anew.

        The browser has kept the key of a row, field and text of a cell; or None, name and text of a text of the whole
        table; or None, where nothing was being typed. It has kept the table with that text, too: a session that had
        none when the page asked (`is_new`) is offered the whole of it instead.
        """
        if self.previews:  # nobody types on in a page that is gone
            self.look()
        table, keys = self.table, self.history.keys
        match left:
            case [str(key), str(field), str(text)] if key in keys and field in FIELDS:
                table = edits.with_cells(table, {(keys.index(key), field): text})
            case [None, str(field), str(text)] if field in edits.TYPED:
                table = edits.with_texts(table, **{field: text})
        if table != self.table and (not is_new or table == kept):
            self.put(table)

    def arrange(self, act: str, key: str | None, other: str | None = None) -> None:
        """Something was done to a row, as `edits.rearranged` has it; ``other`` may be the key of a new row."""
        rows = edits.rearranged(self.history.keys, act, key, other)
        keys = [other if row is None else self.history.keys[row] for row in rows]
        self._go_to(self.history.then(edits.arranged(self.table, rows), keys))

    def _go_to(self, history: edits.History) -> None:
        self.history = history
        self.look()

    def open(self, table: TableText) -> None:
        """A table that was opened takes the place of this one, and of its arm, with every joint at 0."""
        self.q = {}
        self.poses = []
        self.arm = None
        self.confirmed = frozenset()
        self._draw()
        self._go_to(self.history.then(table, ()))

    def edit(self, row: int, field: str, text: str) -> None:
        """A cell was typed; a `LookupError` where there is no such cell."""
        self.put(edits.with_cells(self.table, {(row, field): text}))

    def undo(self) -> None:
        """One state back."""
        self._go_to(self.history.undo())

    def redo(self) -> None:
        """One state forward."""
        self._go_to(self.history.redo())

    def preview(self, row: int, field: str, text: str) -> bool:
        """Shows the arm of a cell that is still being typed; nothing is kept of it. Whether there is something new."""
        try:
            table = edits.with_cells(self.table, {(row, field): text})
        except LookupError:
            return False
        if self._before_preview is None:
            self._before_preview = self.arm, dict(self.q), self.poses, self.sliders
        _, self.q, self.poses, self.sliders = self._before_preview  # half a limit moves no joint for good
        return self._take(read(table, self.catalog))

    @property
    def previews(self) -> bool:
        """Whether the arm on the screen is that of a cell which is still being typed."""
        return self._before_preview is not None

    def set_convention(self, convention: Convention, *, convert: bool) -> None:
        """The other convention: the same arm with new numbers, or the same numbers with a new meaning."""
        table = replace(self.table, convention=str(convention))
        if convert and self.convertible is not None:
            past = (each for each in self.history.earlier if each.convention == str(convention) and each.rows)
            earlier = read_whole(last, self.catalog).manipulator if (last := next(past, None)) else None
            converted = conversions.with_convention(self.table, self.convertible, convention, earlier)
            table = conversions.as_typed(converted, self.history, self.catalog)
        self.put(table)

    def set_units(self, length_unit: str, angle_unit: str, *, convert: bool) -> None:
        """Other units: the same arm with new numbers, or the same numbers with a new meaning."""
        table = replace(self.table, length_unit=length_unit, angle_unit=angle_unit)
        if convert and self.convertible is not None:
            converted = conversions.with_units(self.table, self.convertible, length_unit, angle_unit)
            table = conversions.as_typed(converted, self.history, self.catalog)
        self.put(table)

    @property
    def problems(self) -> tuple[CellProblem, ...]:
        """What is wrong with the table, from every source, but for what a person has answered; errors come first."""
        found = (*self.reading.problems, *self.problems_of_making)
        left = (each for each in found if each.problem.message not in self.confirmed)
        return tuple(sorted(left, key=lambda each: each.problem.severity != "error"))

    @property
    def convertible(self) -> Manipulator | None:
        """The arm that a conversion would keep; None while something is wrong with the table or missing from it."""
        return self.reading.manipulator if self.reading.is_whole else None

    def lay_beside(self, figure: Figure | None, base_link: str = "", tip_link: str = "") -> None:
        """Lays a description upon the arm, or takes it away; an empty name of a link stands for the likeliest one."""
        self._described = None if figure is None else (figure, base_link, tip_link)
        self._draw()

    # --- The arm ------------------------------------------------------------------------------------------------------

    def show_variant(self, variant: str) -> None:
        """The arm of a variant, or of both side by side."""
        self.variant = variant
        self._draw()

    def move(self, values: Mapping[str, float]) -> None:
        """Joint values by name [rad or m]; they are kept inside the limits."""
        super().move(values)
        if self._before_preview is not None:
            self._before_preview[1].update(values)

    def strokes(self) -> tuple[Stroke, ...]:
        """The DH parameters that are shown, at the pose on the screen; of an explained row its own, and a frame."""
        row = self.drawn_row
        if self.lesson is None or row is None or self.arm is None:
            frames, shown = self.frames, super().strokes()
            if self.measured is None or not frames.keys() >= set(self.measured):
                return shown
            one, other = (frames[name].translation for name in self.measured)
            line = Stroke(row=None, field="distance", points=(one, other))
            return (*shown, line) if math.dist(one, other) > LEAST_LENGTH * self.drawing.reach else shown
        own = [stroke for stroke in self.drawing.strokes(self.q) if stroke.row == row]
        # A length a is the common normal; where it is 0, the cross product of the axes takes its place.
        more = ("line", "foot") if self.arm.manipulator.rows[row].a else ("line", "foot", "normal")
        own += [stroke for stroke in self.drawing.normals(self.q, row) if stroke.field in more]
        size = 1.6 * FRAME_SIZE * self.drawing.reach
        return (*own, *moving_frame(self.arm.manipulator, row, self.q, self.lesson, size))

    @property
    def frames(self) -> dict[str, RigidTransform]:
        """The frames of the table in base_link at the pose on the screen, by the names that they have there."""
        if self.arm is None:
            return {}
        table = self.arm.manipulator
        frames = dh_frames(table, self.vector)
        numbered = {f"{{{number}}}": frame for number, frame in enumerate(frames)}
        return {ROOT: IDENTITY, **numbered, TOOL: frames[-1] @ table.tool}

    @property
    def shown_layers(self) -> frozenset[str]:
        """The layers that were chosen, and what belongs to a row that is explained."""
        return self.layers if self.lesson is None else self.layers | {"parameters", "lesson"}

    @property
    def drawn_row(self) -> int | None:
        """The number that the picked row has in the arm on the screen, which may be an earlier one; None without."""
        keys = self.arm.keys if self.arm else ()
        return keys.index(self.picked) if self.picked in keys else None

    @property
    def pose(self) -> RigidTransform | None:
        """T(base_link → tool0) of the table at the pose on the screen: the DH product."""
        return None if self.arm is None else forward_kinematics(self.arm.manipulator, self.vector)

    @property
    def tool(self) -> str:
        """The link that goes where a person wants it: tool0, or the tip of what is attached."""
        return (TOOL, *(self.arm.robot.tips if self.arm else ()))[-1]

    @property
    def tool_pose(self) -> RigidTransform | None:
        """T(base_link → tool) at the pose on the screen."""
        if self.arm is None or self.tool == TOOL:
            return self.pose
        return link_poses(self.arm.robot, self.q)[self.tool]

    def search(self, pose: RigidTransform, attempts: int = ATTEMPTS) -> tuple[dict[str, float], InverseSolution]:
        """The values of the joints that bring the tool of the arm to a pose, and how near; a `LookupError` without arm.

        A joint that turns without end stays within a turn.
        """
        if self.arm is None:
            raise LookupError("there is no arm")
        if self.tool == TOOL:
            table = self.arm.manipulator
            moving: list[tuple[str, DHRow | Joint]] = [(row.joint, row) for row in table.actuated_rows]
            found = inverse_kinematics(table, pose, self.vector, attempts=attempts)
        else:
            robot, tool = self.arm.robot, self.tool
            joints_of_robot = {joint.name: joint for joint in robot.joints}
            way = KinematicChain.between(robot, robot.root, tool)
            moving = [(name, joints_of_robot[name]) for name in way.actuated]
            found = inverse_kinematics(robot, pose, self.q, link=tool, attempts=attempts)
        values = {}
        for (name, joint), value in zip(moving, found.q, strict=True):
            turns = joint.type is not JointType.PRISMATIC and joint.limits.lower is None
            values[name] = math.remainder(value, math.tau) if turns else value
        return values, found

    @property
    def reach(self) -> float:
        """An upper bound of the distance from base_link to tool0, every joint anywhere inside its limits [m]."""
        return 0.0 if self.arm is None else joints.reach(self.arm.manipulator, self.sliders)

    @property
    def other_error(self) -> tuple[float, float] | None:
        """How far the other variant's tool0 is from the arm's [m, rad]; None where there is none."""
        if self.arm is None or self.arm.other is None or (pose := self.pose) is None:
            return None
        chain = KinematicChain.between(self.arm.other)
        found = chain.forward_kinematics([self.q.get(name, 0.0) for name in chain.actuated])
        return position_error(pose, found), angle_error(pose, found)

    @property
    def vector(self) -> list[float]:
        """The values of the actuated rows of the arm on the screen [rad or m]."""
        return [self.q.get(row.joint, 0.0) for row in self.arm.manipulator.actuated_rows] if self.arm else []

    def look(self) -> None:
        """Reads the table; what was right last stays on the screen while something is wrong, a preview does not."""
        if self._before_preview is not None:
            self.arm, self.q, self.poses, self.sliders = self._before_preview
            self._before_preview = None
            self._draw()
        self.reading = read(self.table, self.catalog)
        self._edits, self.problems_of_making = made_edits(self.arm_edits, self.catalog, self._edits)
        if self.reading.waiting == len(self.table.rows):  # Nothing has been begun: no arm was ever this table's.
            self.arm = None
            self._draw()
        else:
            self._take(self.reading)

    def _take(self, reading: Reading) -> bool:
        """Makes the arm of a reading, where there is one."""
        given, variant = reading.manipulator, self.variants[0]
        if given is None or not set(self.arm_edits) <= self._edits.keys():
            return False
        changes = self.changes
        robot, problems = make(given, variant, reading.table, self.catalog, changes)
        if robot is None:
            self.problems_of_making = problems
            return False
        table, keys, typed = given, self.history.keys, reading.table
        remarks = robot.notices
        if changes:
            table = edited_table(given, transform_call(self.catalog, variant), changes)
            plain, _ = make(given, variant, typed, self.catalog)
            remarks = tuple(each for each in remarks if plain is None or each not in plain.notices)
        if table.rows != given.rows:
            typed = table_text(table, typed.length_unit, typed.angle_unit)
            keys = keys if len(table.rows) == len(given.rows) else ()
        self.arm = OpenArm(
            table=reading.table,
            keys=keys,
            given=given,
            manipulator=table,
            robot=robot,
            typed=typed,
            edits=changes,
            remarks=remarks if changes else (),
        )
        self._draw()
        return True

    def _draw(self) -> None:
        self.beside = None
        if self.variant != self.variants[0] and self.arm is not None and not (self.arm.other or self.arm.refusal):
            # No letter has to wait for the other variant while it is not shown.
            arm = self.arm
            robot, problems = make(arm.given, self.variants[-1], arm.table, self.catalog, arm.edits)
            self.arm = replace(self.arm, other=robot, refusal=problems)
        if self.arm is None:
            self.drawing, self.sliders = Drawing(), ()
            return
        arm, variant = self.arm, self.variant
        figures = []
        if variant in (BOTH, self.variants[0]) or arm.other is None:
            title = "the arm" if variant == BOTH and arm.other else ""
            # An edit may make another arm than the table's; that has no DH frames.
            table = arm.manipulator if arm.robot.manipulator else None
            figures.append(Figure(robot=arm.robot, manipulator=table, typed=arm.typed, title=title))
        elif variant == self.variants[-1]:
            figures.append(Figure(robot=arm.other, tint=PAPER, link_frames=False))
        if variant == BOTH and arm.other is not None:
            aside = 0.6 * max(extent(arm.robot), extent(arm.other))
            place, name = RigidTransform(IDENTITY.rotation, (0.0, aside, 0.0)), self.variants[-1]
            other = Figure(robot=arm.other, name=f"{name}/", place=place, tint=PAPER, title=name, link_frames=False)
            figures.append(other)
        if self._described is not None:
            described, base, tip = self._described
            self.beside = beside(described, arm.manipulator, arm.robot, base_link=base, tip_link=tip)
            figures.append(self.beside.figure)
        self.drawing = Drawing.of(figures)
        before, units = self.sliders, (arm.table.length_unit, arm.table.angle_unit)
        self.sliders = joints.sliders(arm.robot.actuated_joints, *units)
        self.poses = [joints.renamed(pose, before, self.sliders) for pose in self.poses]
        self.q = joints.kept(joints.renamed(self.q, before, self.sliders), self.sliders)

    def fade(self, robot: str, opacity: float) -> None:
        """Both variants are the arm; a description that is compared with it is not."""
        self.opacities = {robot: opacity, f"{self.variants[-1]}/": opacity}

    def _moving(self, joint: str) -> str | None:
        names = [slider.name for slider in self.sliders]
        own = {f"{self.variants[-1]}/{name}": name for name in names} | {name: name for name in names}
        if self.beside is not None and self.arm is not None:
            own |= self.beside.named([row.joint for row in self.arm.manipulator.moving_rows])
        return own.get(joint)

    def joint_values(self) -> dict[str, float]:
        """The pose on the screen by the names of all joints in the drawing [rad or m]."""
        variant = f"{self.variants[-1]}/"
        values = {**self.q, **{variant + name: value for name, value in self.q.items()}}
        return values if self.beside is None else {**values, **self.beside.named(self.vector)}
