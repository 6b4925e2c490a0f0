"""Descriptions with random faults through the readers themselves, against what `dh2urdf check` declares about them.

    python fuzz/descriptions.py --files 20000 --seed 1 --workers 2 --found build/mispredicted

Each file is a sound description, or a connected piece of one, with up to three faults. PyBullet, MuJoCo, Pinocchio,
Drake, urdfdom and sdformat load it, each in a process of its own. A refusal that was predicted and does not happen is
false, one that happens and was not predicted is missed. Where neither a refusal nor a change is predicted, the loaded
joints, limits and masses are compared with those of the file: a difference was made in silence. An exception of `check`
itself is a failure too. What is mispredicted is made as small as it can be, grouped by reader, rules and message, and
written to the folder `--found`. The figures and the largest groups are printed after every thousand files, and at the
end, also where SIGINT (Ctrl-C) ends it early.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import re
import signal
import sys
import tempfile
import time
from collections import Counter
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, NamedTuple

import description_faults as faults
from description_facts import Plain, difference, plain
from description_sources import sources, write_meshes
from description_texts import FORMS
from description_tree import Node, piece

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "check"))
from consumers import READERS, Behaviour, Reader

from dh2urdf_check.inspection import inspect_urdf
from dh2urdf_check.rules import Outcome, rules

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

FATAL = {Outcome.REFUSES, Outcome.CRASHES}
CHANGED = {Outcome.LOSES, Outcome.ALTERS}
COLUMNS = ("files", "refused", "predicted", "compared")
KINDS = ("false", "missed", "altered")
MOST_LINKS = 6
"""Links of a piece of a description."""
SECONDS_TO_SHRINK = 20
GROUPS_PRINTED = 10


class Case(NamedTuple):
    """A description with faults: the tree, the way to write it as bytes, and the names of what was done to it."""

    tree: Node
    form: str
    names: tuple[str, ...]

    def write(self, path: Path) -> None:
        """Write the file."""
        text = self.tree.written().replace("FOLDER", str(path.parent))
        path.write_bytes(FORMS[self.form](text))


class Wrong(NamedTuple):
    """A misprediction: of which reader, of which kind, by which rules, and what the reader said."""

    consumer: str
    kind: str
    rules: tuple[str, ...]
    said: str


@dataclass
class Figures:
    """What came of some files."""

    files: int = 0
    predictions: int = 0
    predicted: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    compared: Counter[str] = field(default_factory=Counter)
    wrong: dict[Wrong, list[int]] = field(default_factory=dict)

    def count(self, consumer: str, kind: str) -> int:
        """Mispredictions of a reader, of a kind."""
        return sum(
            len(found) for wrong, found in self.wrong.items() if (wrong.consumer, wrong.kind) == (consumer, kind)
        )

    def add(self, other: Figures) -> None:
        """Those of other files besides."""
        self.files += other.files
        self.predictions += other.predictions
        self.predicted += other.predicted
        self.refused += other.refused
        self.compared += other.compared
        for wrong, found in other.wrong.items():
            self.wrong.setdefault(wrong, []).extend(found)


def case(seed: int, index: int, robots: Sequence[Node]) -> Case:
    """The description of a number: the same each time."""
    rng = Random(f"{seed}/{index}")
    tree = piece(rng.choice(robots), rng, rng.randint(2, MOST_LINKS))
    names = []
    for _ in range(rng.choices((0, 1, 2, 3), (1, 12, 5, 2))[0]):
        fault = rng.choice(faults.IN_THE_TREE)
        if fault(rng, tree):
            names.append(fault.__name__)
    form = rng.choice(list(FORMS)) if rng.random() < 0.12 else "plain"
    return Case(tree, form, tuple(names))


class Prediction(NamedTuple):
    """What is predicted of a reader: the rules by which it does not load a file, and those by which it changes it."""

    fatal: list[str]
    changing: list[str]


def predicted(path: Path) -> dict[str, Prediction]:
    """What is predicted of each reader."""
    found = {consumer: Prediction([], []) for consumer in READERS}
    for finding in inspect_urdf(path).findings:
        for effect in finding.effects:
            if effect.consumer in found:
                outcome = rules()[finding.rule].outcomes[effect.consumer]
                if outcome in FATAL:
                    found[effect.consumer].fatal.append(finding.rule)
                if outcome in CHANGED:
                    found[effect.consumer].changing.append(finding.rule)
    return found


class Tried(NamedTuple):
    """What came of a file in a reader.

    Attributes:
        consumer: the reader.
        wrong: what is mispredicted.
        told: whether a refusal was predicted.
        refused: whether there was one.
        compared: whether the loaded model was compared with the file.
    """

    consumer: str
    wrong: Wrong | None
    told: bool
    refused: bool
    compared: bool = False


def compared(consumer: str, prediction: Prediction, behaviour: Behaviour, file: Plain | None) -> Tried:
    """What is mispredicted of a reader, if anything is."""
    told, refused = bool(prediction.fatal), behaviour.end != "loads"
    if told != refused:
        said = str(behaviour.extra.get("raised", "")) or behaviour.printed[-400:]
        if behaviour.end == "crashes":
            said = f"crash {behaviour.extra.get('signal', '')} {said}"
        kind = "false" if told else "missed"
        return Tried(consumer, _wrong(consumer, kind, prediction.fatal, "" if told else said), told, refused)
    if refused or prediction.changing or file is None:
        return Tried(consumer, None, told, refused)
    said = difference(consumer, file, behaviour)
    return Tried(consumer, _wrong(consumer, "altered", [], said) if said else None, told, refused, compared=True)


def _wrong(consumer: str, kind: str, by: Sequence[str], said: str) -> Wrong:
    said = re.sub(r"/\S*/robots/\S+|0x[0-9a-f]+|[-+]?\d[\d.e+-]*|'[^']*'|\"[^\"]*\"|\[[^\]]*\]", "~", said)
    return Wrong(consumer, kind, tuple(sorted(set(by))), said[:160])


class Bench:
    """The six readers, waiting, and a folder with meshes."""

    def __init__(self, stack: ExitStack) -> None:
        self.folder = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "robots"
        self.folder.mkdir()
        write_meshes(self.folder)
        self.path = self.folder / "arm.urdf"
        self.readers = {consumer: stack.enter_context(Reader(consumer)) for consumer in READERS}

    def tried(self, tried: Case, consumers: Sequence[str] = tuple(READERS)) -> Iterator[Tried]:
        """What came of a description, by reader."""
        tried.write(self.path)
        for consumer in consumers:
            self.readers[consumer].ask(self.path)
        predictions, raised = dict[str, Prediction](), ""
        try:
            predictions = predicted(self.path)
        except Exception as error:  # noqa: BLE001 - whatever `check` raises is what is looked for
            raised = f"{type(error).__name__}: {error}"
        file = plain(self.path.read_bytes())
        for consumer in consumers:
            behaviour = self.readers[consumer].answer()
            if raised:
                wrong = Wrong(consumer, "check raised", (), raised)
                yield Tried(consumer, wrong, told=False, refused=behaviour.end != "loads")
            else:
                yield compared(consumer, predictions[consumer], behaviour, file)

    def shrunk(self, tried: Case, wrong: Wrong) -> Case:
        """The smallest description that is mispredicted in the same way."""
        until = time.monotonic() + SECONDS_TO_SHRINK
        smaller = True
        if self._is(Case(tried.tree, "plain", tried.names), wrong):
            tried = Case(tried.tree, "plain", tried.names)
        while smaller and time.monotonic() < until:
            smaller = False
            for step in range(10**6):
                candidate = _without(tried.tree, step)
                if candidate is None or time.monotonic() > until:
                    break
                if self._is(attempt := Case(candidate, tried.form, tried.names), wrong):
                    tried, smaller = attempt, True
                    break
        return tried

    def _is(self, tried: Case, wrong: Wrong) -> bool:
        return any(found.wrong == wrong for found in self.tried(tried, [wrong.consumer]))


def _without(tree: Node, step: int) -> Node | None:
    """A tree without its element or attribute of a number; None where there are fewer."""
    new = tree.copy()
    for node in new.walk():
        if step < len(node.children):
            node.children.pop(step)
            return new
        step -= len(node.children)
    for node in new.walk():
        if step < len(node.attributes):
            node.attributes.pop(step)
            return new
        step -= len(node.attributes)
    return None


def examine(bench: Bench, robots: Sequence[Node], seed: int, indices: Sequence[int]) -> Figures:
    """Try descriptions by their numbers."""
    figures = Figures()
    for index in indices:
        figures.files += 1
        for tried in bench.tried(case(seed, index, robots)):
            figures.predictions += 1
            figures.predicted[tried.consumer] += tried.told
            figures.refused[tried.consumer] += tried.refused
            figures.compared[tried.consumer] += tried.compared
            if tried.wrong:
                figures.wrong.setdefault(tried.wrong, []).append(index)
    return figures


def write_found(figures: Figures, seed: int, folders: Sequence[Path], folder: Path) -> None:
    """The smallest file of every group of mispredictions, with the group in a comment."""
    folder.mkdir(parents=True, exist_ok=True)
    robots = sources(folders)
    with ExitStack() as stack:
        bench = Bench(stack)
        for number, (wrong, indices) in enumerate(sorted(figures.wrong.items(), key=lambda item: -len(item[1]))):
            found = bench.shrunk(case(seed, indices[0], robots), wrong)
            about = {
                "files": len(indices),
                "first": indices[0],
                **wrong._asdict(),
                "faults": found.names,
                "form": found.form,
            }
            name = f"{number:03}-{wrong.consumer}-{wrong.kind}"
            (folder / f"{name}.json").write_text(json.dumps(about, indent=1))
            found.write(folder / f"{name}.urdf")


def lines(figures: Figures) -> Iterator[str]:
    """The figures as a table, and the largest groups of mispredictions with the number of the first file of each."""
    heads = [f"{name:>{max(8, len(name))}}" for name in COLUMNS]
    yield f"{'reader':10} {' '.join(heads)}" + "".join(f" {kind:>7} {'':>6}" for kind in KINDS)
    total: Counter[str] = Counter()
    for consumer in READERS:
        row = {
            "files": figures.files,
            "refused": figures.refused[consumer],
            "predicted": figures.predicted[consumer],
            "compared": figures.compared[consumer],
        }
        row |= {kind: figures.count(consumer, kind) for kind in KINDS}
        total.update(row)
        yield _row(consumer, row)
    yield _row("all", total)
    for wrong, found in sorted(figures.wrong.items(), key=lambda item: -len(item[1]))[:GROUPS_PRINTED]:
        said = " ".join(wrong.said.split())
        yield f"{len(found):6,} {wrong.kind} {wrong.consumer}, first {found[0]}: {', '.join(wrong.rules)} {said[:100]}"


def _row(name: str, row: Mapping[str, int]) -> str:
    counts = " ".join(f"{row[column]:>{max(8, len(column))},}" for column in COLUMNS)
    shares = zip(KINDS, _shares(row), strict=True)
    return f"{name:10} {counts}" + "".join(f" {row[kind]:7,} {share:6.2%}" for kind, share in shares)


def _shares(row: Mapping[str, int]) -> list[float]:
    """What is mispredicted, by kind: of the predicted refusals, the refusals, and the files that were compared."""
    of = ("predicted", "refused", "compared")
    return [row[kind] / max(row[whole], 1) for kind, whole in zip(KINDS, of, strict=True)]


_WORKER: dict[str, Any] = {}


def _start(folders: Sequence[Path]) -> None:
    """Start the readers of a worker; they end with it, and not by a Ctrl-C, after which the first process prints."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _WORKER["stack"] = stack = ExitStack()
    _WORKER["bench"], _WORKER["robots"] = Bench(stack), sources(folders)


