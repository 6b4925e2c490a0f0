"""What programs made of the files of a command, as findings: seen, and where nobody was asked, foretold."""

from __future__ import annotations

import os
import re
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.documents.text_files import is_folder
from dh2urdf.errors import ConfigError, Dh2UrdfError, ProofError
from dh2urdf.isolation.fence import TRUST, missing_wall
from dh2urdf.meshes import mesh_finder, packages_in, with_its_own
from dh2urdf.source import Mark, Messages
from dh2urdf.stages import Effect, Expansion, Finding, Question, ReadsForeign
from dh2urdf.stages.foreign_robot import ForeignRobot
from dh2urdf_check.ask.asking import Answer, Asked, answering, programs
from dh2urdf_check.ask.comparing import Difference, differences, postures, unlike_meshes
from dh2urdf_check.document import line_of, read_text, unread
from dh2urdf_check.rules import table
from dh2urdf_plugins.formats import foreign_urdf

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from lxml import etree

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.stages import Emitter, Inspection, Severity
    from dh2urdf_check.document import Text

say = Messages(__file__)

JOINT, LINKS = "joint", ("link", "body")
PARTS = (JOINT, *LINKS)
_OWNERS = frozenset({*PARTS, "model", "robot"})
"""The elements whose names programs tell."""
_LINE = re.compile(r"(?:\bline[ =:]+|\.(?:urdf|sdf|xml|mjcf)[:>]L?|:L)(\d+)(?! in \S*/)")
_NAMED = re.compile(r"['\"\[(<]([^'\"\[\]()<>]+)['\"\])>]|(?:\b(?:link|joint|body|name|frame|element)|:) +(\S+)")


def of_name(text: Text, name: str, kinds: Collection[str]) -> tuple[str, Mark]:
    """What has a name, of some kinds, and where it is; the file where there is none."""
    for element, mark in text.marks.items():
        if element.tag in kinds and element.tag in _OWNERS and element.get("name", "") == name:
            return str(element.tag), mark
    return "link", text.whole


def of_words(text: Text, words: str) -> tuple[str, str, Mark]:
    """What a message is about: the tag and the name of a link or joint, and where; the file, where it tells none.

    A name in it decides, or else a line.
    """
    parts = ((element, mark) for element, mark in text.marks.items() if element.tag in PARTS)
    names = {element.get("name", ""): (str(element.tag), element.get("name", ""), mark) for element, mark in parts}
    said = [(found[1] or found[2]).strip(".,;:'\"[]()<>") for found in _NAMED.finditer(words)]
    if name := next((each for each in reversed(said) if each in names), ""):
        return names[name]
    if numbers := _LINE.findall(words):
        before = [element for element in text.marks if line_of(element) <= int(numbers[-1])]
        if before:
            kind, name = owner_of(before[-1])
            mark = text.marks[before[-1]]
            return (kind, name, mark) if kind in PARTS else ("", "", mark)
    return "", "", text.whole


def owner_of(element: etree._Element) -> tuple[str, str]:
    """The tag and the name of the link or joint, or else of the model, that an element is in, or that it is."""
    at: etree._Element | None = element
    while at is not None and at.tag not in _OWNERS:
        at = at.getparent()
    return ("", "") if at is None else (str(at.tag), at.get("name", ""))


# --- The files of a command, as programs are given them ---------------------------------------------------------------


_UNCOMPARED = {"dynamics", "safety_controller", "calibration", "transmission", "gazebo", "sensor", "ros2_control"}
_UNCOMPARED |= {"material", "color", "texture", "mesh"}
"""Elements whose effects nobody can see in what the programs tell, other than that the file is refused."""
_OF_JOINTS = {"seen-lost-joint", "seen-joint-type", "seen-axis", "seen-limit", "seen-mimic"}
_ADDRESS = re.compile(
    rb"(?:filename|file|meshdir|assetdir|texturedir)\s*=\s*[\"']([^\"'<>]+)[\"']|<uri>\s*([^<]+?)\s*</uri>"
)
_PACKAGE = re.compile(rb"package://(\w[^/\"'<>\s]*)/")


