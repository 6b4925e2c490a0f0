"""How rules find their faults: XPath, a dozen functions in it, and a dozen verbs.

A rule says by an XPath where it looks (`at`), by a verb what is wrong there (`is`), and by a sentence with XPaths in
braces what to report (`says`). Each verb is written once, here; the rules are data.
"""

from __future__ import annotations

import itertools
import math
import re
from collections import Counter
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import unquote

from lxml import etree

from dh2urdf.documents import is_file
from dh2urdf.kinematics.mass import principal_moments
from dh2urdf.manipulator import Inertia
from dh2urdf.robot import WEIGHTLESS
from dh2urdf.source import did_you_mean, listed, shown
from dh2urdf_check.rules import At, Hit

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence

    from dh2urdf_check.rules import Rule

_SLOT = re.compile(r"\{([^{}]+)\}")
_FEW = 4
_ROUNDED = 1e-9
"""By what share of the largest a principal moment may be off."""
_SMALLEST_MOMENT = 1e-14
"""Principal moment that MuJoCo takes for 0 [kg·m²]."""
_UNQUOTED = ("name(", "moments(", "implausible(", "mesh(", "faster(", "outside(")
"""Functions whose texts are words of ours."""


class Place(NamedTuple):
    """What a verb finds."""

    at: At
    words: Mapping[str, str] = {}  # for the message: what no XPath has
    others: Sequence[etree._Element] = ()  # what else the finding is about


class Document:
    """An XML document on which rules are evaluated.

    `functions` are what its format adds to the functions of XPath; `place` says where an element is.
    """

    def __init__(
        self,
        root: etree._Element,
        path: Path,
        functions: Mapping[str, Callable[..., Any]] | None = None,
        place: Callable[[etree._Element], str] = lambda at: f"line {at.sourceline}",
    ) -> None:
        self.root, self.path, self.place = root, path, place
        self.text = ""  # with blanks in comments, a letter a byte, where a rule asks for it
        self.sets: dict[str, Collection[str]] = {}  # names that rules know by a word, such as $links
        plain = {"there": lambda _, address: is_file(path.parent / unquote(text_of(address)))}
        self._functions = {(None, name): each for name, each in {**FUNCTIONS, **plain, **(functions or {})}.items()}
        self._compiled: dict[str, etree.XPath] = {}

    def select(self, path: str, at: At | None = None) -> Any:  # noqa: ANN401 - what XPath has
        """What an XPath selects or computes, from the root or from an element on."""
        if path not in self._compiled:
            self._compiled[path] = etree.XPath(path, extensions=self._functions, smart_strings=False)
        return self._compiled[path](self.root if at is None or isinstance(at, tuple) else at)

    def hits(self, rules: Iterable[Rule]) -> Iterator[Hit]:
        """The places where rules are broken, rule by rule; what two cases of a rule find is one place."""
        for rule in rules:
            found: dict[tuple[At, str], Hit] = {}
            for case in rule.cases:
                selected = self.select(case.at) if case.at else []
                for place in VERBS[case.verb](self, selected, case.argument) if selected or not case.at else ():
                    about = (place.at, *place.others)
                    of = frozenset(
                        name
                        for name, holds in rule.where.items()
                        if name in (case.of or rule.where)
                        and (not holds or any(self.select(f"boolean({holds})", each) for each in about))
                    )
                    if of:
                        message = self._said(case.says, place)
                        before = found.get((place.at, message))
                        found[place.at, message] = Hit(rule.name, place.at, message, of | (before.of if before else of))
            yield from found.values()

    def _said(self, sentence: str, place: Place) -> str:
        """A sentence with what its slots select: names in quotation marks, numbers short, tags as they are."""

        def filled(slot: re.Match[str]) -> str:
            path = slot[1]
            if path in place.words:
                return place.words[path]
            found = self.select(path, place.at)
            found = found[0] if isinstance(found, list) and found else found
            if isinstance(found, float):
                return f"{found:.6g}"
            text = text_of(found)
            return text if path.startswith(_UNQUOTED) else shown(text)

        return _SLOT.sub(filled, sentence)


# --- Functions in XPath -----------------------------------------------------------------------------------------------


def numbers_of(text: str | None, count: int) -> tuple[float, ...] | None:
    """As many finite numbers as a text should hold, as every reader takes them; None where it holds something else."""
    words = (text or "").split()
    if len(words) != count or not all(word.isascii() and "_" not in word for word in words):
        # `float` takes 1_000 and the digits of other alphabets, which no reader does.
        return None
    try:
        found = tuple(map(float, words))
    except ValueError:
        return None
    return found if all(map(math.isfinite, found)) else None


def text_of(value: Any) -> str:  # noqa: ANN401 - what XPath has
    """The text of what XPath selected: of the first element or attribute, without blanks around an element's."""
    if isinstance(value, list):
        value = value[0] if value else ""
    if etree.iselement(value):
        return (value.text or "").strip()
    return f"{value:g}" if isinstance(value, float) else str(value)


