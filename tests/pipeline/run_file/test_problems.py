"""Each slip in a run file, or in a setting of one, is one problem: the code, the key, and line and column."""

from pathlib import Path

import pytest

from dh2urdf.run_file.config import load_config

# fmt: off
SLIPS = [
    ("transform: {stage: x}", "1:1 inputs no-inputs"),
    ("inputs: [3]", "1:10 inputs.0.path input-unreadable"),
    ("inputs: .", "1:9 inputs.0.path input-unreadable"),
    ("inputs: '*.xls'", "1:9 inputs.0.path no-file-matches"),
    ('inputs: "a\\0b"', "1:9 inputs.0.path nul-in-path"),
    ("inputs: [{pth: a}]", "1:11 inputs.0.pth key-unknown"),
    ("output: [x]", "2:9 output value-of-other-kind"),
    ("output: {directory: $HOME/ur5}", "2:21 output.directory path-unexpanded"),
    ("output: {layout: shard}", "2:18 output.layout value-of-other-kind"),
    ("output: {meshes: absolute}", "2:18 output.meshes.names mesh-names-unknown"),
    ("sample: {first: -1}", "2:17 sample.first value-of-other-kind"),
    ("execution: {time_limit: .inf}", "2:25 execution.time_limit value-of-other-kind"),
    ("loaders: [{options: {}}]", "2:11 loaders.0.stage key-missing"),
    ("cells: {name: p, arms: []}", "2:24 cells.0.arms value-of-other-kind"),
    ("cells: {name: p, arms: [{name: a}]}", "2:25 cells.0.arms.0.of key-missing"),
    ("cells: {name: p, arms: [{name: a, of: x}, {name: b, of: x, parent: a}]}",
     "2:68 cells.0.arms.1.parent parent-wrong"),
    ("cells: {name: p, arms: [{name: a, of: x}, {name: b, of: x, parent: c/tool0}]}", "2:68 cells.0.arms parent-unknown"),
    ("cells: {name: p, arms: [{name: a, of: x, parent: b/tool0}, {name: b, of: x, parent: a/tool0}]}",
     "2:50 cells.0.arms arms-in-circle"),
    ("cells: {name: p, arms: [{name: a, of: x, prefix: p}, {name: b, of: x, prefix: p}]}", "2:54 cells.0.arms arms-alike"),
    ("cells: [{name: p, arms: [{name: a, of: x}]}, {name: p, arms: [{name: a, of: x}]}]", "2:46 cells.1 name-twice"),
    ("meshes: {of: ur5, joints: {pan: {visual: {scale: 2}}}}", "2:42 meshes.0.joints.pan.visual.file key-missing"),
    ("meshes: {of: ur5, joints: {pan: {mehs: a.stl}}}", "2:34 meshes.0.joints.pan.mehs key-unknown"),
    ("variations: {count: 5, vary: {RULE}}", "2:13 variations.0.of key-missing"),
    ("variations: {of: arm, vary: {RULE}}", "2:13 variations.0.count variants-uncounted"),
    ("variations: [{of: arm, count: 5, vary: {RULE}}, {of: arm, count: 5, vary: {RULE}}]", "2:79 variations.1 name-twice"),
]
RULES = [
    ("joints: 1, field: a", "1 vary-no-way"),
    ("joints: 1, field: alhpa, scale: [1, 2]", "20 .field value-of-other-kind"),
    ("joints: [true], field: a, scale: [1, 2]", "11 .joints joint-wrong"),
    ("field: axes, choices: [0]", "25 .choices axes-no-number"),
    ("joints: 1, field: type, choices: [revolut]", "36 .choices joint-type-unknown"),
    ("joints: 1, field: a, choices: [90 deg]", "33 .choices quantity-refused"),
    ("joints: 1, field: d, offset: [-20, 1]", "32 .offset quantity-refused"),
    ("joints: 1, field: mass, uniform: [0, 1]", "35 .uniform value-out-of-bounds"),
    ("joints: 1, field: a, grid: {from: 1, points: 3}", "29 .grid.to key-missing"),
    ("joints: 1, field: a, normal: [1, 2]", "31 .normal value-of-other-kind"),
    ("joints: 1, field: a, normal: {mean: 0, deviation: 1, bounds: [8, 9]}", "63 .normal bounds-leave-nothing"),
]
SETTINGS = {
    "transfrom.options.x=1": "setting-section-unknown",
    "x": "setting-without-value",
    "inputs.0.path.x=1": "setting-leads-nowhere",
    "inputs.5=x": "setting-entry-unknown",
    "output={directory: [": "setting-unreadable",
}
# fmt: on


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("arm.csv", "a.stl"):
        Path(name).touch()


def problems(text: str, *settings: str) -> list[str]:
    Path("run.yaml").write_text(text)
    found = load_config(Path("run.yaml"), settings).problems
    places = [f"{each.mark.line}:{each.mark.column}" if each.mark and each.mark.line else each.mark for each in found]
    return [f"{place} {each.field} {each.code}" for place, each in zip(places, found, strict=True)]


@pytest.mark.parametrize(("text", "problem"), SLIPS)
def test_of_a_section(text: str, problem: str) -> None:
    text = text.replace("RULE", "joints: 1, field: a, scale: [1, 2]")
    assert problems(text if problem.startswith("1:") else f"inputs: arm.csv\n{text}\n") == [problem]


@pytest.mark.parametrize(("rule", "problem"), RULES)
def test_of_a_rule(rule: str, problem: str) -> None:
    column, _, rest = problem.partition(" ")
    where = f"variations.0.vary.0{'' if rest.startswith('.') else ' '}"
    given = f"inputs: arm.csv\nvariations: {{of: arm, count: 5, vary: [{{{rule}}}]}}\n"
    assert problems(given) == [f"2:{39 + int(column)} {where}{rest}"]


@pytest.mark.parametrize(("setting", "code"), SETTINGS.items())
def test_of_a_setting(setting: str, code: str) -> None:
    assert problems("inputs: arm.csv", setting) == [f"command line None {code}"]
