"""What is fixed is right, and every other byte is as it was."""

import re
from pathlib import Path

import pytest
from faulty_files import ELBOW_AXIS, LINK_2_INERTIA, SOUND

from dh2urdf.errors import InputError
from dh2urdf_check.fixing import fixed
from dh2urdf_check.inspection import inspect_urdf

FAULTS = {
    "axis-not-unit": (ELBOW_AXIS, "<axis  xyz = '0 2 0' />", "<axis  xyz = '0 1 0' />"),
    "swapped-limits": ('lower="-2" upper="2"', 'upper="-2.50" lower="2"', 'upper="2" lower="-2.50"'),
    "no-xml-declaration": ('<?xml version="1.0" encoding="utf-8"?>\n', "", '<?xml version="1.0" encoding="utf-8"?>\n'),
    "name-characters": ('<joint name="elbow"', '<joint name="the &amp; elbow"', '<joint name="the_elbow"'),
}


@pytest.mark.parametrize("rule", FAULTS)
def test_a_fault_is_fixed_at_its_place(tmp_path: Path, rule: str) -> None:
    """Quotes, spaces and comments stay; the rule is broken no more, and what was done is printed once."""
    old, wrong, right = FAULTS[rule]
    text = SOUND.replace("<link name", "<!-- a  comment\t-->\n  <link name", 1)
    path = tmp_path / "arm.urdf"
    path.write_text(text.replace(old, wrong))
    assert rule in {finding.rule for finding in inspect_urdf(path).findings}
    repair = fixed(path)
    assert repair.content.decode() == text.replace(old, right)
    assert len(repair.changes) == 1
    path.write_bytes(repair.content)
    assert rule not in {finding.rule for finding in inspect_urdf(path).findings}
    assert fixed(path).changes == ()


def test_a_sound_file_stays_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(SOUND)
    assert fixed(path).content == SOUND.encode()


def test_the_inertia_of_a_mass_is_that_of_a_ball(tmp_path: Path) -> None:
    """1 kg of aluminium: 4/3·π·r³·2700 = 1 has r = 44.55 mm, and 2/5·r² is 7.938e-4 kg·m²."""
    path = tmp_path / "arm.urdf"
    zero = '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0.0"/>'
    path.write_text(SOUND.replace(LINK_2_INERTIA, zero))
    content = fixed(path).content.decode()
    moments = re.search(r'<inertia ixx="(0\.0007\d+)" ixy="0" ixz="0" iyy="\1" iyz="0" izz="\1"/>', content)
    assert moments
    assert float(moments[1]) == pytest.approx(0.4 * 0.04455**2, rel=1e-3)
    assert content.count('ixx="0"') == SOUND.count('ixx="0"')  # frames without mass stay so


def test_names_are_changed_wherever_they_are_spoken_of(tmp_path: Path) -> None:
    """The new name is nobody else's."""
    path = tmp_path / "arm.urdf"
    path.write_text(SOUND.replace('"link_1"', '"link 1"').replace('"flange"', '"link_1"'))
    content = fixed(path).content.decode()
    assert content == SOUND.replace('"link_1"', '"link_1_"').replace('"flange"', '"link_1"')


@pytest.mark.parametrize("content", [b"<robot", b"", SOUND.encode("utf-16")])
def test_what_is_no_xml_in_utf_8_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "arm.urdf"
    path.write_bytes(content)
    with pytest.raises(InputError):
        fixed(path)
