"""Every rule about SDF and MJCF against a file that breaks it, and what it says against the consumers themselves."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import yaml
from consumers import behaviours, require
from faulty_files import MJCF, MODEL_PROOFS as PROOFS, SDF, SOUND_OF as SOUND, line_of, write_models
from lxml import etree

from dh2urdf.stages import Inspection
from dh2urdf_check.inspection import MODEL_CONSUMERS as CONSUMERS, inspect_mjcf, inspect_sdf, model_rules
from dh2urdf_check.rules import Outcome

if TYPE_CHECKING:
    from consumers import Behaviour


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return write_models(tmp_path_factory.mktemp("models"))


def inspected(path: Path) -> Inspection:
    return inspect_sdf(path) if path.suffix == ".sdf" else inspect_mjcf(path)


@pytest.mark.parametrize("name", ["sdf", "mjcf"])
def test_a_sound_model_has_no_finding(files: dict[str, Path], name: str) -> None:
    """And is an arm, which can be compared with a table."""
    inspection = inspected(files[name])
    assert inspection.findings == ()
    assert inspection.robot is not None


@pytest.mark.parametrize("rule", PROOFS)
def test_a_fault_is_found(files: dict[str, Path], rule: str) -> None:
    """Once, at its line; and nothing else is."""
    name = rule.partition("-")[0]
    findings = inspected(files[rule]).findings
    assert [finding.rule for finding in findings if finding.rule not in PROOFS[rule].besides] == [rule]
    (finding,) = [finding for finding in findings if finding.rule == rule]
    assert finding.mark is not None
    assert finding.mark.file == str(files[rule])
    assert finding.mark.line == line_of(SOUND[name], PROOFS[rule])
    assert finding.fix == model_rules(name)[rule].fix


MEASURED = [(name, consumer) for name in CONSUMERS for consumer in CONSUMERS[name]]


@pytest.fixture(scope="module", params=MEASURED, ids="-".join)
def measured(request: pytest.FixtureRequest, files: dict[str, Path]) -> tuple[str, str, dict[str, Behaviour]]:
    """A format, a consumer, and what it does with every file of the format."""
    name, consumer = request.param
    require(consumer)
    mine = {rule: path for rule, path in files.items() if rule.startswith(name)}
    return name, consumer, dict(zip(mine, behaviours(consumer, list(mine.values())), strict=True))


IGNORED = {
    "sdf-relative-pose": "poses are not asked for",
    "sdf-undefined-frame": "poses are not asked for",
    "sdf-invalid-vector": "poses are not asked for",
    "sdf-missing-inertial": "sdformat prints the file as it is",
    "sdf-inertia-not-positive-definite": "inertias are not asked for",
    "sdf-inertia-triangle-inequality": "inertias are not asked for",
    "sdf-invalid-number": "the number is the one that was there",
    "sdf-unknown-element": "what is ignored has no trace",
    "sdf-mass-without-inertia": "inertias are not asked for",
    "sdf-include": "what is ignored has no trace",
    "sdf-missing-include": "what is ignored has no trace",
    "mjcf-unknown-element": "what is ignored has no trace",
    "mjcf-unknown-attribute": "what is ignored has no trace",
    "mjcf-repeated-element": "the first is the one that was there",
    "mjcf-missing-include": "what is ignored has no trace",
    "mjcf-short-keyframe": "keyframes are not asked for",
    "mjcf-global-coordinates": "poses are not asked for",
    "mjcf-undefined-mesh": "shapes are not asked for",
    "mjcf-body-outside": "what is lost is no part of the sound file",
}
"""Alterations that leave no trace in what is asked of a consumer."""


@pytest.mark.long
def test_the_table_says_what_happens(files: dict[str, Path], measured: tuple[str, str, dict[str, Behaviour]]) -> None:
    """A consumer refuses, crashes or loads as the table has it, and what it alters is other than of the sound file."""
    name, consumer, found = measured
    sound, wrong = found[name], []
    assert sound.end == "loads"
    for rule in PROOFS:
        if not rule.startswith(name) or (PROOFS[rule].of and consumer not in PROOFS[rule].of):
            continue  # Whether Gazebo finds a model that is included depends on the network.
        of = {rule: model_rules(name)[rule].outcomes.get(consumer)} | {
            finding.rule: model_rules(name)[finding.rule].outcomes[consumer]
            for finding in inspected(files[rule]).findings
            if any(effect.consumer == consumer for effect in finding.effects)
        }
        ends = {outcome.value for outcome in of.values() if outcome in {Outcome.REFUSES, Outcome.CRASHES}}
        end = min(ends, default="loads")
        behaviour = found[rule]
        if behaviour.end != end:
            wrong.append(f"{rule}: it {behaviour.end}, and the table says that it {end}: {behaviour}")
        if end != "loads" or behaviour.end != "loads":
            continue
        printed = [line for line in behaviour.printed.splitlines() if line not in sound.printed]
        text = next((effect.text for effect in model_rules(name)[rule].effects if effect.consumer == consumer), "")
        if ("with a message" in text or "says" in text) != bool(
            [line for line in printed if "expected a world" not in line]
        ):
            wrong.append(f"{rule}: it printed {printed}, and the table says {text!r}")
        differs = (behaviour.masses, behaviour.joints) != (sound.masses, sound.joints)
        differs |= behaviour.extra.get("axis") != sound.extra.get("axis")
        if of[rule] in {Outcome.ALTERS, Outcome.LOSES} and not differs and not printed and rule not in IGNORED:
            wrong.append(f"{rule}: it makes the same of it as of the sound file, and the table says {text!r}")
        if not any(of.values()) and behaviour.masses != sound.masses:
            wrong.append(f"{rule}: the table says nothing, and it makes {behaviour} of it")
    assert wrong == []


RULES = Path(inspect_sdf.__code__.co_filename).with_name("rules")


def test_the_schema_is_that_of_mujoco() -> None:
    """Every element that MuJoCo prints has its attributes, and no other; bodies are in each other."""
    mujoco = pytest.importorskip("mujoco")
    table = yaml.safe_load((RULES / "mjcf_elements.yaml").read_text("utf-8"))
    rows: list[tuple[int, str, set[str]]] = []
    for line in mujoco.mj_printSchema(False, False).splitlines():
        if match := re.match(r"^( *)(\S+) \(.\)\s*(.*)$", line):
            rows.append((len(match[1]) // 3, match[2].removeprefix("(world)"), set(match[3].split())))
        elif line.strip():
            rows[-1][2].update(line.split())
    path: list[str] = []
    for depth, tag, attributes in rows:
        path[depth:] = [tag]
        holder = path[depth - 1] if depth else ""
        ours = table["attributes"].get(f"{holder}/{tag}", table["attributes"].get(tag))
        assert attributes <= set(ours.split()), path
        assert tag in table["children"].get(holder, tag).split(), path
    assert {"body", "geom", "frame"} <= set(table["children"]["worldbody"].split())


def test_the_elements_are_those_of_sdformat() -> None:
    """Of every version that it prints: those of the last one are all in the table, and none is in it that no version has."""
    program = shutil.which("ign") or shutil.which("gz")
    if program is None:
        pytest.skip("ign or gz is not installed")
    theirs: dict[str, set[str]] = {}
    for version in ("1.4", "1.5", "1.6", "1.7", "1.8", "1.9"):
        command = [program, "sdf", "--describe", version]
        printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        root = etree.fromstring(printed[printed.index("<element") :].encode(), etree.XMLParser(huge_tree=True))
        for element in root.iter("element"):
            above = element.getparent()
            if above is not None and element.get("name") and above.get("name") not in {None, "plugin"}:
                theirs.setdefault(str(above.get("name")), set()).add(str(element.get("name")))
    table = yaml.safe_load((RULES / "sdf_elements.yaml").read_text("utf-8"))["children"]
    assert {holder: set(names.split()) for holder, names in table.items()} == theirs


def test_what_is_included_is_part_of_the_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names may be defined in another file, and a fault there is reported with that file and its line."""
    write_models(tmp_path)
    asset = MJCF[MJCF.index("  <asset>") : MJCF.index("  <worldbody>")]
    path, inner = tmp_path / "arm.xml", tmp_path / "assets.xml"
    path.write_text(MJCF.replace(asset, '  <include file="assets.xml"/>\n'))
    inner.write_text(f"<mujocoinclude>\n{asset}</mujocoinclude>\n")
    assert inspect_mjcf(path).findings == ()
    inner.write_text(inner.read_text().replace("rgba", "colour"))
    (finding,) = inspect_mjcf(path).findings
    assert (finding.rule, str(finding.mark)) == ("mjcf-unknown-attribute", f"{inner}:3")
    monkeypatch.chdir(tmp_path.parent)
    relative = Path(tmp_path.name)
    (finding,) = inspect_mjcf(relative / "arm.xml").findings
    assert str(finding.mark) == f"{relative / 'assets.xml'}:3"


