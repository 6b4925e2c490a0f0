"""The words of the house as one table: the code of each message, one case that makes it, and the sentence."""

import re
import shlex
import tomllib
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import dh2urdf
from dh2urdf.manipulator import Follower, JointType
from dh2urdf.robot_check import check_robot
from dh2urdf.source import Messages, Problem

pytestmark = pytest.mark.words

TABLE: dict[str, Any] = yaml.safe_load(Path(__file__).with_name("messages.yaml").read_text("utf-8"))
CASES: dict[str, dict[str, Any]] = {
    f"{package} {code}": case for package, cases in TABLE["cases"].items() for code, case in cases.items()
}
ROOT = Path(__file__).parents[1]
PACKAGES = {"host": "pipeline/dh2urdf"} | {name: f"plugins/dh2urdf_{name}" for name in ("check", "plugins", "studio")}


def write_files(case: dict[str, Any], folder: Path) -> None:
    """The files of a case, and those that every case may name."""
    for name, text in {**TABLE["files"], **case.get("files", {})}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")


def changed(record: Any, changes: dict[str, Any]) -> Any:
    """A record with other values in its fields, or in those of its parts."""
    new = {}
    for name, value in changes.items():
        old = getattr(record, name)
        if isinstance(value, dict) and is_dataclass(old):
            new[name] = changed(old, value)
        else:
            made = {"type": JointType, "follows": lambda law: Follower(*law)}.get(name)
            new[name] = made(value) if made else tuple(value) if isinstance(value, list) else value
    return replace(record, **new)


def ask_rules(changes: dict[str, Any]) -> None:
    """Ask the rules of a robot whose first turning joint, its link or itself has been changed."""
    robot = dh2urdf.convert("arm.csv", convention="standard").robot
    number = next(place for place, joint in enumerate(robot.joints) if joint.type is JointType.REVOLUTE)
    joints, links = list(robot.joints), list(robot.links)
    moved = next(place for place, link in enumerate(links) if link.name == joints[number].child)
    joints[number] = changed(joints[number], changes.get("joint", {}))
    links[moved] = changed(links[moved], changes.get("link", {}))
    list(check_robot(changed(replace(robot, joints=tuple(joints), links=tuple(links)), changes.get("robot", {}))))


def in_python(case: dict[str, Any]) -> None:
    """Do what a case does without a command, as far as it comes."""
    with suppress(Exception, SystemExit), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if "rules" in case:
            ask_rules(case["rules"])
        else:
            exec(case["python"], {"dh2urdf": dh2urdf, "np": np, "Path": Path})  # noqa: S102 - the table is ours


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[Problem]:
    """The problems that are made while the test runs."""
    found: list[Problem] = []
    make = Messages.__call__

    def call(self: Messages, code: str, *given: Any, **values: Any) -> Problem:
        found.append(make(self, code, *given, **values))
        return found[-1]

    monkeypatch.setattr(Messages, "__call__", call)
    return found


@pytest.mark.parametrize("name", CASES)
def test_a_case_makes_its_message(  # noqa: PLR0917 - fixtures
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    in_this_process: Callable[..., Any],  # noqa: ARG001 - it is asked for its effect
    made: list[Problem],
) -> None:
    """The code, the sentence, and, of a command, that it is printed."""
    from dh2urdf.cli import exit_status_of

    case, code = CASES[name], name.partition(" ")[2]
    write_files(case, tmp_path)
    monkeypatch.chdir(tmp_path)
    if "run" not in case:
        in_python(case)
    else:
        exit_status_of(shlex.split(case["run"]), debug=False)
        printed = "".join(capfd.readouterr())
        assert case["says"] in printed, printed
    said = [problem.message for problem in made if problem.code == code]
    assert any(message.startswith(case["says"]) for message in said), said or [problem.code for problem in made]


@pytest.mark.parametrize("package", PACKAGES)
def test_every_code_has_a_case_or_a_reason(package: str) -> None:
    """A code without a case is listed with the reason why none makes it on demand; nothing is listed that is no code."""
    codes = tomllib.loads((ROOT / PACKAGES[package] / "messages.toml").read_text("utf-8")).keys()
    cases = TABLE["cases"].get(package, {}).keys()
    listed = [code for reason in TABLE["not on demand"].get(package, {}).values() for code in reason]
    assert sorted([*cases, *listed]) == sorted(codes)
    named = [path for reason in TABLE["not on demand"].get(package, {}) for path in re.findall(r"tests[/\w.]+", reason)]
    assert [path for path in named if not (ROOT / path).exists()] == []
