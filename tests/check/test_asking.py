"""`dh2urdf check` asks the programs that are installed: what they refuse, print, lose and change is seen."""

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from command_line import Cli
from consumers import require
from faulty_files import collada

import dh2urdf
from dh2urdf.plugin_system.catalog import load
from dh2urdf.stages import Question
from dh2urdf_check.ask import urdfdom
from dh2urdf_check.ask.asking import Asked, answering, programs

BODY = '<inertial><mass value="{}"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
JOINT = (
    '<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
    '<origin xyz="0 0 0.3"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="10" velocity="1"/>{more}</joint>'
)
SDF = (
    '<?xml version="1.0"?>\n<sdf version="1.9"><model name="m"><link name="base">{base}</link>'
    '<link name="arm"/><joint name="j" type="revolute"><parent>base</parent><child>arm</child>'
    "<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>\n"
)
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
ASSET = '<asset><unit meter="{}"/><up_axis>Z_UP</up_axis></asset>'


def urdf(base: str = BODY.format(9), arm: str = BODY.format(2), more: str = "", joint: str = "") -> str:
    """Two links, and what else is in the robot or in its joint."""
    first = JOINT.format(name="j1", parent="base", child="arm", more=joint)
    return (
        f'<?xml version="1.0"?>\n<robot name="r">\n<link name="base">{base}</link>\n'
        f'<link name="arm">{arm}</link>\n{first}\n{more}\n</robot>\n'
    )


def mesh(name: str) -> str:
    return f'<collision><geometry><mesh filename="{name}"/></geometry></collision>'


@pytest.fixture
def told(cli: Cli, tmp_path: Path) -> Callable[..., dict[str, Any]]:
    """What `check` finds in a text, as its JSON."""

    def check(text: str, *words: str, name: str = "arm.urdf", status: int = 0) -> dict[str, Any]:
        (tmp_path / name).write_text(text)
        document: dict[str, Any] = json.loads(cli("check", name, *words, "--json", status=status).stdout)
        return document

    return check


def seen(document: dict[str, Any], consumer: str) -> dict[str, dict[str, Any]]:
    """By rule, the findings with something that was seen in a consumer's program."""
    return {
        finding["rule"]: {**finding, **finding["consumers"][consumer]}
        for finding in document["findings"]
        if (finding["consumers"].get(consumer) or {}).get("seen")
    }


def test_a_program_says_which_it_is(told: Any) -> None:
    """With its version, in the findings and in the list of those that were asked."""
    require("mujoco")
    document = told(urdf(), "--for", "mujoco")
    assert document["asked"]["mujoco"] == {"program": "MuJoCo 4.0.0", "end": "loads"}
    assert seen(document, "mujoco")["root-merged"]["seen"] == "MuJoCo 4.0.0"


def test_python_asks_where_it_is_told_to(tmp_path: Path) -> None:
    require("mujoco")
    (tmp_path / "arm.urdf").write_text(urdf())
    seen_in = [
        {name for finding in dh2urdf.check(tmp_path / "arm.urdf", ask=ask).findings for name in finding.seen}
        for ask in (False, True)
    ]
    assert ["MuJoCo 4.0.0" in names for names in seen_in] == [False, True]


def test_nobody_is_asked_where_the_user_wants_that(told: Any) -> None:
    document = told(urdf(), "--no-ask")
    assert document["asked"] == {}
    assert all(does["seen"] is None for each in document["findings"] for does in each["consumers"].values())


def test_only_the_programs_that_are_named_are_asked(told: Any) -> None:
    require("pinocchio", "mujoco")
    assert list(told(urdf(), "--for", "pinocchio")["asked"]) == ["pinocchio"]


def test_a_refusal_is_at_the_joint_that_the_program_names(told: Any) -> None:
    """In the program's words; what one program refuses is not said of the others."""
    require("ros", "pinocchio", "mujoco")
    document = told(urdf(joint='<calibration rising="x"/>'), status=1)
    for consumer in ("ros", "pinocchio"):
        found = seen(document, consumer)["calibration-text"]
        assert "not a valid float" in found["does"]
        assert (found["severity"], found["line"]) == ("error", 5)
    assert document["asked"]["mujoco"]["end"] == "loads"


