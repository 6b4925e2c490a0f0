"""The walk of one arm at many joint vectors, in a third of the calls of numpy that columns of arms take.

The arrays of one arm are so short that the calls themselves are most of the time. So the axes stay in one array, the
factors of all steps are worked out before the walk, and the origin is summed up after it, for all moves at once.
Products and sums are those of `STACKS`, in the same order: the figures are the same to the last bit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.kinematics.walk import _MOVE, _SCREW, _STOP, _TURN, _UNNAMED, STACKS, Frame, _about, _renamed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.kinematics.walk import Names, Step

Array = Any


def walk_of_one(steps: Sequence[Step], values: Array, cosines: Array, sines: Array) -> Frame:
    """The frame at the last stop of a chain of floats, as arrays of shape (3, P, 1).

    Args:
        steps: those of the chain.
        values: the values of n joints at P joint vectors, of shape (n, P) [rad or m].
        cosines: their cosines.
        sines: their sines.
    """
    import numpy as np

    poses, multiply, add = values.shape[1], np.multiply, np.add
    axes = np.empty((3, 3, poses))
    axes[:] = np.eye(3)[:, :, None]
    # The axes that a turn turns: the one after its own, and the one before.
    turned = [(pair, pair[::-1]) for pair in (axes[1:3], axes[2::-2], axes[0:2])]
    left, right = np.empty((2, 2, 3, poses))
    thirds, sums, each = np.empty((3, 3, 3, poses)), np.empty((3, 3, poses)), axes[:, None]
    lengths = _lengths([step for step in steps if step[0] == _MOVE], values)
    turns = iter(_turns([step for step in steps if step[0] == _TURN], cosines, sines))
    mixes = iter(_matrices([step for step in steps if step[0] not in {_MOVE, _TURN, _STOP}], cosines, sines))
    along = np.empty((len(lengths), 3, poses))
    moves, names = iter(along), _UNNAMED
    for kind, axis, _, numbers in steps:
        if kind == _MOVE:
            next(moves)[:] = axes[axis]
        elif kind == _TURN:
            cosine, sine = next(turns)
            pair, reverse = turned[axis]
            multiply(cosine, pair, left)
            multiply(sine, reverse, right)
            add(left, right, pair)
        elif kind == _STOP:
            names = numbers
        else:
            names_before: Names = numbers[1]
            x, y, z = [name for name, _ in names_before]
            matrix = next(mixes)[np.argsort((x, y, z))] if names_before is not _UNNAMED else next(mixes)
            multiply(matrix, each, thirds)
            for name, sign in names_before:
                if sign < 0:
                    thirds[name] *= sign
            add(thirds[x], thirds[y], sums)
            add(sums, thirds[z], axes)
    along *= lengths
    # Sums along another dimension than the last are made one after the other.
    origin = add.reduce(along, axis=0) if len(along) else np.zeros((3, poses))
    return Frame(_renamed(list(axes[..., None]), names, STACKS), origin[..., None])


def _lengths(moves: Sequence[Step], values: Array) -> Array:
    """The lengths of M moves, of shape (M, 1, P)."""
    import numpy as np

    lengths = np.empty((len(moves), 1, values.shape[1]))
    lengths[:, 0] = np.array([numbers[0] for _, _, _, numbers in moves]).reshape(-1, 1)
    for place, (_, _, joint, (length, factor)) in enumerate(moves):
        if joint is not None:
            lengths[place] = length + factor * values[joint]
    return lengths


def _turns(turns: Sequence[Step], cosines: Array, sines: Array) -> zip[tuple[Array, Array]]:
    """What M turns multiply both axes by, and the other ones, each of shape (2, 3, P)."""
    import numpy as np

    fixed = [(1.0, 0.0, numbers[2]) if numbers[0] is None else numbers for _, _, _, numbers in turns]
    cosine, sine, sign = np.array(fixed, dtype=float).reshape(-1, 3).T[:, :, None]
    places = [place for place, (_, _, joint, _) in enumerate(turns) if joint is not None]
    joints: list[Any] = [turns[place][2] for place in places]
    both, other = np.empty((2, len(turns), 2, 3, cosines.shape[1]))
    both[:] = cosine[:, :, None, None]
    other[:, 0], other[:, 1] = sine[:, :, None], -sine[:, :, None]
    if places:
        a, b, sign = cosine[places], sine[places], sign[places]
        c, s = cosines[joints], sines[joints]
        both[places] = (a * c + -sign * b * s)[:, None, None]
        moved = (b * c + sign * a * s)[:, None]
        other[places, 0], other[places, 1] = moved, -moved
    return zip(both, other, strict=True)


def _matrices(mixes: Sequence[Step], cosines: Array, sines: Array) -> Array:
    """The matrices of M mixes, of shape (M, 3, 3, 1, P): each row belongs to one of the axes."""
    import numpy as np

    matrices = np.empty((9, len(mixes), cosines.shape[1]))
    places: list[int] = []
    for place, (kind, _, _, numbers) in enumerate(mixes):
        if kind == _SCREW:
            places.append(place)
        else:
            matrices[:, place] = np.array(numbers[0])[:, None]
    if places:
        joints: list[Any] = [mixes[place][2] for place in places]
        x, y, z = np.array([mixes[place][3][0] for place in places], dtype=float).T[:, :, None]
        for elements, of_screws in zip(matrices, _about(x, y, z, cosines[joints], sines[joints]), strict=True):
            elements[places] = of_screws
    return matrices.reshape(3, 3, len(mixes), 1, -1).transpose(2, 0, 1, 3, 4) if mixes else matrices
