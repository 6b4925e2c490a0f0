"""What `dh2urdf check` foretells of published descriptions, against what it sees the installed programs do.

    python fuzz/foretold.py ~/corpora --most 100 --report report.md

Each folder below a FOLDER is one source: its ROS packages are known to its files, and the files that are drawn are
spread over the sources. Descriptions of the same bytes count once.

The table has a line for each format and program. Of the files that it was asked about, it names how many

- the program does not load, and nothing foretold that (missed), or it loads although that was foretold (false);
- have something that the program loses or alters, and nothing foretold that, or the other way round (changes).

Below the table, each of those is named, with the rules or the words of the program.
"""

from __future__ import annotations

import argparse
import hashlib
import random
import sys
from collections import Counter, defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.commands.check import inspect
from dh2urdf.errors import Dh2UrdfError
from dh2urdf.plugin_system.catalog import load
from dh2urdf.stages import Expansion
from dh2urdf_check.ask.findings import asking
from dh2urdf_check.files import described_files
from dh2urdf_check.inspection import model_rules
from dh2urdf_check.rules import Outcome, rules

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.stages import Finding
    from dh2urdf_check.ask.asking import Answer
    from dh2urdf_check.ask.findings import Seen

SUFFIXES = {"urdf": (".urdf",), "xacro": (".xacro",), "sdf": (".sdf",), "mjcf": (".xml", ".mjcf")}
"""The formats, and by which suffixes the programs know them."""
UNANSWERED = ("PackageMap: when downloading",)
"""Words of a program that wanted something of the network: what it would have done is not known."""
CATALOG = load()
FATAL = {Outcome.REFUSES, Outcome.CRASHES}
LONGEST = 400
"""How many characters of a program's words are shown."""


class Case(NamedTuple):
    """A description, the format that it has, and the folder of its source."""

    path: Path
    form: str
    source: Path


class Wrong(NamedTuple):
    """Something that a program does and was not foretold, or the other way round."""

    case: Case
    consumer: str
    kind: str
    why: str


