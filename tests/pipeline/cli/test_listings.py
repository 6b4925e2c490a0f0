import json
from pathlib import Path
from typing import Any

import yaml
from command_line import Cli
from jsonschema import Draft202012Validator

from dh2urdf import __version__
from dh2urdf.hookspecs import INTERFACE_VERSION
from dh2urdf.plugin_system import KINDS, load

CONFIGS = Path(__file__).parents[3] / "configs"


def test_every_stage_is_listed_with_its_options(cli: Cli) -> None:
    """By kind: name, what it does, the distribution, and per option its default, its type and what it is for."""
    lines = cli("plugins").stdout.splitlines()
    assert [line for line in lines if not line.startswith(" ")] == [f"{kind}s" for kind in KINDS]
    for kind in KINDS:
        for item in load().provided(kind):
            assert f"  {item.stage.name}: {item.stage.summary}  [{item.plugin.distribution}]" in lines
    option = next(line for line in lines if line.startswith("      frames = "))
    assert option.startswith("      frames = aligned (aligned or dh): exact variant: link frames parallel to the base")


def test_the_same_as_json(cli: Cli) -> None:
    """A script gets kind, name, summary, plugin, distribution and options, as `schema plugins` says."""
    listed = json.loads(cli("plugins", "--json").stdout)
    Draft202012Validator(json.loads(cli("schema", "plugins").stdout)).validate(listed)
    assert (listed["version"], listed["interface"]) == (__version__, INTERFACE_VERSION)
    assert [listed[what] for what in ("clashes", "shadowed", "broken", "incompatible", "left_out")] == [[]] * 5
    stages = {(stage["kind"], stage["name"]): stage for stage in listed["stages"]}
    assert {
        ("reader", "csv"),
        ("reader", "yaml"),
        ("transform", "alpha-swap"),
        ("emitter", "urdf"),
        ("emitter", "xacro"),
        ("loader", "pybullet"),
        ("executor", "local"),
    } <= set(stages)
    swap = stages["transform", "alpha-swap"]
    assert swap["plugin"] == "builtin = dh2urdf_plugins"
    assert swap["distribution"] == f"dh2urdf {__version__}"
    frames = next(option for option in swap["options"] if option["name"] == "frames")
    assert set(frames) == {"name", "type", "default", "help"}
    assert (frames["type"], frames["default"]) == ("aligned or dh", "aligned")


def schema(cli: Cli, *words: str) -> dict[str, Any]:
    return dict(json.loads(cli("schema", *words).stdout))


def test_it_validates_every_run_file_of_the_project(cli: Cli) -> None:
    """What an editor gets accepts every run file in configs/, and finds a slip in it."""
    validator = Draft202012Validator(schema(cli))
    for path in CONFIGS.glob("*.yaml"):
        config = yaml.safe_load(path.read_text("utf-8"))
        assert [error.message for error in validator.iter_errors(config)] == []
        assert list(validator.iter_errors({**config, "emiters": ["urdf"]}))