def _numbers(values: Sequence[Any]) -> list[float]:
    """The plain numbers in some texts, of all that each XPath selects; NaN for a text that is of others, too."""
    texts = [text_of(each) for value in values for each in (value if isinstance(value, list) else [value])]
    return [number for text in texts for number in numbers_of(text, len(text.split()) or 1) or (math.nan,)]


def _number(_: object, value: Any) -> float:  # noqa: ANN401
    """The plain finite number of a text; NaN where it is none."""
    found = numbers_of(text_of(value), 1)
    return found[0] if found else math.nan


def _length(_: object, value: Any) -> float:  # noqa: ANN401
    """The length of the vector in a text; NaN where it is none."""
    found = numbers_of(text_of(value), 3)
    return math.hypot(*found) if found else math.nan


def _word(_: object, value: Any, index: float) -> float:  # noqa: ANN401
    """The plain number at some place in a text, from 1; NaN where there is none."""
    words = text_of(value).split()
    return _number(None, words[int(index) - 1]) if 0 < index <= len(words) else math.nan


def _largest(_: object, *values: Any) -> float:  # noqa: ANN401
    """The largest magnitude of the plain numbers in some texts; NaN where there are others, or none."""
    found = [abs(number) for number in _numbers(values)]
    return math.nan if any(map(math.isnan, found)) else max(found, default=math.nan)


def _tensor(moments: Sequence[Any]) -> Inertia | None:
    """The tensor of ixx, iyy, izz, ixy, ixz and iyz; None where one of them is no plain number."""
    xx, yy, zz, xy, xz, yz = (_number(None, moment) for moment in moments)
    if not all(map(math.isfinite, (xx, yy, zz, xy, xz, yz))):
        return None
    return Inertia(ixx=xx, iyy=yy, izz=zz, ixy=xy, ixz=xz, iyz=yz)


def _inertia(_: object, *moments: Any) -> str:  # noqa: ANN401
    """Which law of a body the tensor ixx, iyy, izz, ixy, ixz, iyz breaks: zero, definite, triangle, semidefinite.

    Else `sound`, or an empty text where it is not written in numbers.
    """
    tensor = _tensor(moments)
    if tensor is None:
        return ""
    if tensor == WEIGHTLESS.inertia:
        return "zero"
    low, middle, high = principal_moments(tensor)
    if low < -_ROUNDED * high:
        return "definite"
    if low + middle < high * (1.0 - _ROUNDED):
        return "triangle"
    return "semidefinite" if low < _SMALLEST_MOMENT else "sound"


def _moments(_: object, *moments: Any) -> str:  # noqa: ANN401
    """The principal moments of a tensor, as a sentence has them."""
    tensor = _tensor(moments)
    return "" if tensor is None else "{:.6g}, {:.6g} and {:.6g} kg·m²".format(*principal_moments(tensor))


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "n": _number,
    "length": _length,
    "word": _word,
    "words": lambda _, value: float(len(text_of(value).split())),
    "plain": lambda _, value, count: numbers_of(text_of(value), int(count)) is not None,
    "largest": _largest,
    "least": lambda _, *values: min(_numbers(values), default=math.nan),
    "halves": lambda _, *values: all((2.0 * number).is_integer() for number in _numbers(values)),
    "same-numbers": lambda _, one, other: _numbers([one]) == _numbers([other]),
    "inertia": _inertia,
    "moments": _moments,
    "is-like": lambda _, value, pattern: re.fullmatch(pattern, text_of(value)) is not None,
    "suffix": lambda _, value: Path(text_of(value)).suffix.lower(),
}
"""The functions of all formats."""


# --- Verbs ------------------------------------------------------------------------------------------------------------


def _without(document: Document, found: list[etree._Element], wanted: list[str]) -> Iterator[Place]:
    """Each element that lacks some of its attributes or children; `$missing` has them."""
    for element in found:
        if missing := [path for path in wanted if not document.select(f"boolean({path})", element)]:
            yield Place(element, {"$missing": " and no ".join(each.lstrip("@") for each in missing)})


def _unknown(document: Document, found: list[etree._Element], about: Mapping[str, Any]) -> Iterator[Place]:
    """Each element whose `value` is none of those `among` which it should be; `$near` is one of them.

    They are a list, an XPath, or the name of a set of the document.
    """
    among: list[str] | str = about["among"]
    above = among.count("../") if isinstance(among, str) else 0
    names: dict[object, dict[str, None]] = {}
    """What an XPath selects, by the element that it starts from: all children of one have the same."""
    for element in found:
        value = text_of(document.select(about["value"], element))
        start = next(itertools.islice(element.iterancestors(), above - 1, None)) if above else document.root
        if start not in names:
            if isinstance(among, list) or among in document.sets:
                names[start] = dict.fromkeys(among if isinstance(among, list) else document.sets[among])
            else:
                names[start] = dict.fromkeys(map(text_of, document.select(among, element)))
        known = names[start]
        if value and value not in known:
            near = did_you_mean(value, known)
            yield Place(element, {"$near": f": {near}" if near else ""})


