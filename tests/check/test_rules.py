"""Every rule against a file that breaks it, and every sentence of the table against the consumer that it speaks of."""

import math
import os
import re
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from consumers import Behaviour, behaviours, require
from faulty_files import CYLINDER, ELBOW_AXIS, ELBOW_LIMIT, END, PROOFS, SOUND, UNPROVED, faulty, line_of, write_all
from foretelling import descriptions, findings_of

from dh2urdf.stages import Expansion, Finding
from dh2urdf_check.inspection import inspect_urdf
from dh2urdf_check.rules import CONSUMERS, Outcome, rules, rules_of

OF_ANY_FILE = {"root-without-inertial", "fixed-link", "named-colour", "free-root", "empty-root", "usd-name"}
"""Notes of every file that a person would call right."""
IN_THE_TEXT = {"not-xml", "wrong-encoding", "long-line", "unknown-attribute"}
"""Rules whose findings are at a letter, and not at an element."""


def by_rule(path: Path) -> dict[str, Finding]:
    return {finding.rule: finding for finding in inspect_urdf(path).findings}


# --- What is found ----------------------------------------------------------------------------------------------------


def test_a_sound_file_has_nothing_but_notes(files: dict[str, Path]) -> None:
    """The root frame that KDL wants, frames that some readers merge, colours that CoppeliaSim loses, who holds the root."""
    findings = inspect_urdf(files["sound"]).findings
    assert {finding.rule for finding in findings} == OF_ANY_FILE
    assert {finding.severity for finding in findings} == {"note"}


@pytest.mark.parametrize("rule", PROOFS)
def test_a_fault_is_found(files: dict[str, Path], rule: str) -> None:
    """Once, at its line, with the consumers of the table; and nothing else is."""
    proof = PROOFS[rule]
    findings = inspect_urdf(files[rule]).findings
    (finding,) = [finding for finding in findings if finding.rule == rule]
    assert {finding.rule for finding in findings} - OF_ANY_FILE - {*proof.besides} <= {rule}
    assert finding.mark is not None
    assert (finding.mark.file, finding.mark.line) == (str(files[rule]), line_of(SOUND, proof))
    if finding.mark.column is not None and rule not in IN_THE_TEXT:
        line = faulty(SOUND, proof).splitlines()[finding.mark.line - 1]
        assert line[finding.mark.column - 1] == "<"
    assert finding.fix == rules()[rule].fix
    of = proof.of or tuple(rules()[rule].outcomes)
    assert [effect.consumer for effect in finding.effects] == [name for name in CONSUMERS if name in of]


# --- What the consumers do --------------------------------------------------------------------------------------------

IGNORED = {
    "repeated-element",
    "unknown-element",
    "xacro-element",
    "mimic-joint",
    "mimic-itself",
    "mimic-undefined",
    "mimic-of-fixed",
}
"""Faults whose effect is that a part of the file is ignored: what is measured is the sound robot."""
UNMEASURED = {
    # check_urdf prints the tree of links, and nothing else of what it read.
    *(("ros", rule) for rule in ("axis-zero", "missing-range", "swapped-limits", "missing-inertial", "negative-mass")),
    *(("ros", rule) for rule in ("axis-without-direction", "mimic-without-range")),
    *(("ros", rule) for rule in ("nothing-that-weighs", "missing-mesh", "unresolved-package")),
    *(("ros", f"inertia-{rule}") for rule in ("not-positive-definite", "triangle-inequality")),
    *((name, rule) for name in ("ros", "gazebo") for rule in ("unreadable-mesh", "hollow-mesh", "missing-vertex")),
    ("pybullet", "missing-vertex"),  # The shape is another, if anything.
    # Without a display nothing is drawn; the merged tool0 is not in the SDF.
    *(("gazebo", rule) for rule in ("missing-mesh", "unresolved-package", "several-parents")),
}


