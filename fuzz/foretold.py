"""What `dh2urdf check` foretells of published descriptions, against what the installed programs do with them.

    python fuzz/foretold.py ~/corpora --most 100 --seen /tmp/seen.json --report report.md

Each folder below a FOLDER is one source: its ROS packages are known to its files, and the files that are drawn are
spread over the sources. Descriptions of the same bytes count once. A xacro is handed to the programs as it expands, in
a file beside it. No program is told of packages that it does not find itself.

The table has a line for each format and program: how many files were asked about, how many of them the program does not
load although nothing foretold that (missed), and how many it loads against what was foretold (false). Below it, each
of those is named, with the rules or the words of the program. `--seen` keeps what the programs did: the next run asks
about new files only.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import random
import subprocess
import sys
from collections import defaultdict
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.commands.check import inspect
from dh2urdf.errors import Dh2UrdfError
from dh2urdf.plugin_system.catalog import load
from dh2urdf.stages import Expansion
from dh2urdf_check.described_files import described_files
from dh2urdf_check.models import model_rules
from dh2urdf_check.rules import Outcome, rules
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "check"))
import consumers as of_urdf
import model_consumers as of_models

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

FORMATS = {
    "urdf": ("pybullet", "mujoco", "pinocchio", "drake", "ros", "gazebo"),
    "xacro": ("pybullet", "mujoco", "pinocchio", "drake", "ros", "gazebo"),
    "sdf": ("gazebo", "drake", "pybullet"),
    "mjcf": ("mujoco", "drake", "pybullet"),
}
"""The programs that are asked about each format."""
SUFFIXES = {"urdf": (".urdf",), "xacro": (".xacro",), "sdf": (".sdf",), "mjcf": (".xml", ".mjcf")}
"""By which the programs know the formats."""
UNANSWERED = ("PackageMap: when downloading",)
"""Words of a program that wanted something of the network: what it would have done is not known."""
CATALOG = load()
FATAL = {Outcome.REFUSES, Outcome.CRASHES}
AT_ONCE = 8
"""How many models a process of a program is given [files]."""
LONGEST = 400
"""How much is kept of what a program raised, and of the end of what it printed."""


class Case(NamedTuple):
    """A description, the format that it has, and the folder of its source."""

    path: Path
    form: str
    source: Path


class Wrong(NamedTuple):
    """A program that did something else than was foretold."""

    case: Case
    consumer: str
    end: str
    why: str


def main() -> int:
    """Ask, compare, and print the table; the exit status is 1 where something was wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="folders of sources")
    parser.add_argument("--most", type=int, default=100, help="how many descriptions of each format are drawn")
    parser.add_argument("--seed", default="0", help="of the draw")
    parser.add_argument("--format", choices=FORMATS, action="append", help="only this one; repeatable")
    parser.add_argument("--seen", type=Path, help="a file where it is kept what the programs did")
    parser.add_argument("--report", type=Path, help="where the table and what was wrong is written, too")
    asked = parser.parse_args()
    cases = drawn(list(published(asked.folders)), asked.format or FORMATS, asked.most, asked.seed)
    seen = json.loads(asked.seen.read_text()) if asked.seen and asked.seen.exists() else {}
    with ExitStack() as stack:
        given = {case: handed(case, stack) for case in cases}
        for source in dict.fromkeys(case.source for case in cases):
            ask([case for case in cases if case.source == source], given, seen)
            if asked.seen:
                asked.seen.write_text(json.dumps(seen))
    wrong, counts = compared(cases, given, seen)
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
        for source in sorted(each for each in folder.iterdir() if each.is_dir()):
            try:
                found = described_files(CATALOG, [source]).files
            except Dh2UrdfError as error:
                print(error, file=sys.stderr)
                continue
            for path, form in found:
                digest = hashlib.sha256(path.read_bytes()).digest()
                if form in FORMATS and path.suffix in SUFFIXES[form] and digest not in known:
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


def packages_of(case: Case) -> tuple[Path, ...]:
    """The folders whose packages a description may name."""
    return (case.source,) if next(case.source.rglob("package.xml"), None) else ()


def handed(case: Case, stack: ExitStack) -> Path | None:
    """The file that the programs are handed: of a xacro, what it expands to, beside it; None where it does not."""
    if case.form != "xacro":
        return case.path
    try:
        content = expand_foreign(case.path, Expansion(package_paths=packages_of(case))).content
    except Dh2UrdfError:
        return None
    out = case.path.with_name(f"expanded-{case.path.stem}.urdf")
    out.write_bytes(content)
    stack.callback(out.unlink)
    return out


# --- What the programs do ---------------------------------------------------------------------------------------------


