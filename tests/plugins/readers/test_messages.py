"""What a person reads: the whole text of every kind of message about a table, as prose to be reviewed in messages.yaml."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import in_file_order
from dh2urdf.stages import Rejected

CASES: dict[str, dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("messages.yaml").read_text("utf-8"))


@pytest.mark.parametrize("code", CASES)
def test_a_message_says_where_what_and_what_to_do(code: str, read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """File, line, column, joint and field, the text found, what is accepted, and what was probably meant."""
    case = CASES[code]
    try:
        arms = read(case["table"], case.get("suffix", ".csv"), **case.get("options", {"convention": "standard"}))
        said = [
            problem
            for arm in arms
            for problem in in_file_order((*arm.notices, *(() if isinstance(arm, Manipulator) else arm.problems)))
        ]
        text = "\n".join(map(str, said))
    except TableError as error:
        text = str(error)
    assert text == case["says"].rstrip("\n")