def _expected(rule: str, path: Path, consumer: str) -> tuple[str, list[Outcome], list[str]]:
    """How loading should end, the outcomes, and the sentences."""
    proof = PROOFS[rule]
    found = [finding for finding in findings_of(path) if finding.rule in {rule, *proof.besides}]
    effects = [(finding.rule, effect) for finding in found for effect in finding.effects if effect.consumer == consumer]
    outcomes = [rules()[name].outcomes[consumer] for name, _ in effects]
    ends = {outcome.value for outcome in outcomes if outcome in {Outcome.REFUSES, Outcome.CRASHES}}
    return min(ends, default="loads"), outcomes, [effect.text for _, effect in effects]


def _measured(behaviour: Behaviour) -> tuple[Any, ...]:
    return behaviour.masses, behaviour.joints, behaviour.finite, behaviour.positions, behaviour.extra


def _printed(behaviour: Behaviour, sound: Behaviour) -> list[str]:
    return [line for line in behaviour.printed.splitlines() if line not in sound.printed]


@pytest.fixture(scope="module", params=[name for name in CONSUMERS if name not in {"coppeliasim", "isaac"}])
def measured(request: pytest.FixtureRequest, files: dict[str, Path]) -> tuple[str, dict[str, Behaviour]]:
    """A consumer, and what it does with every file."""
    consumer = str(request.param)
    require(consumer)
    return consumer, dict(zip(files, behaviours(consumer, list(files.values())), strict=True))


@pytest.mark.long
def test_the_table_says_what_happens(measured: tuple[str, dict[str, Behaviour]], files: dict[str, Path]) -> None:
    """A consumer refuses, crashes or loads as the table has it; what it loads otherwise is measured; it says what it says."""
    consumer, found = measured
    sound, wrong = found["sound"], []
    assert sound.end == "loads"
    for rule in PROOFS:
        end, outcomes, sentences = _expected(rule, files[rule], consumer)
        behaviour = found[rule]
        if behaviour.end != end:
            wrong.append(f"{rule}: it {behaviour.end}, and the table says that it {end}: {behaviour.extra}")
        if end != "loads" or behaviour.end != "loads":
            continue
        printed = _printed(behaviour, sound)
        speaks = Outcome.WARNS in outcomes or any(re.search("with a message|print", sentence) for sentence in sentences)
        if bool(printed) != speaks:
            wrong.append(f"{rule}: it printed {printed}, and the table says {sentences}")
        changes = set(outcomes) & {Outcome.ALTERS, Outcome.LOSES}
        differs = _measured(behaviour) != _measured(sound)
        if changes and not differs and not printed and rule not in IGNORED and (consumer, rule) not in UNMEASURED:
            wrong.append(f"{rule}: it makes the same of it as of the sound file, and the table says {sentences}")
        if rule in IGNORED and Outcome.ALTERS in outcomes and behaviour.masses != sound.masses:
            wrong.append(f"{rule}: the masses are {behaviour.masses}")
    assert wrong == []


@pytest.mark.long
def test_an_empty_cell_was_seen(measured: tuple[str, dict[str, Behaviour]]) -> None:
    """Where a rule does not name a reader, the reader loaded the faulty file, or another fault in it is to blame."""
    consumer, found = measured
    untried = set(rules()) - set(found) - UNPROVED
    refused = [
        rule
        for rule, proof in PROOFS.items()
        if not any(consumer in rules()[name].outcomes for name in (rule, *proof.besides)) and found[rule].end != "loads"
    ]
    assert (untried, refused) == (set(), [])