def key(case: Case, consumer: str, given: dict[Case, Path | None]) -> str:
    """What an answer is kept by."""
    return f"{consumer} {case.path}" if given[case] else ""


def ask(cases: Sequence[Case], given: dict[Case, Path | None], seen: dict[str, Any]) -> None:
    """Ask the programs about the files of one source that they have not answered yet."""
    for consumer in FORMATS["urdf"]:
        fresh = [case for case in cases if consumer in FORMATS[case.form] and given[case]]
        fresh = [case for case in fresh if key(case, consumer, given) not in seen]
        robots = [case for case in fresh if case.form in ("urdf", "xacro")]
        paths = [given[case] for case in robots]
        answers = [each.__dict__ for each in of_urdf.behaviours(consumer, paths)] if robots else []
        seen.update((key(case, consumer, given), said(each)) for case, each in zip(robots, answers, strict=True))
        models = [case for case in fresh if case not in robots]
        for start in range(0, len(models), AT_ONCE):
            some = models[start : start + AT_ONCE]
            answers = outcomes(consumer, [case.path for case in some])
            seen.update((key(case, consumer, given), said(each)) for case, each in zip(some, answers, strict=True))


def outcomes(consumer: str, paths: list[Path]) -> list[dict[str, Any]]:
    """What a program does with some models; one that it does not end with counts as a crash."""
    try:
        return of_models.outcomes(consumer, paths)
    except subprocess.TimeoutExpired:
        if len(paths) > 1:
            return [outcomes(consumer, [path])[0] for path in paths]
        return [{"end": "crashes", "printed": "it does not end"}]


def said(answer: dict[str, Any]) -> tuple[str, str]:
    """How a program ended, and its words."""
    extra = answer.get("extra", {})
    raised = answer.get("raised") or extra.get("raised") or extra.get("said") or ""
    printed = " ".join(answer.get("printed", "").split())
    return answer["end"], f"{' '.join(raised.split())[:LONGEST]} … {printed[-LONGEST:]}"


# --- Comparison -------------------------------------------------------------------------------------------------------


def foretold(case: Case) -> dict[str, list[str]]:
    """By program, the rules by which `check` foretells that it does not load a file."""
    form = "urdf" if case.form == "xacro" else case.form
    known = rules() if form == "urdf" else model_rules(form)
    expansion = Expansion(package_paths=packages_of(case)) if form == "urdf" else None
    fatal = defaultdict[str, list[str]](list)
    for finding in inspect(CATALOG, case.path, case.form, "--as", expansion).findings:
        outcomes = known[finding.rule].outcomes if finding.rule in known else {}
        for effect in finding.effects:
            if outcomes.get(effect.consumer) in FATAL:
                fatal[effect.consumer].append(finding.rule)
    return fatal


def compared(
    cases: Sequence[Case], given: dict[Case, Path | None], seen: dict[str, Any]
) -> tuple[list[Wrong], dict[tuple[str, str], int]]:
    """What was foretold against what was seen, and how many answers there are by format and program."""
    wrong, counts = list[Wrong](), defaultdict[tuple[str, str], int](int)
    for case in cases:
        fatal = foretold(case)
        for consumer in FORMATS[case.form] if given[case] else ():
            end, words = seen[key(case, consumer, given)]
            if any(text in words for text in UNANSWERED):
                continue
            counts[case.form, consumer] += 1
            if (end == "loads") is bool(fatal[consumer]):
                why = ", ".join(dict.fromkeys(fatal[consumer])) or words
                wrong.append(Wrong(case, consumer, end, why))
    return wrong, counts


def table(wrong: Sequence[Wrong], counts: dict[tuple[str, str], int]) -> Iterator[str]:
    """A line for each format and program."""
    yield "| format | program | files | missed | false |"
    yield "|---|---|---|---|---|"
    for (form, consumer), count in counts.items():
        ends = [each.end for each in wrong if (each.case.form, each.consumer) == (form, consumer)]
        false = ends.count("loads")
        missed = len(ends) - false
        shares = [f"{number} ({100 * number / count:.1f} %)" for number in (missed, false)]
        yield f"| {form} | {consumer} | {count} | {shares[0]} | {shares[1]} |"


def named(wrong: Sequence[Wrong]) -> Iterator[str]:
    """Each file that was wrong, by what was wrong about it."""
    for each in sorted(wrong, key=lambda each: (each.end == "loads", each.case.form, each.consumer, each.why)):
        what = "false" if each.end == "loads" else "missed"
        yield f"{what}: {each.case.form}, {each.consumer} {each.end}: {each.why} ({each.case.path})"


if __name__ == "__main__":
    sys.exit(main())
