import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given, settings, strategies as st

from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.robot import Box, Collision, Cylinder, Inertial, Joint, Link, Material, Mesh, Origin, Robot, Sphere, Visual
from dh2urdf.stages import Emitter, ReadsBack
from dh2urdf_plugins.formats.urdf import EMITTER as URDF
from dh2urdf_plugins.formats.xacro import EMITTER as XACRO

numbers = st.floats(allow_nan=False, allow_infinity=False)
angles = numbers | st.sampled_from([k * 3.141592653589793 / m for k in range(-6, 7) for m in (1, 2, 3, 4, 6)])
vectors = st.tuples(numbers, numbers, numbers)
# Text that means something to XML, to xacro or to Python, between text that means nothing.
MARKUP = "$ $$ ${ } $( ) ${1/0} ${prefix} ' \" & &amp; < > <!-- --> ]]> -- xacro:eval-comments"
hostile = st.sampled_from([*MARKUP.split(), "$(arg prefix)", "$(find x)", " ", "\u00a0", "\u2028"]) | st.sampled_from(
    ["\\", "%s", "{0}", "007", "1e3", "true", "é", "🦾"]
)
texts = st.lists(hostile | st.text(st.characters(exclude_categories=("Cc", "Cs", "Cn")), max_size=8), min_size=1).map(
    "".join
)
origins = st.builds(Origin, xyz=vectors, rpy=st.tuples(angles, angles, angles))
geometries = (
    st.builds(Box, size=vectors)
    | st.builds(Cylinder, radius=numbers, length=numbers)
    | st.builds(Sphere, radius=numbers)
    | st.builds(Mesh, filename=texts, scale=vectors)
)
inertias = st.builds(Inertia, **dict.fromkeys(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), numbers))
inertials = st.builds(Inertial, mass=numbers, com=vectors, inertia=inertias)


@st.composite
def robots(draw: st.DrawFn) -> Robot:
    """Robots that use everything that a robot may hold, in chains and trees."""
    names = draw(st.lists(texts, min_size=1, max_size=9, unique=True))
    count = (len(names) + 1) // 2
    paints = draw(
        st.lists(
            st.builds(Material, name=texts, rgba=st.tuples(numbers, numbers, numbers, numbers)),
            max_size=2,
            unique_by=lambda paint: paint.name,
        )
    )
    visuals = st.builds(
        Visual,
        geometry=geometries,
        origin=origins,
        material=st.none() | st.sampled_from(paints) if paints else st.none(),
    )
    collisions = st.builds(Collision, geometry=geometries, origin=origins)
    links = tuple(
        Link(
            name=name,
            inertial=draw(st.none() | inertials),
            visuals=tuple(draw(st.lists(visuals, max_size=2))),
            collisions=tuple(draw(st.lists(collisions, max_size=2))),
        )
        for name in names[:count]
    )
    return Robot(
        name=draw(texts),
        links=links,
        joints=tuple(
            draw(joints(name, links[draw(st.integers(0, index))].name, links[index + 1].name))
            for index, name in enumerate(names[count : 2 * count - 1])
        ),
        comment=draw(st.text()),
    )


def joints(name: str, parent: str, child: str) -> st.SearchStrategy[Joint]:
    ends = {"name": st.just(name), "parent": st.just(parent), "child": st.just(child), "origin": origins}
    motion: dict[str, Any] = {"axis": vectors, "damping": st.none() | numbers, "friction": st.none() | numbers}
    speed = {"velocity": angles, "effort": numbers}
    bounded = st.builds(Limits, lower=angles, upper=angles, **speed)
    return (
        st.builds(Joint, type=st.just(JointType.FIXED), **ends)
        | st.builds(Joint, type=st.just(JointType.CONTINUOUS), limits=st.builds(Limits, **speed), **ends, **motion)
        | st.builds(
            Joint, type=st.sampled_from([JointType.REVOLUTE, JointType.PRISMATIC]), limits=bounded, **ends, **motion
        )
    )


@pytest.mark.long
@pytest.mark.parametrize("emitter", [URDF, XACRO], ids=lambda emitter: emitter.name)
@given(robot=robots())
@settings(max_examples=60, deadline=None)
def test_what_is_written_reads_back_as_the_same_robot(emitter: Emitter[Any], robot: Robot) -> None:
    """Every name, to the letter, and every number, to the bit, whatever the names mean to XML or to xacro."""
    with tempfile.TemporaryDirectory() as folder:
        files = emitter.emit(robot, "robot", emitter.options())
        for file in files:
            (Path(folder) / file.name).write_bytes(file.content)
        reads = emitter.can(ReadsBack)
        assert reads.read_back(Path(folder) / files[0].name) == robot


def urdf(robot: Robot) -> str:
    (file,) = URDF.emit(robot, "stem", URDF.options())
    return file.content.decode("utf-8")


def renamed(robot: Robot, old: str, new: str) -> Robot:
    """The robot with another name for a link."""
    return replace(
        robot,
        links=tuple(replace(link, name=new) if link.name == old else link for link in robot.links),
        joints=tuple(
            replace(
                joint,
                parent=new if joint.parent == old else joint.parent,
                child=new if joint.child == old else joint.child,
            )
            for joint in robot.joints
        ),
    )


def test_a_comment_ends_where_it_should(arm: Robot) -> None:
    """Two hyphens and control characters, which a path may hold, do not end or garble the comment."""
    text = urdf(replace(arm, comment="from ----><robot> \x1b[2J\n--"))
    assert text.splitlines()[1] == r"<!-- from - - - -><robot> \x1b[2J\n- - -->"
    assert ET.fromstring(text).tag == "robot"  # noqa: S314


def test_no_line_is_longer_than_readers_take(arm: Robot) -> None:
    """PyBullet cuts a line of more than 8 kB without a word, so such a name is refused; a comment is cut."""
    assert max(map(len, urdf(replace(arm, comment="x" * 100_000)).splitlines())) < 8000
    with pytest.raises(EmitterError) as caught:
        urdf(renamed(arm, "link_2", "é" * 4000))
    assert [problem.code for problem in caught.value.problems] == ["line-too-long"]