ONE = pytest.approx(1.0)
SAID: dict[tuple[str, str], Callable[[Behaviour], bool]] = {
    ("pybullet", "missing-inertial"): lambda b: (
        b.masses["link_1"] == 1.0 and b.extra["inertias"]["link_1"] == [1, 1, 1]
    ),
    ("pybullet", "long-line"): lambda b: b.masses["link_2"] == 0.0,
    ("pybullet", "unexpanded-xacro"): lambda b: b.extra["effort"]["elbow"] == 0.0,
    ("pybullet", "axis-zero"): lambda b: not b.finite,
    ("pybullet", "continuous-joint"): lambda b: b.joints["elbow"] == [0, -1],
    ("pybullet", "swapped-limits"): lambda b: b.joints["elbow"] == [2, -2],
    ("pybullet", "floating-joint"): lambda b: b.positions == 1,
    ("pybullet", "negative-mass"): lambda b: b.masses["link_2"] == -1.0,
    ("pybullet", "inertia-not-positive-definite"): lambda b: b.extra["inertias"]["link_2"] == [0, 0, 0],
    ("mujoco", "missing-inertial"): lambda b: b.masses["link_1"] == pytest.approx(1000 * math.pi * 0.02**2 * 0.05),
    ("mujoco", "missing-range"): lambda b: b.joints["elbow"] is None,
    ("mujoco", "swapped-limits"): lambda b: b.joints["elbow"] is None,
    ("mujoco", "mimic-joint"): lambda b: b.extra["equalities"] == 1,
    ("mujoco", "no-link"): lambda b: b.masses == {},
    ("pinocchio", "missing-inertial"): lambda b: b.masses["shoulder"] == 0.0,
    ("pinocchio", "negative-mass"): lambda b: b.masses["elbow"] == -1.0,
    ("pinocchio", "planar-joint"): lambda b: b.positions == 1 + 4,
    ("pinocchio", "axis-zero"): lambda b: b.finite and not b.extra["rigid"],
    ("pinocchio", "unresolved-package"): lambda b: "could not be found" in b.extra["geometry"],
    ("drake", "missing-inertial"): lambda b: b.masses["link_1"] == 0.0,
    ("drake", "inertial-without-mass"): lambda b: b.masses["link_2"] == ONE,
    ("drake", "negative-mass"): lambda b: b.masses["link_2"] == ONE,
    ("drake", "missing-limit"): lambda b: b.joints["elbow"] == [-math.inf, math.inf],
    ("drake", "empty-parent-or-child"): lambda b: "elbow" not in b.joints,
    ("drake", "floating-joint"): lambda b: b.positions == 1 + 7 + 7,
    ("drake", "planar-joint"): lambda b: b.positions == 1 + 3 + 7,
    ("ros", "several-parents"): lambda b: b.extra["stdout"].count("tool0") == 2,
    ("gazebo", "zero-mass"): lambda b: set(b.masses) == {"base_link", "link_1"},
    ("gazebo", "fixed-link"): lambda b: set(b.masses) == {"base_link", "link_1", "link_2"},
}
"""What a sentence says in numbers."""


@pytest.mark.long
def test_the_numbers_of_the_table_are_measured(measured: tuple[str, dict[str, Behaviour]]) -> None:
    """Masses, limits, coordinates and axes are those that the sentences speak of."""
    consumer, found = measured
    wrong = [rule for (name, rule), holds in SAID.items() if name == consumer and not holds(found[rule])]
    assert wrong == [], [found[rule] for rule in wrong]


@pytest.mark.long
def test_the_root_frame_is_noted_by_pybullet(measured: tuple[str, dict[str, Behaviour]]) -> None:
    """Of the sound file PyBullet prints that the root has no inertial, and nobody else prints anything."""
    consumer, found = measured
    lines = [line for line in found["sound"].printed.splitlines() if "warn" in line.lower() or "No inertial" in line]
    assert bool(lines) == (consumer == "pybullet")


# --- Other people's files ---------------------------------------------------------------------------------------------


def foreign_files() -> list[Path]:
    """Without the hands of one robot, which have meshes in a package that is not there, in more ways than a test needs."""
    return [path for path in descriptions() if "alex" not in path.name]


