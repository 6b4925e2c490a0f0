"""Every rule about SDF and MJCF against a file that breaks it, and what it says against the consumers themselves."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from consumers import require
from faulty_models import MJCF, MJCF_FAULTS, SDF, SDF_FAULTS, write_models
from model_consumers import outcomes

from dh2urdf_check.models.mjcf import inspect_mjcf, schema
from dh2urdf_check.models.models import CONSUMERS, model_rules
from dh2urdf_check.models.sdf import inspect_sdf
from dh2urdf_check.rules import Outcome
from dh2urdf_check.single_readers.mujoco import kind_of

if TYPE_CHECKING:
    from dh2urdf.stages import Inspection

FAULTS = {**SDF_FAULTS, **MJCF_FAULTS}
SOUND = {"sdf": SDF, "mjcf": MJCF}


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return write_models(tmp_path_factory.mktemp("models"))


def inspected(path: Path) -> Inspection:
    return inspect_sdf(path) if path.suffix == ".sdf" else inspect_mjcf(path)


def test_every_rule_has_a_file_that_breaks_it() -> None:
    """None is untried."""
    assert {*model_rules("sdf"), *model_rules("mjcf")} == set(FAULTS)


def test_the_tables_are_in_order() -> None:
    """Names are in kebab-case and begin with the format; phrases have no full stop."""
    for name in CONSUMERS:
        for rule in model_rules(name).values():
            assert re.fullmatch(rf"{name}(-[a-z]+)+", rule.name)
            assert rule.effects
            assert set(rule.outcomes) <= set(CONSUMERS[name])
            for text in (rule.fault, rule.fix, *(effect.text for effect in rule.effects)):
                assert text == text.strip()
                assert not text.endswith(".")


@pytest.mark.parametrize("name", ["sdf", "mjcf"])
def test_a_sound_model_has_no_finding(files: dict[str, Path], name: str) -> None:
    """And is an arm, which can be compared with a table."""
    inspection = inspected(files[name])
    assert inspection.findings == ()
    assert inspection.robot is not None


@pytest.mark.parametrize("rule", FAULTS)
def test_a_fault_is_found(files: dict[str, Path], rule: str) -> None:
    """Once, at its line; and nothing else is."""
    name = rule.partition("-")[0]
    findings = inspected(files[rule]).findings
    assert [finding.rule for finding in findings if finding.rule not in FAULTS[rule].besides] == [rule]
    (finding,) = [finding for finding in findings if finding.rule == rule]
    assert finding.mark is not None
    assert finding.mark.file == str(files[rule])
    assert finding.mark.line == FAULTS[rule].line(SOUND[name])
    assert finding.fix == model_rules(name)[rule].fix


MEASURED = [(name, consumer) for name in CONSUMERS for consumer in CONSUMERS[name]]


@pytest.fixture(scope="module", params=MEASURED, ids="-".join)
def measured(request: pytest.FixtureRequest, files: dict[str, Path]) -> tuple[str, str, dict[str, dict[str, Any]]]:
    """A format, a consumer, and what it does with every file of the format."""
    name, consumer = request.param
    require(consumer)
    mine = {rule: path for rule, path in files.items() if rule.startswith(name)}
    return name, consumer, dict(zip(mine, outcomes(consumer, list(mine.values())), strict=True))


IGNORED = {
    "sdf-relative-pose": "poses are not asked for",
    "sdf-undefined-frame": "poses are not asked for",
    "sdf-invalid-vector": "poses are not asked for",
    "sdf-missing-inertial": "sdformat prints the file as it is",
    "sdf-inertia-not-positive-definite": "inertias are not asked for",
    "sdf-inertia-triangle-inequality": "inertias are not asked for",
    "sdf-invalid-number": "the number is the one that was there",
    "sdf-unknown-element": "what is ignored has no trace",
    "sdf-missing-include": "what is ignored has no trace",
    "mjcf-unknown-element": "what is ignored has no trace",
    "mjcf-unknown-attribute": "what is ignored has no trace",
    "mjcf-repeated-element": "the first is the one that was there",
    "mjcf-invalid-number": "the number is the one that was there",
    "mjcf-misread-number": "the number is the one that was there",
    "mjcf-missing-include": "what is ignored has no trace",
    "mjcf-short-keyframe": "keyframes are not asked for",
    "mjcf-global-coordinates": "poses are not asked for",
    "mjcf-undefined-mesh": "shapes are not asked for",
}
"""Alterations that leave no trace in what is asked of a consumer."""


@pytest.mark.long
def test_the_table_says_what_happens(
    files: dict[str, Path], measured: tuple[str, str, dict[str, dict[str, Any]]]
) -> None:
    """A consumer refuses, crashes or loads as the table has it, and what it alters is other than of the sound file."""
    name, consumer, found = measured
    sound, wrong = found[name], []
    assert sound["end"] == "loads"
    for rule in FAULTS:
        if not rule.startswith(name):
            continue
        of = {rule: model_rules(name)[rule].outcomes.get(consumer)} | {
            finding.rule: model_rules(name)[finding.rule].outcomes[consumer]
            for finding in inspected(files[rule]).findings
            if any(effect.consumer == consumer for effect in finding.effects)
        }
        ends = {outcome.value for outcome in of.values() if outcome in {Outcome.REFUSES, Outcome.CRASHES}}
        end = min(ends, default="loads")
        behaviour = found[rule]
        if behaviour["end"] != end:
            wrong.append(f"{rule}: it {behaviour['end']}, and the table says that it {end}: {behaviour}")
        if end != "loads" or behaviour["end"] != "loads":
            continue
        printed = [line for line in behaviour["printed"].splitlines() if line not in sound["printed"]]
        text = next((effect.text for effect in model_rules(name)[rule].effects if effect.consumer == consumer), "")
        if ("with a message" in text or "says" in text) != bool(
            [line for line in printed if "expected a world" not in line]
        ):
            wrong.append(f"{rule}: it printed {printed}, and the table says {text!r}")
        differs = any(behaviour.get(key) != sound.get(key) for key in ("masses", "joints"))
        if of[rule] in {Outcome.ALTERS, Outcome.LOSES} and not differs and not printed and rule not in IGNORED:
            wrong.append(f"{rule}: it makes the same of it as of the sound file, and the table says {text!r}")
        if not any(of.values()) and behaviour["masses"] != sound["masses"]:
            wrong.append(f"{rule}: the table says nothing, and it makes {behaviour} of it")
    assert wrong == []


def test_the_schema_is_that_of_mujoco() -> None:
    """Every element and attribute that MuJoCo prints, and no other."""
    mujoco = pytest.importorskip("mujoco")
    rows: list[tuple[int, str, set[str]]] = []
    for line in mujoco.mj_printSchema(False, False).splitlines():
        if match := re.match(r"^( *)(\S+) \(.\)\s*(.*)$", line):
            rows.append((len(match[1]) // 3, match[2], set(match[3].split())))
        elif line.strip():
            rows[-1][2].update(line.split())
    path, printed = [], {}
    for depth, tag, attributes in rows:
        path[depth:] = [tag]
        printed["/".join(path)] = attributes
    ours = {}
    text = (Path(inspect_mjcf.__code__.co_filename).with_name("mjcf_schema.txt")).read_text("utf-8")
    for line in text.splitlines():
        depth = len(line) - len(line.lstrip(" "))
        tag, _, *attributes = line.split()
        path[depth:] = [tag]
        ours["/".join(path)] = {attribute.rstrip("!") for attribute in attributes}
    assert ours == printed
    assert {"body", "geom", "frame"} <= set(schema().children["mujoco"].children["worldbody"].children)


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
    (found,) = outcomes("gazebo", [path])
    assert found["end"] == "loads"
    path.write_text(WORLD.replace("</plugin>", ""))
    (finding,) = inspect_sdf(path).findings
    assert (finding.rule, finding.message) == (
        "sdf-not-xml",
        f"this is not XML: Opening and ending tag mismatch: plugin line {WORLD[: WORLD.index('<plugin')].count(chr(10)) + 1} and world",
    )


NAMED = """<mujoco model="named">
  <compiler angle="radian"/><include file="parts/rest.xml"/>
  <default><default class="unused"><geom material="nowhere" mesh="nowhere"/></default>
    <default class="shell"><geom material="red" mass="0" group="2"/></default></default>
  <worldbody>
    <body name="a"><freejoint/><geom class="shell" size="1"/><body name="tip"><geom size="0.1"/></body>
      <frame pos="0 0 1"><body name="b"><joint name="j"/><site name="s"/><geom name="g" size="0.1" material="red"/></body></frame>
    </body>
  </worldbody>
  <tendon><spatial name="t"><site site="s"/><geom geom="g"/><site site="end"/></spatial></tendon>
  <sensor><framepos objtype="xbody" objname="b" reftype="site" refname="s"/><contact subtree1="a" geom2="g"/><tendonpos
    tendon="t"/></sensor>
  <keyframe><key qpos="0 0 1 1 0 0 0 0.5" qvel="0 0 0 0 0 0 1" ctrl="2"/></keyframe>
