"""The pages in docs/rules have what the tables of rules have. `pytest --renew` writes them again."""

import importlib.metadata
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import pytest
from faulty_files import PROOFS, UNPROVED
from lxml import etree

from dh2urdf.kinematics import comparison as agreement
from dh2urdf_check.ask.findings import seen_rules
from dh2urdf_check.command import command
from dh2urdf_check.inspection import MODEL_CONSUMERS, inspect_urdf, model_rules
from dh2urdf_check.packages import CONSUMERS as PACKAGE_CONSUMERS, package_rules
from dh2urdf_check.rules import CONSUMERS, GROUPS, Rule, rules_of

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "check.md"
GENERATED = re.compile(
    r"(?P<remark><!-- (?:rules|matrix): [^>]*-->\n)(?P<lines>.*?)(?=<!-- /(?:rules|matrix) -->)", re.DOTALL
)

PAGES: dict[str, tuple[dict[str, Rule], Mapping[str, str]]] = {
    **{group: (rules_of(group), CONSUMERS) for group in GROUPS},
    **{name: (model_rules(name), MODEL_CONSUMERS[name]) for name in MODEL_CONSUMERS},
    "packages": (package_rules(), PACKAGE_CONSUMERS),
}


ELSEWHERE = {"package-missing-limits", "package-not-installed"}
"""Rules that tests of their own break."""


@pytest.mark.parametrize("group", PAGES)
def test_a_table_is_in_order(group: str) -> None:
    """Names are in kebab-case; phrases have no full stop; consumers are known; every rule is broken by a file."""
    rules, consumers = PAGES[group]
    proved = PROOFS.keys() | {name for name, rule in rules.items() if rule.proof}
    assert rules.keys() <= proved | UNPROVED | ELSEWHERE
    for rule in rules.values():
        assert re.fullmatch(r"[a-z]+(-[a-z]+)*", rule.name)
        assert rule.effects
        assert set(rule.outcomes) <= set(consumers)
        for path in filter(None, (*(case.at for case in rule.cases), *rule.where.values())):
            etree.XPath(path)
        for text in (rule.fault, rule.fix, *(effect.text for effect in rule.effects)):
            assert text == text.strip()
            assert not text.endswith(".")


def head(consumers: Iterable[str]) -> Iterator[str]:
    """The head of a matrix."""
    names = list(consumers)
    yield f"\n| rule | {' | '.join(names)} |"
    yield f"|---|{'---|' * len(names)}"


def matrix(page: str, rules: Mapping[str, Rule], consumers: Iterable[str]) -> Iterator[str]:
    """A row for each rule, a column for each consumer."""
    for rule in rules.values():
        cells = " | ".join(rule.outcomes.get(consumer, "") for consumer in consumers)
        yield f"| [{rule.name}]({page}.md#{rule.name}) | {cells} |".replace("|  ", "| ")


def paragraphs(rules: Mapping[str, Rule]) -> Iterator[str]:
    """A section for each rule."""
    for rule in rules.values():
        yield f"\n## {rule.name}\n\n{rule.fault[0].upper()}{rule.fault[1:]}.\n"
        together: dict[str, list[str]] = {}
        for effect in rule.effects:
            together.setdefault(f"{effect.text} ({rule.outcomes[effect.consumer]})", []).append(f"`{effect.consumer}`")
        for text, consumers in together.items():
            yield f"- {', '.join(consumers)}: {text}"
        yield f"\nFix: {rule.fix}."


def all_matrices() -> Iterator[str]:
    """The matrix of URDF, of all its tables, then those of SDF, MJCF and packages."""
    yield "\n## URDF"
    yield from head(CONSUMERS)
    for group in GROUPS:
        yield from matrix(group, *PAGES[group])
    for name, consumers in MODEL_CONSUMERS.items():
        yield f"\n## {name.upper()}"
        yield from head(consumers)
        yield from matrix(name, *PAGES[name])
    yield "\n## Packages of ROS 2"
    yield from head(PACKAGE_CONSUMERS)
    yield from matrix("packages", *PAGES["packages"])


def seen_paragraphs() -> Iterator[str]:
    """A section for each kind of thing that was seen."""
    for name, rule in seen_rules().items():
        yield f"\n## {name}\n\n{rule.fault[0].upper()}{rule.fault[1:]} ({rule.severity}).\n\nFix: {rule.fix}."


@pytest.mark.parametrize("name", ["index", "seen", *PAGES])
def test_every_rule_is_in_the_pages(name: str, *, renew: bool) -> None:
    """With what every consumer does, and how to fix it; and whatever no rule foretells."""
    path = DOCS / "rules" / f"{name}.md"
    made = {"index": all_matrices, "seen": seen_paragraphs}.get(name, lambda: paragraphs(PAGES[name][0]))
    expected = "\n".join(made()) + "\n\n"
    if renew:
        path.write_text(GENERATED.sub(lambda match: match["remark"] + expected, path.read_text("utf-8")), "utf-8")
    match = GENERATED.search(path.read_text("utf-8"))
    assert match is not None
    assert match["lines"] == expected


def test_every_option_is_in_the_page() -> None:
    """And the numbers are those of the code."""
    page = PAGE.read_text("utf-8")
    options = {option for parameter in command.params for option in parameter.opts if option.startswith("--")}
    assert {option for option in options if option not in page} == set()
    assert f"at {agreement.POSES + 1} joint vectors" in page
    assert (agreement.TOLERANCE, agreement.NEAR) == (1e-6, 5e-3)
    assert all(f"`{name}`" in page for name in agreement.USUAL_TIPS)


QUOTED = re.compile(r"^(?P<file>\w+\.urdf):\d+:\d+: error: (?P<message>.*)\n(?P<more>(?:    .*\n)+)", re.MULTILINE)


def test_what_is_quoted_of_real_robots_is_said_of_them() -> None:
    """Findings, effects and fixes; the lines may be others in another version of the package."""
    try:
        files = importlib.metadata.files("example-robot-data") or ()
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("example-robot-data is not installed")
    paths = {file.name: Path(file.locate()) for file in files if file.suffix == ".urdf"}
    quotes = list(QUOTED.finditer(PAGE.read_text("utf-8")))
    assert len(quotes) == 4
    for quote in quotes:
        finding = next(each for each in inspect_urdf(paths[quote["file"]]).findings if quote["message"] in each.message)
        lines = {line.strip() for line in quote["more"].splitlines()}
        for line in lines - {f"fix: {finding.fix}"}:
            consumer, _, text = line.partition(" (foretold")
            severity, _, text = text.partition("): ")
            effect = next(each for each in finding.effects if each.consumer == consumer)
            assert text == effect.text
            assert severity == ("" if effect.severity == finding.severity else f", {effect.severity}")
