"""What failed in a run, and why: gathered while the rows of its manifest pass by; none is kept."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dh2urdf.conversion.outcome import ManifestRow

MAX_REASONS = 100
"""Reasons of one kind of failure that the index tells apart."""
MAX_NAMES = 1000
"""Names of one kind of failure that the index lists."""
LONGEST_REASON = 300
"""Characters of a reason; of a longer one the beginning counts."""

_QUOTED = re.compile(r"(?<!\w)('[^']*'|\"[^\"]*\")(?!\w)")
_NUMBER = re.compile(r"[-+−]?\d+(?:[.,]\d+)*(?:e[-+]?\d+)?|\b(?:nan|inf)\b", re.IGNORECASE)
_NUMBERS = re.compile(r"#(?:, #)+")


@dataclass(slots=True)
class _Failures:
    """The failures of one kind: the first names; of each reason how often it was given, and the first message."""

    count: int = 0
    names: list[str] = field(default_factory=list)
    reasons: Counter[str] = field(default_factory=Counter)
    examples: dict[str, str] = field(default_factory=dict)


class FailureIndex:
    """What failed in a run, and why, by kind: gathered while the rows of its manifest pass by."""

    def __init__(self) -> None:
        self._statuses: Counter[str] = Counter()
        self._failures: dict[str, _Failures] = {}

    def add(self, row: ManifestRow) -> None:
        """Take one row of the manifest."""
        self._statuses[row["status"]] += 1
        if row["status"] != "failed":
            return
        message = row["errors"][0]["message"] if row["errors"] else ""
        found = self._failures.setdefault(row["kind"] or "", _Failures())
        found.count += 1
        if len(found.names) < MAX_NAMES:
            found.names.append(row["name"])
        reason = pattern(message)
        if reason in found.reasons or len(found.reasons) < MAX_REASONS:
            found.reasons[reason] += 1
            found.examples.setdefault(reason, message)

    def as_json(self) -> dict[str, Any]:
        """Return the index as plain data.

        ::

            {
              "manipulators": 1000000,
              "ok": 999985,
              "failed": 15,
              "failures": {
                "table": {                      the kind; the commonest first
                  "count": 12,
                  "reasons": [                  at most 100, the commonest first
                    {
                      "count": 12,              manipulators whose first error has this pattern
                      "pattern": "'…' is more than a full turn in rad, and no unit is declared for it",
                      "example": "'90' is more than a full turn in rad, …"
                    }
                  ],
                  "other_reasons": 0,           manipulators with reasons beyond these
                  "names": ["robot_17", …]      at most 1,000, in the order of the run
                },
                …
              }
            }
        """
        kinds = sorted(self._failures.items(), key=lambda item: -item[1].count)
        return {
            "manipulators": self._statuses.total(),
            "ok": self._statuses["ok"],
            "failed": self._statuses["failed"],
            "failures": {
                kind: {
                    "count": found.count,
                    "reasons": [
                        {"count": count, "pattern": reason, "example": found.examples[reason]}
                        for reason, count in found.reasons.most_common()
                    ],
                    "other_reasons": found.count - found.reasons.total(),
                    "names": found.names,
                }
                for kind, found in kinds
            },
        }


def pattern(message: str) -> str:
    """Return a message without what differs between manipulators: quoted text is '…', a number or several are #."""
    without = _NUMBER.sub("#", _QUOTED.sub("'…'", message[: 4 * LONGEST_REASON]))
    return _NUMBERS.sub("#", without)[:LONGEST_REASON]
