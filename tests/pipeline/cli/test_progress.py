import re
from collections import Counter
from collections.abc import Callable, Sequence
from datetime import timedelta
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from terminal import on_a_terminal

from dh2urdf.cli.run import MOST_ROWS, WINDOW, Pace, print_summary, progress
from dh2urdf.conversion.outcome import Outcome
from dh2urdf.errors import SCREENFUL
from dh2urdf.report.verdicts import Verdicts
from dh2urdf.source import Cause, Mark, Problem
from dh2urdf.tasks.batch_report import BatchReport, Result, add_cause

MANY = SCREENFUL + 7
ARMS = "# convention: standard\nrobot,a,alpha,d\n" + "".join(
    f"arm{number},{'x' if number == 3 else 0.4},{1.5708 if number == 5 else 0},0.1\n" for number in range(40)
)


def problem(message: str, severity: Any = "error", *, line: int = 3, found: str | None = None) -> Problem:
    return Problem(message=message, severity=severity, mark=Mark(file="arms.csv", line=line), found=found)


def batch(*problems: Problem, notices: int = 0, **statuses: int) -> BatchReport:
    """A batch in which some is noticed: what is known of it, and `notices` more of which nothing is."""
    report = BatchReport(first=0, statuses=Counter(statuses), severities=Counter(each.severity for each in problems))
    for each in problems:
        add_cause(report.causes, each.cause, Cause(each))
    report.severities["notice"] = max(notices, report.severities["notice"])
    return report


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
        """How many are made, of how many, how many failed, how fast since the first batch, and how long it will take."""
        clock = iter([0.0, 2.0, 4.0, 6.0])
        monkeypatch.setattr("dh2urdf.cli.run.time.monotonic", lambda: next(clock))
        monkeypatch.setattr("dh2urdf.cli.run.LINE_EVERY", 0.0)
        assert said(batch(ok=1000), batch(ok=1990, failed=10), batch(ok=1000), total=1_004_000) == [
            "1,000 of about 1,004,000 manipulators, 0 failed",
            "3,000 of about 1,004,000 manipulators, 10 failed, 1,000/s, 0:16:41 left",
            "4,000 of about 1,004,000 manipulators, 10 failed, 750/s, 0:22:13 left",
        ]


class TestPace:
    """Against one manipulator after the other, counted here."""

    def test_the_rate_is_that_of_the_last_while(self) -> None:
        """A slow start and a fast middle are forgotten: the rate and the rest follow from the last half a minute."""
        pace, ends = Pace(), [*range(0, 1000, 100), *(1000 + step for step in range(100)), *range(1100, 1400, 2)]
        for end in ends:
            pace.note(float(end), batch(ok=8))
        within = [end for end in ends if end > ends[-1] - WINDOW]
        rate = 8 * len(within) / WINDOW
        assert pace.words(8 * len(ends) + 480) == (f"{rate:.2g}/s", f"{timedelta(seconds=480 / rate)} left")

    def test_batches_longer_than_the_window(self) -> None:
        """There is a rate all the same, of the last few batches."""
        pace = Pace()
        for number in range(10):
            pace.note(100.0 * number**2, batch(ok=60))
        assert pace.words(None) == (f"{3 * 60 / (100 * (81 - 36)):.2g}/s", "")

    def test_what_was_skipped_does_not_count(self) -> None:
        """What an earlier run has made is done, and is no part of the rate; what remains takes this long at most."""
        pace = Pace()
        pace.note(0.0, batch(kept=50_000))
        pace.note(10.0, batch(kept=50_000))
        assert pace.words(200_000) == ("", "")
        pace.note(20.0, batch(ok=400, kept=600))
        assert pace.words(101_400) == ("20/s", "at most 0:00:20 left")

    def test_too_little_is_known(self) -> None:
        """Of the first batch nobody knows how long it took without the start, nor of two in one instant."""
        pace = Pace()
        pace.note(0.8, batch(ok=1))
        assert pace.words(200) == ("", "")
        pace.note(0.9, batch(ok=100))
        assert pace.words(200) == ("", "")


