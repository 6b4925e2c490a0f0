from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from jsonschema import Draft202012Validator

if TYPE_CHECKING:
    from collections.abc import Callable

    from conftest import Answer

CONFIGS = Path(__file__).parents[3] / "configs"

# What the schemas accept and refuse is tested where they are made: tests/pipeline/test_schema.py and the readers' tests.


def schema(cli: Callable[..., Answer], *words: str) -> dict[str, Any]:
    return dict(json.loads(cli("schema", *words).stdout))


def test_it_validates_every_run_file_of_the_project(cli: Callable[..., Answer]) -> None:
    """What an editor gets accepts every run file in configs/, and finds a slip in it."""
    validator = Draft202012Validator(schema(cli))
    for path in CONFIGS.glob("*.yaml"):
        config = yaml.safe_load(path.read_text("utf-8"))
        assert [error.message for error in validator.iter_errors(config)] == []
        assert list(validator.iter_errors({**config, "emiters": ["urdf"]}))


def test_the_one_of_tables_validates_every_table_of_the_project(cli: Callable[..., Answer]) -> None:
    """What an editor gets accepts every YAML table in configs/, and finds a slip in it."""
    validator = Draft202012Validator(schema(cli, "table"))
    for path in (CONFIGS / "tables").glob("*.yaml"):
        table = yaml.safe_load(path.read_text("utf-8"))
        assert [error.message for error in validator.iter_errors(table)] == []
        assert list(validator.iter_errors({**table, "convetion": "standard"}))
