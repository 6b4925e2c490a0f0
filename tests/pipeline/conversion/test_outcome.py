from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.conversion.one_manipulator import Written
from dh2urdf.conversion.outcome import Outcome, Verdict, kind_of, to_line
from dh2urdf.errors import (
    CrashError,
    EmitterError,
    LoaderError,
    ManipulatorError,
    ProofError,
    RobotError,
    StageError,
    TableError,
    TimeLimitError,
    TransformError,
)
from dh2urdf.kinematics.proof import Proof
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import EmittedFile, LoadReport

PROOF = Proof(position_error=1e-16, angle_error=2e-16, q=(0.5, -1.0), tolerance=1e-9, poses=35)
ARM = Outcome(
    name="arm",
    status="ok",
    source="arm.csv",
    drawn={"a_2": 0.4, "type_1": "prismatic"},
    written=(
        Written(stage="urdf", files=(EmittedFile(name="arm.urdf", content=b"<robot>"),), proof=PROOF),
        Written(stage="text", files=(EmittedFile(name="arm.txt", content=b"arm"),), proof=None),
    ),
    loads={
        "paper": Verdict(
            report=LoadReport(
                simulator="Paper",
                version="1",
                mass=2.5,
                findings=(Problem(message="it is flat", severity="notice", joint="turn"),),
            )
        )
    },
    notices=(Problem(message="an ignored column", severity="notice", mark=Mark(file="arm.csv", line=1, column=9)),),
    seconds={"transform": 0.25, "write": 0.5},
)
BAD = Outcome(
    name="bad",
    status="failed",
    source="arm.csv",
    kind="table",
    was_read=False,
    errors=(
        Problem(
            message="'x' is no number",
            mark=Mark(file="arm.csv", line=3, column=5),
            joint="elbow",
            field="alpha",
            found="x",
            accepted="a number",
            suggestion="did you mean '0'?",
        ),
    ),
)
FILE = {"path": "arm.urdf", "stage": "urdf", "bytes": 7, "sha256": "ab"}


def test_a_row_has_all_that_is_known_of_a_manipulator() -> None:
    """Files as they are handed in, a proof per emitter, null where there is none, a report per loader, the drawn values."""
    row = json.loads(to_line(ARM.row("00ff", [FILE])))
    assert list(row) == [
        *("name", "status", "kind", "source", "key", "drawn", "keeps_kinematics", "files", "proof", "loaders"),
        *("notices", "errors"),
    ]
    assert (row["name"], row["status"], row["kind"], row["source"], row["key"]) == (
        "arm",
        "ok",
        None,
        "arm.csv",
        "00ff",
    )
    assert row["drawn"] == {"a_2": 0.4, "type_1": "prismatic"}
    assert row["files"] == [FILE]
    assert row["proof"] == {
        "urdf": {"position_error": 1e-16, "angle_error": 2e-16, "q": [0.5, -1.0], "tolerance": 1e-9, "poses": 35},
        "text": None,
    }
    assert row["loaders"]["paper"]["mass"] == 2.5
    assert row["loaders"]["paper"]["findings"][0]["joint"] == "turn"
    assert [(notice["line"], notice["message"]) for notice in row["notices"]] == [(1, "an ignored column")]
    assert row["errors"] == []


def test_a_cell_has_the_error_of_every_tool0() -> None:
    """One arm has one tool0, and its row does not repeat it; a cell has as many as arms."""
    assert "tips" not in ARM.row("", [])["proof"]["urdf"]
    several = replace(PROOF, tip="b_tool0", tips={"a_tool0": 0.0, "b_tool0": 1e-16})
    cell = replace(ARM, written=(replace(ARM.written[0], proof=several),)).row("", [])
    assert cell["proof"]["urdf"]["tip"] == "b_tool0"
    assert cell["proof"]["urdf"]["tips"] == {"a_tool0": 0.0, "b_tool0": 1e-16}


@pytest.mark.parametrize(
    ("error", "kind"),
    [
        (TableError("x"), "table"),
        (TransformError("x"), "transform"),
        (RobotError("x"), "robot"),
        (EmitterError("x"), "emitter"),
        (ProofError("x"), "proof"),
        (LoaderError("x"), "loader"),
        (CrashError("x"), "crash"),
        (TimeLimitError("x"), "time limit"),
        (StageError("emitter 'x'", "KeyError: 1"), "stage"),
        (ManipulatorError("x"), "manipulator"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_the_kind_of_a_failure_is_its_class_in_words(error: Exception, kind: str) -> None:
    """So that whoever counts failures reads words, and whoever adds a class need not add a word."""
    assert kind_of(error) == kind


TEXTS = st.text(st.characters(codec=None), max_size=5)


@given(st.recursive(st.none() | st.booleans() | st.integers(-9, 9) | TEXTS, lambda inner: st.lists(inner, max_size=3)))
def test_anything_plain_can_be_written(data: Any) -> None:
    """Whatever texts it holds, lone surrogates too: what is UTF-8 comes back as it was."""
    found = json.loads(to_line({"data": data}))["data"]
    try:
        json.dumps(data, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return
    assert found == data