class TestWhatIsNoticedAndFails:
    def test_each_cause_is_said_once(self, said: Callable[..., list[str]]) -> None:
        """Over all batches: errors as they come, notices at the end, each with its first place and its count."""
        arms = [f"arm{number}" for number in range(9)]
        batches = [
            batch(
                problem(f"{name!r} leaves out 'supplier'", "notice", line=number, found="supplier"),
                *([problem(f"{name!r} leaves out 'limts'", "notice", line=number, found="limts")] * (number == 5)),
                *([problem(f"joint {number} has no {number}", line=number)] * (number > 6)),
                failed=1,
            )
            for number, name in enumerate(arms)
        ]
        assert said(*batches) == [
            "arms.csv:7: error: joint 7 has no 7",
            "arms.csv:0: notice: 'arm0' leaves out 'supplier'",
            "    and 8 more: line 1, line 2, line 3, line 4 and 4 more",
            "arms.csv:5: notice: 'arm5' leaves out 'limts'",
            "arms.csv:7: error: and 1 more: line 8",
        ]
        assert said(*batches, quiet=True) == [
            "arms.csv:7: error: joint 7 has no 7",
            "arms.csv:7: error: and 1 more: line 8",
        ]

    def test_a_screenful_of_each_is_said_and_the_rest_counted(self, said: Callable[..., list[str]]) -> None:
        """However many causes there are, and however they are cut into batches."""
        words = ["".join(pair) for pair in product("abcdefghijklmnopqrst", repeat=2)][:MANY]
        found = said(
            *(batch(problem(f"no {word}"), failed=1) for word in words),
            batch(*(problem(f"odd {word}", "notice") for word in words), ok=3000, notices=3000),
        )
        assert [line.split()[-1] for line in found[:-1] if "more" not in line] == words[:SCREENFUL] * 2
        assert [line for line in found if "more" in line] == [
            f"and {3000 - SCREENFUL:,} more notices: the manifest has all of them, and --verbose prints them",
            "and 7 more errors: the manifest has all of them, and --verbose prints them",
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
import dh2urdf.cli.run
dh2urdf.cli.run.ENOUGH = 0.0
"""
"""Each batch is shown, however fast it comes, and has a rate."""


def test_a_bar_on_a_terminal(arms: Path) -> None:
    """It shows how many are made of how many, the rate, the time that remains and the failures; and then it is gone."""
    status, printed, shown = on_a_terminal(
        arms, "run", "arms.yaml", "--workers", "1", "--set", "report.html=false", before=DRAWN, stdout=False
    )
    assert status == 1
    assert "39 made, 1 failed (table: 1)" in printed
    plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown)
    assert re.search(r"manipulators +\S+ +16/3\d +[\d.,]+/s +\d+:\d\d:\d\d left +1 failed", plain)
    assert "arms.csv:6:6: error: " in plain
    _, _, after = shown.rpartition("\r\x1b[1A\x1b[2K")
    assert after.startswith("arms.csv:8:10: notice: ")


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


def test_no_rate_where_work_was_skipped(printed: Callable[..., list[str]]) -> None:
    """The seconds of a resumed run went by with looking at files, too."""
    assert "199 made, 800 unchanged" in printed(*(outcome(f"arm{i}") for i in range(199)), kept=800)


def test_a_dry_run_has_planned(printed: Callable[..., list[str]]) -> None:
    """Nothing that it counts or lists claims to be made or written."""
    text = "\n".join(printed(outcome("arm", "planned"), outcome("bad", "failed"), dry_run=True))
    assert "1 planned, 1 failed (dry run: nothing was written)" in text
    assert not re.search(r"\b(made|ok|written to)\b", text)


def test_names_are_shown_harmlessly(printed: Callable[..., list[str]]) -> None:
    """Neither a terminal nor the printer of the table acts on what is in a name."""
    ((name, *_),) = cells(printed(outcome("\x1b[31m[red]arm[/red]")))
    assert name == "�[31m[red]arm[/red]"
