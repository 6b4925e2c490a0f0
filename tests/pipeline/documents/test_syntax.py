from __future__ import annotations

import pytest

from dh2urdf.documents import load_yaml
from dh2urdf.errors import ConfigError


@pytest.mark.parametrize(
    ("text", "place", "advice"),
    [
        ("a:\n\t- b", "2:1", "indent with spaces"),
        ("a: b: c", "1:5", "quote a text that holds ': '"),
        ("a: 1\n b: 2", "2:3", "indent the keys of a mapping alike"),
        ("name:arm\nx: 1", "2:2", "indent the keys of a mapping alike"),
        ("a: 1\nb", "2:1", "each line of a mapping is `name: value`"),
        ("a: @x", "1:4", "quote a text that starts with this character"),
        ("a: `x`", "1:4", "quote a text that starts with this character"),
        ("a: [1, 2", "1:4", "close the bracket that opens here"),
        ("a: [1, 2}", "1:9", "a comma between the values"),
        ("a: {x: 1\nb: 2\n", "2:2", "comma"),
        ("a: ]", "1:4", "a bracket or comma is too many"),
        ("x: 1\na: 'abc", "2:4", "close the quote that opens here"),
        ("a: *", "1:4", "quote a text that starts with * or &"),
        (r'a: "C:\new\q"', "1:11", "use single quotes"),
        ("a:\n- b: 1\n - c: 2", "3:2", "indent the keys"),
        ("%YAML 2.0\n---\na: 1", "1:1", "remove the line %YAML"),
    ],
)
def test_what_is_no_yaml_is_told_with_place_and_advice(text: str, place: str, advice: str) -> None:
    """A syntax error names the place where a person fixes it and says how."""
    with pytest.raises(ConfigError) as caught:
        load_yaml(text, "f")
    message = str(caught.value)
    assert message.startswith(f"f:{place}: error: this is not valid YAML: ")
    assert advice in message


def test_an_error_repeats_the_text_that_it_is_about() -> None:
    """What was found is in the message."""
    with pytest.raises(ConfigError, match="at ': c'"):
        load_yaml("a: b: c", "f")


def test_problems_before_a_syntax_error_are_told_too() -> None:
    """What is known to be wrong is said together with what stopped the reading."""
    with pytest.raises(ConfigError) as caught:
        load_yaml("a: !x 1\nb: 2\nb: 3\nc: [1", "f")
    assert [problem.mark.line for problem in caught.value.problems if problem.mark] == [1, 3, 4]
