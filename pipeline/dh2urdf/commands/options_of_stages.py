"""The options of stages that somebody gives, on the command line or in a program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ConfigError
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.plugin_system.options import COMMAND_LINE, make_options
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf.stage_calls.calls import Call

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.source import Mark


_FLAGS = {"reader": "--from", "formats": "--to", "out": "-o", "edits": "--edit", "options": "--set"}
"""Options of the command line that are not called as the arguments of the functions are."""


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
    from dh2urdf.commands.argument_words import word_of

    return [Setting(f"{key}={word_of(value)}", key, word_of(value)) for key, value in options.items()]


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
    known = {kind: {name: None for stage in some for name in _fields(stage)} for kind, some in stages.items()}
    problems: list[Problem] = []
    for text, path, value in settings:
        said = option(mark, "options", shown(text))
        kind, _, key = path.rpartition(".")
        kinds = [kind] if kind in known else [] if kind else [k for k in known if key in known[k]]
        if value is None or len(kinds) != 1 or key not in known[kinds[0]]:
            keys = [f"{k}.{name}" for k in known for name in known[k]]
            near = None
            if value is None:
                wrong = "has no value"
            elif len(kinds) > 1:
                wrong = f"is an option of the {' and of the '.join(kinds)}"
                near = f"write {' or '.join(f'{each}.{key}' for each in kinds)}"
            else:
                wrong = "names no option"
                near = did_you_mean(path, [*keys, *(key.partition(".")[2] for key in keys)])
            problems.append(
                Problem(
                    message=f"{said} {wrong}",
                    mark=mark,
                    found=text,
                    accepted=f"KEY=VALUE, where KEY is one of {', '.join(keys)}",
                    suggestion=near,
                )
            )
            continue
        earlier = words[kinds[0]].setdefault(key, value)
        if earlier != value:
            problems.append(
                Problem(
                    message=f"{said} contradicts {shown(earlier)}, which is given for {key} too",
                    mark=mark,
                    field=key,
                    found=text,
                    accepted="one value of each option",
                )
            )
    calls: dict[str, list[Call[Any]]] = {kind: [] for kind in stages}
    for kind, some in stages.items():
        for stage in some:
            # What no stage of the kind has is left in, for the message about it.
            foreign = known[kind].keys() - _fields(stage).keys()
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


def _fields(stage: Any) -> Mapping[str, Any]:  # noqa: ANN401 - a stage of any kind
    fields: Mapping[str, Any] = stage.options.__dataclass_fields__
    return fields
