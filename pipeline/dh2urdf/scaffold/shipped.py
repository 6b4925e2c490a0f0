"""The tables of known arms that the package ships: `dh2urdf example`."""

from __future__ import annotations

from pathlib import Path

from dh2urdf.documents.text_files import is_file, is_folder
from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Problem, did_you_mean, shown

_IN_A_WHEEL = Path(__file__).parents[1] / "tables"
_IN_A_CLONE = Path(__file__).parents[3] / "configs" / "tables"


def shipped_tables() -> dict[str, Path]:
    """The tables by name; of a clone of the repository those in `configs/tables`, of which a wheel holds a copy."""
    folder = _IN_A_WHEEL if is_folder(_IN_A_WHEEL) else _IN_A_CLONE
    return {path.stem: path for path in sorted(folder.iterdir()) if is_file(path)} if is_folder(folder) else {}


def shipped_table(name: str) -> Path:
    """The table of a name.

    Raises:
        ConfigError: there is none.
    """
    tables = shipped_tables()
    if name in tables:
        return tables[name]
    raise ConfigError(
        Problem(
            message=f"no example is called {shown(name)}",
            mark=COMMAND_LINE,
            found=name,
            accepted=", ".join(tables),
            suggestion=did_you_mean(name, tables),
        )
    )


def summary_of(table: Path) -> str:
    """What the first line of a table says about it."""
    with table.open(encoding="utf-8") as file:
        return file.readline().strip("#\n ").rstrip(".")
