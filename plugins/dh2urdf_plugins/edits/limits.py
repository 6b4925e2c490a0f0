"""The edit ``limits``: limits of joints that a controller shall keep, narrower than those of the table."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import EditError
from dh2urdf.rotations import agreed
from dh2urdf.source import Messages, did_you_mean, shown
from dh2urdf.stages import Edit, EditsInColumns
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from dh2urdf.manipulator import Limits, Manipulator

say = Messages(__file__)

_FACTORS = ("range", "velocity", "effort")


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsOptions:
    """What limits become. Limits that a table leaves out stay left out."""

    range: float = option("factor of the range of a joint, about its middle", 1.0)
    margin: float | str = option(
        "what is taken off both ends of the range, after the factor: a number [rad or m], or one with its "
        "unit, such as 5 deg or 10 mm, which is about the joints that turn or those that slide",
        0.0,
    )
    velocity: float = option("factor of the largest speed", 1.0)
    effort: float = option("factor of the largest torque or force", 1.0)
    joints: tuple[str, ...] = option("names of the joints that are meant; all by default", ())

    def __post_init__(self) -> None:
        if wrong := [name for name in _FACTORS if not 0.0 < getattr(self, name) < math.inf]:
            raise ValueError(f"{' and '.join(wrong)}: a factor is a number greater than 0")
        if not all(map(math.isfinite, self.margins)):
            raise ValueError("margin is a number [rad or m]; a negative one widens the range")

    @property
    def margins(self) -> tuple[float, float]:
        """The margin of joints that turn [rad], and of those that slide [m]."""
        if not isinstance(self.margin, str):
            return (self.margin, self.margin)
        from dh2urdf.quantities import Dimension, QuantityError, evaluate

        for place, dimension in enumerate((Dimension.ANGLE, Dimension.LENGTH)):
            try:
                margin = evaluate(self.margin, dimension)
            except QuantityError:
                continue
            if not margin.variable:
                both = (margin.value, margin.value)
                return both if not margin.has_unit else (both[0], 0.0) if place == 0 else (0.0, both[1])
        raise ValueError(f"margin: {shown(self.margin)} is neither an angle nor a length, such as 5 deg or 10 mm")


def edit_table(manipulator: Manipulator, options: LimitsOptions) -> Manipulator:
    """The manipulator with other limits of its joints."""
    from dh2urdf.columns import LIMITS
    from dh2urdf.fields import replace_unchecked
    from dh2urdf.manipulator import JointType

    names = [row.joint for row in manipulator.moving_rows]
    problems = []
    for name in options.joints:
        if name not in names:
            near = did_you_mean(name, names)
            problems.append(say("edit-joint-unknown", field="edits", found=name, names=names, suggestion=near))
    rows = []
    is_changed = False
    turning, sliding = options.margins
    for row in manipulator.rows:
        is_meant = row.type is not JointType.FIXED and (not options.joints or row.joint in options.joints)
        margin = sliding if row.type is JointType.PRISMATIC else turning
        limits = _limited(row.limits, options, margin) if is_meant else row.limits
        if limits.lower is not None and limits.upper is not None and not agreed(limits.lower < limits.upper):
            problems.append(say("limits-gone", field="edits", name=row.joint, margin=margin))
            limits = row.limits
        pairs = [(getattr(limits, name), getattr(row.limits, name)) for name in LIMITS]
        is_changed |= any(new is not old and not agreed(new == old) for new, old in pairs)
        rows.append(replace_unchecked(row, limits=limits))
    if problems:
        raise EditError(problem.about(robot=manipulator.name, mark=manipulator.mark) for problem in problems)
    notices = manipulator.notices
    if not is_changed:
        notices = (*notices, say("edit-changes-nothing", field="edits", edit="limits", what="limit"))
    return replace_unchecked(manipulator, rows=tuple(rows), notices=notices)


def _limited(limits: Limits, options: LimitsOptions, margin: float) -> Limits:
    lower, upper = limits.lower, limits.upper
    if lower is not None and upper is not None and options.range != 1.0:
        middle, half = 0.5 * lower + 0.5 * upper, (0.5 * upper - 0.5 * lower) * options.range
        lower, upper = middle - half, middle + half
    return replace(
        limits,
        lower=None if lower is None else lower + margin,
        upper=None if upper is None else upper - margin,
        velocity=None if limits.velocity is None else limits.velocity * options.velocity,
        effort=None if limits.effort is None else limits.effort * options.effort,
    )


EDIT = Edit(
    name="limits",
    summary="narrower or wider limits of joints: factors of range, speed and effort, and a margin at both ends",
    options=LimitsOptions,
    edit_table=edit_table,
    capabilities=(EditsInColumns(),),
)
