"""What a simulator holds, beside the robot that was written, and what its hold test says: the same for all loaders."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from dh2urdf import measuring
from dh2urdf.manipulator import JointType
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.base_bodies import STILL, is_weightless_base
from dh2urdf_plugins.loaders.measures import HOLD_SECONDS, HOLD_STAYS, gravity_loads

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.measuring import Body
    from dh2urdf.robot import Inertial, Joint

_SHOWN_PAIRS = 5


class Comparison(measuring.Comparison):
    """What a simulator holds, beside the robot that was written."""

    def is_filled_in(self, name: str, written: Inertial, held: Body) -> bool:
        """Whether a link is a base without a mass, to which the file gives one for a reader that needs it."""
        return is_weightless_base(name, written) and held.mass == STILL.mass

    def hold(
        self, start: Sequence[float], displacement: Sequence[float], contacts: Sequence[tuple[str, str]]
    ) -> tuple[dict[str, Any], tuple[Problem, ...]]:
        """The hold test as a report has it, and its findings.

        Args:
            start: the joint vector at which it began [rad or m].
            displacement: how far each joint was from there at most [rad or m]; infinite where the arm flew apart.
            contacts: the pairs of links that overlapped at the start.
        """
        largest = max(displacement, default=0.0)
        loads = gravity_loads(self.robot, start)
        weakest = self.robot.moving_joints[displacement.index(largest)] if largest > 0.0 else None
        hold = {
            "seconds": HOLD_SECONDS,
            "start": tuple(start),
            "largest_displacement": largest if math.isfinite(largest) else None,
            "joint": weakest.name if weakest else None,
            "threshold": HOLD_STAYS,
            "stayed": largest <= HOLD_STAYS,
            "largest_load": self._largest_share(loads),
            "contacts": list(contacts),
        }
        return hold, tuple(self._hold_findings(weakest, largest, loads, contacts))

    def _largest_share(self, loads: Sequence[float]) -> float | None:
        """The largest share of an effort that gravity asks; None where it loads a joint without an effort."""
        shares = [0.0]
        for joint, load in zip(self.robot.moving_joints, loads, strict=True):
            effort = joint.limits.effort
            shares.append(abs(load) / effort if effort else math.inf if load else 0.0)
        return max(shares) if math.isfinite(max(shares)) else None

    def _hold_findings(
        self, weakest: Joint | None, largest: float, loads: Sequence[float], contacts: Sequence[tuple[str, str]]
    ) -> Iterator[Problem]:
        if weakest and largest > HOLD_STAYS:
            yield self._did_not_stay(weakest, largest, loads)
        if contacts:
            pairs = [f"{shown(first)} and {shown(second)}" for first, second in contacts[:_SHOWN_PAIRS]]
            pairs += [f"{more} more pairs"] if (more := len(contacts) - _SHOWN_PAIRS) > 0 else []
            yield self.problem(
                message=f"collision shapes of the arm overlap at the start of the hold test: {', '.join(pairs)}",
                severity="notice",
                suggestion="switch the arm's contacts with itself off, or give these links a smaller radius",
            )

    def _did_not_stay(self, weakest: Joint, largest: float, loads: Sequence[float]) -> Problem:
        """Why an arm did not stay: a motor is too weak, or every motor is strong enough and the solver is not."""
        unit = "m" if weakest.type is JointType.PRISMATIC else "rad"
        by = f"by {largest:.3g} {unit}" if math.isfinite(largest) else "without end"
        moved = f"in {HOLD_SECONDS:g} s under gravity this joint moved {by}"
        share = self._largest_share(loads)
        if share is not None and share <= 1.0:
            return self.problem(
                message=f"the solver gave way: {moved}, though at the start gravity asks at most {share:.0%} "
                "of any effort",
                severity="notice",
                joint=weakest.name,
                suggestion="the efforts suffice; simulate with shorter time steps or more iterations of the solver",
            )
        return self.problem(
            message=f"the arm did not stay in place: {moved}",
            severity="notice",
            joint=weakest.name,
            field="limits.effort",
            found=str(weakest.limits.effort),
            suggestion="give the joint the effort that its motor has",
        )
