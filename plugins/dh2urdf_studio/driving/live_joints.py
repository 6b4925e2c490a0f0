"""The joint values that programs give to the robots of a view: what is accepted, and which tabs show it.

A request has names and positions, as urdf-viz has it: ``{"names": ["elbow"], "positions": [0.5]}``. Everything in it is
checked before a joint moves.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, Protocol

from dh2urdf.errors import InputError
from dh2urdf.source import Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from dh2urdf_studio.viewing import View

ACCEPTED = '{"names": ["…", …], "positions": [0.0, …]}, in radians and metres'
"""The form of a request."""
_TOLD_NAMES = 20


class LivePage(Protocol):
    """What shows a view, and follows it when another program has moved its joints."""

    def follow(self) -> None:
        """The joints of the view have moved."""


class LiveJoints:
    """The joint values that programs give and ask for.

    Args:
        first: a view of the robots, which no tab shows.

    Attributes:
        pages: the pages that are open.
        q: the values that any tab or program has set last, by name [rad or m].
    """

    def __init__(self, first: View) -> None:
        self.pages: set[LivePage] = set()
        self._first = first
        self._given: dict[str, float] = {}

    @property
    def q(self) -> Mapping[str, float]:
        """See the class."""
        return self._first.q

    def note(self, view: View) -> None:
        """A person has moved the joints of a tab."""
        self._first.q = view.q

    def begin(self, view: View) -> View:
        """A new view, with the values that programs have given."""
        view.move(self._given)
        return view

    def as_json(self) -> dict[str, Any]:
        """What a program gets that asks for the values."""
        return {"names": list(self.q), "positions": list(self.q.values())}

    def take(self, text: bytes, views: Iterable[View]) -> list[str]:
        """Moves the joints of all views as a program asks for.

        Args:
            text: the request.
            views: those of the tabs.

        Returns:
            The joints whose values were outside their limits: they are at the nearest limit.

        Raises:
            InputError: a part of the request is wrong; no joint has moved.
        """
        values = self._read(text)
        for view in (self._first, *views):
            view.move(values)
        self._given |= {name: self.q[name] for name in values}
        for page in self.pages:
            page.follow()
        sliders = {slider.name: slider for slider in self._first.sliders}
        return [name for name, value in values.items() if name in sliders and not sliders[name].holds(value)]

    def _read(self, text: bytes) -> dict[str, float]:
        try:
            asked = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise _refused(f"the request is no JSON: {error}") from error
        names, positions = (asked.get(key) if isinstance(asked, dict) else None for key in ("names", "positions"))
        if not isinstance(names, list) or not isinstance(positions, list):
            raise _refused("the request needs a list of names and a list of positions")
        if len(names) != len(positions):
            raise _refused(f"there are {len(names)} names, but {len(positions)} positions")
        if wrong := next((name for name in names if not isinstance(name, str) or name not in self.q), None):
            raise self._unknown(wrong)
        values = dict(zip(names, map(_number, names, positions), strict=True))
        if len(values) < len(names):
            twice = next(name for name in names if names.count(name) > 1)
            raise _refused(f"joint {shown(twice)} is named more than once")
        return values

    def _unknown(self, name: object) -> InputError:
        names = ", ".join(list(self.q)[:_TOLD_NAMES]) + (", …" if len(self.q) > _TOLD_NAMES else "")
        near = did_you_mean(name, self.q) if isinstance(name, str) else None
        return _refused(f"no joint that moves is called {shown(str(name))}", names or "no joint moves", near)


def _number(name: str, position: object) -> float:
    """A position [rad or m].

    Raises:
        InputError: it is none.
    """
    try:
        number = float(position) if isinstance(position, int | float) and not isinstance(position, bool) else math.nan
    except OverflowError:  # an integer of hundreds of digits
        number = math.inf
    if not math.isfinite(number):
        told = shown(json.dumps(position))[1:-1]
        raise _refused(f"the position of joint {shown(name)} is {told}", "a finite number, in rad or m")
    return number


def _refused(message: str, accepted: str = ACCEPTED, suggestion: str | None = None) -> InputError:
    return InputError(Problem(message=message, accepted=accepted, suggestion=suggestion))
