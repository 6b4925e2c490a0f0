# ruff: noqa: ISC004 - what is printed is one text
"""What simulators say: a faulty file is refused in their own words, and what they print becomes findings, each once."""

import re
from typing import Any

import pytest

from dh2urdf.errors import LoaderError
from dh2urdf.plugin_system import load
from dh2urdf.stages import ReadsOutput

CATALOG = load()
ELBOW, AXIS, NO_AXIS = 'name="elbow"', '<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>'
LIMIT = '<limit lower="-2" upper="2" effort="30" velocity="3"/>'
INERTIA = '<inertia ixx="0.004" ixy="0.0003" ixz="0.0001" iyy="0.03" iyz="-0.0002" izz="0.031"/>'
FAULTY = {
    "pinocchio": [
        (' effort="60"', "", "Pinocchio cannot load the file.*no effort"),
        ("<robot ", "<", "XML"),
        (INERTIA, "", "another inertia of the link 'upper_arm'.*printed 'Inertial element must have inertia element'"),
    ],
    "drake": [
        ('lower="-2" upper="2.5"', 'lower="2.5" upper="-2"', "pos_lower_limits.* failed"),  # SystemExit
        (AXIS, NO_AXIS, "line 19: .*axis is zero"),
        ("</robot>", '<link name="second_root"/>\n</robot>', "cannot simulate the arm: .*second_root"),
        ('iyy="0.03"', 'iyy="0.3"', "another inertia.*Drake printed 'line 23: warning: While parsing inertia matrix"),
    ],
    "gazebo": [
        (ELBOW, 'name="shoulder"', "cannot convert.*'shoulder' is not unique"),
        (AXIS, NO_AXIS, "finds the file invalid.*norm of the xyz vector"),
        # What it drops in silence, with all that hangs on it:
        ('<mass value="1"/>', '<mass value="0"/>', "lost the joint.*lost the link 'forearm'.*'slider'.*'hand'"),
    ],
    "mujoco": [
        ('mass value="2"', 'mass value="0"', "cannot load the file: .*mass and inertia of moving bodies"),
        ('<child link="tool0"/>', '<child link="upper_arm"/>', "multiple parents"),
        ("<robot ", "<", "XML"),
    ],
    "pybullet": [
        (LIMIT, "", "cannot load.*'Joint is of type REVOLUTE but it does not specify limits: elbow'.*'joint xml is not")
    ],
}


@pytest.mark.parametrize(
    ("name", "written", "instead", "said"), [(name, *each) for name, table in FAULTY.items() for each in table]
)
def test_a_faulty_file_is_refused_in_the_words_of_the_simulator(
    run: Any, request_for: Any, planar: Any, *, name: str, written: str, instead: str, said: str
) -> None:
    """What it raises, what makes it leave the interpreter, what it loses in silence; what it printed follows."""
    text = planar.for_mujoco if name == "mujoco" else planar.urdf
    assert written in text
    with pytest.raises(LoaderError) as caught:
        run(name, request_for(text.replace(written, instead, 1)))
    message = str(caught.value)
    assert re.search(said, message, re.DOTALL), message
    assert "\x1b" not in message


LINE = "         at line 63 in urdf_parser/src/model.cpp\n"
DRAKE = "Drake logged WARNING: {path}:30: warning: the inertia\n [1 2 3]\nis impossible\n"
BULLET = "b3Warning[BulletUrdfImporter.cpp,467]:\n"
UNSTABLE = "Nan, Inf or huge value in QACC at DOF 1. The simulation is unstable. Time = 1.3750."
PRINTED = {
    "pinocchio": (
        f"Warning: link 'a' material 'x' undefined.\n{LINE}Error:   joint 'b' is not unique.\n{LINE}",
        [
            "notice: Pinocchio printed 'link 'a' material 'x' undefined.'",
            "error: Pinocchio printed 'joint 'b' is not unique.'",
        ],
    ),
    "drake": (
        DRAKE + DRAKE + "Drake logged ERROR: worse\n",
        ["notice: Drake printed 'line 30: warning: the inertia [1 2 3] is impossible'", "error: Drake printed 'worse'"],
    ),
    "gazebo": (
        "Library error: libignition-tools-backward.so not found. Improved backtrace generation will be disabled\n"
        f"Error:   link 'a' is not unique.\n{LINE}" + 2 * "\x1b[1;33mWarning [Utils.cc:130]\x1b[0m unused\n",
        [
            "error: sdformat printed 'Error:   link 'a' is not unique. at line 63 in urdf_parser/src/model.cpp'",
            "notice: sdformat printed 'Warning [Utils.cc:130] unused'",
        ],
    ),
    "pybullet, of a good file": (
        f"pybullet build time: Jan 29 2025 23:17:20\n{BULLET}No inertial data for link, using mass=1, "
        f"localinertiadiagonal = 1,1,1, identity local inertial frame{BULLET}base_link",
        [],
    ),
    "pybullet": (
        f"{BULLET}No inertial data for link, using mass=1{BULLET}hand{BULLET}Bad inertia tensor properties for link: hand\n"
        f"{BULLET}Bad inertia tensor properties for link: hand\n"
        "b3Error[BulletUrdfImporter.cpp,121]:\njoint xml is not initialized correctly\n"
        "Using 4 threads\ncannot connect to X server\n",
        [
            "notice: PyBullet printed 'No inertial data for link, using mass=1: hand'",
            "notice: PyBullet printed 'Bad inertia tensor properties for link: hand'",
            "error: PyBullet printed 'joint xml is not initialized correctly'",
            "notice: PyBullet printed 'cannot connect to X server'",
        ],
    ),
    "mujoco": (
        "libEGL warning: DRI2: failed to authenticate\n"
        "WARNING: Geom with duplicate name '' encountered in URDF, creating an unnamed geom.\n"
        + 2
        * f"WARNING: {UNSTABLE}\n",
        [f"notice: MuJoCo printed '{UNSTABLE}'"],
    ),
}


@pytest.mark.parametrize("case", PRINTED)
def test_what_is_printed_becomes_findings(request_for: Any, case: str) -> None:
    """Each message once, with all its lines, as severe as the simulator says; what is said of a good file is none."""
    loader, request = CATALOG.get("loader", case.partition(",")[0]), request_for()
    output, findings = PRINTED[case]
    reads = loader.can(ReadsOutput)
    assert reads is not None
    found = reads.read_output(request, output.replace("{path}", str(request.path.resolve())))
    assert [f"{problem.severity}: {problem.message}" for problem in found] == findings
