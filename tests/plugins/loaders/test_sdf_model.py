from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from dh2urdf_plugins.loaders.gazebo.sdf_model import parse_sdf

if TYPE_CHECKING:
    from dh2urdf.rotations import RigidTransform

BODY = "<inertial><mass>2</mass></inertial>"

# A column that turns about a joint frame aside of its own, a slider on it, and a frame on the slider.
SDF = f"""<sdf version="1.9"><model name="m">
  <link name="column"><pose>0 0 1 0 0 0</pose>{BODY}</link>
  <link name="slider"><pose relative_to="slide">0 0 0.5 0 0 0</pose>
    <inertial><pose>0.1 0 0 0 0 1.5707963267948966</pose><mass>3</mass>
      <inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>
  <joint name="turn" type="revolute"><pose>1 0 0 0 0 0</pose><parent>world</parent><child>column</child>
    <axis><xyz>0 0 1</xyz><limit><lower>-1e16</lower><upper>1e16</upper><velocity>-1</velocity></limit></axis></joint>
  <joint name="slide" type="prismatic"><pose relative_to="column">0 0 0 0 1.5707963267948966 0</pose>
    <parent>column</parent><child>slider</child>
    <axis><xyz>0 0 1</xyz><limit><lower>0</lower><upper>2</upper><effort>5</effort><velocity>3</velocity></limit></axis>
  </joint>
  <frame name="tip" attached_to="slider"><pose>0 0 0.25 0 0 0</pose></frame>
  <frame name="middle" attached_to="tip"><pose relative_to="slider">0 0 0.1 0 0 0</pose></frame>
</model></sdf>"""


def at(frame: RigidTransform) -> tuple[float, ...]:
    return pytest.approx(frame.translation, abs=1e-12)


def test_frames_follow_the_joints() -> None:
    """A joint turns its child about its own frame's axis, wherever that is; frames move with their link."""
    model = parse_sdf(SDF.encode())
    still = model.frames({})
    assert still["column"].translation == (0.0, 0.0, 1.0)
    assert at(still["slider"]) == (0.5, 0.0, 1.0)  # the joint's z lies along x
    assert at(still["tip"]) == (0.75, 0.0, 1.0)
    assert at(still["middle"]) == (0.6, 0.0, 1.0)
    moved = model.frames({"turn": math.pi / 2, "slide": 0.25})
    assert at(moved["column"]) == (1.0, -1.0, 1.0)
    assert at(moved["slider"]) == (1.0, -0.25, 1.0)
    assert at(moved["tip"]) == (1.0, 0.0, 1.0)


def test_endless_limits_are_none() -> None:
    """What sdformat writes for no limit, 1e16 and −1, and what it leaves out, is none."""
    turn, slide = parse_sdf(SDF.encode()).joints
    assert (turn.lower, turn.upper, turn.velocity, turn.effort) == (None, None, None, None)
    assert (slide.lower, slide.upper, slide.velocity, slide.effort) == (0.0, 2.0, 3.0, 5.0)


def test_inertia_is_told_in_the_link_frame() -> None:
    """The pose of an inertial turns its tensor and places its centre; what SDF is not told, it takes for 1."""
    links = parse_sdf(SDF.encode()).links
    assert links["slider"].com == (0.1, 0.0, 0.0)
    assert links["slider"].inertia == pytest.approx((2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.5))
    assert (links["column"].mass, links["column"].inertia[0]) == (2.0, 1.0)
    assert parse_sdf(SDF.replace(BODY, "").encode()).links["column"].mass == 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no XML"),
        ("<sdf/>", "no model"),
        (SDF.replace("<parent>world</parent>", "<parent>slider</parent>"), "a loop"),
        (SDF.replace("<parent>world</parent>", "<parent>tip</parent>"), "other things than links"),
    ],
)
def test_other_texts_are_refused(text: str, message: str) -> None:
    """A text that is no XML, has no model, or has joints in a loop is refused in words."""
    with pytest.raises(ValueError, match=message):
        parse_sdf(text.encode())


def test_long_chain_is_no_recursion() -> None:
    """A thousand joints are followed from link to link, without a call in a call."""
    links = ['<link name="l0"/>']
    for number in range(1, 1001):
        links.append(f'<link name="l{number}"><pose relative_to="j{number}">0 0 0 0 0 0</pose></link>')
        links.append(
            f'<joint name="j{number}" type="prismatic"><pose relative_to="l{number - 1}">0.5 0 0 0 0 0</pose>'
            f"<parent>l{number - 1}</parent><child>l{number}</child><axis><xyz>0 0 1</xyz></axis></joint>"
        )
    model = parse_sdf(f'<sdf><model name="long">{"".join(links)}</model></sdf>'.encode())
    assert model.frames({"j1000": 2.0})["l1000"].translation == (500.0, 0.0, 2.0)
