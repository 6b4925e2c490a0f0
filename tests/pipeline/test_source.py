from dataclasses import replace
from itertools import chain
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.source import Cause, Mark, Problem, did_you_mean, shown

FULL = Problem(
    message="the twist is larger than a whole turn",
    mark=Mark(file="ur5.csv", line=3, column=7),
    robot="ur5",
    joint="elbow",
    field="alpha",
    found="90",
    accepted="an angle in rad, or with a unit, such as 90deg",
    suggestion="did you mean 90deg?",
)


class TestProblem:
    def test_a_full_problem_reads_as_prose(self) -> None:
        """A problem says where, about what, what is wrong, what is accepted and what to do, in this order."""
        assert str(FULL).splitlines() == [
            "ur5.csv:3:7: error: joint 'elbow', field 'alpha': the twist is larger than a whole turn",
            "    accepted: an angle in rad, or with a unit, such as 90deg",
            "    did you mean 90deg?",
        ]

    def test_about_fills_in_what_is_missing_only(self) -> None:
        """The manipulator and its place are filled in where a problem has none of its own."""
        other = Mark(file="b.csv", line=1)
        assert FULL.about(robot="other", mark=other) == FULL
        filled = Problem(message="m").about(robot="ur5", mark=other)
        assert (filled.robot, filled.mark) == ("ur5", other)


class TestShown:
    @pytest.mark.parametrize(
        ("text", "expected"),
        [("\x1b[31mred", r"'\x1b[31mred'"), ("\u202eleft", r"'\u202eleft'"), ("lone \udc80", r"'lone \udc80'")],
    )
    def test_what_would_act_on_a_terminal_is_spelled_out(self, text: str, expected: str) -> None:
        """Escape sequences, line ends, direction marks and lone surrogates of a table never reach the terminal."""
        assert shown(text) == expected

    @given(st.text(st.characters(codec=None), max_size=400), st.integers(1, 80))
    def test_any_text_is_one_short_printable_line(self, text: str, limit: int) -> None:
        """Whatever a table says, a message repeats it as one printable line of bounded length."""
        line = shown(text, limit)
        assert line.isprintable()
        assert len(line) <= limit + 3
        assert line.encode()


class TestDidYouMean:
    @pytest.mark.parametrize("word", ["frmaes", "Frames", "frame"])
    def test_the_nearest_choice_is_named(self, word: str) -> None:
        """A slip of a finger, a capital and a missing letter find the word that was meant."""
        assert did_you_mean(word, ["variant", "frames"]) == "did you mean 'frames'?"


class TestCauses:
    @pytest.mark.parametrize(
        ("other", "is_one"),
        [
            ({"robot": "panda", "joint": "j3", "mark": None}, True),
            ({"message": "'j9' turns by 7 and 8e-3", "found": "-3.1"}, True),
            ({"found": "limts"}, False),
            ({"message": "'j9' slides by 7"}, False),
            ({"field": "beta"}, False),
            ({"severity": "notice"}, False),
        ],
    )
    def test_names_and_numbers_do_not_make_a_cause(self, other: dict[str, Any], is_one: bool) -> None:  # noqa: FBT001
        """Two problems have one cause if they differ in where they are, in names and in numbers only."""
        one = replace(FULL, message="'j1' turns by 2")
        assert (one.cause == replace(one, **other).cause) is is_one

    def test_it_comes_back_from_a_report(self) -> None:
        """With its place; what is suggested is a part of the message there, and the manipulator is the row's."""
        back = Problem.from_json(FULL.as_json(), FULL.severity, FULL.robot)
        assert back == replace(FULL, message=f"{FULL.message}; {FULL.suggestion}", suggestion=None)

    @given(st.lists(st.lists(st.integers(1, 30), max_size=9), max_size=9))
    def test_batches_add_up(self, batches: list[list[int]]) -> None:
        """However they are cut into batches, all are counted, and the first places are named."""
        cause, lines = Cause(FULL), [*chain.from_iterable(batches)]
        for batch in batches:
            cause.add([replace(FULL, mark=Mark(file="ur5.csv", line=line)) for line in batch])
        assert cause.count == 1 + len(lines)
        named = cause.elsewhere.removeprefix(f"{len(lines)} more: ").partition(" and ")[0]
        assert named == ", ".join(f"line {line}" for line in dict.fromkeys(lines[:4]))
