"""What all simulators share that are given a description of any origin: see `dh2urdf.stages.Inspects`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from dh2urdf.measuring import Body
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.stages import Question

VISUAL, COLLISION = "visual", "collision"


def refused(error: BaseException | str, question: Question) -> LoaderError:
    """A simulator's refusal of a file: its words in one line, with places in the file as ``line 12``.

    An empty text says that the reason is in what the simulator prints.
    """
    words = str(error).replace(f"/{question.path}:", "line ").replace(f"{question.path}:", "line ")
    words = words.replace(str(question.path), question.path.name)
    return LoaderError(" ".join(words.split()))


def told_bodies(
    bodies: Mapping[str, Body],
) -> dict[str, tuple[float, tuple[float, ...], tuple[float, ...]] | None]:
    """The links of a `HeldRobot`."""
    return {name: (float(body.mass), tuple(body.com), tuple(body.inertia)) for name, body in bodies.items()}


def told_frames(
    postures: Iterable[Mapping[str, float]], frames: Callable[[Mapping[str, float]], Mapping[str, RigidTransform]]
) -> dict[str, list[list[float]]]:
    """The frames of a `HeldRobot`: `frames` has those of all links at values of joints."""
    found: dict[str, list[list[float]]] = {}
    for values in postures:
        for name, frame in frames(values).items():
            found.setdefault(name, []).append(_matrix(frame))
    return found


def _matrix(frame: RigidTransform) -> list[float]:
    a, b, c, d, e, f, g, h, i = frame.rotation
    x, y, z = frame.translation
    return [float(each) for each in (a, b, c, x, d, e, f, y, g, h, i, z, 0.0, 0.0, 0.0, 1.0)]


def lengths(x: float, y: float, z: float) -> tuple[float, float, float]:
    """The lengths of a shape along its axes, the longest first [m]."""
    first, second, third = sorted((float(x), float(y), float(z)), reverse=True)
    return first, second, third


def lengths_of(vertices: Any) -> tuple[float, float, float]:  # noqa: ANN401 - an array of shape (n, 3)
    """The lengths of a mesh along its axes, the longest first [m]."""
    import numpy as np

    return lengths(*np.ptp(np.asarray(vertices, dtype=float).reshape(-1, 3), axis=0))
