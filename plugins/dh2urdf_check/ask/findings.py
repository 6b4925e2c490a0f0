"""What programs made of the files of a command, as findings: seen, and where nobody was asked, foretold."""

from __future__ import annotations

import os
import re
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.documents import read_bytes
from dh2urdf.documents.text_files import is_folder
from dh2urdf.errors import ConfigError, Dh2UrdfError, InputError
from dh2urdf.isolation.fence import TRUST, missing_wall
from dh2urdf.meshes import mesh_finder, packages_in, with_its_own
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Effect, Expansion, Finding, Question, ReadsForeign
from dh2urdf.stages.foreign_robot import ForeignRobot
from dh2urdf_check.ask.asking import Answer, Asked, Asking, programs
from dh2urdf_check.ask.comparing import Difference, differences, postures, unlike_meshes
from dh2urdf_check.ask.places import JOINT, LINKS, Places, owner_of
from dh2urdf_check.rules import table
from dh2urdf_plugins.formats.xml_files import LARGEST

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from lxml import etree

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.stages import Emitter, HeldRobot, Inspection, Severity

_UNCOMPARED = frozenset(
    {
        *("dynamics", "safety_controller", "calibration", "transmission", "gazebo", "sensor", "ros2_control"),
        *("material", "color", "texture", "mesh"),
    }
)
"""Elements whose effects nobody can see in what the programs tell, other than that the file is refused."""
_OF_JOINTS = frozenset({"seen-lost-joint", "seen-joint-type", "seen-axis", "seen-limit", "seen-mimic"})
_ADDRESS = re.compile(
    rb"(?:filename|file|meshdir|assetdir|texturedir)\s*=\s*[\"']([^\"'<>]+)[\"']|<uri>\s*([^<]+?)\s*</uri>"
)


_PACKAGE = re.compile(rb"package://(\w[^/\"'<>\s]*)/")


class SeenRule(NamedTuple):
    """A kind of fact, as ``rules/seen.yaml`` has it.

    Attributes:
        severity: how bad it is.
        fault: what it is.
        fix: what to do about it.
        at: the elements that it is about; empty for all of a link or joint.
    """

    severity: Severity
    fault: str
    fix: str
    at: str = ""


@cache
def seen_rules() -> dict[str, SeenRule]:
    """The kinds of facts by name, in the order of their table."""
    return {name: SeenRule(**entry) for name, entry in table("seen").items()}


class Given(NamedTuple):
    """A file of the command, as programs are given it.

    Attributes:
        path: as the user named it.
        places: its elements.
        own: our own reading of it; None where it has none.
        asked: what the programs get.
    """

    path: Path
    places: Places
    own: ForeignRobot | None
    asked: Asked


class Seen(NamedTuple):
    """What was seen of one file.

    Attributes:
        given: the file.
        answers: what each program made of it.
    """

    given: Given
    answers: tuple[Answer, ...]

    def beside(self, foretold: Sequence[Finding]) -> list[Finding]:
        """The findings about the file, see `seen_findings`."""
        return seen_findings(self, foretold)


@contextmanager
def asking(
    catalog: Catalog, files: Sequence[tuple[Path, Emitter[Any]]], expansion: Expansion, consumers: Sequence[str] | None
) -> Iterator[Iterator[Seen]]:
    """Give files to the programs that are installed; a context, in which they are at work.

    Args:
        catalog: the loaders that there are.
        files: the files, each with the emitter of its format.
        expansion: how those are expanded that hold macros, and where packages are.
        consumers: whom to ask; all where it is empty, and nobody where it is None.

    Yields:
        what was seen of each file, in their order. A file that cannot be read or expanded is left out.
    """
    found = [] if consumers is None else programs(catalog, consumers)
    formats = {form for program in found for form in program.inspects.formats}
    with TemporaryDirectory(prefix="dh2urdf-check-") as folder:
        given = []
        for number, (path, emitter) in enumerate(files):
            one = _given(path, emitter, expansion, Path(folder, str(number))) if found else None
            if one is not None and one.asked.question.format in formats:
                given.append(one)
        with Asking(found, [each.asked for each in given]) as at_work:
            yield (Seen(*each) for each in zip(given, at_work.answers(), strict=True))


