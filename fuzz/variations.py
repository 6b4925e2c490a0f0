"""Random variations through whole runs: no section may end one, and every variant has a row.

    python fuzz/variations.py --sections 20000 --seed 1

Each section (`variation_sections.py`) is loaded like one of a run file. One that is refused must be refused with a
problem that names its place. Sections that are accepted go into one run, several together, and every variant of theirs
must have a row of the manifest: made and proved, or failed with what is wrong with its values. A failure of a stage is
a fault of dh2urdf, and so is anything else that is raised.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import tempfile
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from variation_sections import TABLES, make_section

from dh2urdf.documents.document import load_yaml
from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.calls import Call
from dh2urdf.plugin_system.catalog import Catalog, load
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.running.run import execute
from dh2urdf.stages import Executor, NoOptions

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

TOGETHER = 40
"""Accepted sections of one run."""
FORMS = ("files", "shards", "dry")
FAILURES = frozenset({"manipulator", "proof", "transform", "robot", "emitter", "table"})
"""Kinds of failure that values can have."""
HERE = Call(
    stage=Executor(
        name="here",
        summary="does everything in this process, where nothing catches what is raised",
        options=NoOptions,
        map=lambda function, tasks, _: map(function, tasks),
    ),
    options=NoOptions(),
)


class WrongRunError(Exception):
    """A run ended, or a variant is missing or failed for no reason of its own."""


@dataclass
class Figures:
    """What was done."""

    sections: int = 0
    refused: int = 0
    runs: int = 0
    variants: int = 0
    failed: Counter[str] = field(default_factory=Counter)
    pairs: set[tuple[str, str, str]] = field(default_factory=set)

    def see(self, section: dict[str, Any]) -> None:
        """Takes notice of the field, law and sampling of each rule."""
        self.sections += 1
        for rule in section["vary"] if isinstance(section["vary"], list) else [section["vary"]]:
            (law,) = rule.keys() - {"field", "joints"}
            self.pairs.add((rule["field"], law, section.get("sampling", "random")))


@cache
def catalog() -> Catalog:
    """The stages that there are."""
    return load()


def try_sections(sections: Sequence[dict[str, Any]], folder: Path, form: str, figures: Figures) -> None:
    """Loads sections one by one, and runs those that are accepted together.

    Args:
        sections: the sections.
        folder: a folder for the tables and the output.
        form: the layout of the output, or ``dry``.
        figures: what was done so far.

    Raises:
        WrongRunError: something was raised, or a row is missing or wrong.
    """
    for name, table in TABLES.items():
        (folder / name).write_text(table)
    accepted = []
    for section in sections:
        figures.see(section)
        if is_accepted(section, folder):
            accepted.append(section)
        else:
            figures.refused += 1
    if not accepted:
        return
    try:
        run(accepted, folder, form, figures)
    except WrongRunError:
        for section in accepted:
            run([section], folder, form, Figures())  # which of them it is
        raise


def is_accepted(section: dict[str, Any], folder: Path) -> bool:
    """Whether nothing is wrong with a section by itself.

    Raises:
        WrongRunError: it is refused with something else than a problem that has a place.
    """
    try:
        problems = _config(folder, [section]).problems
    except ConfigError as error:
        problems = error.problems
    except Exception as error:
        raise WrongRunError(f"loading raised {error!r}\n{text_of(section)}") from error
    if any(not problem.message or problem.mark is None for problem in problems):
        raise WrongRunError(f"a problem without a place: {problems}\n{text_of(section)}")
    return not problems


def _config(folder: Path, sections: Sequence[dict[str, Any]], **others: Any) -> Any:
    inputs = [str(folder / name) for name in TABLES]
    document = {"inputs": inputs, "variations": list(sections), "report": {"html": False}, **others}
    return load_config(folder / "run.yaml", root=load_yaml(text_of(document), str(folder / "run.yaml")))


def text_of(document: Any) -> str:
    """A run file: JSON is YAML, but for the word `all`, which in quotes is the name of a joint."""
    return json.dumps(document).replace('"joints": "all"', '"joints": all')


def run(sections: Sequence[dict[str, Any]], folder: Path, form: str, figures: Figures) -> None:
    """Does one run, and looks at every row.

    Raises:
        WrongRunError: something was raised, or a row is missing or wrong.
    """
    dry = form == "dry"
    output = {"directory": str(folder / "out"), "layout": "files" if dry else form}
    try:
        plan = make_plan(_config(folder, sections, output=output, emitters=["urdf"]), catalog())
        _, report = execute(replace(plan, executor=HERE), dry_run=dry)
    except Exception as error:
        raise WrongRunError(f"the run raised {error!r}\n{text_of(sections)}\n{traceback.format_exc()}") from error
    figures.runs += 1
    rows = report["manipulators"] if dry else [json.loads(line) for line in (folder / "out/manifest.jsonl").open("rb")]
    for section in sections:
        own = [row for row in rows if row["name"].startswith(section["name"])]
        count = section.get("count", len(own))
        once = len(own) == 1 and own[0]["kind"] == "table"  # a variation that its table does not fit fails once
        all_there = not dry or not report["left_out"]  # The report of a run has the first manipulators alone.
        if all_there and (not own or (len(own) != count and not once)):
            raise WrongRunError(f"{len(own)} rows for {count} variants\n{text_of(section)}")
        for row in own:
            _check(row, section, figures, dry=dry)


def _check(row: dict[str, Any], section: dict[str, Any], figures: Figures, *, dry: bool) -> None:
    figures.variants += 1
    if row["status"] == "failed":
        figures.failed[row["kind"]] += 1
        if row["kind"] not in FAILURES or not row["errors"]:
            raise WrongRunError(f"{row['kind']}: {row['errors']}\n{text_of(section)}")
    elif row["status"] != ("planned" if dry else "ok"):
        raise WrongRunError(f"{row['status']}\n{text_of(section)}")


def cases(seed: int, count: int) -> Iterator[tuple[list[dict[str, Any]], str]]:
    """Sections for run after run, and the layout of each."""
    for number in range(-(-count // TOGETHER)):
        rng = random.Random(f"{seed} {number}")
        some = min(TOGETHER, count - number * TOGETHER)
        # Names of one length: none is the beginning of another.
        yield [make_section(rng, f"v{place:02d}") for place in range(some)], rng.choice(FORMS)


def main() -> int:
    """Try random sections, and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sections", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--all", action="store_true", help="go on after what is wrong, and print each once")
    given = parser.parse_args()
    figures, began, wrong = Figures(), time.monotonic(), 0
    for sections, form in cases(given.seed, given.sections):
        with tempfile.TemporaryDirectory(prefix="dh2urdf-fuzz-") as folder:
            try:
                try_sections(sections, Path(folder), form, figures)
            except WrongRunError as error:
                wrong += 1
                print(error, file=sys.stderr)
                if not given.all:
                    break
    print(
        f"{figures.sections} sections, {figures.refused} refused, {figures.runs} runs, {figures.variants} variants, "
        f"{sum(figures.failed.values())} of them failed ({dict(figures.failed)}), {len(figures.pairs)} combinations of "
        f"field, law and sampling, {time.monotonic() - began:.0f} s, {wrong} runs wrong"
    )
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