def _examine(task: tuple[int, Sequence[int]]) -> Figures:
    return examine(_WORKER["bench"], _WORKER["robots"], *task)


def main() -> int:
    """Try many, and print the figures; the exit status is 1 where more than `--allowed` % are false."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=int, default=500)
    parser.add_argument("--seconds", type=float, help="end after this time, whatever --files says")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--descriptions", type=Path, action="append", default=[], help="a folder of URDFs to spoil too")
    parser.add_argument("--found", type=Path, help="a folder for the smallest file of every group of mispredictions")
    parser.add_argument(
        "--allowed", type=float, default=1.0, help="false ones that are no failure; of missed ones thrice as many [%%]"
    )
    given = parser.parse_args()
    start, figures, chunk = time.monotonic(), Figures(), 20
    tasks = [(given.seed, range(i, min(i + chunk, given.files))) for i in range(0, given.files, chunk)]
    workers = multiprocessing.get_context("spawn").Pool(given.workers, _start, (given.descriptions,))
    with suppress(KeyboardInterrupt), workers as pool:
        for done in pool.imap_unordered(_examine, tasks):
            figures.add(done)
            if given.seconds and time.monotonic() - start > given.seconds:
                break
            if figures.files % 1000 == 0:
                print(*lines(figures), sep="\n", file=sys.stderr, flush=True)
    print(*lines(figures), f"seconds {time.monotonic() - start:.0f}", sep="\n", flush=True)
    if given.found:
        write_found(figures, given.seed, given.descriptions, given.found)
    total = {"refused": figures.refused.total(), "predicted": figures.predicted.total()}
    total |= {"compared": figures.compared.total()}
    total |= {kind: sum(figures.count(consumer, kind) for consumer in READERS) for kind in KINDS}
    raised = any(wrong.kind == "check raised" for wrong in figures.wrong)
    false, missed, altered = _shares(total)
    return int(raised or max(false, missed / 3, altered) > given.allowed / 100)


if __name__ == "__main__":
    sys.exit(main())
