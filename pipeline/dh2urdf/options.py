"""Options of a stage: from what a person wrote to an instance of the stage's options dataclass.

A run file gives nodes, the command line gives words; both come through `make_options`. Words and truth values are
checked here; anything else is left to pydantic, whose import alone costs as much as converting a table, and which
reports everything that is wrong at once. Its checks are strict: ``yes`` is not true, and ``true`` is not 1.
"""

from __future__ import annotations

import json
import math
import traceback
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from types import NoneType
from typing import TYPE_CHECKING, Any, Literal, TypeVar, get_args, get_type_hints

from dh2urdf.documents import Node, load_yaml
from dh2urdf.errors import BrokenPluginError, ConfigError, InputError
from dh2urdf.option_types import choices, default_text, members, type_text
from dh2urdf.source import Mark, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from dataclasses import Field

O = TypeVar("O")  # noqa: E741 - the options type of a stage

COMMAND_LINE = "command line"
"""The file of marks for what was said on the command line."""
_UNDECIDED = object()
_TEXT_WANTED = frozenset({"string_type", "literal_error", "enum", "path_type"})
"""Errors of pydantic [1] that a number's or truth value's text may mend: the name `007` is a text."""


def make_options(
    options_type: type[O], given: Node | Mapping[str, Node | str] | None, *, mark: Mark | None = None, where: str
) -> O:
    """The options of a stage, checked.

    Args:
        options_type: the stage's options dataclass.
        given: what the user wrote: the node of a mapping, or values by option; a str is a word of the command line.
        mark: where the stage is named, for what has no place of its own.
        where: the stage, for messages: ``emitter 'urdf'``.

    Raises:
        ConfigError: options are unknown, missing or of another type; all of them are listed.
        BrokenPluginError: the stage's own options type does not work.
    """
    mapping = _as_mapping(given, mark, where)
    root = Node(mapping, "", 0, 0)
    try:
        hints = get_type_hints(options_type, include_extras=True)
        problems = list(_unknown_options(options_type, root, mark, where))
        known = {name: node for name, node in mapping.items() if name in hints}
        if all(_decided(hints[name], node) is not _UNDECIDED for name, node in known.items()):
            options = options_type(**{name: _decided(hints[name], node) for name, node in known.items()})
        else:
            options = _validated(options_type, Node(known, "", 0, 0))
    except InputError as error:  # from the type's own __post_init__
        problems += [problem.about(mark=mark) for problem in error.problems]
    except _Invalid as invalid:
        problems += [_problem(error, hints, root, mark, where) for error in invalid.errors]
    except ValueError as error:
        problems.append(_own_refusal(str(error), root, mark, where))
    except Exception as error:
        reason = f"its options {options_type.__qualname__} cannot be made: {type(error).__name__}: {error}"
        raise BrokenPluginError(options_type.__module__, where, reason, traceback.format_exc()) from error
    if problems:
        raise ConfigError(problems)
    return options