def test_a_crash_is_a_finding_and_the_other_files_are_asked(cli: Cli, tmp_path: Path) -> None:
    """The mesh ends PyBullet with a signal; in a new child it gets the next file."""
    require("pybullet")
    (tmp_path / "one.dae").write_text(collada(ASSET.format("").replace(' meter=""', ""), "0 0 0 2 0 0 0 2 0 0 0 2"))
    (tmp_path / "a.urdf").write_text(urdf(arm=BODY.format(2) + mesh("one.dae")))
    (tmp_path / "b.urdf").write_text(urdf())
    document = json.loads(cli("check", "a.urdf", "b.urdf", "--for", "pybullet", "--json", status=1).stdout)
    (crash,) = [each for each in document["findings"] if each["rule"] == "hollow-mesh"]
    assert crash["file"] == "a.urdf"
    assert "segmentation fault" in crash["consumers"]["pybullet"]["does"]
    assert document["asked"] == {"PyBullet 3.2.7": {"crashes": 1, "loads": 1}}


def test_a_mesh_across_the_principal_axes_has_one_size(told: Any, tmp_path: Path) -> None:
    """PyBullet has the vertices along the principal axes of the link: the body is as large there as elsewhere."""
    skew = BODY.format(2).replace('ixy="0"', 'ixy="0.04"')
    corners = [(x, y, z) for x in (0, 3) for y in (0, 0.2) for z in (0, 0.1)]
    quads = ("1243", "5687", "1562", "3487", "1375", "2684")
    triangles = [f"f {a} {b} {c}\nf {a} {c} {d}" for a, b, c, d in quads]
    text = "\n".join([*(f"v {x} {y} {z}" for x, y, z in corners), *triangles, ""])
    (tmp_path / "long.obj").write_text(text)
    document = told(urdf(arm=skew + mesh("long.obj")))
    assert [each for each in document["findings"] if each["rule"] == "seen-mesh-size"] == []


def test_units_of_a_mesh_that_two_programs_read_otherwise(told: Any, tmp_path: Path) -> None:
    """PyBullet multiplies by the unit of COLLADA, Pinocchio does not."""
    require("pybullet", "pinocchio")
    for factor, name in ((0.01, "hundredth"), (1, "metre")):
        (tmp_path / f"{name}.dae").write_text(collada(ASSET.format(factor), "0 0 0 2 0 0 0 2 0 0 0 2"))
    found = seen(told(urdf(arm=BODY.format(2) + mesh("hundredth.dae")), status=1), "pybullet")["collada-unit"]
    assert "0.01 times as large" in found["does"]
    assert (
        not {"seen-mesh-size", "collada-unit"}
        & seen(told(urdf(arm=BODY.format(2) + mesh("metre.dae")), status=1), "pybullet").keys()
    )


def test_what_mujoco_makes_of_the_root(told: Any) -> None:
    """Its name and its mass are gone."""
    require("mujoco")
    found = seen(told(urdf()), "mujoco")["root-merged"]
    assert (found["severity"], found["line"]) == ("note", 3)
    assert "9 of 11 kg are gone" in found["does"]


def test_a_joint_that_follows_another_one_does_not_in_pybullet(told: Any) -> None:
    require("pybullet", "mujoco", "drake")
    second = JOINT.format(name="j2", parent="arm", child="hand", more='<mimic joint="j1" multiplier="2"/>')
    document = told(urdf(more=f'<link name="hand">{BODY.format(1)}</link>{second}'))
    does = " ".join(each["does"] for each in seen(document, "pybullet").values())
    assert "does not follow 'j1'" in does
    for consumer in ("mujoco", "drake"):
        assert "does not follow" not in " ".join(each["does"] for each in seen(document, consumer).values())


def test_an_inertia_that_pybullet_does_not_take(told: Any) -> None:
    """It prints that, and has another one; MuJoCo refuses the file."""
    require("pybullet", "mujoco")
    impossible = BODY.format(2).replace('izz="0.1"', 'izz="0.9"')
    document = told(urdf(arm=impossible), status=1)
    assert "mujoco" in document["asked"]
    assert document["asked"]["mujoco"]["end"] == "refuses"
    assert any("inertia" in each["does"] for each in seen(document, "pybullet").values())
    assert any("A + B >= C" in each["does"] for each in seen(document, "mujoco").values())


def test_a_mass_below_0_does_not_end_the_command(told: Any) -> None:
    """PyBullet loads it, and the inertia that it has is compared with that of a body which no robot has."""
    require("pybullet")
    document = told(urdf(arm=BODY.format(-2)), "--for", "pybullet")
    assert document["asked"]["pybullet"]["end"] == "loads"