@pytest.mark.long
@pytest.mark.parametrize("consumer", ["mujoco", "drake", "ros"])
def test_what_is_said_of_real_robots_is_true(consumer: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of each of some sixty descriptions a consumer loads those, and only those, of which no finding says that it does not."""
    paths = foreign_files()
    require(consumer)
    if not paths:
        pytest.skip("example-robot-data is not installed")
    assert len(paths) > 50
    if consumer == "pybullet":  # It reads all meshes, and takes its time.
        paths = paths[::4]
    share = next(above for above in paths[0].parents if above.name == "example-robot-data")
    monkeypatch.setenv("DRAKE_PACKAGES", str(share))  # Drake is told where the package is, as the finding asks for.
    told = {"package-address"} if consumer == "drake" else set()
    assert _mispredicted(consumer, paths, told) == []


def _mispredicted(consumer: str, paths: Sequence[Path], told: set[str]) -> list[str]:
    wrong = []
    for path, behaviour in zip(paths, behaviours(consumer, paths), strict=True):
        fatal = {
            finding.rule
            for finding in findings_of(path)
            for effect in finding.effects
            if effect.consumer == consumer
            and rules()[finding.rule].outcomes[consumer] in {Outcome.REFUSES, Outcome.CRASHES}
        } - told
        if bool(fatal) != (behaviour.end != "loads"):
            wrong.append(f"{path.name} {behaviour.end}: {sorted(fatal)} {behaviour.extra}")
    return wrong


def test_a_package_is_found_by_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Above the file, in ROS_PACKAGE_PATH, or in AMENT_PREFIX_PATH."""
    text = SOUND.replace('<box size="0.1 0.05 0.05"/>', '<mesh filename="package://my_robot/part.obj"/>')
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    for variable, folder in (("ROS_PACKAGE_PATH", "a/my_robot"), ("AMENT_PREFIX_PATH", "b/share/my_robot")):
        assert "unresolved-package" in by_rule(path)
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "part.obj").touch()
        with monkeypatch.context() as context:
            context.setenv(variable, f"{os.pathsep}{tmp_path / folder.partition('/')[0]}")
            assert "unresolved-package" not in by_rule(path)
            address = by_rule(path)["package-address"]  # PyBullet looks in the folders above the file alone.
            assert "pybullet" in {effect.consumer for effect in address.effects}
    inside = tmp_path / "a" / "my_robot" / "urdf" / "arm.urdf"
    inside.parent.mkdir()
    inside.write_text(text)
    assert "unresolved-package" not in by_rule(inside)


@pytest.mark.parametrize(("folder", "is_above"), [("src/my_robot", True), ("src/somewhere", False)])
def test_a_package_has_the_name_that_it_gives_itself(tmp_path: Path, folder: str, *, is_above: bool) -> None:
    """A file's own, and one that the user names; PyBullet finds it by a folder of its name above the file alone."""
    text = SOUND.replace('<box size="0.1 0.05 0.05"/>', '<mesh filename="package://my_robot/part.obj"/>')
    package = tmp_path / folder
    for path in (package / "urdf" / "arm.urdf", tmp_path / "apart" / "arm.urdf"):
        path.parent.mkdir(parents=True)
        path.write_text(text)
    (package / "package.xml").write_text("<package><name>my_robot</name></package>")
    shutil.copy(write_all(tmp_path)["sound"].parent / "part.obj", package)
    inside, apart = package / "urdf" / "arm.urdf", tmp_path / "apart" / "arm.urdf"
    assert "unresolved-package" in by_rule(apart)
    named = inspect_urdf(apart, Expansion(package_paths=(tmp_path / "src",))).findings
    assert not {finding.rule for finding in named} & {"unresolved-package", "missing-mesh"}
    assert not {*by_rule(inside)} & {"unresolved-package", "missing-mesh"}
    require("pybullet")
    for path, findings, loads in ((inside, by_rule(inside).values(), is_above), (apart, named, False)):
        (finding,) = [finding for finding in findings if finding.rule == "package-address"]
        assert ("pybullet" not in {effect.consumer for effect in finding.effects}) == loads
        assert (behaviours("pybullet", [path])[0].end == "loads") == loads


