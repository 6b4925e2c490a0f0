"""A fault that is none of the chain leaves out what has it, with a notice; the arm is that of the file without it."""

from pathlib import Path

import pytest

import dh2urdf
from dh2urdf.errors import ProofError, TableError
from dh2urdf.kinematics import forward_kinematics
from dh2urdf_plugins.formats.mjcf.reader import read_mjcf
from dh2urdf_plugins.formats.sdf.reader import read_sdf
from dh2urdf_plugins.formats.urdf.reader import read_urdf

STRICT = {"urdf": read_urdf, "sdf": read_sdf, "mjcf": read_mjcf}
SUFFIX = {"urdf": "urdf", "sdf": "sdf", "mjcf": "xml"}
ARM = {
    form: (Path(__file__).parent / "files" / f"sound.{suffix}").read_text("utf-8") for form, suffix in SUFFIX.items()
}
Q = [0.4]


def written(folder: Path, form: str, was: str = "", now: str = "") -> Path:
    assert was in ARM[form]
    path = folder / f"arm.{SUFFIX[form]}"
    path.write_text(ARM[form].replace(was, now, 1) if was else ARM[form])
    return path


@pytest.mark.filterwarnings("ignore::dh2urdf.TableWarning")
@pytest.mark.parametrize(
    ("form", "was", "now", "line", "mass"),
    [
        ("urdf", 'value="2"', 'value="2kg"', 4, None),
        ("urdf", ' ixy="0"', "", 4, None),
        ("urdf", 'size="0.1 0.1 0.1"', 'size="0.1 0.1"', 5, 2.0),
        ("urdf", 'scale="1 1 1"', 'scale="1"', 6, 2.0),
        ("sdf", "<mass>2<", "<mass>2kg<", 4, None),
        ("sdf", "<size>0.1 0.1 0.1<", "<size>0.1 0.1<", 5, 2.0),
        ("mjcf", 'mass="2"', 'mass="2kg"', 3, None),
        ("mjcf", 'size="0.05 0.05 0.05"', 'size="0.05 0.05"', 4, 2.0),
    ],
)
def test_a_mass_or_a_shape(  # noqa: PLR0917 - a row of the table above
    tmp_path: Path, form: str, was: str, now: str, line: int, mass: float | None
) -> None:
    sound = dh2urdf.read(written(tmp_path, form))
    path = written(tmp_path, form, was, now)
    arm = dh2urdf.read(path)
    assert forward_kinematics(arm, Q) == forward_kinematics(sound, Q)
    assert sound.rows[0].mass == 2
    assert arm.rows[0].mass == mass
    assert line in [notice.mark.line for notice in arm.notices if notice.mark]
    with pytest.raises(ProofError):  # of a file of ours, it is a fault
        STRICT[form](path)


@pytest.mark.filterwarnings("ignore::dh2urdf.TableWarning")
@pytest.mark.parametrize(
    ("form", "was", "now", "line"),
    [
        ("urdf", 'velocity="1"', 'velocity="1rad/s"', 10),
        ("urdf", 'effort="10"', 'effort="10Nm"', 10),
        ("sdf", "<lower>", '<velocity>2.35"</velocity><lower>', 8),
        ("mjcf", 'axis="0 1 0"', 'axis="0 1 0" damping="soft"', 2),
    ],
)
def test_what_bounds_no_motion(tmp_path: Path, form: str, was: str, now: str, line: int) -> None:
    """As the velocity of a published iiwa in SDF, which ends with a quotation mark."""
    sound = dh2urdf.read(written(tmp_path, form))
    arm = dh2urdf.read(written(tmp_path, form, was, now))
    assert forward_kinematics(arm, Q) == forward_kinematics(sound, Q)
    assert (arm.rows[0].limits.lower, arm.rows[0].limits.upper) == (
        sound.rows[0].limits.lower,
        sound.rows[0].limits.upper,
    )
    assert line in [notice.mark.line for notice in arm.notices if notice.mark]


BRANCH = """<link name="imu"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="carries" type="fixed"><parent link="upper"/><child link="imu"/><origin xyz="$(optenv XYZ 0 0 0)"/></joint>
</robot>"""


@pytest.mark.filterwarnings("ignore::dh2urdf.TableWarning")
def test_a_joint_of_a_branch(tmp_path: Path) -> None:
    """As of the camera of a published Husky: nobody knows where its link is, so that the arm has nothing of it."""
    sound = dh2urdf.read(written(tmp_path, "urdf"))
    path = written(tmp_path, "urdf", "</robot>", BRANCH)
    arm = dh2urdf.read(path)
    assert forward_kinematics(arm, Q) == forward_kinematics(sound, Q)
    assert arm.rows[0].mass == 2
    assert 13 in [notice.mark.line for notice in arm.notices if notice.mark]
    with pytest.raises(TableError):
        dh2urdf.read(path, tip_link="imu")
    with pytest.raises(ProofError):
        read_urdf(path)


@pytest.mark.filterwarnings("ignore::dh2urdf.TableWarning")
@pytest.mark.parametrize(
    ("form", "was", "now"),
    [
        ("urdf", 'xyz="0 0 0.3"', 'xyz="0 0 0.3m"'),
        ("urdf", 'upper="1"', 'upper="1rad"'),
        ("sdf", "0 0 0.3 0 0 0", "0 0 0.3m 0 0 0"),
        ("mjcf", 'pos="0 0 0.3"', 'pos="0 0 0.3m"'),
    ],
)
def test_a_number_of_the_chain_is_an_error(tmp_path: Path, form: str, was: str, now: str) -> None:
    with pytest.raises(TableError):
        dh2urdf.read(written(tmp_path, form, was, now))
