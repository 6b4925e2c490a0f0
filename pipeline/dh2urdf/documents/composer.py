"""Makes the nodes of a YAML document out of the parser's events."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NoReturn, TypeAlias

import yaml

from dh2urdf.documents.nodes import Item, Node, core_value
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf.errors import InputError

say = Messages(__file__)


_ADVICE = (
    ("mapping values are not allowed", "indent the keys of a mapping alike, and quote a text that holds ': '"),
    ("could not find expected ':'", "each line of a mapping is `name: value`, with a space after the colon"),
    ("did not find expected key", "indent the keys of a mapping alike, and the dashes of a list"),
    ("did not find expected '-' indicator", "indent the dashes of a list alike"),
    ("did not find expected ','", "close the bracket that opens here, or put a comma between the values"),
    ("did not find expected node content", "a value is missing, or a bracket or comma is too many"),
    ("unexpected end of stream", "close the quote that opens here"),
    ("expected alphabetic or numeric", "quote a text that starts with * or &"),
    ("unknown escape character", "use single quotes, in which a backslash means itself"),
    ("invalid Unicode character escape", "write the character itself"),
    ("incompatible YAML document", "remove the line %YAML"),
)
_TAB = "indent with spaces: YAML takes no tabs there"
_RESERVED = "quote a text that starts with this character"


def syntax_problem(reason: Exception, text: str, file: str) -> Problem:
    """The problem that an error of PyYAML's parser describes."""
    said = str(getattr(reason, "problem", None) or reason).partition("\n")[0]
    place = getattr(reason, "problem_mark", None)
    opened = getattr(reason, "context_mark", None)
    if place is None:
        return say("yaml-unreadable", Mark(file=file), reason=said)
    lines = re.split(r"\r\n|\n|\r", text)
    if opened is not None and not "".join([_rest(lines, place.line, place.column), *lines[place.line + 1 :]]).strip():
        place = opened  # The text ended too early: what was left open is the place to fix.
    rest = _rest(lines, place.line, place.column)
    suggestion = next((advice for words, advice in _ADVICE if words in said), None)
    if "cannot start any token" in said:
        said = f"a value cannot start with {shown(rest[:1])}"
        suggestion = _TAB if rest[:1] == "\t" else _RESERVED
    mark, found = Mark(file=file, line=place.line + 1, column=place.column + 1), rest.strip() or None
    if found:
        said += f", at {shown(found)}"
    return say("yaml-unreadable", mark, found=found, reason=said, suggestion=suggestion)


def _rest(lines: list[str], line: int, column: int) -> str:
    return lines[line][column:] if line < len(lines) else ""


MAX_DEPTH = 64
"""Mappings and lists that may stand inside each other."""
_TOO_DEEP = "exceeded maximum nesting depth"
"""How newer versions of libyaml refuse a thousand, which they look for before they report the first of them."""
MAX_ALIASED = 1_000_000
"""Values that all aliases of a document (``*name``) may stand for together."""
MAX_ALIASED_PER_CHARACTER = 10
"""Values that they may stand for beyond `MAX_ALIASED`, for each character of the document before them."""

_NO_KEYS: Mapping[str, tuple[int, int]] = MappingProxyType({})

# A character outside the first 65,536 as JSON may write it: two escapes, each half a character. libyaml refuses them.
_HALVES = re.compile(r"(?<!\\)((?:\\\\)*)(\\u[dD][89abAB][0-9a-fA-F]{2}\\u[dD][c-fC-F][0-9a-fA-F]{2})")


_Sized: TypeAlias = tuple[Node, int, int]
"""A node, the number of values in it, and how many mappings and lists stand inside each other in it."""


@dataclass(slots=True)
class _OpenNode:
    """A mapping or list that is not finished."""

    entries: dict[str, Node] | list[Node]
    place: tuple[int, int]
    anchor: str | None
    key: str | None = None  # the key whose value comes next
    key_places: dict[str, tuple[int, int]] = field(default_factory=dict)
    merge_next: bool = False  # whether that key is `<<`
    merged: Node | None = None  # what `<<` stands for
    size: int = 1  # values in it, those that aliases stand for included
    depth: int = 1
    problems_outside: list[Problem] | None = None  # where its entries are yielded one by one


