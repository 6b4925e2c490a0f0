"""The options of stages and the edits that somebody gives, on the command line or in a program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import ConfigError, InputError
from dh2urdf.plugin_system.options import COMMAND_LINE, broken_structure, make_options, word_node
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf.stage_calls.calls import Call

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.source import Mark
    from dh2urdf.stages import Edit

_FLAGS = {"reader": "--from", "formats": "--to", "out": "-o", "edits": "--edit", "options": "--set"}
"""Options of the command line that are not called as the arguments of the functions are."""
ACCEPTED = "the name of an edit, or a name and its options: `payload: {mass: 2.5}`"


def option(mark: Mark, name: str, value: str = "") -> str:
    """An option with its value, as its user gives it: ``--robot NAME``, or ``robot=NAME`` in a program.

    Args:
        mark: the place that problems of the options name: the command line, or the function that was called.
        name: the argument of the function.
        value: its value.
    """
    if mark != COMMAND_LINE:
        return value if name == "options" else f"{name}={value}"
    return f"{_FLAGS.get(name) or '--' + name.replace('_', '-')} {value}"


class Setting(NamedTuple):
    """An option of some stage.

    Attributes:
        text: as it was typed.
        key: ``frames``, or ``transform.frames`` where the kind of its stage has to be named.
        value: its value as a word of the command line; None where there is none.
    """

    text: str
    key: str
    value: str | None


def settings_of(options: Mapping[str, object]) -> list[Setting]:
    """The options that a program gives."""
    from dh2urdf.commands.arguments import words_of

    return [Setting(f"{key}={word}", key, word) for key, word in words_of(options).items()]


def stage_calls(
    catalog: Catalog,
    stages: Mapping[str, Sequence[Any]],
    mark: Mark,
    given: Mapping[str, Mapping[str, str | None]],
    settings: Iterable[Setting] = (),
) -> dict[str, list[Call[Any]]]:
    """The calls of stages with their options, in the order of the stages of each kind.

    Args:
        catalog: where the stages are from.
        stages: the stages by kind. Those of one kind share the settings: each takes the options that it has.
        mark: the place that problems name: the command line, or the function that was called.
        given: options by kind; a stage that has no such option is an error.
        settings: options that go to the kind of stage which has them.

    Raises:
        ConfigError: an option is unknown or its value wrong; all problems are reported at once.
    """
    words: dict[str, dict[str, str]] = {
        kind: {name: value for name, value in given.get(kind, {}).items() if value is not None} for kind in stages
    }
    known = {
        kind: {name: None for stage in some for name in stage.options.__dataclass_fields__}
        for kind, some in stages.items()
    }
    keys = [f"{kind}.{name}" for kind in known for name in known[kind]]
    problems: list[Problem] = []
    for text, path, value in settings:
        kind, _, key = path.rpartition(".")
        kinds = [each for each in known if key in known[each] and kind in ("", each)]
        accepted, suggestion = f"KEY=VALUE, where KEY is one of {', '.join(keys)}", None
        if value is None:
            wrong = "has no value"
        elif not kinds:
            wrong = "names no option"
            suggestion = did_you_mean(path, [*keys, *(each.partition(".")[2] for each in keys)])
        elif len(kinds) > 1:
            wrong = f"is an option of the {' and of the '.join(kinds)}"
            suggestion = f"write {' or '.join(f'{each}.{key}' for each in kinds)}"
        elif (earlier := words[kinds[0]].setdefault(key, value)) != value:
            wrong, accepted = f"contradicts {shown(earlier)}, which is given for {key} too", "one value of each option"
        else:
            continue
        message = f"{option(mark, 'options', shown(text))} {wrong}"
        problem = Problem(message=message, mark=mark, found=text, accepted=accepted, suggestion=suggestion)
        problems.append(problem)
    calls: dict[str, list[Call[Any]]] = {kind: [] for kind in stages}
    for kind, stage in ((kind, stage) for kind, some in stages.items() for stage in some):
        # What no stage of the kind has is left in, for the message about it.
        foreign = known[kind].keys() - stage.options.__dataclass_fields__.keys()
        own = {name: word for name, word in words[kind].items() if name not in foreign}
        plugin, where = catalog.plugin_of(stage), f"{kind} {stage.name!r}"
        try:
            options = make_options(stage.options, own, mark=mark, where=where, plugin=plugin)
            calls[kind].append(Call(stage=stage, options=options, plugin=plugin))
        except ConfigError as error:
            problems.extend(error.problems)
    if problems:
        raise ConfigError(problems)
    return calls


def edit_calls(words: Iterable[str], mark: Mark, catalog: Catalog) -> tuple[Call[Edit[Any]], ...]:
    """The edits with their options, in the order in which they were asked for.

    Args:
        words: a word for each, such as ``payload`` or ``payload: {mass: 2.5}``, which is read as YAML.
        mark: the place that problems name.
        catalog: where the edits are from.

    Raises:
        ConfigError: a word names no edit, or an option is wrong; all of it is reported at once.
        PluginError: the plugin of an edit is broken.
    """
    calls, problems = [], []
    for word in words:
        try:
            calls.append(_edit_call(word, mark, catalog))
        except InputError as error:
            problems += [problem.about(mark=mark) for problem in error.problems]
    if problems:
        raise ConfigError(problems)
    return tuple(calls)


def _edit_call(word: str, mark: Mark, catalog: Catalog) -> Call[Edit[Any]]:
    node = word_node(word, mark.file)
    name, options = node.text if isinstance(node.value, str) else None, None
    broken = broken_structure(word, mark.file) if name and not node.quoted else None
    if isinstance(node.value, dict) and "stage" in node.value and node.value.keys() <= {"stage", "options"}:
        name, options = node.value["stage"].text, node.value.get("options")  # as in a run file
    elif isinstance(node.value, dict) and len(node.value) == 1:
        ((name, options),) = node.value.items()
    if broken or not name or (options is not None and not isinstance(options.value, dict | None)):
        wrong = f"cannot be read: {broken}" if broken else "is no edit"
        message = f"{option(mark, 'edits', shown(word))} {wrong}"
        raise ConfigError(Problem(message=message, mark=mark, found=word, accepted=ACCEPTED))
    edit = catalog.get("edit", name)
    plugin = catalog.plugin_of(edit)
    given: Any = {} if options is None or options.value is None else options
    made = make_options(edit.options, given, mark=mark, where=f"edit {edit.name!r}", plugin=plugin)
    return Call(stage=edit, options=made, plugin=plugin)