class SeenRule(NamedTuple):
    """A kind of fact, as ``rules/seen.yaml`` has it; `at` are the elements that it is about, all where it is empty."""

    severity: Severity
    fault: str
    fix: str
    at: str = ""


@cache
def seen_rules() -> dict[str, SeenRule]:
    """The kinds of facts by name, in the order of their table."""
    return {name: SeenRule(**entry) for name, entry in table("seen").items()}


class Seen(NamedTuple):
    """A file of the command, and what was seen of it."""

    path: Path  # as the user named it
    text: Text
    own: ForeignRobot | None  # our own reading of it, where there is one
    asked: Asked
    answers: tuple[Answer, ...] = ()

    def beside(self, foretold: Sequence[Finding]) -> list[Finding]:
        """The findings: what is foretold of consumers that were not asked, and what was seen in the others.

        Where a rule has foretold what a program did to an element, its finding says that it was seen. What is foretold
        besides of a program that loads the file is left out: it was not seen.
        """
        left = [fact for answer in self.answers for fact in _facts(answer, self)]
        if self.own is not None:
            by_name = {answer.name: answer for answer in self.answers}
            told = {name: answer.held for name, answer in by_name.items() if answer.held is not None}
            for name, each in unlike_meshes(self.own.robot, told):
                left.append(_of_difference(by_name[name], each, self.text))
        findings = []
        for finding in foretold:
            effects, fitting = [], list(self.text.at(finding.mark))
            for effect in finding.effects:
                answer = next((each for each in self.answers if each.program.consumer == effect.consumer), None)
                if answer is None or answer.end == "unasked":
                    effects.append(effect)
                    continue
                mine = [each for each in left if each.answer is answer and _fits(each, effect, finding, fitting)]
                if mine:
                    left = [fact for fact in left if fact not in mine]
                    does = "; ".join(dict.fromkeys(fact.text for fact in mine))
                    effects.append(replace(effect, text=does, seen=answer.name))
                elif not _is_settled(answer, effect, fitting):
                    effects.append(effect)
            if effects or not finding.effects:
                findings.append(replace(finding, effects=tuple(effects)))
        return [*findings, *_unforetold(left)]


@contextmanager
def asking(
    catalog: Catalog, files: Iterable[tuple[Path, Emitter[Any]]], expansion: Expansion, consumers: Sequence[str]
) -> Iterator[Iterator[Seen]]:
    """Give files, each with the emitter of its format, to the programs that are installed, of all consumers or of some.

    A context, in which the programs are at work. It yields what was seen of each file, in their order; a file that
    cannot be read or expanded is left out.
    """
    found = programs(catalog, consumers)
    formats = {form for program in found for form in program.inspects.formats}
    with TemporaryDirectory(prefix="dh2urdf-check-") as folder:
        given = []
        for number, (path, emitter) in enumerate(files if found else ()):
            one = _given(path, emitter, expansion, Path(folder, str(number)))
            if one is not None and one.asked.question.format in formats:
                given.append(one)
        with answering(found, [each.asked for each in given]) as answers:
            yield (each._replace(answers=of_file) for each, of_file in zip(given, answers, strict=True))


def why_unasked() -> str:
    """Why no program is given a file of a stranger here; an empty text where all can be."""
    missing = missing_wall()
    return f"{missing}; `--trust` asks the programs all the same" if missing and not os.environ.get(TRUST) else ""


def with_what_is_seen(
    catalog: Catalog, emitter: Emitter[Any], path: Path, expansion: Expansion, found: Inspection
) -> Inspection:
    """An inspection with what the programs that are installed were seen to do with the file."""
    if why := why_unasked():
        raise ConfigError(say("nobody-asked", Mark(file=str(path)), reason=why))
    with asking(catalog, [(path, emitter)], expansion, ()) as at_work:
        seen = next(at_work, None)
    return replace(found, findings=tuple(seen.beside(found.findings))) if seen else found