def why_unasked() -> str:
    """Why no program is given a file of a stranger here; an empty text where all can be."""
    missing = missing_wall()
    return f"{missing}; `--trust` asks the programs all the same" if missing and not os.environ.get(TRUST) else ""


def with_what_is_seen(
    catalog: Catalog, emitter: Emitter[Any], path: Path, expansion: Expansion, found: Inspection
) -> Inspection:
    """An inspection with what the programs that are installed were seen to do with the file.

    Raises:
        ConfigError: no program can be given the file of a stranger here.
    """
    if why := why_unasked():
        raise ConfigError(Problem(message=f"no simulator is given the file: {why}", mark=Mark(file=str(path))))
    with asking(catalog, [(path, emitter)], expansion, ()) as at_work:
        seen = next(at_work, None)
    return replace(found, findings=tuple(seen_findings(seen, found.findings))) if seen else found


def _given(path: Path, emitter: Emitter[Any], expansion: Expansion, folder: Path) -> Given | None:
    """A file as programs are given it; a xacro as what it expands to, beside links to its neighbours."""
    marks: list[Mark | None] = []
    try:
        content, known = read_bytes(path, InputError, limit=LARGEST), packages_in(expansion.package_paths)
        where, form = Path(os.path.abspath(path)), emitter.name  # noqa: PTH100 - standard input has another name as text
        reads = emitter.can(ReadsForeign)
        if reads is not None and reads.has_macros:
            from dh2urdf_plugins.xacro_fence.expansion import expand_foreign, mark_of

            expanded = expand_foreign(path, expansion)
            content, form = expanded.content, "urdf"
            marks = [place and mark_of(place) for place in expanded.places]
            where = _written(content, where, folder, _packages_above(content, where))
    except (Dh2UrdfError, OSError):  # The inspection of the file reports it.
        return None
    own = _own(path, emitter, expansion)
    packages = with_its_own(path, known)
    question = Question(path=where, format=form, packages=packages, postures=postures(own) if own else ())
    readable = (
        Path(os.fspath(path)).absolute().parent,
        where.parent,
        *packages.values(),
        *_packages_above(content, Path(os.fspath(path)).absolute()).values(),
        *_named(content, path, packages),
    )
    return Given(path, Places(content, path, marks), own, Asked(question, tuple(dict.fromkeys(readable))))


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


def _own(path: Path, emitter: Emitter[Any], expansion: Expansion) -> ForeignRobot | None:
    reads = emitter.can(ReadsForeign)
    try:
        robot = reads.read_foreign(path, expansion) if reads else None
    except Dh2UrdfError:  # What is not read here cannot be compared.
        return None
    if robot is None:
        return None
    found = robot if isinstance(robot, ForeignRobot) else ForeignRobot(robot=robot)
    return replace(found, robot=_from_the_root(found.robot))


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
    find = mesh_finder(path.absolute().parent, packages)
    for texts in _ADDRESS.findall(content):
        address = b"".join(texts).decode("utf-8", "replace")
        folder = path.absolute().parent / address
        if "://" not in address and is_folder(folder):
            yield folder
        elif file := find(address):
            yield file.resolve() if address.startswith(("/", "file:")) else file.resolve().parent


# --- What was seen as findings ----------------------------------------------------------------------------------------


