"""What a finding says was seen in a program, and what a rule foretells."""

from __future__ import annotations

from dh2urdf.stages import Effect, Finding


def test_a_finding_names_the_programs_in_which_it_was_seen() -> None:
    """Each once, in the order of its effects; what is foretold names none."""
    foretold = Effect(consumer="ros", severity="error", text="refuses the file")
    seen = Effect(consumer="mujoco", severity="note", text="has no link", seen="MuJoCo 4.0.0")
    assert Finding(rule="r", message="m", fix="f", effects=(foretold, seen, seen)).seen == ("MuJoCo 4.0.0",)
    assert Finding(rule="r", message="m", fix="f", effects=(foretold,)).seen == ()