def _given(path: Path, emitter: Emitter[Any], expansion: Expansion, folder: Path) -> Seen | None:
    """A file as programs are given it; a xacro as what it expands to, beside links to its neighbours."""
    reads = emitter.can(ReadsForeign)
    has_macros = reads is not None and reads.has_macros
    try:
        text = unread(path) if not has_macros else read_text(path, "xacro", expansion)
        with suppress(ProofError):  # Programs are given what is no XML, too.
            text = text if has_macros else read_text(path, emitter.name, expansion)
        where = here = Path(os.path.abspath(path))  # noqa: PTH100 - standard input has another name as text
        above = _packages_above(text.content, here)
        if has_macros:
            where = _written(text.content, here, folder, above)
    except (Dh2UrdfError, OSError):  # The inspection of the file reports it.
        return None
    own = None
    with suppress(Dh2UrdfError):  # What is not read here cannot be compared.
        if read := foreign_urdf(where) if has_macros else reads.read_foreign(path, expansion) if reads else None:
            own = read if isinstance(read, ForeignRobot) else ForeignRobot(robot=read)
            own = replace(own, robot=_from_the_root(own.robot))
    packages = with_its_own(path, packages_in(expansion.package_paths))
    form = "urdf" if has_macros else emitter.name
    question = Question(path=where, format=form, packages=packages, postures=postures(own) if own else ())
    readable = (here.parent, where.parent, *packages.values(), *above.values(), *_named(text.content, here, packages))
    return Seen(path, text, own, Asked(question, tuple(dict.fromkeys(readable))))


def _packages_above(content: bytes, path: Path) -> dict[str, Path]:
    """The folders that are called as the packages in a text and are beside a folder above it: PyBullet looks there."""
    names = {name.decode("utf-8", "replace") for name in _PACKAGE.findall(content)}
    places = [(name, parent / name) for name in sorted(names) for parent in path.parents[:-1]]
    return {name: place for name, place in reversed(places) if is_folder(place)}  # the nearest comes last


def _written(content: bytes, path: Path, folder: Path, packages: Mapping[str, Path]) -> Path:
    """Write a text where files that are named relative to another one are found, too, and packages above that."""
    folder.mkdir()
    for name, package in packages.items():
        (folder / name).symlink_to(package)
    folder /= "0"  # no name of a package
    folder.mkdir()
    for neighbour in path.parent.iterdir():
        (folder / neighbour.name).symlink_to(neighbour)
    written = folder / f"{path.name.removesuffix('.xacro').removesuffix('.urdf')}.expanded.urdf"
    written.unlink(missing_ok=True)
    written.write_bytes(content)
    return written


def _from_the_root(robot: Robot) -> Robot:
    """A robot whose links and joints follow each other from the root on, whatever their order in the file."""
    below: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint)
    held, links = {joint.child for joint in robot.joints}, {link.name: link for link in robot.links}
    names = [name for name in links if name not in held]
    joints: list[Joint] = []
    for name in names:
        for joint in below.get(name, ()):
            if joint.child in links and joint.child not in names:
                names.append(joint.child)
                joints.append(joint)
    return replace(robot, links=tuple(links[name] for name in names), joints=tuple(joints))


def _named(content: bytes, path: Path, packages: Mapping[str, Path]) -> Iterator[Path]:
    """What a file names: of a relative address the folder in which the file is, of an absolute one the file alone."""
    find = mesh_finder(path.parent, packages)
    for texts in _ADDRESS.findall(content):
        address = b"".join(texts).decode("utf-8", "replace")
        folder = path.parent / address
        if "://" not in address and is_folder(folder):
            yield folder
        elif file := find(address):
            yield file.resolve() if address.startswith(("/", "file:")) else file.resolve().parent


# --- What was seen as findings ----------------------------------------------------------------------------------------


class _Fact(NamedTuple):
    """Something that a program was seen to do: the rule of its kind, the link or joint, its place, and in words."""

    answer: Answer
    rule: str
    kind: str
    name: str
    mark: Mark
    text: str


