"""Options that every simulator has."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatorOptions:
    """What is measured in a simulator."""

    poses: int = field(default=25, metadata={"help": "random joint vectors at which tool0 is compared with the table"})

    def __post_init__(self) -> None:
        if self.poses < 1:
            raise ValueError("poses is a number from 1 on")
