"""Points of the unit cube, each of which can be made by itself.

Point `index` of a sample depends on the seed, the number of points and its index alone, and no function keeps anything
that grows with their number: so any part of a run can be made anywhere, in any order. All is whole-number arithmetic
and BLAKE2, whose results no processor and no library changes.

Sources: Salmon et al., Parallel random numbers: as easy as 1, 2, 3 (SC 2011), for generators that count; McKay,
Beckman and Conover (Technometrics 21, 1979) for Latin hypercubes; Black and Rogaway, Ciphers with arbitrary finite
domains (CT-RSA 2002), for permutations that need no table; Steele, Lea
and Flood (OOPSLA 2014), for the mixing in them; Joe and Kuo (SIAM J. Sci. Comput. 30, 2008) for the
direction numbers of Sobol sequences, which scipy has; L'Ecuyer and Lemieux (2002) for digital shifts.
"""

from __future__ import annotations

from enum import StrEnum
from functools import lru_cache
from hashlib import blake2b
from math import isqrt
from typing import TYPE_CHECKING

from dh2urdf.errors import MissingDependencyError

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

MOST_POINTS = 10**9
"""Points of a sample: fewer than the 2**30 of scipy's Sobol sequences."""
SOBOL_DIMENSIONS = 21201
"""Dimensions for which there are direction numbers."""

_BITS = 52  # (word + 1/2) / 2**52 is exact, and neither 0 nor 1.
_WORDS = 8  # of 64 bits, in a digest of BLAKE2b
_SOBOL_BITS = 30
_ROUNDS = 6  # of the Feistel network; four already make a good one where the round function is
_MASK = 2**64 - 1


class Sampling(StrEnum):
    """How the points of a sample spread over the unit cube."""

    RANDOM = "random"
    """Independent points."""
    LATIN_HYPERCUBE = "latin-hypercube"
    """In every dimension, each of `count` equal parts holds one point."""
    SOBOL = "sobol"
    """The points of a Sobol sequence in base 2, shifted by the seed: 2**m of them are spread most evenly."""


def require(sampling: Sampling) -> None:
    """Make sure that a kind of sampling can be done here; a MissingDependencyError says what is missing."""
    if sampling is Sampling.SOBOL:
        _sobol_engine(1)


def points(
    sampling: Sampling, *, seed: int | str, count: int, indices: Sequence[int], dimensions: int
) -> NDArray[np.float64]:
    """Points of a sample of so many, by their indices from 0: an array of shape (dimensions, len(indices)).

    Each coordinate is above 0 and below 1. There are up to `MOST_POINTS` points, and for Sobol sequences up to
    `SOBOL_DIMENSIONS` dimensions.

    Raises:
        MissingDependencyError: scipy is needed and not installed.
    """
    import numpy as np

    if sampling is Sampling.SOBOL:
        return np.array([_sobol(seed, count, index, dimensions) for index in indices]).T.copy()
    blocks = range(-(-dimensions // _WORDS))
    digests = b"".join([_digest(f"{seed} point {index} {block}") for index in indices for block in blocks])
    words = np.frombuffer(digests, dtype=">u8").astype(np.uint64) >> np.uint64(64 - _BITS)
    coordinates = (words.astype(float) + 0.5) / 2.0**_BITS  # exact, as words are of `_BITS` bits
    coordinates = coordinates.reshape(len(indices), -1).T[:dimensions].copy()
    if sampling is Sampling.LATIN_HYPERCUBE:
        for dimension, row in enumerate(coordinates):
            strata = [permuted(index, count, f"{seed} dimension {dimension}") for index in indices]
            row[:] = np.minimum((np.array(strata, dtype=float) + row) / count, 1.0 - 2.0**-53)
    return coordinates


def permuted(index: int, count: int, key: str) -> int:
    """Where a permutation of `range(count)` has an index: a Feistel network, walked until it is back in the range."""
    side = isqrt(count - 1) + 1  # side² is count or little more: few walks take more than one step
    keys = _round_keys(key)
    while True:
        left, right = divmod(index, side)
        for round_key in keys:
            left, right = right, (left + _mixed(right ^ round_key)) % side
        index = left * side + right
        if index < count:
            return index


def regrouped(index: int, groups: int, count: int, seed: int | str) -> int:
    """The point for an index where `index % groups` decides what the point is combined with, such as a point of a grid.

    Each group has points that follow each other, which a Sobol sequence spreads evenly. It does not do so with every
    second or fourth point: they are all in one half or quarter of the first coordinate. Which points a group has is
    random, so that groups that are neighbours of each other are not neighbours in the sample.
    """
    place, group = divmod(index, groups)
    size, larger = divmod(count, groups)  # so many groups have a point more
    first, among = (0, larger) if group < larger else (larger, groups - larger)
    block = first + permuted(group - first, among, f"{seed} groups")
    return block * size + min(block, larger) + place


@lru_cache(maxsize=65536)
def _round_keys(key: str) -> list[int]:
    return _words(f"{key} rounds")[:_ROUNDS]


def _mixed(word: int) -> int:
    """SplitMix64's finalizer: every bit of the result depends on every bit of the word."""
    word = ((word ^ (word >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
    word = ((word ^ (word >> 27)) * 0x94D049BB133111EB) & _MASK
    return word ^ (word >> 31)


def _words(text: str) -> list[int]:
    """Random whole numbers of `_BITS` bits, the same for the same text."""
    digest = _digest(text)
    return [int.from_bytes(digest[first : first + 8], "big") >> (64 - _BITS) for first in range(0, 8 * _WORDS, 8)]


def _digest(text: str) -> bytes:
    return blake2b(text.encode(), person=b"dh2urdf").digest()


# --- Sobol sequences --------------------------------------------------------------------------------------------------


def _sobol(seed: int | str, count: int, index: int, dimensions: int) -> list[float]:
    gray = index ^ (index >> 1)
    words = [_shift(seed, dimension) for dimension in range(dimensions)]
    for bit, directions in enumerate(_directions(dimensions, (count - 1).bit_length())):
        if gray >> bit & 1:
            words = [word ^ direction for word, direction in zip(words, directions, strict=True)]
    return [(word + 0.5) / 2.0**_BITS for word in words]


@lru_cache(maxsize=65536)
def _shift(seed: int | str, dimension: int) -> int:
    return _words(f"{seed} shift {dimension}")[0]


@lru_cache(maxsize=16)
def _directions(dimensions: int, bits: int) -> list[list[int]]:
    """The direction numbers of a Sobol sequence, as scipy has them: for every bit, one per dimension.

    scipy goes from point to point in the order of Gray codes, where point 2**i differs from the start by the directions
    of the bits i and i - 1: its public points give them away.
    """
    directions: list[list[int]] = []
    before = [0] * dimensions
    for bit in range(bits):
        engine = _sobol_engine(dimensions)
        engine.fast_forward(2**bit)
        words = [int(x * 2.0**_BITS) for x in engine.random(1)[0].tolist()]
        before = [word ^ other for word, other in zip(words, before, strict=True)]
        directions.append(before)
    return directions


def _sobol_engine(dimensions: int):  # type: ignore[no-untyped-def]  # noqa: ANN202 - scipy has no types
    try:
        from scipy.stats import qmc
    except ImportError as error:
        raise MissingDependencyError("sampling 'sobol'", "scipy", "dh2urdf[sampling]", error) from error
    return qmc.Sobol(dimensions, scramble=False, bits=_SOBOL_BITS)