def _twice(document: Document, found: list[etree._Element], key: str, *, anywhere: bool = False) -> Iterator[Place]:
    """Each element with the key of one before it, in the same element or anywhere; `$first` is the place of that."""
    first: dict[tuple[object, str], etree._Element] = {}
    for element in found:
        known = None if anywhere else element.getparent(), text_of(document.select(key, element))
        if known[1] and known in first:
            yield Place(element, {"$first": document.place(first[known])})
        first.setdefault(known, element)


def _together(document: Document, found: list[etree._Element], name: str) -> Iterator[Place]:
    """All elements as one finding, at the first of them; `$names` are theirs."""
    names = dict.fromkeys(text_of(document.select(name, element)) for element in found)
    words = {"$names": listed([shown(each) for each in names], _FEW), "$count": str(len(found))}
    yield Place(found[0], words, found[1:])


def _each_kind(document: Document, found: list[etree._Element], key: str) -> Iterator[Place]:
    """The elements of each key as one finding, at the first of them; `$count` is how many they are."""
    kinds: dict[str, list[etree._Element]] = {}
    for element in found:
        kinds.setdefault(text_of(document.select(key, element)), []).append(element)
    for alike in kinds.values():
        yield from _together(document, alike, key)


def _not_numbers(_: Document, found: list[etree._Element], wanted: Mapping[str, int]) -> Iterator[Place]:
    """Each attribute that is there and is not as many plain numbers as are wanted; `$numbers` names it."""
    for element in found:
        for name, count in wanted.items():
            if (text := element.get(name)) is not None and numbers_of(text, count) is None:
                what = "one finite number" if count == 1 else f"{count} finite numbers"
                yield Place(element, {"$numbers": f"{name} of {element.tag} is {shown(text)}, not {what}"})


def _matches(document: Document, _found: object, pattern: str) -> Iterator[Place]:
    """The first place of the text where a regular expression matches, or its group does."""
    if match := re.search(pattern, document.text, re.DOTALL):
        start = match.start(match.lastindex or 0)
        yield Place((document.text.count("\n", 0, start) + 1, start - document.text.rfind("\n", 0, start)))


def _misplaced(_: Document, found: list[etree._Element], about: Mapping[str, Any]) -> Iterator[Place]:
    """Each child or attribute of an element that a table does not have there; `$name` is it, `$near` one of the table.

    The table has the names by that of the element, or by `HOLDER/ELEMENT` where that matters; `of` is `children` or
    `attributes`. With `near`, only what is nearly a name of the table counts: others may be somebody's own.
    """
    table: Mapping[str, str] = about["table"][about["of"]]
    for element in found:
        holder = element.getparent()
        key = f"{holder.tag if holder is not None else ''}/{element.tag}"
        if (names := table.get(key, table.get(str(element.tag)))) is None:
            continue
        known = names.split()
        children = ((child, str(child.tag)) for child in element.iterchildren(etree.Element))
        given = children if about["of"] == "children" else ((element, str(name)) for name in element.attrib)
        for at, name in given:
            if name in known or {":", "{", "."} & set(name):
                continue
            near = did_you_mean(name, [each for each in known if at is not element or element.get(each) is None])
            if near or not about.get("near"):
                yield Place(at, {"$name": shown(name), "$near": f": {near}" if near else ""})


def _circle(document: Document, found: list[etree._Element], about: Mapping[str, str]) -> Iterator[Place]:
    """Elements that lead to each other in a circle, once for each; `$names` are those in it."""
    names = {text_of(document.select(about["name"], element)): element for element in found}
    way = {name: text_of(document.select(about["next"], element)) for name, element in names.items()}
    seen = Counter[str]()
    for start in way:
        passed: dict[str, None] = {}
        name = start
        while name in way and name not in passed and not seen[name]:
            passed[name] = None
            name = way[name]
        if name in passed and way[name] != name:
            circle = [*passed][[*passed].index(name) :]
            yield Place(names[start], {"$names": listed([shown(each) for each in circle], _FEW)})
        seen.update(passed.keys())


VERBS: dict[str, Callable[[Document, list[etree._Element], Any], Iterator[Place]]] = {
    "there": lambda _, found, _argument: map(Place, found),
    "without": _without,
    "unknown": _unknown,
    "twice": _twice,
    "twice anywhere": partial(_twice, anywhere=True),
    "together": _together,
    "each kind": _each_kind,
    "not numbers": _not_numbers,
    "matches": _matches,
    "misplaced": _misplaced,
    "in a circle": _circle,
}
"""The verbs of `is`, by name."""
