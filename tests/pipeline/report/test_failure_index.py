import json
import re
from collections import Counter
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.report.verdicts import MAX_NAMES, MAX_REASONS, FailureIndex
from dh2urdf.source import LONGEST_PATTERN, pattern


def row(name: str = "arm", **facts: Any) -> dict[str, Any]:
    """What the index looks at in a row of the manifest."""
    return {"name": name, "status": "ok", "kind": None, "errors": [], **facts}


def failed(name: str, kind: str, message: str) -> dict[str, Any]:
    return row(name, status="failed", kind=kind, errors=[{"message": message, "file": "arms.csv", "line": 3}])


MESSAGES = (
    "'{q}' is more than a full turn in rad, and no unit is declared for it",
    "what the emitter 'urdf' wrote is not the arm of the table: tool0 is off by {x} m at q = [{x}, {x}]",
    "the worker crashed (segmentation fault)",
    "it didn't answer within {n} s",
)
KINDS = ("table", "proof", "crash", "time limit")


class TestIndex:
    @given(
        st.lists(
            st.tuples(
                st.sampled_from(range(5)), st.integers(0, 10**9), st.floats(allow_nan=False, allow_infinity=False)
            ),
            max_size=60,
        )
    )
    def test_counts_are_those_of_the_rows(self, outcomes: list[tuple[int, int, float]]) -> None:
        """By kind and by reason, as a plain count finds them; examples and names are those of the first rows."""
        index, rows = FailureIndex(), []
        for number, (which, n, x) in enumerate(outcomes):
            if which == len(KINDS):
                rows.append(row(f"arm_{number}"))
            else:
                rows.append(failed(f"arm_{number}", KINDS[which], MESSAGES[which].format(q=f"{x} deg", n=n, x=x)))
            index.add(rows[-1])
        found = json.loads(json.dumps(index.as_json()))
        bad = [each for each in rows if each["status"] == "failed"]
        assert (found["manipulators"], found["ok"], found["failed"]) == (len(rows), len(rows) - len(bad), len(bad))
        assert {kind: failures["count"] for kind, failures in found["failures"].items()} == Counter(
            each["kind"] for each in bad
        )
        counts = [failures["count"] for failures in found["failures"].values()]
        assert counts == sorted(counts, reverse=True)
        for kind, failures in found["failures"].items():
            of_kind = [each for each in bad if each["kind"] == kind]
            assert failures["names"] == [each["name"] for each in of_kind]
            (reason,) = failures["reasons"]
            assert reason["count"] == len(of_kind)
            assert reason["example"] == of_kind[0]["errors"][0]["message"]

    def test_the_index_stays_small(self) -> None:
        """Of many names the first ones are listed, of many reasons the first ones are distinguished; all are counted."""
        index = FailureIndex()
        words = [f"{chr(97 + k // 26)}{chr(97 + k % 26)}" for k in range(MAX_REASONS + 50)]
        for number in range(10 * len(words)):
            index.add(failed(f"arm_{number}", "emitter", f"{words[number % len(words)]} {'x' * 10_000}"))
        failures = index.as_json()["failures"]["emitter"]
        assert failures["count"] == 10 * len(words)
        assert failures["names"] == [f"arm_{number}" for number in range(MAX_NAMES)]
        assert [reason["pattern"][:2] for reason in failures["reasons"]] == words[:MAX_REASONS]
        assert {reason["count"] for reason in failures["reasons"]} == {10}
        assert {len(reason["pattern"]) for reason in failures["reasons"]} == {LONGEST_PATTERN}
        assert failures["other_reasons"] == 10 * 50

    @pytest.mark.parametrize(
        ("message", "what"),
        [
            ("off by 1.5e-07 m and −3 rad, q = [0.1, -0.2, inf]", "off by # m and # rad, q = [#]"),
            ("joint_12: 5,000 joints, nan kg", "joint_#: # joints, # kg"),
            ("the name 'a b 7' is that of \"it's\"", "the name '…' is that of '…'"),
            ("it doesn't move, and it can't", "it doesn't move, and it can't"),
            ("information about infinity", "information about infinity"),
        ],
    )
    def test_a_pattern_keeps_what_was_said(self, message: str, what: str) -> None:
        """Numbers and quoted texts are taken out, and nothing else: no word that only looks like one of them."""
        assert pattern(message) == what
        assert not re.search(r"\d", pattern(message))
