from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import LoaderError
from dh2urdf.isolation.loads import load_in_child
from dh2urdf_plugins.loaders.simulators import LOADERS, SimulatorOptions

LOADER = next(each for each in LOADERS if each.name == "drake")

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.stages import LoadReport, LoadRequest

pytest.importorskip("pydrake")

OPTIONS = SimulatorOptions()
CONFIGS = Path(__file__).parents[3] / "configs"


def run(request: LoadRequest) -> LoadReport:
    return load_in_child(LOADER, request, OPTIONS)


def refusal(request: LoadRequest) -> LoaderError:
    """Why a file is refused, in this process: it is quicker, and Drake raises what it would leave by."""
    with pytest.raises(LoaderError) as caught:
        LOADER.open(request, OPTIONS)
    return caught.value


def surprises(report: LoadReport) -> list[str]:
    """The findings but for the one that every URDF without transmissions has."""
    return [finding.message for finding in report.findings if "no actuators" not in finding.message]


def with_transmissions(urdf: str, joints: Sequence[str]) -> str:
    parts = [
        f'<transmission name="of_{joint}">\n<type>transmission_interface/SimpleTransmission</type>\n'
        f'<joint name="{joint}"/>\n<actuator name="motor_of_{joint}"/>\n</transmission>\n'
        for joint in joints
    ]
    return urdf.replace("</robot>", "".join([*parts, "</robot>"]))


def test_joint_without_actuator_is_a_finding(request_for: Any, planar: Any) -> None:
    """Drake takes efforts from transmissions only: it names the joints without; with one, the effort is compared."""
    (finding,) = run(request_for()).findings
    assert finding.severity == "notice"
    assert finding.message.endswith("of 4 joints: 'shoulder', 'elbow', 'slide', 'wrist'")
    (finding,) = run(request_for(with_transmissions(planar.urdf, ["shoulder", "elbow", "slide"]))).findings
    assert finding.message.endswith("of 1 joint: 'wrist'")
    written = with_transmissions(planar.urdf, ["shoulder", "elbow", "slide", "wrist"])
    report = run(request_for(written))
    assert report.findings == ()
    assert [joint["effort"] for joint in report.joints] == [60.0, 30.0, 50.0, 10.0]
    assert report.hold["stayed"] is True
    assert "effort 61.0 where 60.0 was written" in str(
        refusal(request_for(written.replace('effort="60"', 'effort="61"')))
    )


def test_arm_without_effort_falls(request_for: Any, planar: Any) -> None:
    """A joint whose effort is 0 has no motor in the hold test; Drake takes no actuator without effort."""
    joints = tuple(replace(joint, limits=replace(joint.limits, effort=0.0)) for joint in planar.robot.joints)
    report = run(request_for(planar.urdf, replace(planar.robot, joints=joints)))
    assert report.hold["stayed"] is False


def test_friction_is_a_finding(request_for: Any, planar: Any) -> None:
    """What Drake logs is a finding with the line of the file: it takes no joint friction."""
    text = planar.urdf.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/>\n<dynamics friction="0.1"/>', 1)
    (message,) = surprises(run(request_for(text)))
    assert message.startswith("Drake printed 'line 27: warning: A joint has specified a non-zero value for")
