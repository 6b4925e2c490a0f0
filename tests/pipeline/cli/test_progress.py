from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, Any

import pytest
from terminal import on_a_terminal

from dh2urdf.cli.run import MOST_ROWS, print_summary, progress
from dh2urdf.conversion.outcome import Outcome
from dh2urdf.errors import SCREENFUL
from dh2urdf.report.verdicts import Verdicts
from dh2urdf.source import Mark, Problem
from dh2urdf.tasks.batch_report import BatchReport, Result

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path


MANY = SCREENFUL + 7
ARMS = "# convention: standard\nrobot,a,alpha,d\n" + "".join(
    f"arm{number},{'x' if number == 3 else 0.4},{1.5708 if number == 5 else 0},0.1\n" for number in range(40)
)


def problem(message: str, severity: Any = "error") -> Problem:
    return Problem(message=message, severity=severity, mark=Mark(file="arms.csv", line=3))


def batch(*problems: Problem, traceback: str = "", **statuses: int) -> BatchReport:
    return BatchReport(
        first=0,
        rows=b"",
        statuses=Counter(statuses),
        kinds=Counter(),
        problems=problems,
        severities=Counter(each.severity for each in problems),
        tracebacks=(traceback,) if traceback else (),
    )


@pytest.fixture
def said(capsys: pytest.CaptureFixture[str]) -> Callable[..., list[str]]:
    """The lines on standard error of a run of some batches, which a log takes."""

    def call(*batches: BatchReport, total: int | None = None, quiet: bool = False, debug: bool = False) -> list[str]:
        with progress(quiet=quiet, debug=debug) as note:
            for each in batches:
                note(each, total)
        printed = capsys.readouterr()
        assert printed.out == ""
        return printed.err.splitlines()

    return call


class TestInALog:
    def test_plain_lines(self, said: Callable[..., list[str]], monkeypatch: pytest.MonkeyPatch) -> None:
        """How many are made, of how many, how many failed, how fast, and how long it will take."""
        clock = iter([0.0, 2.0, 4.0])
        monkeypatch.setattr("dh2urdf.cli.run.time.monotonic", lambda: next(clock))
        monkeypatch.setattr("dh2urdf.cli.run.LINE_EVERY", 0.0)
        assert said(batch(ok=1000), batch(ok=1990, kept=1000, failed=10), total=1_004_000) == [
            "1,000 of about 1,004,000 manipulators, 0 failed, 500/s, 0:33:26 left",
            "4,000 of about 1,004,000 manipulators, 10 failed, 1,000/s, 0:16:40 left",
        ]


class TestWhatIsNoticedAndFails:
    def test_a_screenful_of_each_is_said_and_the_rest_counted(self, said: Callable[..., list[str]]) -> None:
        """Over all batches, however they are cut; what a batch itself left out is counted too."""
        errors = [batch(problem(f"e{number}"), failed=1) for number in range(MANY)]
        notices = BatchReport(
            first=0,
            rows=b"",
            statuses=Counter(ok=3000),
            kinds=Counter(),
            problems=tuple(problem(f"n{number}", "notice") for number in range(SCREENFUL)),
            severities=Counter(notice=3000),
        )
        found = said(*errors, notices)
        assert [line.split()[-1] for line in found[:-2]] == [
            *(f"e{number}" for number in range(SCREENFUL)),
            *(f"n{number}" for number in range(SCREENFUL)),
        ]
        assert found[-2:] == [
            "and 2,980 more notices: the manifest has all of them",
            "and 7 more errors: the manifest has all of them",
        ]


# --- The command ------------------------------------------------------------------------------------------------------


@pytest.fixture
def arms(tmp_path: Path) -> Path:
    (tmp_path / "arms.csv").write_text(ARMS)
    (tmp_path / "arms.yaml").write_text("inputs: arms.csv\noutput: {directory: out}\n")
    return tmp_path


DRAWN = """
from rich.progress import Progress
update = Progress.update
def drawn(self, *words, **fields):
    update(self, *words, **fields)
    self.refresh()
Progress.update = drawn
"""
"""Each batch is shown, however fast it comes."""


def test_a_bar_on_a_terminal(arms: Path) -> None:
    """It shows how many are made of how many, the rate, the time that remains and the failures; and then it is gone."""
    status, printed, shown = on_a_terminal(
        arms, "run", "arms.yaml", "--workers", "1", "--set", "report.html=false", before=DRAWN, stdout=False
    )
    assert status == 1
    assert "39 made, 1 failed (table: 1)" in printed
    plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown)
    assert re.search(r"manipulators +\S+ +16/3\d +[\d,]+/s +\d+:\d\d:\d\d left +1 failed", plain)
    assert "arms.csv:6:6: error: " in plain
    assert "arms.csv:8:10: notice: " in plain
    assert shown.endswith("\r\x1b[1A\x1b[2K")


# --- The summary ------------------------------------------------------------------------------------------------------


def outcome(name: str = "arm", status: Any = "ok", **fields: Any) -> Outcome:
    return Outcome(name=name, status=status, source="arm.csv", **fields)


@pytest.fixture
def printed(capsys: pytest.CaptureFixture[str]) -> Callable[..., list[str]]:
    """The lines of a summary: of a run of these outcomes and, where its report has no row of them, of some others."""

    def call(
        *outcomes: Outcome,
        dry_run: bool = False,
        seconds: float = 1.0,
        kinds: dict[str, int] | None = None,
        **others: int,
    ) -> list[str]:
        result = Result(keeps_kinematics=all(each.keeps_kinematics for each in outcomes))
        result.seconds["total"] = seconds
        result.statuses.update(each.status for each in outcomes)
        result.statuses.update(others)
        result.kinds.update(kinds or {})
        rows = [
            each.row(
                "", [{"path": file.name, "stage": written.stage} for written in each.written for file in written.files]
            )
            for each in outcomes
        ]
        gathered = Verdicts({name: False for each in outcomes for name in each.loads})
        for row in rows:
            gathered.add(row)
        report = {"manipulators": rows, "coverage": gathered.coverage, "simulator_notices": gathered.notices()}
        print_summary(result, report, "build/out", "build/out", dry_run=dry_run)
        return capsys.readouterr().out.splitlines()

    return call


def cells(lines: Sequence[str]) -> list[list[str]]:
    """The cells of the rows of a summary."""
    return [[cell.strip() for cell in line.strip("│").split("│")] for line in lines if line.startswith("│")]


def test_a_long_run_is_cut(printed: Callable[..., list[str]]) -> None:
    """A screenful of rows, the failures among them, and the number of the others, in the report or not."""
    outcomes = [outcome(f"arm{i}") for i in range(MOST_ROWS + 9)]
    lines = printed(*outcomes, outcome("bad", "failed"), ok=1_000_000, seconds=1000.0)
    assert cells(lines)[0][0] == "bad"
    assert len(cells(lines)) == MOST_ROWS
    assert "and 1,000,010 more manipulators" in lines
    assert "1,000,049 made, 1 failed; 1,000 per second" in lines


def test_names_are_shown_harmlessly(printed: Callable[..., list[str]]) -> None:
    """Neither a terminal nor the printer of the table acts on what is in a name."""
    ((name, *_),) = cells(printed(outcome("\x1b[31m[red]arm[/red]")))
    assert name == "�[31m[red]arm[/red]"
