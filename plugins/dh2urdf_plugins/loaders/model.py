"""What a simulator makes of a file of any origin: see `dh2urdf.stages.Inspects`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.errors import LoaderError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from dh2urdf.measuring import Body
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.stages import Question

VISUAL, COLLISION = "visual", "collision"
Lengths: TypeAlias = tuple[float, float, float]
Shapes: TypeAlias = dict[str, dict[str, list[Lengths]]]
"""The lengths of shapes, by the name of the link, and by `VISUAL` or `COLLISION`."""


class Model:
    """What a simulator makes of a file: where it puts joints, and where links are then."""

    def put(self, values: Mapping[str, float]) -> None:
        """Put joints at values [rad or m], at rest."""
        raise NotImplementedError

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world, with the joints where they are put."""
        raise NotImplementedError

    def told_frames(
        self, links: Iterable[str], postures: Iterable[Mapping[str, float]]
    ) -> dict[str, list[list[float]]]:
        """The frames of a `dh2urdf.stages.HeldRobot`."""
        links, found = tuple(links), dict[str, list[list[float]]]()
        for values in postures:
            self.put(values)
            for name, (r, t) in self.placed(links).items():
                matrix = (*r[:3], t[0], *r[3:6], t[1], *r[6:], t[2], 0.0, 0.0, 0.0, 1.0)
                found.setdefault(name, []).append([*map(float, matrix)])
        return found


def told_bodies(bodies: Mapping[str, Body]) -> dict[str, tuple[float, tuple[float, ...], tuple[float, ...]] | None]:
    """The links of a `dh2urdf.stages.HeldRobot`."""
    return {name: (float(body.mass), tuple(body.com), tuple(body.inertia)) for name, body in bodies.items()}


def told_shapes(shapes: Iterable[tuple[str, str, Lengths | None]]) -> Shapes:
    """The shapes of a `dh2urdf.stages.HeldRobot`, each with its link and its kind; None is a size that nobody tells."""
    found: Shapes = {}
    for link, kind, size in shapes:
        if size:
            found.setdefault(link, {}).setdefault(kind, []).append(size)
    return found


def refused(error: BaseException | str, question: Question) -> LoaderError:
    """A simulator's refusal of a file: its words in one line, with places in the file as ``line 12``.

    An empty text says that the reason is in what the simulator prints.
    """
    words = str(error).replace(f"/{question.path}:", "line ").replace(f"{question.path}:", "line ")
    words = words.replace(str(question.path), question.path.name)
    return LoaderError(" ".join(words.split()))


def lengths(x: float, y: float, z: float) -> Lengths:
    """The lengths of a shape along its axes, the longest first [m]."""
    first, second, third = sorted((float(x), float(y), float(z)), reverse=True)
    return first, second, third


def lengths_of(vertices: Any) -> Lengths:  # noqa: ANN401 - an array of shape (n, 3)
    """The lengths of a mesh along its axes, the longest first [m]."""
    import numpy as np

    return lengths(*np.ptp(np.asarray(vertices, dtype=float).reshape(-1, 3), axis=0))
