"""What is set in type, and what has two meanings: as texts, before any number is read."""

import time

import pytest

from dh2urdf.quantities import Symbols, plain_text
from dh2urdf.quantities.spellings import advice, misreading

LONGER = 10_000


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("**-π/2**", "-π/2"),
        ("`0.155`", "0.155"),
        ("<b>90°</b>", "90°"),
        ("θ<sub>1</sub>", "θ_1"),
        (r"$\theta_1$", "θ_1"),
        (r"$\theta_{1}^{*}$", "θ_1"),
        (r"$90^{\circ}$", "90°"),
        (r"-\SI{90}{\degree}", "-90 °"),
        (r"$\theta_2 - \frac{\pi}{2}$", "θ_2 - ((pi)/(2))"),
        (r"\(2\pi/3\)", "2pi/3"),
        ("q(2) - pi/2", "q2 - pi/2"),
        ("θ1(t)", "θ1"),
        ("var", "q"),
        ("０．５", "0.5"),
        ("\u00a090\u202f°", "90 °"),
        ("−90", "-90"),
        ("cos(pi/3) + abs(-1)", "cos(pi/3) + abs(-1)"),
    ],
)
def test_typesetting_is_taken_off(text: str, plain: str) -> None:
    assert plain_text(text) == plain
    assert plain_text(plain) == plain


@pytest.mark.parametrize("text", ["Jan 5", "5 jan", "mär 2", "1/2/2024", " 12:30", "2024-01-05", "3-4"])
def test_dates_are_none(text: str) -> None:
    assert misreading(text) == ("it is a date", misreading("3-4")[1])  # type: ignore[index]


@pytest.mark.parametrize(
    "part", ["1", "0.", "-", "*", "_", "$", "\\frac{", "^{", "<b>", "q(", " ", "0,", "10-", "a1 = 1, ", "L1", ": "]
)
def test_every_pattern_is_linear(part: str) -> None:
    """Texts ten thousand times as long take no more than a moment: cells, comments and what has two meanings."""
    begin = time.perf_counter()
    for text in (part * LONGER, "1" + part * LONGER, part * LONGER + "x"):
        plain_text(text)
        plain_text(text[:1000])
        misreading(text[:1000])
        advice(text)
        list(Symbols().take_line(text, None))  # type: ignore[arg-type]  # a place that nobody asks for
        Symbols().take_cell(text[:1000], None)  # type: ignore[arg-type]
    assert time.perf_counter() - begin < 2
