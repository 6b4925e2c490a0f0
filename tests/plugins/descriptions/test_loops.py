"""A chain that is part of a closed loop has no table, in whatever format it is described; a chain beside the loop has one."""

from pathlib import Path

import pytest

import dh2urdf
from dh2urdf.errors import Dh2UrdfError

BODY = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
LINKS = ("base", "crank", "coupler", "rocker", "arm", "hand")
JOINTS = (
    ("j1", "base", "crank"),
    ("j2", "crank", "coupler"),
    ("j3", "base", "rocker"),
    ("j4", "rocker", "coupler"),
    ("j5", "base", "arm"),
    ("j6", "arm", "hand"),
)
"""A four-bar, and an arm of two joints beside it."""


def urdf() -> str:
    links = "".join(f'<link name="{link}">{BODY}</link>' for link in LINKS)
    joints = "".join(
        f'<joint name="{name}" type="continuous"><origin xyz="1 0 0"/><parent link="{parent}"/><child link="{child}"/>'
        '<axis xyz="0 0 1"/></joint>'
        for name, parent, child in JOINTS
    )
    return f'<robot name="r">{links}{joints}</robot>'


def sdf() -> str:
    links = "".join(f'<link name="{link}"/>' for link in LINKS)
    joints = "".join(
        f'<joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child><axis><xyz>0 0 1</xyz>'
        "</axis></joint>"
        for name, parent, child in JOINTS
    )
    return f'<sdf version="1.7"><model name="r">{links}{joints}</model></sdf>'


INNER = '<joint name="{}" axis="0 0 1"/><geom size="0.1" mass="1"/>'
MJCF = f"""<mujoco><worldbody><body name="base"><geom size="0.1" mass="1"/>
<body name="crank" pos="1 0 0">{INNER.format("j1")}<body name="coupler" pos="1 0 0">{INNER.format("j2")}
<site name="end" pos="1 0 0"/></body></body>
<body name="rocker" pos="1 1 0">{INNER.format("j3")}<site name="top" pos="1 0 0"/></body>
<body name="arm" pos="0 1 0">{INNER.format("j5")}<body name="hand" pos="1 0 0">{INNER.format("j6")}</body></body>
</body><body name="target" mocap="true"/><body name="ball"><freejoint name="f"/><geom size="0.1" mass="1"/></body>
</worldbody><equality>{{}}</equality></mujoco>"""
CONNECT = '<connect body1="coupler" body2="rocker" anchor="1 0 0"/>'
FORMS = {
    "urdf": urdf(),
    "sdf": sdf(),
    "connect": MJCF.format(CONNECT),
    "sites": MJCF.format('<connect site1="end" site2="top"/>'),
    "weld": MJCF.format('<weld body1="coupler"/>'),
}
OPEN = {
    "not active": MJCF.format(CONNECT.replace("/>", ' active="false"/>')),
    "a target": MJCF.format('<weld body1="target" body2="coupler"/>'),
    "a ball that it holds": MJCF.format('<weld body1="coupler" body2="ball"/>'),
}


def written(folder: Path, form: str) -> Path:
    text = {**FORMS, **OPEN}[form]
    path = folder / f"r.{form if form in {'urdf', 'sdf'} else 'xml'}"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("form", FORMS)
def test_a_chain_in_a_loop_is_refused(tmp_path: Path, form: str) -> None:
    """Its joints do not move on their own, and those of a table do; a chain beside the loop is an arm."""
    with pytest.raises(Dh2UrdfError) as caught:
        dh2urdf.extract(written(tmp_path, form), base_link="base", tip_link="coupler")
    assert caught.value.problems[0].code == "chain-in-loop"
    found = dh2urdf.extract(written(tmp_path, form), base_link="base", tip_link="hand")
    assert len(found.moving_rows) == 2


@pytest.mark.parametrize("form", OPEN)
def test_what_closes_no_loop_keeps_no_chain_from_its_table(tmp_path: Path, form: str) -> None:
    """A constraint that is not active, one to what a mouse drags, and one to what would fly otherwise."""
    found = dh2urdf.extract(written(tmp_path, form), base_link="base", tip_link="coupler")
    assert len(found.moving_rows) == 2


@pytest.mark.parametrize("form", ["connect", "sites", "weld", *OPEN])
def test_mujoco_loads_the_models(tmp_path: Path, form: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    mujoco.MjModel.from_xml_path(str(written(tmp_path, form)))