def _facts(answer: Answer, seen: Seen) -> Iterator[_Fact]:
    """What a program did to a file: how it ended, what was printed, and what differs from our own reading."""
    held = answer.held
    said: list[tuple[str, str, str]] = []  # a rule, words that name a place, and what the program does
    match answer.end:
        case "refuses":
            reasons = " ".join((answer.words, *answer.complaints))
            said.append(("seen-refusal", reasons, f"refuses the file: {answer.words}"))
        case "crashes":
            said.append(("seen-crash", "", answer.words))
        case "unasked":
            said.append(("seen-unasked", "", answer.words))
        case "loads":
            said += [("seen-message", words, f"prints: {words}") for words in answer.complaints]
            refusals = held.refusals if held else ()
            said += [("seen-refused-part", words, f"loads the file without its {words}") for words in refusals]
    for rule, words, text in said:
        yield _Fact(answer, rule, *of_words(seen.text, words), text)
    if held is not None and not (held.links or held.joints):
        if any(each.tag in LINKS for each in seen.text.marks):
            text = "takes the file for an empty world: it has no link"
            yield _Fact(answer, "seen-empty-world", "", "", seen.text.whole, text)
    elif held is not None and seen.own is not None:
        for each in differences(seen.own, held, seen.asked.question):
            yield _of_difference(answer, each, seen.text)


def _of_difference(answer: Answer, each: Difference, text: Text) -> _Fact:
    kind, mark = of_name(text, each.name, JOINT if each.rule in _OF_JOINTS else LINKS)
    return _Fact(answer, each.rule, kind, each.name, mark, each.text)


def _fits(fact: _Fact, effect: Effect, finding: Finding, at: Sequence[etree._Element]) -> bool:
    """Whether something that was seen is what a rule foretells of an element."""
    is_named = bool(fact.name) and f"'{fact.name}'" in finding.message
    if fact.rule in {"seen-refusal", "seen-crash"}:
        return effect.severity == "error" and (
            not fact.name or is_named or any(owner_of(e)[1] == fact.name for e in at)
        )
    tags = seen_rules()[fact.rule].at.split()
    return bool(fact.name) and any(
        (owner_of(each)[1] == fact.name or is_named) and (not tags or each.tag in (*tags, owner_of(each)[0]))
        for each in at
    )


def _is_settled(answer: Answer, effect: Effect, at: Sequence[etree._Element]) -> bool:
    """Whether a program has shown that it does not do what a rule foretells."""
    inside = {str(inner.tag) for each in at for inner in (each, *each.iterancestors())}
    if answer.end != "loads":
        return effect.severity != "error"
    if effect.severity != "error" and answer.held and not (answer.held.joints or any(answer.held.links.values())):
        return False  # It tells the names of links, as urdfdom does.
    if inside & set(answer.program.inspects.unopened):
        return False
    return effect.severity == "error" or not inside & _UNCOMPARED


def _unforetold(facts: Sequence[_Fact]) -> Iterator[Finding]:
    """The findings about what no rule has foretold.

    Facts about one element in one program are one finding: they have one cause, and a program prints what it changes.
    """
    groups: dict[tuple[str, str, str], list[_Fact]] = {}
    for number, fact in enumerate(facts):
        is_alone = not fact.name or seen_rules()[fact.rule].severity != "warning" or fact.rule == "seen-mesh-size"
        groups.setdefault((fact.answer.name, fact.name, str(number) if is_alone else ""), []).append(fact)
    for group in groups.values():
        first = min(group, key=lambda fact: fact.rule == "seen-message")
        rule, program = seen_rules()[first.rule], first.answer.program
        does = "; ".join(dict.fromkeys(fact.text for fact in group))
        effect = Effect(consumer=program.consumer, severity=rule.severity, text=does, seen=first.answer.name)
        fault = rule.fault.replace("a program", program.inspects.title)
        of = f"{first.kind} {first.name!r}" if first.name else "the file"
        message = f"{of} {fault}"
        if rule.fault.startswith("a program"):
            message = f"{fault}, at {of}" if first.name else fault
        yield Finding(rule=first.rule, message=message, fix=rule.fix, effects=(effect,), mark=first.mark)
