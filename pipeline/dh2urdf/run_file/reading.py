"""Reads a run file section by section and gathers all that is wrong; changes it by ``--set KEY=VALUE``."""

from __future__ import annotations

import glob
import os
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.documents.document import Node
from dh2urdf.documents.text_files import check_file, is_folder, is_there, tidy_path
from dh2urdf.errors import ConfigError
from dh2urdf.output.file_patterns import matching
from dh2urdf.plugin_system.options import COMMAND_LINE, broken_structure, word_node
from dh2urdf.plugin_system.validator import record_of
from dh2urdf.source import Messages, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from dh2urdf.source import Mark

say = Messages(__file__)

S = TypeVar("S")
T = TypeVar("T")


class Reading:
    """What is wrong with a run file, and where its paths begin: whatever reads a value adds to the problems.

    Marks name the file `changes` where a value is a change of the run file.
    """

    def __init__(self, folder: Path = Path(), changes: str = "") -> None:
        self.problems: list[Problem] = []
        self._folder, self._changes = folder, changes

    def record(self, kind: type[T], node: Node, field: str) -> T | None:
        """A section, or an entry of one; None where something is wrong with it."""
        with self.noting(node, field):
            return record_of(kind, node, whose="a run file", keyword="key")
        return None

    @contextmanager
    def noting(self, node: Node, field: str) -> Iterator[None]:
        """Note the problems of a `ConfigError`: at the key of a mapping that a problem names, or at the node."""
        try:
            yield
        except ConfigError as error:
            for problem in error.problems:
                at = node.value.get(problem.field or "", node) if isinstance(node.value, dict) else node
                place = f"{field}.{problem.field}" if problem.field else field
                mark, found = problem.mark or at.mark, problem.found or at.text
                self.problems.append(replace(problem, mark=mark, field=place, found=found))

    def note(self, code: str, node: Node, field: str, **values: Any) -> None:  # noqa: ANN401 - of a message
        """Note a problem at a node."""
        self.problems.append(say(code, node.mark, field=field, found=node.text, **values))

    def entries(
        self, given: Iterable[tuple[Node, str]], kind: type[S], make: Callable[[S, Node, str, Reading], T | None]
    ) -> Iterator[tuple[T, Node, str]]:
        """What is made of the right entries of a section, each in its node at its place."""
        for node, field in given:
            before, record = len(self.problems), self.record(kind, node, field)
            made = make(record, node, field, self) if record is not None else None
            if made is not None and len(self.problems) == before:
                yield made, node, field

    def distinct(self, entries: Iterable[tuple[T, Node, str]], name_of: Callable[[T], str], what: str) -> tuple[T, ...]:
        """The first entry of each name; each comes with its node and its place."""
        taken: list[T] = []
        first: dict[str, Node] = {}
        for entry, node, field in entries:
            if (other := first.setdefault(name_of(entry), node)) is node:
                taken.append(entry)
            else:
                self.note("name-twice", node, field, what=what, name=name_of(entry), first=other.mark)
        return tuple(taken)

    # --- Paths

    def folder_of(self, node: Node) -> Path:
        """The folder of a path in the run file is that of the file, of one in a change the working directory."""
        return Path() if node.file == self._changes else self._folder

    def is_path(self, node: Node, field: str) -> bool:
        """Whether a text can be a path as it is written."""
        path = node.text or ""
        if "\0" in path:
            self.note("nul-in-path", node, field)
        elif path.startswith(("~", "$")):
            self.note("path-unexpanded", node, field, part=path.partition("/")[0])
        else:
            return True
        return False

    def directory(self, node: Node | None, field: str) -> Path | str | None:
        """A folder, or an address such as ``s3://bucket/prefix``."""
        if node is None or node.text is None or not self.is_path(node, field):
            return None
        return node.text if "://" in node.text else tidy_path(self.folder_of(node) / node.text)

    def files(self, node: Node, field: str) -> tuple[tuple[Path, ...], tuple[Problem, ...], str | None]:
        """The files of a path or a pattern in the order of their names, the findings about it, and the pattern."""
        path, folder = node.text or "", self.folder_of(node)
        if not self.is_path(node, field):
            return (), (), None
        candidates, notices, pattern = [tidy_path(folder / path)], [], None
        if glob.has_magic(path) and not is_there(candidates[0]):
            candidates, pattern = [], path
            with self.noting(node, field):
                found = matching(folder, path)
                candidates = [tidy_path(file) for file in found.paths]
                notices = [found.notice.about(mark=node.mark)] if found.notice else []
        files = []
        for file in candidates:
            try:
                check_file(file)
                files.append(file)
            except ConfigError as error:
                (why, *_) = error.problems
                advice = why.suggestion
                if is_folder(file):
                    advice = f"name the tables in it, such as {os.path.join(path, '*.csv')}"  # noqa: PTH118 - as it is written
                self.note("input-unreadable", node, field, file=file, reason=why.message, suggestion=advice)
        return tuple(files), tuple(notices), pattern


# --- Settings ---------------------------------------------------------------------------------------------------------


MAX_KEYS = 16  # names in the key of a setting


def with_setting(root: Node, setting: str, sections: Sequence[str], mark: Mark = COMMAND_LINE) -> Node:
    """A run file with a setting put in its place; the file's own nodes stay as they are.

    A setting is KEY=VALUE, where KEY is a path of names and of indices from 0, which begins with one of the sections.
    `mark` is where it is given: the command line, or a function.
    """

    def error(code: str, **values: Any) -> ConfigError:  # noqa: ANN401 - of a message
        told = f"{'--set' if mark == COMMAND_LINE else 'settings:'} {shown(setting)}"
        return ConfigError(say(code, mark, found=setting, setting=told, **values))

    def put(node: Node, keys: Sequence[str], value: Node) -> Node:
        """A copy of a node with a value put in its place; mappings on the way there are made."""
        if not keys:
            return value
        key, *rest = keys
        if isinstance(node.value, list):
            entries = list(node.value)
            if key not in map(str, range(len(entries))):
                raise error("setting-entry-unknown", key=key, count=len(entries))
            entries[int(key)] = put(entries[int(key)], rest, value)
            return replace(node, value=entries)
        if node.value is not None and not isinstance(node.value, dict):
            raise error("setting-leads-nowhere", key=key, kind=node.describe())
        mapping = dict(node.value or {})
        mapping[key] = put(mapping.get(key, Node(None, mark.file, 0, 0)), rest, value)
        return replace(node, value=mapping)

    key, equals, word = setting.partition("=")
    keys = [part.strip() for part in key.split(".")]
    if not equals or not 0 < len(keys) <= MAX_KEYS:
        raise error("setting-without-value")
    if keys[0] not in sections:
        near = did_you_mean(keys[0], sections)
        raise error("setting-section-unknown", key=keys[0], sections=sections, suggestion=near)
    word = word.strip()
    if broken := broken_structure(word, mark.file):
        raise error("setting-unreadable", reason=broken)
    return put(root, keys, word_node(word, mark.file))
