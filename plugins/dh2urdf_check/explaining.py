"""What each rule means, and where that is written: `dh2urdf check --explain RULE`, and the rules of a SARIF log."""

from __future__ import annotations

from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any

from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf_check.rules import table

_TABLES = Path(__file__).with_name("rules")


@cache
def tables() -> dict[str, tuple[Path, dict[str, Any]]]:
    """Every rule by its name: the table that has it, and its entry there."""
    return {
        name: (path, entry)
        for path in sorted(_TABLES.glob("*.yaml"))
        for name, entry in table(path.stem).items()
        if isinstance(entry, dict) and "fault" in entry
    }


def explanation(name: str) -> str:
    """What a rule means, what each consumer does with a file that breaks it, and what to do.

    Raises:
        ConfigError: there is no such rule.
    """
    if name not in tables():
        near = did_you_mean(name, get_close_matches(name, tables(), n=1))
        message = f"no rule {shown(name)} is known"
        raise ConfigError(Problem(message=message, mark=COMMAND_LINE, field="--explain", suggestion=near))
    _, entry = tables()[name]
    together: dict[str, list[str]] = {}
    for consumer, (outcome, does, *_) in entry.get("consumers", {}).items():
        together.setdefault(f"{does} ({outcome})", []).append(consumer)
    lines = [f"{name}: {entry['fault']}"]
    lines += [f"    {', '.join(consumers)}: {does}" for does, consumers in together.items()]
    lines += [f"    seen in a program ({entry['severity']})"] if "severity" in entry else []
    return "\n".join([*lines, f"    fix: {entry['fix']}", f"    {address_of(name)}"])


def address_of(name: str) -> str | None:
    """The address of the page that explains a rule; without a published source, that of its table on this machine."""
    if name not in tables():
        return None
    import importlib.metadata

    path, _ = tables()[name]
    urls = importlib.metadata.metadata("dh2urdf").get_all("Project-URL") or ()
    known = dict(each.partition(", ")[::2] for each in urls)
    if source := known.get("Source"):
        return f"{source.rstrip('/')}/docs/rules/{path.stem}.md#{name}"
    return f"{path.as_uri()}#{name}"
