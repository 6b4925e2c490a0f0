import json
from pathlib import Path

import pytest

from dh2urdf.source import Mark
from dh2urdf.stages import Effect, Finding
from dh2urdf_check.reports import as_sarif, counts

MILD = Effect(consumer="one", severity="note", text="says so")
BAD = Effect(consumer="two", severity="warning", text="reads it otherwise")


def finding(*effects: Effect, line: int | None = 3, column: int | None = 5, file: str = "arm.urdf") -> Finding:
    mark = Mark(file=file, line=line, column=column)
    return Finding(rule="a-rule", message="it is so", fix="make it otherwise", effects=effects, mark=mark)


@pytest.mark.parametrize(("effects", "severity"), [((MILD,), "note"), ((MILD, BAD), "warning"), ((), "error")])
def test_a_finding_is_as_bad_as_its_worst_effect(effects: tuple[Effect, ...], severity: str) -> None:
    """And an error of its own where it is about no consumer."""
    assert finding(*effects).severity == severity
    assert counts([finding(*effects)])[severity] == 1  # type: ignore[index]


@pytest.mark.parametrize(
    ("line", "column", "region"),
    [(3, 5, {"startLine": 3, "startColumn": 5}), (3, None, {"startLine": 3}), (None, None, None)],
)
def test_sarif_has_as_much_of_a_place_as_is_known(line: int | None, column: int | None, region: object) -> None:
    """Line and column, a line, or the file as a whole."""
    log = json.loads(as_sarif([finding(MILD, line=line, column=column)]))
    (run,) = log["runs"]
    ((result,), driver) = run["results"], run["tool"]["driver"]
    assert (log["version"], set(driver)) == ("2.1.0", {"name", "semanticVersion", "rules"})
    assert result["ruleId"] == driver["rules"][result["ruleIndex"]]["id"] == "a-rule"
    assert result["level"] == "note"
    assert result["locations"][0]["physicalLocation"].get("region") == region
    assert result["message"]["text"] == "it is so\none: says so\nfix: make it otherwise"


def test_sarif_addresses_are_uris(tmp_path: Path) -> None:
    """Absolute ones with their scheme, and spaces as URIs have them."""
    path = tmp_path / "my arm.urdf"
    (result,) = json.loads(as_sarif([finding(file=str(path))]))["runs"][0]["results"]
    assert result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == path.as_uri()


def test_a_finding_names_the_programs_in_which_it_was_seen() -> None:
    """Each once, in the order of its effects; what is foretold names none."""
    foretold = Effect(consumer="ros", severity="error", text="refuses the file")
    seen = Effect(consumer="mujoco", severity="note", text="has no link", seen="MuJoCo 4.0.0")
    assert Finding(rule="r", message="m", fix="f", effects=(foretold, seen, seen)).seen == ("MuJoCo 4.0.0",)
    assert Finding(rule="r", message="m", fix="f", effects=(foretold,)).seen == ()