def seen_findings(seen: Seen, foretold: Sequence[Finding]) -> list[Finding]:
    """The findings about a file: what is foretold of consumers that were not asked, and what was seen in the others.

    Where a rule has foretold what a program did to an element, the finding of the rule says that it was seen. What is
    foretold besides of a program that loads the file is left out: it was not seen.
    """
    facts = [fact for answer in seen.answers for fact in _facts(answer, seen.given)]
    told = {answer.name: answer.held for answer in seen.answers if answer.held is not None}
    if seen.given.own is not None:
        by_name = {answer.name: answer for answer in seen.answers}
        for name, each in unlike_meshes(seen.given.own.robot, told):
            facts.append(_of_difference(by_name[name], each, seen.given.places))
    findings, left = [], list(facts)
    for finding in foretold:
        effects, fitting = [], list(seen.given.places.at(finding.mark))
        for effect in finding.effects:
            answer = next((each for each in seen.answers if each.program.consumer == effect.consumer), None)
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
    return [*findings, *(_own_finding(fact) for fact in _together(left))]


class _Fact(NamedTuple):
    """Something that a program was seen to do: the rule of its kind, the link or joint, its place, and in words."""

    answer: Answer
    rule: str
    kind: str
    name: str
    mark: Mark
    text: str


def _facts(answer: Answer, given: Given) -> Iterator[_Fact]:
    def fact(rule: str, words: str, text: str) -> _Fact:
        kind, name, mark = given.places.of_words(words)
        return _Fact(answer, rule, kind, name, mark, text)

    match answer.end:
        case "refuses":
            reasons = " ".join((answer.words, *answer.complaints))
            yield fact("seen-refusal", reasons, f"refuses the file: {answer.words}")
        case "crashes":
            yield fact("seen-crash", "", answer.words)
        case "unasked":
            yield fact("seen-unasked", "", answer.words)
        case "loads":
            for words in answer.complaints:
                yield fact("seen-message", words, f"prints: {words}")
            if answer.held is not None:
                yield from _of_held(answer, answer.held, given)


def _of_held(answer: Answer, held: HeldRobot, given: Given) -> Iterator[_Fact]:
    """What a program that loads the file has otherwise than our own reading."""
    for words in held.refusals:
        kind, name, mark = given.places.of_words(words)
        yield _Fact(answer, "seen-refused-part", kind, name, mark, f"loads the file without its {words}")
    if not (held.links or held.joints):
        if any(each.tag in LINKS for each in given.places.elements):
            text = "takes the file for an empty world: it has no link"
            yield _Fact(answer, "seen-empty-world", "", "", given.places.whole, text)
    elif given.own is not None:
        for each in differences(given.own, held, given.asked.question):
            yield _of_difference(answer, each, given.places)


def _of_difference(answer: Answer, each: Difference, places: Places) -> _Fact:
    kind, mark = places.of_name(each.name, JOINT if each.rule in _OF_JOINTS else LINKS)
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


def _together(facts: Sequence[_Fact]) -> list[list[_Fact]]:
    """Facts about one element in one program, which have one cause: a program prints that it changes something."""
    groups: dict[tuple[str, str, str], list[_Fact]] = {}
    for number, fact in enumerate(facts):
        is_alone = not fact.name or seen_rules()[fact.rule].severity != "warning" or fact.rule == "seen-mesh-size"
        groups.setdefault((fact.answer.name, fact.name, str(number) if is_alone else ""), []).append(fact)
    return list(groups.values())


def _own_finding(facts: Sequence[_Fact]) -> Finding:
    """The finding about what no rule has foretold."""
    first = min(facts, key=lambda fact: fact.rule == "seen-message")
    rule = seen_rules()[first.rule]
    title = first.answer.program.inspects.title
    fault, of = rule.fault.replace("a program", title), f"{first.kind} {first.name!r}" if first.name else "the file"
    effect = Effect(
        consumer=first.answer.program.consumer,
        severity=rule.severity,
        text="; ".join(dict.fromkeys(fact.text for fact in facts)),
        seen=first.answer.name,
    )
    about_program = rule.fault.startswith("a program")
    message = f"{of} {fault}" if not about_program else f"{fault}, at {of}" if first.name else fault
    return Finding(rule=first.rule, message=message, fix=rule.fix, effects=(effect,), mark=first.mark)
