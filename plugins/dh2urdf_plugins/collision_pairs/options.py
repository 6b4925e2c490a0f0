"""How collision pairs are looked for."""

from __future__ import annotations

from dataclasses import dataclass

from dh2urdf_plugins.options import option

TRIALS = 10_000  # random states in which a pair that is `Never` does not touch; MoveIt's setup assistant tries as many
MOST_TRIALS = 10_000_000
MIN_DISTANCE = 0.01  # how near a pair that is `Never` does not come in these states [m]
FARTHEST = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PairOptions:
    """How collision pairs are looked for."""

    trials: int = option("random states in which pairs that never touch are sought", TRIALS)
    seed: int = option("seed of the random states; the same seed finds the same pairs", 0)
    min_distance: float = option("a pair that comes nearer than this is not Never [m]", MIN_DISTANCE, measures="length")

    def __post_init__(self) -> None:
        if not 1 <= self.trials <= MOST_TRIALS:
            raise ValueError(f"trials is a number from 1 to {MOST_TRIALS}")
        if self.seed < 0:
            raise ValueError("seed is a number from 0 on")
        if not 0.0 <= self.min_distance <= FARTHEST:
            raise ValueError(f"min_distance is from 0 to {FARTHEST:g} m")