@pytest.mark.parametrize("consumer", ["pybullet", "mujoco", "pinocchio", "drake", "gazebo"])
def test_a_good_file_is_the_same_in_every_program(told: Any, consumer: str) -> None:
    """Links, masses, centres, axes, limits, shapes and poses: nothing but what is merged or held by the world."""
    require(consumer)
    box = '<collision><origin xyz="0.1 0 0"/><geometry><box size="0.1 0.2 0.3"/></geometry></collision>'
    off = BODY.format(2).replace("<mass", '<origin xyz="0.1 0.02 0.03" rpy="0.3 0 0"/><mass')
    second = JOINT.format(name="j2", parent="arm", child="hand", more="").replace("0 0 0.3", "0.1 0.2 0.3")
    second = second.replace('<axis xyz="0 1 0"/>', '<axis xyz="0.6 0 0.8"/>').replace("<axis", "<axis", 1)
    text = urdf(arm=off + box, more=f'<link name="hand">{BODY.format(1)}</link>{second}')
    document = told(text, "--for", consumer)
    assert document["asked"][consumer]["end"] == "loads"
    assert set(seen(document, consumer)) <= {"root-merged"}


def test_links_may_come_before_what_holds_them(told: Any) -> None:
    """The root of a file is the link that nothing holds, wherever it is: it was taken for the first one."""
    require("pinocchio")
    first = JOINT.format(name="j1", parent="base", child="arm", more="")
    second = JOINT.format(name="j2", parent="arm", child="hand", more="")
    links = "".join(f'<link name="{name}">{BODY.format(1)}</link>' for name in ("hand", "arm", "base"))
    text = f'<?xml version="1.0"?>\n<robot name="r">{links}{second}{first}</robot>\n'
    document = told(text, "--for", "pinocchio")
    assert document["asked"]["pinocchio"]["end"] == "loads"
    assert seen(document, "pinocchio") == {}


def test_what_our_own_reader_refuses_behind_the_fence(told: Any) -> None:
    """A joint that our reader does not take: that sdformat takes the file is known all the same."""
    require("gazebo")
    text = SDF.format(base="").replace('type="revolute"', 'type="ball"')
    assert told(text, "--for", "gazebo", name="arm.sdf")["asked"]["gazebo"]["end"] == "loads"


def test_a_xacro_is_given_as_what_it_expands_to(cli: Cli, tmp_path: Path) -> None:
    """Places are those of the xacro; files beside it are found."""
    require("mujoco")
    text = urdf(arm=BODY.format("${1 + 1}") + mesh("part.obj"))
    (tmp_path / "arm.urdf.xacro").write_text(
        text.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"')
    )
    (tmp_path / "part.obj").write_text(OBJ)
    document = json.loads(cli("check", "arm.urdf.xacro", "--for", "mujoco", "--json").stdout)
    assert document["asked"]["mujoco"]["end"] == "loads"
    assert seen(document, "mujoco")["root-merged"]["line"] == 3


def test_what_a_xacro_expands_to_is_in_its_package(cli: Cli, tmp_path: Path) -> None:
    """PyBullet looks for packages in the folders above a file: it refused 23 of 27 published xacros elsewhere."""
    require("pybullet")
    package = tmp_path / "src" / "arm_support"
    for folder in ("urdf", "meshes"):
        (package / folder).mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>arm_support</name></package>")
    (package / "meshes" / "part.obj").write_text(OBJ)
    text = urdf(arm=BODY.format(2) + mesh("package://arm_support/meshes/part.obj"))
    (package / "urdf" / "arm.urdf.xacro").write_text(text)
    words = ("check", str(package / "urdf" / "arm.urdf.xacro"), "--for", "pybullet", "--json")
    assert json.loads(cli(*words).stdout)["asked"]["pybullet"]["end"] == "loads"


def test_a_file_of_two_roots_does_not_end_the_command(told: Any) -> None:
    """As the linkages of Drake's Strandbeest: no chain led from the first root to the links below the second."""
    require("drake")
    other = f'<link name="floor">{BODY.format(1)}</link><link name="post">{BODY.format(1)}</link>'
    other += JOINT.format(name="j2", parent="floor", child="post", more="")
    assert told(urdf(more=other), "--for", "drake")["asked"]["drake"]["end"] == "loads"


def test_pybullet_is_not_asked_what_kills_it(told: Any) -> None:
    """PyBullet 3.2.7 loads the hopper of its own data, and crashes when it is asked for its shapes that touch."""
    require("pybullet")
    text = (
        '<mujoco model="hopper"><worldbody><body name="torso" pos="0 0 1.25"><joint name="slide" type="slide" '
        'axis="1 0 0"/><joint name="turn" type="hinge" axis="0 1 0"/><geom name="g" type="capsule" '
        'fromto="0 0 1.45 0 0 1.05" size="0.05"/></body></worldbody></mujoco>'
    )
    document = told(text, "--for", "pybullet", name="arm.xml", status=1)
    assert document["asked"]["pybullet"]["end"] == "loads"


