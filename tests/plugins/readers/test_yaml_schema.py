import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from dh2urdf.documents import load_yaml
from dh2urdf.documents.document import read_yaml
from dh2urdf.errors import InputError
from dh2urdf.manipulator import Manipulator
from dh2urdf_plugins.readers.sources.yaml_schema import table_schema
from dh2urdf_plugins.readers.stages import YAML

ROOT = Path(__file__).parents[3]
INPUTS = ROOT / "tests" / "reference" / "inputs"
EXPECTED: list[dict[str, Any]] = json.loads((INPUTS / "expected.json").read_text(encoding="utf-8"))
SCHEMA = Draft202012Validator(table_schema())

BEYOND_A_SCHEMA = {"base_bad_row.yaml", "phys_com_far.yaml", "robot_name_empty.yaml", "robot_name_traversal.yaml"}
"""Errors of meaning: a matrix that is not rigid, a body that cannot be, a name that is no name."""


def cases(outcome: str) -> list[str]:
    return [case["file"] for case in EXPECTED if case["file"].endswith(".yaml") and case["outcome"] == outcome]


def valid(text: str) -> bool:
    return bool(SCHEMA.is_valid(load_yaml(text, "f").plain()))


@pytest.mark.long
def test_the_schema_is_a_schema() -> None:
    """It keeps the rules of its dialect and can be written as JSON."""
    Draft202012Validator.check_schema(table_schema())
    assert json.loads(json.dumps(table_schema())) == table_schema()


def test_every_process_makes_the_same_schema() -> None:
    """The order of sets, which each interpreter draws anew, is in none of its patterns."""
    printing = "from dh2urdf_plugins.readers.sources.yaml_schema import table_schema; print(table_schema())"
    made = {
        subprocess.run(
            [sys.executable, "-c", printing],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(made) == 1


@pytest.mark.parametrize("name", cases("accept"))
def test_tables_that_are_read_are_valid(name: str) -> None:
    """What the reader accepts, an editor does not mark."""
    errors = [error.message for error in SCHEMA.iter_errors(read_yaml(INPUTS / name).plain())]
    assert errors == []


@pytest.mark.parametrize("path", sorted((ROOT / "configs" / "tables").glob("*.yaml")), ids=lambda path: path.name)
def test_the_example_tables_are_valid(path: Path) -> None:
    """The project's own tables are valid."""
    assert SCHEMA.is_valid(read_yaml(path).plain())


@pytest.mark.parametrize("name", sorted(set(cases("error")) - BEYOND_A_SCHEMA))
def test_tables_that_are_refused_are_not_valid(name: str) -> None:
    """What is wrong in form is found by the schema, or is no YAML of this project at all."""
    try:
        table = read_yaml(INPUTS / name).plain()
    except InputError:
        return
    assert not SCHEMA.is_valid(table)


@pytest.mark.parametrize(
    "text",
    [
        "{joints: [{A: 0, Twist: 90deg, d_: 0, Joint Name: 7, SIGN: -1, q_min: -1, qmax: 1}]}",
        "{defaults: {alpha: 0, geometry: {shape: box}}, joints: [{a: 0, d: 1 mm, type: Prismatic}]}",
        "{tool: [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], joints: [{a: 0, alpha: 0, d: 0, sigma: 1}], units: 'mm,deg'}",
        "{base: {xyz: [0, 0, 1], mass: 3}, joints: [{a: 0, alpha: 0, d: 0, limits: {lower: -1, upper: 1}}]}",
        "{joints: [{a: 0, alpha: 0, d: 1, mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}]}",
    ],
)
def test_other_names_and_forms_are_valid_and_read(text: str, tmp_path: Path) -> None:
    """Synonyms, any case and separators, expressions and matrices are known to the schema and to the reader."""
    assert valid(text)
    path = tmp_path / "table.yaml"
    path.write_text(text)
    (read,) = YAML.read(path, YAML.options(convention="modified"))
    assert isinstance(read, Manipulator)


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "{robots: [], joints: []}",
        "{joints: [{a: 0, alpha: 0}]}",
        "{joints: [{a: 0, alhpa: 0, d: 0}]}",
        "{convention: foo, joints: [{a: 0, alpha: 0, d: 0}]}",
        "{joints: [{a: 0, alpha: 0, d: 0, type: screw}]}",
        "{joints: [{a: 0, alpha: 0, d: 0, com: [1, 2]}]}",
        "{tool: {xyz: [0, 0]}, joints: [{a: 0, alpha: 0, d: 0}]}",
        "{defaults: {geometry: {shape: blob}}, joints: [{a: 0, alpha: 0, d: 0}]}",
    ],
)
def test_typical_mistakes_are_not_valid(text: str) -> None:
    """Missing and misspelt keys, unknown words and lists of the wrong length are found by an editor."""
    assert not valid(text)