WORLD = f"""<?xml version="1.0"?>
<sdf version="1.7">
  <world name="w">
    {SDF[SDF.index("<model") : SDF.index("</sdf>")]}
    <model name="marker"><static>true</static><pose>0 0 1 0 0 0</pose></model>
    <model name="floor"><static>1</static><link name="floor">
      <sensor name="touch" type="contact"><contact><collision>shape</collision></contact></sensor>
      <collision name="shape"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
    <!-- -- a comment, as simulators take it --->
    <plugin filename="p" name="p"><gz:topic gz:of="a">t</gz:topic><model><link>a</link></model><visual>b</visual></plugin>
    <state world_name="w"><model name="arm"><link name="base"><velocity>0 0 0 0 0 0</velocity></link></model></state>
  </world>
</sdf>
"""


def test_what_is_no_part_of_a_model_is_no_fault(tmp_path: Path) -> None:
    """Plugins, sensors and states have words of models; a prefix may be declared nowhere; static models need no link."""
    path = tmp_path / "w.sdf"
    path.write_text(WORLD)
    assert [finding.message for finding in inspect_sdf(path).findings] == []
    require("gazebo")
    assert behaviours("gazebo", [path])[0].end == "loads"
    path.write_text(WORLD.replace("</plugin>", ""))
    (finding,) = inspect_sdf(path).findings
    assert (finding.rule, finding.message) == (
        "sdf-not-xml",
        f"this is not XML: Opening and ending tag mismatch: plugin line {WORLD[: WORLD.index('<plugin')].count(chr(10)) + 1} and world",
    )


@pytest.mark.parametrize("bomb", ["sdf", "mujoco"])
def test_entities_are_not_expanded(tmp_path: Path, bomb: str) -> None:
    """A thousand million of one letter are no memory."""
    entities = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(9))
    path = tmp_path / f"bomb.{'sdf' if bomb == 'sdf' else 'xml'}"
    path.write_text(f'<!DOCTYPE r [<!ENTITY e0 "l">{entities}]>\n<{bomb} version="1.7" model="a">&e9;</{bomb}>')
    assert all(len(finding.message) < 1000 for finding in inspected(path).findings)