def test_sdf_is_asked_too(told: Any) -> None:
    """An address of an unknown package, which Drake and PyBullet refuse and sdformat passes over."""
    require("drake", "pybullet", "gazebo")
    visual = '<visual name="v"><geometry><mesh><uri>package://gone/t.obj</uri></mesh></geometry></visual>'
    document = told(SDF.format(base=visual), name="arm.sdf", status=1)
    ends = {consumer: each["end"] for consumer, each in document["asked"].items()}
    assert ends == {"pybullet": "refuses", "drake": "refuses", "gazebo": "loads"}
    assert "unknown package" in " ".join(each["does"] for each in seen(document, "drake").values())


def test_an_mjcf_that_is_an_empty_world(told: Any) -> None:
    """MuJoCo loads it in silence: bodies beside `worldbody` are no bodies."""
    require("mujoco")
    text = '<mujoco><body name="b"><geom size="0.1"/></body></mujoco>'
    document = told(text, "--for", "mujoco", name="arm.xml", status=1)
    assert document["asked"]["mujoco"]["end"] == "loads"
    assert "seen-empty-world" in seen(document, "mujoco")


def test_a_program_is_behind_the_fence(tmp_path: Path) -> None:
    """It sees the folders that it is given, and no other: here the mesh is in one that it is not given."""
    require("mujoco")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "part.obj").write_text(OBJ)
    (tmp_path / "arm").mkdir()
    path = tmp_path / "arm" / "arm.urdf"
    mjcf = '<mujoco><compiler strippath="false"/></mujoco>'
    path.write_text(urdf(arm=BODY.format(2) + mesh(str(tmp_path / "elsewhere" / "part.obj")), more=mjcf))
    ends = []
    for readable in ((path.parent,), (path.parent, tmp_path / "elsewhere")):
        question = Question(path=path, format="urdf")
        with answering(programs(load(), ["mujoco"]), [Asked(question, readable)]) as answers:
            ((answer,),) = answers
        ends.append(answer.end)
    assert ends == ["refuses", "loads"]


def test_where_the_kernel_has_no_wall_nobody_is_asked(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Unless the user trusts the file; a notice says so."""
    from dh2urdf.isolation import fence

    (tmp_path / "arm.urdf").write_text(urdf())
    monkeypatch.setattr("dh2urdf_check.ask.findings.missing_wall", lambda: "this kernel offers no Landlock: none")
    monkeypatch.delenv(fence.TRUST, raising=False)
    answer = cli("check", "arm.urdf", "--json")
    assert json.loads(answer.stdout)["asked"] == {}
    assert answer.stderr.startswith("notice: ")


def test_what_a_program_cannot_show_stays_foretold(told: Any) -> None:
    """urdfdom tells the names of links, and nothing of their masses."""
    require("ros")
    effects = [
        finding["consumers"]["ros"]
        for finding in told(urdf(arm=BODY.format(2).replace('ixx="0.1"', 'ixx="9"')), "--for", "ros")["findings"]
    ]
    assert [effect["seen"] for effect in effects if effect["severity"] == "warning"] == [None]


def test_the_urdfdom_of_a_wheel_is_asked_itself(told: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The script of its name in a virtual environment makes a folder before it starts it, and no fence allows that."""
    require("pinocchio")
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent))
    urdfdom.command.cache_clear()
    try:
        assert told(urdf(), "--for", "ros")["asked"]["ros"]["end"] == "loads"
    finally:
        urdfdom.command.cache_clear()


def test_what_is_foretold_and_was_not_seen_is_left_out(told: Any) -> None:
    """A finding of a rule says where it was seen; of a program that was asked nothing else is foretold."""
    require("pybullet")
    text = urdf(
        more='<link name="tool0"/><joint name="t" type="fixed"><parent link="arm"/><child link="tool0"/></joint>'
    )
    document = told(text)
    foretold = [
        (each["rule"], consumer)
        for each in document["findings"]
        for consumer, does in each["consumers"].items()
        if does["seen"] is None and consumer in {"pybullet", "mujoco", "pinocchio", "drake"} & set(document["asked"])
    ]
    assert foretold == []
    assert "tool0" in seen(document, "pybullet")["frame-without-inertial"]["does"]


def test_many_files_in_one_command(cli: Cli, tmp_path: Path) -> None:
    """Each simulator is imported once: a file more costs a fork."""
    require("pybullet", "mujoco", "pinocchio", "drake")
    (tmp_path / "many").mkdir()
    for number in range(12):
        (tmp_path / "many" / f"{number}.urdf").write_text(urdf(base=BODY.format(number + 1)))
    begun = time.monotonic()
    document = json.loads(cli("check", "many", "--json").stdout)
    assert all(sum(ends.values()) == 12 for ends in document["asked"].values())
    assert time.monotonic() - begun < 60
