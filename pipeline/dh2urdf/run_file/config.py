"""The run file: what goes in, which stages do what, where the output goes.

Only the structure of the file is checked here. Whether a stage exists and takes its options is known where the catalog
of stages is (`dh2urdf.run_file.plan.make_plan`), so a `RunConfig` carries its problems along, and all of them, of both
kinds, are reported at once.
"""

from __future__ import annotations

from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING

from dh2urdf.documents.document import Node, expect_mapping, load_yaml, read_yaml
from dh2urdf.documents.text_files import read_bytes
from dh2urdf.errors import ConfigError
from dh2urdf.run_file.overrides import ON_THE_COMMAND_LINE, Asked, with_setting
from dh2urdf.run_file.records import RunConfig
from dh2urdf.run_file.sections import RUN_FILE, SECTIONS, written_out
from dh2urdf.run_file.validator import Validator
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

RUN_SUFFIXES = (".yaml", ".yml", ".json")
"""How the names of run files end."""
LIKELY_BYTES = 2**20
"""Size of a file that may be a run file [B]: a table may be a thousand times larger."""


def is_run_file(path: Path) -> bool:
    """Whether a file has a run file's sections, right or wrong; one of more than `LIKELY_BYTES` has not."""
    try:
        root = load_yaml(read_bytes(path, limit=LIKELY_BYTES), str(path))
    except ConfigError:
        return False
    return isinstance(root.value, dict) and not root.value.keys().isdisjoint(SECTIONS)


def load_config(
    path: Path, overrides: Sequence[str] = (), root: Node | None = None, asked: Asked = ON_THE_COMMAND_LINE
) -> RunConfig:
    """A run file with changes from the command line.

    Args:
        path: the run file.
        overrides: changes as ``--set`` takes them: ``transform.options.frames=dh``.
        root: what the run file says, where it is not in the file.
        asked: where the changes are given.

    Returns:
        The run file; `RunConfig.problems` says what is wrong with its structure.

    Raises:
        ConfigError: the file cannot be read, is not a YAML mapping, or has nothing of a run file.
    """
    root = root or read_yaml(path)
    keys = expect_mapping(root, "a run file").keys()
    if keys and not any(get_close_matches(key, SECTIONS, cutoff=0.75) for key in keys):
        raise ConfigError(
            Problem(
                message="this is no run file: it has none of its sections",
                mark=root.mark,
                found=", ".join(keys),
                accepted=", ".join(SECTIONS),
                suggestion="if it is a table, `dh2urdf convert` takes it, or `inputs:` of a run file",
            )
        )
    to = Validator(folder=path.parent, changes=asked.mark.file)
    for setting in overrides:
        try:
            root = with_setting(written_out(root), setting, SECTIONS, asked)
        except ConfigError as error:
            to.problems.extend(error.problems)
    config = RUN_FILE.read(written_out(root), "", to) or RunConfig()
    directory = config.output.directory or path.parent / "build" / path.stem
    return replace(config.written_to(directory), folder=path.parent, problems=tuple(to.problems))