def main() -> int:
    """Ask, compare, and print the table; the exit status is 1 where something was wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="folders of sources")
    parser.add_argument("--most", type=int, default=100, help="how many descriptions of each format are drawn")
    parser.add_argument("--seed", default="0", help="of the draw")
    parser.add_argument("--format", choices=SUFFIXES, action="append", help="only this one; repeatable")
    parser.add_argument("--report", type=Path, help="where the table and what was wrong is written, too")
    asked = parser.parse_args()
    cases = drawn(list(published(asked.folders)), asked.format or SUFFIXES, asked.most, asked.seed)
    seen: dict[Path, Seen] = {}
    for source in dict.fromkeys(case.source for case in cases):
        ask([case for case in cases if case.source == source], seen)
    counts, wrong = Counter[tuple[str, str]](), list[Wrong]()
    for case in cases:
        if case.path in seen:
            counts.update((case.form, answer.program.consumer) for answer in answers_of(seen[case.path]))
            wrong += compared(case, seen[case.path])
    text = "\n".join([*table(wrong, counts), "", *named(wrong), ""])
    print(text)
    if asked.report:
        asked.report.write_text(text)
    return int(bool(wrong))


# --- Descriptions -----------------------------------------------------------------------------------------------------


def published(folders: Iterable[Path]) -> Iterator[Case]:
    """The descriptions below some folders; of the same bytes, the first."""
    known = set[bytes]()
    for folder in folders:
        for source in sorted(each for each in folder.resolve().iterdir() if each.is_dir()):
            try:
                found = described_files(CATALOG, [source]).files
            except Dh2UrdfError as error:
                print(error, file=sys.stderr)
                continue
            for path, form in found:
                digest = hashlib.sha256(path.read_bytes()).digest()
                if path.suffix in SUFFIXES.get(form, ()) and digest not in known:
                    known.add(digest)
                    yield Case(path, form, source)


def drawn(cases: Sequence[Case], forms: Iterable[str], most: int, seed: str) -> list[Case]:
    """As many of each format, one of each source in turn."""
    chosen: list[Case] = []
    for form in forms:
        piles = defaultdict[Path, list[Case]](list)
        for case in cases:
            if case.form == form:
                piles[case.source].append(case)
        for source, pile in piles.items():
            random.Random(f"{seed} {form} {source.name}").shuffle(pile)
        turns = [pile[turn] for turn in range(most) for pile in piles.values() if turn < len(pile)]
        chosen += turns[:most]
    return chosen


def packages_of(case: Case) -> Expansion:
    """The packages that a description may name."""
    return Expansion(package_paths=(case.source,) if next(case.source.rglob("package.xml"), None) else ())


# --- Comparison -------------------------------------------------------------------------------------------------------


def ask(cases: Sequence[Case], seen: dict[Path, Seen]) -> None:
    """Ask the programs about the files of one source."""
    files = [(case.path, CATALOG.get("emitter", case.form)) for case in cases]
    with asking(CATALOG, files, packages_of(cases[0]), ()) as at_work:
        seen.update((each.path, each) for each in at_work)


def answers_of(seen: Seen) -> list[Answer]:
    """The programs that have answered about a file."""
    return [each for each in seen.answers if each.end != "unasked" and not any(map(each.words.count, UNANSWERED))]


def compared(case: Case, seen: Seen) -> Iterator[Wrong]:
    """What was foretold of a file and was not seen, and what was seen and not foretold."""
    known = rules() if case.form in ("urdf", "xacro") else model_rules(case.form)
    expansion = packages_of(case) if case.form in ("urdf", "xacro") else None
    foretold = inspect(CATALOG, case.path, case.form, "--as", expansion).findings
    found = seen.beside(foretold)
    kept, own = effects_of(found), {finding.rule for finding in found} - {finding.rule for finding in foretold}
    for answer in answers_of(seen):
        consumer, loads = answer.program.consumer, answer.end == "loads"
        told = [rule for rule, *_, of in effects_of(foretold) if of == consumer]
        fatal = [rule for rule in told if rule in known and known[rule].outcomes.get(consumer) in FATAL]
        if fatal and loads:
            yield Wrong(case, consumer, "false", ", ".join(dict.fromkeys(fatal)))
        if not fatal and not loads:
            yield Wrong(case, consumer, "missed", f"{answer.end}: {answer.words[:LONGEST]}")
        if loads:
            gone = {rule for rule, *where, of in effects_of(foretold) - kept if of == consumer} - set(fatal)
            came = {rule for rule, *_, of in kept if rule in own and of == consumer and rule != "seen-message"}
            yield from (Wrong(case, consumer, "false change", rule) for rule in sorted(gone))
            yield from (Wrong(case, consumer, "missed change", rule) for rule in sorted(came))


def effects_of(findings: Sequence[Finding]) -> set[tuple[str, str, str, str]]:
    """What findings foretell or tell, but for notes: the rule, the message, its place, and the program."""
    return {
        (finding.rule, finding.message, str(finding.mark), effect.consumer)
        for finding in findings
        for effect in finding.effects
        if effect.severity != "note"
    }


def table(wrong: Sequence[Wrong], counts: Counter[tuple[str, str]]) -> Iterator[str]:
    """A line for each format and program."""
    kinds = ("missed", "false", "missed change", "false change")
    yield f"| format | program | files | {' | '.join(kinds)} |"
    yield f"|---|---|---{'|---' * len(kinds)}|"
    for (form, consumer), count in counts.items():
        mine = [each for each in wrong if (each.case.form, each.consumer) == (form, consumer)]
        numbers = (len({each.case.path for each in mine if each.kind == kind}) for kind in kinds)
        shares = (f"{number} ({100 * number / count:.1f} %)" for number in numbers)
        yield f"| {form} | {consumer} | {count} | {' | '.join(shares)} |"


def named(wrong: Sequence[Wrong]) -> Iterator[str]:
    """Each file that was wrong, by what was wrong about it."""
    for each in sorted(wrong, key=lambda each: (each.kind, each.case.form, each.consumer, each.why)):
        yield f"{each.kind}: {each.case.form}, {each.consumer}: {each.why} ({each.case.path})"


if __name__ == "__main__":
    sys.exit(main())
