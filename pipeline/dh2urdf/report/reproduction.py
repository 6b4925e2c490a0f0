"""What a reader of a report needs to do the run again: the command, the inputs by their hashes, versions and seeds."""

from __future__ import annotations

import math
import platform
import shlex
from dataclasses import fields, is_dataclass
from hashlib import file_digest
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf._version import __version__

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from dh2urdf.conversion.one_manipulator import Recipe
    from dh2urdf.results import InputEntry, Reproduction
    from dh2urdf.stage_calls.calls import Call
    from dh2urdf.variations.variation import VariationCall

MOST_INPUTS = 1000
"""Input files that are hashed and listed; of a longer list the first ones."""
CITATION = (
    f"The dh2urdf authors, dh2urdf {__version__}: Denavit-Hartenberg tables as robot descriptions that are provably "
    "the same arm, software under the MIT licence, 2026"
)
HOW_DRAWN = (
    "zero and both ends of the limits, then vectors drawn evenly inside the limits by Python's "
    'random.Random("dh2urdf N"), where N is the number of joints; simulators are asked at the vector nearest to zero '
    "and at the first of these vectors"
)
"""Where joint vectors of proofs and of simulators come from: `dh2urdf.kinematics.proof` draws them."""


def command_line(path: Path, overrides: Sequence[str]) -> str:
    """The command that makes the same files: who works, and where the output goes, makes no difference to them."""
    settings = [word for word in overrides if not word.startswith(("execution.", "output.directory"))]
    return shlex.join(["dh2urdf", "run", str(path), *(part for word in settings for part in ("--set", word))])


def reproduction(
    command: str | None, files: Iterable[Path], recipe: Recipe, variations: Iterable[VariationCall]
) -> Reproduction:
    """What is to be known of a run besides what became of it.

    Args:
        command: the command line; None where the run was begun by a program.
        files: the run file and the tables; they are read once more, for their hashes.
        recipe: what is done with every manipulator.
        variations: what is drawn.
    """
    paths = list(files)
    distributions = {call.plugin.distribution.rpartition(" ")[::2] for call in recipe.calls if call.plugin}
    names = ("name", "of", "count", "seed", "sampling")
    drawn: list[Any] = [{name: _plain(getattr(call, name)) for name in names} for call in variations]
    stages: Any = [
        {"kind": call.kind, "stage": call.stage.name, "options": plain_options(call)} for call in recipe.calls
    ]
    return {
        "command": command,
        "inputs": [_input(path) for path in paths[:MOST_INPUTS]],
        "inputs_left_out": max(0, len(paths) - MOST_INPUTS),
        "versions": {
            "dh2urdf": __version__,
            "Python": platform.python_version(),
            "numpy": version("numpy"),
            **dict(sorted(each for each in distributions if each[0])),
        },
        "variations": drawn,
        "stages": stages,
        "joint_vectors": HOW_DRAWN,
        "citation": CITATION,
    }


def plain_options(call: Call[Any]) -> dict[str, Any]:
    """The options of a stage as plain data, as a run file gives them."""
    options: dict[str, Any] = _plain(call.options)
    return options


def _plain(value: Any) -> Any:  # noqa: ANN401 - the value of any option
    if value is None or type(value) in (bool, int, str) or (isinstance(value, float) and math.isfinite(value)):
        return value
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if isinstance(value, dict):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if is_dataclass(value):
        return {each.name: _plain(getattr(value, each.name)) for each in fields(value)}
    return str(value)


def _input(path: Path) -> InputEntry:
    try:
        with path.open("rb") as file:
            return {"path": str(path), "sha256": file_digest(file, "sha256").hexdigest()}
    except OSError:  # The run says what is wrong with it.
        return {"path": str(path), "sha256": None}
