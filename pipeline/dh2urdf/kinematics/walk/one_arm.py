"""The walk of one arm at many joint vectors, in a third of the calls of numpy that columns of arms take.

The arrays of one arm are so short that the calls themselves are most of the time. So the axes stay in one array, the
factors of all steps are worked out before the walk, and the origin is summed up after it, for all moves at once.
Factors have the shape of what they multiply, or no dimension: numpy takes three times as long where it has
to stretch an array. Products and sums are those of `STACKS`, in the same order, and so every bit of the figures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.kinematics.walk import _MIX, _MOVE, _SCREW, _STOP, _TURN, _UNNAMED, STACKS, Frame, _about, _renamed

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

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

    multiply, add, subtract = np.multiply, np.add, np.subtract
    axes, cosine_times, sine_times, sums = np.empty((4, 3, 3, values.shape[1]))
    axes[:] = np.eye(3)[:, :, None]
    thirds, of_mixes = np.empty((3, *axes.shape)), axes[:, None]
    each, kept, turned, summed = list(axes), list(cosine_times), list(sine_times), list(thirds)
    lengths = _lengths([step for step in steps if step[0] == _MOVE], values)
    turns = iter(_turns([step for step in steps if step[0] == _TURN], cosines, sines))
    mixes = iter(_matrices([step for step in steps if step[0] in {_MIX, _SCREW}], cosines, sines))
    along = np.empty((len(lengths), *axes.shape[1:]))
    moves, names = zip(lengths, along, strict=True), _UNNAMED
    for kind, axis, _, numbers in steps:
        if kind == _MOVE:
            length, move = next(moves)
            multiply(length, each[axis], move)
        elif kind == _TURN:
            cosine, sine = next(turns)
            multiply(cosine, axes, cosine_times)
            multiply(sine, axes, sine_times)
            after, last = axis - 2, axis - 1
            add(kept[after], turned[last], each[after])
            subtract(kept[last], turned[after], each[last])
        elif kind == _STOP:
            names = numbers
        else:
            matrix = next(mixes)
            if numbers[1] is _UNNAMED:
                multiply(matrix, of_mixes, thirds)
                x, y, z = summed
            else:
                x, y, z = _named(matrix, numbers[1], of_mixes, thirds)
            add(x, y, sums)
            add(sums, z, axes)
    # Sums along another dimension than the last are made one after the other.
    origin = add.reduce(along, axis=0) if lengths else np.zeros(axes.shape[1:])
    return Frame(_renamed(list(axes[..., None]), names, STACKS), origin[..., None])


def _lengths(moves: Sequence[Step], values: Array) -> list[Array]:
    """The lengths of moves: arrays without dimensions, or of shape (3, P) where they belong to joints."""
    import numpy as np

    fixed = np.array([numbers[0] for _, _, _, numbers in moves], dtype=float)
    return [
        fixed[place, ...] if joint is None else np.tile(length + factor * values[joint], (3, 1))
        for place, (_, _, joint, (length, factor)) in enumerate(moves)
    ]


def _turns(turns: Sequence[Step], cosines: Array, sines: Array) -> Iterator[tuple[Array, Array]]:
    """The cosines and sines of turns: arrays without dimensions, or of shape (3, 3, P) where they belong to joints."""
    import numpy as np

    fixed = [(1.0, 0.0, numbers[2]) if numbers[0] is None else numbers for _, _, _, numbers in turns]
    cosine, sine, sign = np.array(fixed, dtype=float).reshape(-1, 3).T
    places = [place for place, (_, _, joint, _) in enumerate(turns) if joint is not None]
    joints: list[Any] = [turns[place][2] for place in places]
    a, b, sign = (each[places, None] for each in (cosine, sine, sign))
    c, s = cosines[joints], sines[joints]
    both = np.repeat((a * c + -sign * b * s, b * c + sign * a * s), 9, axis=1)
    moving = zip(*both.reshape(2, -1, 3, 3, cosines.shape[1]), strict=True)
    for place, (_, _, joint, _) in enumerate(turns):
        yield (cosine[place, ...], sine[place, ...]) if joint is None else next(moving)


def _named(matrix: Array, names: Names, of_mixes: Array, thirds: Array) -> list[Array]:
    """The products of the rows of a matrix with the axes that have these names."""
    for (name, sign), row in zip(names, matrix, strict=True):
        thirds[name] = row * of_mixes[name]
        thirds[name] *= sign
    return [thirds[name] for name, _ in names]


def _matrices(mixes: Sequence[Step], cosines: Array, sines: Array) -> Array:
    """The matrices of M mixes, of shape (M, 3, 3, 1, P): each row belongs to one of the axes."""
    import numpy as np

    if not mixes:
        return ()
    places = [place for place, (kind, _, _, _) in enumerate(mixes) if kind == _SCREW]
    joints: list[Any] = [mixes[place][2] for place in places]
    x, y, z = np.array([mixes[place][3][0] for place in places], dtype=float).reshape(-1, 3).T[:, :, None]
    matrices = np.stack(_about(x, y, z, cosines[joints], sines[joints]), axis=1)
    if len(places) < len(mixes):
        of_screws, matrices = matrices, np.empty((len(mixes), *matrices.shape[1:]))
        matrices[places] = of_screws
        for place, (kind, _, _, numbers) in enumerate(mixes):
            if kind == _MIX:
                matrices[place] = np.array(numbers[0])[:, None]
    return matrices.reshape(len(mixes), 3, 3, 1, -1)
