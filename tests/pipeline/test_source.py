from __future__ import annotations

import pytest
from hypothesis import given, strategies as st

from dh2urdf.source import SHOWN_TEXT, Mark, Problem, did_you_mean, shown

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


class TestMark:
    @pytest.mark.parametrize(
        ("mark", "text"),
        [
            (Mark(file="a.csv", line=3, column=7), "a.csv:3:7"),
            (Mark(file="a.csv", line=3), "a.csv:3"),
            (Mark(file="command line"), "command line"),
        ],
    )
    def test_a_mark_is_written_as_editors_read_it(self, mark: Mark, text: str) -> None:
        """A mark is file:line:column, as far as it is known."""
        assert str(mark) == text


class TestProblem:
    def test_a_full_problem_reads_as_prose(self) -> None:
        """A problem says where, about what, what is wrong, what is accepted and what to do, in this order."""
        assert str(FULL).splitlines() == [
            "ur5.csv:3:7: error: joint 'elbow', field 'alpha': the twist is larger than a whole turn",
            "    accepted: an angle in rad, or with a unit, such as 90deg",
            "    did you mean 90deg?",
        ]

    def test_a_problem_of_a_whole_manipulator_names_it(self) -> None:
        """Where no joint is concerned, the manipulator is named."""
        problem = Problem(message="it has no rows", severity="notice", robot="ur5")
        assert str(problem) == "notice: manipulator 'ur5': it has no rows"

    def test_a_problem_without_a_place_is_its_sentence(self) -> None:
        """What is not known is left out."""
        assert str(Problem(message="nothing to do")) == "error: nothing to do"

    def test_as_json(self) -> None:
        """A report has the fields that a script asks for, and the suggestion in the message."""
        assert FULL.as_json() == {
            "file": "ur5.csv",
            "line": 3,
            "column": 7,
            "place": None,
            "joint": "elbow",
            "field": "alpha",
            "found": "90",
            "accepted": "an angle in rad, or with a unit, such as 90deg",
            "message": "the twist is larger than a whole turn; did you mean 90deg?",
        }

    def test_as_json_without_a_mark(self) -> None:
        """What is not known is null."""
        entry = Problem(message="nothing to do").as_json()
        assert entry.pop("message") == "nothing to do"
        assert set(entry) == {"file", "line", "column", "place", "joint", "field", "found", "accepted"}
        assert set(entry.values()) == {None}

    def test_about_fills_in_what_is_missing_only(self) -> None:
        """The manipulator and its place are filled in where a problem has none of its own."""
        other = Mark(file="b.csv", line=1)
        assert FULL.about(robot="other", mark=other) == FULL
        filled = Problem(message="m").about(robot="ur5", mark=other)
        assert (filled.robot, filled.mark) == ("ur5", other)


class TestShown:
    def test_a_text_is_quoted(self) -> None:
        """A text of a table is in quotes, letters of all scripts as they are."""
        assert shown("bras_été_肘") == "'bras_été_肘'"

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("\x1b[31mred", r"'\x1b[31mred'"),
            ("two\nlines", r"'two\nlines'"),
            ("\u202eleft", r"'\u202eleft'"),
            ("lone \udc80", r"'lone \udc80'"),
        ],
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

    def test_a_long_text_is_cut(self) -> None:
        """A long text ends in an ellipsis; one that just fits does not."""
        assert shown("x" * SHOWN_TEXT) == f"'{'x' * SHOWN_TEXT}'"
        assert shown("x" * (SHOWN_TEXT + 1)) == f"'{'x' * SHOWN_TEXT}…'"
        assert len(shown("x" * 10**7)) == SHOWN_TEXT + 3


class TestDidYouMean:
    @pytest.mark.parametrize("word", ["frmaes", "Frames", "frame"])
    def test_the_nearest_choice_is_named(self, word: str) -> None:
        """A slip of a finger, a capital and a missing letter find the word that was meant."""
        assert did_you_mean(word, ["variant", "frames"]) == "did you mean 'frames'?"

    @pytest.mark.parametrize("choices", [[], ["variant", "frames"]])
    def test_where_nothing_is_near_it_is_silent(self, choices: list[str]) -> None:
        """A word that is near nothing gets no guess."""
        assert did_you_mean("colour", choices) is None
