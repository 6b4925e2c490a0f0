from __future__ import annotations

import pytest
from hypothesis import given, strategies as st

from dh2urdf.source import Mark, Problem, did_you_mean, shown

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
