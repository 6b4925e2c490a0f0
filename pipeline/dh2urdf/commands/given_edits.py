"""The edits that are asked for beside one table, such as ``payload`` or ``payload: {mass: 2.5}``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.commands.options_of_stages import option
from dh2urdf.errors import ConfigError, InputError
from dh2urdf.plugin_system.options import broken_structure, make_options, word_node
from dh2urdf.source import Problem, shown
from dh2urdf.stage_calls.calls import Call

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.documents.document import Node
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.source import Mark
    from dh2urdf.stages import Edit

ACCEPTED = "the name of an edit, or a name and its options: `payload: {mass: 2.5}`"


def edit_calls(words: Iterable[str], mark: Mark, catalog: Catalog) -> tuple[Call[Edit[Any]], ...]:
    """The edits with their options, in the order in which they were asked for.

    Args:
        words: a word for each, which is read as YAML.
        mark: the place that problems name.
        catalog: where the edits are from.

    Raises:
        ConfigError: a word names no edit, or an option is wrong; all of it is reported at once.
        PluginError: the plugin of an edit is broken.
    """
    calls, problems = [], []
    for word in words:
        try:
            calls.append(_call(word, mark, catalog))
        except InputError as error:
            problems += [problem.about(mark=mark) for problem in error.problems]
    if problems:
        raise ConfigError(problems)
    return tuple(calls)


def _call(word: str, mark: Mark, catalog: Catalog) -> Call[Edit[Any]]:
    node = word_node(word, mark.file)
    name, options = node.text if isinstance(node.value, str) else None, None
    if name and not node.quoted and (broken := broken_structure(word, mark.file)):
        message = f"{option(mark, 'edits', shown(word))} cannot be read: {broken}"
        raise ConfigError(Problem(message=message, mark=mark, found=word, accepted=ACCEPTED))
    if isinstance(node.value, dict) and "stage" in node.value and node.value.keys() <= {"stage", "options"}:
        name, options = node.value["stage"].text, node.value.get("options")  # as in a run file
    elif isinstance(node.value, dict) and len(node.value) == 1:
        ((name, options),) = node.value.items()
    if options is not None and options.value is None:
        options = None
    if not name or (options is not None and not isinstance(options.value, dict)):
        message = f"{option(mark, 'edits', shown(word))} is no edit"
        raise ConfigError(Problem(message=message, mark=mark, found=word, accepted=ACCEPTED))
    edit = catalog.get("edit", name)
    plugin = catalog.plugin_of(edit)
    given: Node | dict[str, str] = options or {}
    made = make_options(edit.options, given, mark=mark, where=f"edit {edit.name!r}", plugin=plugin)
    return Call(stage=edit, options=made, plugin=plugin)