</mujoco>"""
REST = """<mujoco><compiler meshdir="meshes"/><asset><mesh file="part.obj"/><material name="red"/></asset><worldbody><site name="end"
  pos="1 0 0"/></worldbody><actuator><motor tendon="t" class="main"/></actuator></mujoco>"""


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("", "", None),
        ('objname="b"', 'objname="c"', "mjcf-undefined-name"),
        ('tendon="t"/></s', 'tendon="s"/></s', "mjcf-undefined-name"),
        ('<geom material="red" mass', '<geom material="blue" mass', "mjcf-undefined-material"),
        ('<geom size="0.1"/>', '<joint/><geom size="0.1" mass="0"/>', "mjcf-weightless-body"),
        ("0 0.5", "0 0.5 0.6", "mjcf-long-keyframe"),
    ],
)
def test_what_is_named_carried_and_kept_is_what_mujoco_finds(
    tmp_path: Path, old: str, new: str, rule: str | None
) -> None:
    """Sensors and tendons of any kind of thing, defaults that nothing takes, masses of fixed bodies, several files."""
    mujoco = pytest.importorskip("mujoco")
    write_models(tmp_path)
    for folder in ("parts", "meshes"):
        (tmp_path / folder).mkdir()
    (tmp_path / "part.obj").rename(tmp_path / "meshes" / "part.obj")
    (tmp_path / "parts" / "rest.xml").write_text(REST)
    path = tmp_path / "named.xml"
    path.write_text(NAMED.replace(old, new, 1))
    found = [finding.rule for finding in inspect_mjcf(path).findings if finding.severity == "error"]
    assert {*found} == ({rule} if rule else set())
    if rule is None:
        mujoco.MjModel.from_xml_path(str(path))
    else:
        with pytest.raises(ValueError, match="Error"):
            mujoco.MjModel.from_xml_path(str(path))


@pytest.mark.parametrize("bomb", ["sdf", "mujoco"])
def test_entities_are_not_expanded(tmp_path: Path, bomb: str) -> None:
    """A thousand million of one letter are no memory."""
    entities = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(9))
    path = tmp_path / f"bomb.{'sdf' if bomb == 'sdf' else 'xml'}"
    path.write_text(f'<!DOCTYPE r [<!ENTITY e0 "l">{entities}]>\n<{bomb} version="1.7" model="a">&e9;</{bomb}>')
    assert all(len(finding.message) < 1000 for finding in inspected(path).findings)


def test_the_words_and_counts_are_those_of_mujoco(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of every attribute whose element needs nothing else: it takes each word and count, and no other."""
    mujoco = pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)  # MuJoCo writes a log

    def refusal(section: str, tag: str, name: str, text: str) -> str:
        inner = f'<{tag} {name}="{text}"/>'
        outer = "<worldbody>%s</worldbody>" if section == "worldbody" else f"<{section}>%s</{section}>"
        try:
            mujoco.MjSpec.from_string(f"<mujoco>{inner if section == tag else outer % inner}</mujoco>")
        except ValueError as error:
            return str(error)
        return ""

    tried, wrong = 0, []
    sections = {**schema().children["mujoco"].children}
    for section in ("compiler", "option", "size", "statistic", "visual", "default", "asset", "worldbody", "actuator"):
        inner = (
            {section: sections[section]} if section in {"compiler", "option", "size"} else sections[section].children
        )
        for tag, node in inner.items():
            for name in node.attributes:
                kind = kind_of(tag, name)
                if kind == "any" or tag in {"dcmotor", "default", "flexcomp", "replicate"}:
                    continue
                tried += 1
                least, _, most = kind.removeprefix("whole ").partition("-")
                taken = kind.split("|") if "|" in kind else [" ".join(["1"] * int(n)) for n in (least, most) if n]
                refused = ["qqq"] if "|" in kind else ["x", " ".join(["1"] * (int(most or least) + 1))]
                if kind.endswith("-"):
                    refused = ["x"]
                wrong += [
                    f"{tag} {name}: {text} is not taken"
                    for text in taken
                    if re.search("keyword|format|much|enough", refusal(section, tag, name, text))
                ]
                wrong += [f"{tag} {name}: {text} is taken" for text in refused if not refusal(section, tag, name, text)]
    assert wrong == []
    assert tried > 300
