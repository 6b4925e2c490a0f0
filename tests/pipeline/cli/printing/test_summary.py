from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.cli.printing.summary import MOST_ROWS, print_summary
from dh2urdf.conversion.one_manipulator import Written
from dh2urdf.conversion.outcome import Outcome, Verdict
from dh2urdf.kinematics.proof import Proof
from dh2urdf.report.verdicts import Verdicts
from dh2urdf.stages import EmittedFile, LoadReport
from dh2urdf.tasks.result import Result

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


def wrote(stage: str, error: float | None) -> Written:
    proof = None if error is None else Proof(position_error=error, angle_error=0, q=(), tolerance=1e-9, poses=1)
    return Written(stage=stage, files=(EmittedFile(name=f"arm.{stage}", content=b""),), proof=proof)


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
        report = {
            "manipulators": rows,
            "coverage": gathered.coverage,
            "simulator_notices": gathered.notices(),
        }
        print_summary(result, report, "build/out", "build/out", dry_run=dry_run)
        return capsys.readouterr().out.splitlines()

    return call


def cells(lines: Sequence[str]) -> list[list[str]]:
    """The cells of the rows of a summary."""
    return [[cell.strip() for cell in line.strip("│").split("│")] for line in lines if line.startswith("│")]


def columns(lines: Sequence[str]) -> list[str]:
    header = next(line for line in lines if line.startswith("┃"))
    return [cell.strip() for cell in header.strip("┃").split("┃")]


def test_a_column_per_emitter_and_loader(printed: Callable[..., list[str]]) -> None:
    """With the largest error each, 0 as 0; a dash where there is no proof; the files, pictures included."""
    load = LoadReport(simulator="Paper", version="1", position_error=3.3e-8, hold={"stayed": True}, picture="arm.png")
    lines = printed(
        outcome(
            written=(wrote("urdf", 1.5e-16), wrote("dae", None), wrote("txt", 0.0)),
            loads={"paper": Verdict(report=load)},
        )
    )
    assert columns(lines) == ["manipulator", "status", "urdf", "dae", "txt", "paper", "holds still", "files"]
    assert cells(lines) == [["arm", "ok", "1.5e-16", "–", "0", "3.3e-08", "yes", "arm.urdf, arm.dae, arm.txt, arm.png"]]
    assert lines[0] == "largest distance of tool0 from the DH product, in metres:"
    assert lines[-3:] == ["1 made", "simulators: paper 1 of 1", "written to build/out"]


@pytest.mark.parametrize(
    ("holds", "word"), [([{"stayed": True}], "yes"), ([{"stayed": True}, {"stayed": False}], "no"), ([{}], "–")]
)
def test_whether_the_arm_holds_still(printed: Callable[..., list[str]], holds: list[dict[str, Any]], word: str) -> None:
    """It does where it does in every simulator that tried."""
    loads = {str(i): Verdict(report=LoadReport(simulator="S", version="1", hold=hold)) for i, hold in enumerate(holds)}
    assert cells(printed(outcome(written=(wrote("urdf", 0.0),), loads=loads)))[0][-2] == word


def test_failures_come_first(printed: Callable[..., list[str]]) -> None:
    """Whoever looks at the top sees what is wrong; the counts are at the end."""
    lines = printed(outcome("a", written=(wrote("urdf", 0.0),)), outcome("b", "failed"), outcome("c", "failed"))
    assert [row[:3] for row in cells(lines)] == [["b", "failed", "–"], ["c", "failed", "–"], ["a", "ok", "0"]]
    assert "1 made, 2 failed" in lines


def test_a_long_run_is_cut(printed: Callable[..., list[str]]) -> None:
    """A screenful of rows, the failures among them, and the number of the others, in the report or not."""
    outcomes = [outcome(f"arm{i}") for i in range(MOST_ROWS + 9)]
    lines = printed(*outcomes, outcome("bad", "failed"), ok=1_000_000, seconds=1000.0)
    assert cells(lines)[0][0] == "bad"
    assert len(cells(lines)) == MOST_ROWS
    assert "and 1,000,010 more manipulators" in lines
    assert "1,000,049 made, 1 failed; 1,000 per second" in lines


def test_a_transform_that_gives_another_arm_is_named(printed: Callable[..., list[str]]) -> None:
    """A large error is no failure then, and a person wants to know why."""
    lines = printed(outcome(written=(wrote("urdf", 0.5),), keeps_kinematics=False))
    assert "the transform does not keep the kinematics: differences are reported and fail nothing" in lines


def test_names_are_shown_harmlessly(printed: Callable[..., list[str]]) -> None:
    """Neither a terminal nor the printer of the table acts on what is in a name."""
    ((name, *_),) = cells(printed(outcome("\x1b[31m[red]arm[/red]")))
    assert name == "�[31m[red]arm[/red]"
