"""What was chosen on the command line or in Python: a table, one of its manipulators, stages and their options."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.documents.text_files import check_file
from dh2urdf.errors import ConfigError, InputError, TableError
from dh2urdf.plugin_system.calls import call_of
from dh2urdf.plugin_system.options import COMMAND_LINE, broken_structure, word_node
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Edit, Reader
    from dh2urdf.table_text import Trace

say = Messages(__file__)

GivenOptions: TypeAlias = "Mapping[str, Mapping[str, str | None]]"  # options as words, by kind of stage
_FLAGS = {"reader": "--from", "formats": "--to", "out": "-o", "edits": "--edit", "options": "--set"}
"""Options of the command line that are not called as the arguments of the functions are."""


def option(mark: Mark, name: str, value: str = "") -> str:
    """An argument of a function with its value, as its user gives it: ``--robot NAME``, or ``robot=NAME`` in a program.

    `mark` is the place that problems of the options name: the command line, or the function that was called.
    """
    if mark != COMMAND_LINE:
        return value if name == "options" else f"{name}={value}"
    return f"{_FLAGS.get(name) or '--' + name.replace('_', '-')} {value}"


# --- A table and its manipulator --------------------------------------------------------------------------------------


def chosen_reader(catalog: Catalog, table: Path, name: str | None, mark: Mark) -> Reader[Any]:
    """The reader that is named, or the one by the table's suffix."""
    check_file(table, TableError)
    if name:
        return catalog.get("reader", name)
    return catalog.reader_for(table, f"`{option(mark, 'reader', 'NAME')}` chooses a reader")


def reader_call(
    catalog: Catalog, table: Path, name: str | None, mark: Mark, given: GivenOptions, *, settings: Iterable[str] = ()
) -> Call[Reader[Any]]:
    """The reader of a table, with its options; see `chosen_reader` and `stage_calls`."""
    stages = {"reader": [chosen_reader(catalog, table, name, mark)]}
    return stage_calls(catalog, stages, mark, given, settings)["reader"][0]


def read_manipulator(
    call: Call[Reader[Any]], table: Path, robot: str | None, mark: Mark, trace: Trace | None = None
) -> Manipulator:
    """The manipulator of a table that is meant."""
    with refuse_run_file(table):
        return chosen_manipulator(read_items(call, table, trace), robot, str(table), mark)


def chosen_manipulator(
    items: Iterator[Manipulator | Rejected], robot: str | None, file: str, mark: Mark
) -> Manipulator:
    """The manipulator that is meant; a TableError where there is none, or which of several is not said."""
    others: list[str] = []
    chosen: Manipulator | Rejected | None = None
    for item in items:
        if robot is None and chosen is not None:
            names = " or ".join(option(mark, "robot", shown(name)) for name in (chosen.name, item.name))
            setting = option(mark, "robot", "NAME")
            raise TableError(say("several-manipulators", Mark(file=file), option=setting, names=names))
        others.append(item.name)
        if robot in (None, item.name):
            chosen = item
            if robot is not None:
                break
    if isinstance(chosen, Rejected):
        raise TableError(chosen.problems, chosen.notices)
    if chosen is None:
        near = did_you_mean(robot or "", others)
        code = "manipulator-unknown" if robot else "table-empty"
        raise TableError(say(code, Mark(file=file), found=robot, names=others[:20], suggestion=near))
    return chosen


@contextmanager
def refuse_run_file(table: Path) -> Iterator[None]:
    """Reports that a file which cannot be read as a table is a run file, where it is one."""
    try:
        yield
    except TableError:
        from dh2urdf.run_file.config import is_run_file  # not needed where all is well

        if not is_run_file(table):
            raise
        raise ConfigError(say("run-file-for-table", Mark(file=str(table)))) from None


# --- Stages and their options -----------------------------------------------------------------------------------------


def stage_calls(
    catalog: Catalog, stages: Mapping[str, Sequence[Any]], mark: Mark, given: GivenOptions, settings: Iterable[str] = ()
) -> dict[str, list[Call[Any]]]:
    """The calls of stages by kind with their options, those of one kind sharing what is given for it.

    `settings` go to the kind of stage which has them: ``frames=dh``, or ``transform.frames=dh`` where several kinds
    have one of that name. All that is wrong is reported at once, in a ConfigError.
    """
    words: dict[str, dict[str, str]] = {
        kind: {name: value for name, value in given.get(kind, {}).items() if value is not None} for kind in stages
    }
    known = {
        kind: {name: None for stage in some for name in stage.options.__dataclass_fields__}
        for kind, some in stages.items()
    }
    problems: list[Problem] = []
    for text in settings:
        keys = [f"{kind}.{name}" for kind in known for name in known[kind]]
        path, equals, value = map(str.strip, text.partition("="))
        kind, _, key = path.rpartition(".")
        kinds = [each for each in known if key in known[each] and kind in ("", each)]
        code, suggestion = "option-unknown", None
        about = {"accepted": f"KEY=VALUE, where KEY is one of {', '.join(keys)}"}
        if not equals:
            code = "option-without-value"
        elif not kinds:
            suggestion = did_you_mean(path, [*keys, *(each.partition(".")[2] for each in keys)])
        elif len(kinds) > 1:
            code = "option-of-several"
            about |= {"kinds": " and of the ".join(kinds), "choices": " or ".join(f"{each}.{key}" for each in kinds)}
        elif (earlier := words[kinds[0]].setdefault(key, value)) != value:
            code, about = "option-twice", {"earlier": shown(earlier), "key": key}
        else:
            continue
        setting = option(mark, "options", shown(text))
        problems.append(say(code, mark, found=text, setting=setting, suggestion=suggestion, **about))
    calls: dict[str, list[Call[Any]]] = {kind: [] for kind in stages}
    for kind, stage in ((kind, stage) for kind, some in stages.items() for stage in some):
        # What no stage of the kind has is left in, for the message about it.
        foreign = known[kind].keys() - stage.options.__dataclass_fields__.keys()
        own = {name: word for name, word in words[kind].items() if name not in foreign}
        try:
            calls[kind].append(call_of(catalog, stage, own, mark))
        except ConfigError as error:
            problems.extend(error.problems)
    if problems:
        raise ConfigError(problems)
    return calls


def edit_calls(words: Iterable[str], mark: Mark, catalog: Catalog) -> tuple[Call[Edit[Any]], ...]:
    """The edits with their options, a word of YAML for each, such as ``payload`` or ``payload: {mass: 2.5}``."""
    calls, problems = [], []
    for word in words:
        node = word_node(word, mark.file)
        name, options = node.text if isinstance(node.value, str) else None, None
        broken = broken_structure(word, mark.file) if name and not node.quoted else None
        if isinstance(node.value, dict) and "stage" in node.value and node.value.keys() <= {"stage", "options"}:
            name, options = node.value["stage"].text, node.value.get("options")  # as in a run file
        elif isinstance(node.value, dict) and len(node.value) == 1:
            ((name, options),) = node.value.items()
        if broken or not name or (options is not None and not isinstance(options.value, dict | None)):
            code, setting = "edit-unreadable" if broken else "edit-unknown-form", option(mark, "edits", shown(word))
            problems.append(say(code, mark, found=word, setting=setting, reason=broken))
            continue
        try:
            given = None if options is None or options.value is None else options
            calls.append(call_of(catalog, catalog.get("edit", name), given, mark))
        except InputError as error:
            problems += [problem.about(mark=mark) for problem in error.problems]
    if problems:
        raise ConfigError(problems)
    return tuple(calls)