class Composer:
    """Makes nodes of PyYAML's events, with a stack of its own in place of recursion."""

    def __init__(
        self, text: str, file: str, error: type[InputError], items_of: str | None, longest_list: int | None
    ) -> None:
        whole = _HALVES.sub(lambda found: found[1] + json.loads(f'"{found[2]}"'), text) if "\\u" in text else text
        self.parser = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(whole)
        self.text, self.file, self.error = text, file, error
        self.items_of = items_of
        self.longest_list = longest_list or sys.maxsize
        self.problems: list[Problem] = []
        self.stack: list[_OpenNode] = []
        self.root: Node | None = None
        self.anchors: dict[str, _Sized | None] = {}  # None: not finished
        self.aliased = 0

    def run(self) -> Iterator[Item]:
        """Yields the entries of the chosen list, and then the document."""
        try:
            for event in iter(self.parser.get_event, None):
                finished = self._finished(event)
                if finished is None:
                    continue
                if not self.stack:
                    self.root = finished[0]
                elif self.stack[-1].problems_outside is None:
                    self._place(self.stack[-1], *finished)
                else:
                    yield Item(finished[0], tuple(self.problems))
                    self.problems = []
        except (yaml.YAMLError, ValueError, OverflowError) as reason:  # PyYAML's own parser does not check \U escapes.
            problem = syntax_problem(reason, self.text, self.file)
            if _TOO_DEEP in str(reason) and problem.mark:
                self._too_deep(problem.mark)
            self._stop(problem)
        if self.root is None or self.root.text == "":
            self._stop(say("file-empty", Mark(file=self.file)))
        yield Item(self.root, tuple(self.problems))

    def _finished(self, event: yaml.Event) -> _Sized | None:
        """The node that an event finishes, if any."""
        if isinstance(event, yaml.ScalarEvent):
            text, quoted = event.value, bool(event.style)
            node = Node(text if quoted else core_value(text), self.file, *_place(event), text, quoted, _NO_KEYS)
            if event.tag:
                self._refuse_tag(event, event.tag)
            if event.anchor:
                self._begin_anchor(event, event.anchor)
                self.anchors[event.anchor] = node, 1, 0
            return node, 1, 0
        if isinstance(event, yaml.CollectionStartEvent):
            self._open(event)
        elif isinstance(event, yaml.CollectionEndEvent):
            return self._close(self.stack.pop())
        elif isinstance(event, yaml.AliasEvent):
            return self._alias(event)
        elif isinstance(event, yaml.DocumentStartEvent) and self.root:
            self._stop(say("yaml-second-document", self._mark(event)))
        return None

    def _open(self, event: yaml.CollectionStartEvent) -> None:
        """Begins a mapping or list."""
        if event.tag:
            self._refuse_tag(event, event.tag)
        if event.anchor:
            self._begin_anchor(event, event.anchor)
        if len(self.stack) >= MAX_DEPTH:
            self._too_deep(self._mark(event))
        is_list = isinstance(event, yaml.SequenceStartEvent)
        frame = _OpenNode([] if is_list else {}, _place(event), event.anchor)
        if self.items_of and is_list and len(self.stack) == 1 and self.stack[0].key == self.items_of:
            frame.problems_outside, self.problems = self.problems, []
        self.stack.append(frame)

    def _close(self, frame: _OpenNode) -> _Sized:
        """Ends a mapping or list."""
        if frame.problems_outside is not None:
            self.problems = frame.problems_outside
        if frame.merged and isinstance(frame.entries, dict):
            self._merge(frame.merged, frame.entries, frame.key_places)
        node = Node(frame.entries, self.file, *frame.place, key_places=frame.key_places)
        if frame.anchor:
            self.anchors[frame.anchor] = node, frame.size, frame.depth
        return node, frame.size, frame.depth

    def _place(self, frame: _OpenNode, node: Node, size: int, depth: int) -> None:
        """Puts a node into the mapping or list that it is in, as a key, a value or an entry."""
        entries = frame.entries
        frame.size += size
        if depth >= frame.depth:
            frame.depth = depth + 1
        if isinstance(entries, list):
            entries.append(node)
            if len(entries) > self.longest_list:
                line, column = frame.place
                mark = Mark(file=self.file, line=line, column=column)
                self._stop(say("yaml-list-too-long", mark, most=self.longest_list))
        elif frame.merge_next:
            frame.merge_next, frame.merged = False, node
        elif frame.key is None:
            self._take_key(frame, node)
        else:
            entries.setdefault(frame.key, node)  # Of two equal keys the first stands; the second is a problem.
            frame.key = None

    def _take_key(self, frame: _OpenNode, node: Node) -> None:
        key = node.text
        if key is None:
            self._stop(say("yaml-key-no-name", node.mark, what=node.describe()))
        if key == "<<" and not node.quoted:
            frame.merge_next = True
            if frame.merged:
                self._refuse_duplicate(node, (frame.merged.line, frame.merged.column))
        elif key in frame.key_places:
            self._refuse_duplicate(node, frame.key_places[key])
            frame.key = key
        else:
            frame.key_places[key] = node.line, node.column
            frame.key = key

    def _merge(self, merged: Node, entries: dict[str, Node], key_places: dict[str, tuple[int, int]]) -> None:
        """Adds what ``<<`` stands for; keys of the mapping itself, and earlier ones of a list, win."""
        for source in merged.value if isinstance(merged.value, list) else [merged]:
            if not isinstance(source.value, dict):
                what = source.describe()
                self.problems.append(say("yaml-merge-no-mapping", source.mark, found=source.text, what=what))
                continue
            for key, node in source.value.items():
                if key not in entries:
                    entries[key] = node
                    key_places[key] = source.key_places[key]

    def _begin_anchor(self, event: yaml.NodeEvent, name: str) -> None:
        if name in self.anchors:
            self.problems.append(say("yaml-anchor-twice", self._mark(event), anchor="&" + name))
        self.anchors[name] = None

    def _alias(self, event: yaml.AliasEvent) -> _Sized:
        """What an alias stands for."""
        name, mark = str(event.anchor), self._mark(event)
        alias = f"*{name}"
        if name not in self.anchors:
            near = did_you_mean(name, self.anchors)
            self._stop(say("yaml-alias-unknown", mark, found=alias, anchor="&" + name, suggestion=near))
        anchored = self.anchors[name]
        if anchored is None:
            self._stop(say("yaml-alias-in-itself", mark, alias=alias))
        _, size, depth = anchored
        self.aliased += size
        start: Any = event.start_mark
        limit = MAX_ALIASED + MAX_ALIASED_PER_CHARACTER * start.index
        if self.aliased > limit:
            self._stop(say("yaml-aliases-too-many", mark, found=alias, limit=limit))
        if len(self.stack) + depth > MAX_DEPTH:
            self._too_deep(self._mark(event))
        return anchored

    def _refuse_tag(self, event: yaml.Event, tag: str) -> None:
        found = tag.replace("tag:yaml.org,2002:", "!!")
        self.problems.append(say("yaml-tag", self._mark(event), found=found))

    def _refuse_duplicate(self, node: Node, first: tuple[int, int]) -> None:
        line, column = first
        self.problems.append(say("yaml-key-twice", node.mark, found=node.text, line=line, column=column))

    def _too_deep(self, mark: Mark) -> NoReturn:
        self._stop(say("yaml-too-deep", mark, most=MAX_DEPTH))

    def _mark(self, event: yaml.Event) -> Mark:
        line, column = _place(event)
        return Mark(file=self.file, line=line, column=column)

    def _stop(self, problem: Problem) -> NoReturn:
        raise self.error([*self.problems, problem])


def _place(event: yaml.Event) -> tuple[int, int]:
    mark: Any = event.start_mark  # PyYAML's types say it may be None; a parsed event always has one.
    return mark.line + 1, mark.column + 1