# --- What is hardly meant ----------------------------------------------------------------------------------------------

PLAUSIBLE = rules_of("plausibility")
NOT_MEANT_OTHERWISE = {
    "no limits": (ELBOW_LIMIT, ELBOW_LIMIT.replace('"-2" upper="2"', '"-100" upper="100"')),
    "a rotor that is not drawn": (CYLINDER, '<cylinder radius="0.001" length="0.001"/>'),
    "what ROS 2 controls": (END, f'<ros2_control name="c" type="system"><joint name="elbow"/></ros2_control>{END}'),
    "an attribute of one's own": (ELBOW_AXIS, '<axis xyz="0 1 0" colour="red"/>'),
}


def write(folder: Path, name: str, old: str, new: str) -> Path:
    assert SOUND.count(old) == 1
    path = folder / f"{name}.urdf"
    path.write_text(SOUND.replace(old, new))
    return path


def doubtful(path: Path) -> list[Finding]:
    return [finding for finding in inspect_urdf(path).findings if finding.rule in PLAUSIBLE]


@pytest.mark.parametrize("name", NOT_MEANT_OTHERWISE)
def test_what_may_be_meant_is_not_spoken_of(tmp_path: Path, name: str) -> None:
    assert doubtful(write(tmp_path, "arm", *NOT_MEANT_OTHERWISE[name])) == []


def test_an_effort_of_0_is_no_limit_to_mujoco_and_takes_drakes_actuator(tmp_path: Path) -> None:
    """Drake reads efforts where a transmission makes an actuator, and nothing is said of it elsewhere."""
    require("drake", "mujoco")
    drive = (
        '<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="elbow"/>'
        f'<actuator name="motor"/></transmission>{END}'
    )
    paths = [
        write(tmp_path, "plain", PROOFS["zero-effort"].old, PROOFS["zero-effort"].new),
        tmp_path / "driven.urdf",
        write(tmp_path, "with effort", END, drive),
    ]
    paths[1].write_text(paths[0].read_text().replace(END, drive))
    spoken_of = [
        "drake" in {effect.consumer for effect in finding.effects} for path in paths for finding in doubtful(path)
    ]
    assert spoken_of == [False, True]
    assert [each.extra["actuators"] for each in behaviours("drake", paths)] == [0, 0, 1]
    efforts = [each.extra["told"]["elbow"]["effort"] for each in behaviours("mujoco", paths)]
    assert efforts == [None, None, 20.0]


def test_a_ground_may_be_large(tmp_path: Path) -> None:
    """A single link with a box of 200 m is where robots stand."""
    path = tmp_path / "plane.urdf"
    path.write_text(
        '<robot name="plane"><link name="ground"><collision><geometry><box size="200 200 10"/></geometry>'
        "</collision></link></robot>"
    )
    assert doubtful(path) == []


TRUE = {
    "inertia-of-a-larger-body": {"a1.urdf", "b1-z1.urdf", "tiago.urdf"},
    "reference-to-nothing": {"talos_left_arm.urdf", "tiago_dual.urdf"},
}
"""Descriptions of real robots of which each finding was looked at by hand."""


@pytest.mark.long
def test_real_robots_are_plausible_but_for_what_was_looked_at() -> None:
    """No arm of a maker has limits, angles or lengths that are taken for other units: of a sixth of them."""
    by_rule: dict[str, set[str]] = {}
    known = set().union(*TRUE.values())
    for path in [path for number, path in enumerate(descriptions()) if path.name in known or number % 6 == 0]:
        for finding in findings_of(path):
            if finding.rule not in PLAUSIBLE:
                continue
            by_rule.setdefault(finding.rule, set()).add(path.name)
    assert {*TRUE} <= set(by_rule) <= {*TRUE, "zero-velocity", "zero-effort"}
    for rule, names in TRUE.items():
        assert names <= by_rule[rule]
