"""How collision pairs are looked for."""

from __future__ import annotations

from dataclasses import dataclass, field

from dh2urdf.errors import ConfigError
from dh2urdf.source import Problem

TRIALS = 10_000
"""Random states in which a pair that is `Never` does not touch; MoveIt's setup assistant tries as many."""
MOST_TRIALS = 10_000_000
MIN_DISTANCE = 0.01
"""How near a pair that is `Never` does not come in these states [m]."""
FARTHEST = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PairOptions:
    """How collision pairs are looked for."""

    trials: int = field(default=TRIALS, metadata={"help": "random states in which pairs that never touch are sought"})
    seed: int = field(default=0, metadata={"help": "seed of the random states; the same seed finds the same pairs"})
    min_distance: float = field(
        default=MIN_DISTANCE,
        metadata={"help": "a pair that comes nearer than this is not Never [m]", "measures": "length"},
    )

    def __post_init__(self) -> None:
        """Refuses what finds no pairs.

        Raises:
            ConfigError: a number is out of its range.
        """
        ranges = {
            "trials": (self.trials, 1 <= self.trials <= MOST_TRIALS, f"1 to {MOST_TRIALS}"),
            "seed": (self.seed, self.seed >= 0, "0 or more"),
            "min_distance": (self.min_distance, 0.0 <= self.min_distance <= FARTHEST, f"0 to {FARTHEST:g} [m]"),
        }
        problems = [
            Problem(message=f"{name} is out of its range", field=name, found=f"{value:.9g}", accepted=accepted)
            for name, (value, is_right, accepted) in ranges.items()
            if not is_right
        ]
        if problems:
            raise ConfigError(problems)
