from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import LoaderError
from dh2urdf.isolation.loads import load_in_child
from dh2urdf_plugins.loaders import pinocchio as pinocchio_loader
from dh2urdf_plugins.loaders.simulators import LOADERS, SimulatorOptions

LOADER = next(each for each in LOADERS if each.name == "pinocchio")

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

pytest.importorskip("pinocchio")

CONFIGS = Path(__file__).parents[3] / "configs"
OPTIONS = SimulatorOptions()


def run(request: LoadRequest) -> LoadReport:
    return load_in_child(LOADER, request, OPTIONS)


def refusal(request: LoadRequest) -> LoaderError:
    with pytest.raises(LoaderError) as caught:
        run(request)
    return caught.value


# Stretched out along x with the rail at 0.05 m, gravity asks of the shoulder [N·m]:
STATIC_LOAD = 9.81 * (2.0 * 0.2 + 1.0 * 0.4 + (0.5 + 0.2) * (0.4 + 0.35 + 0.05))


def test_weight_is_held_against_the_efforts(request_for: Any, planar: Any) -> None:
    """The largest load is the largest share of a joint's effort that gravity asks: here of the shoulder, at the start."""
    hold = run(request_for(poses=planar.poses[:1], expected={"tool0": planar.expected[:1]})).hold
    assert hold["largest_load"] == pytest.approx(STATIC_LOAD / 60.0, rel=1e-12)
    assert (hold["joint"], hold["q"], hold["poses"]) == ("shoulder", (0.0, 0.0, 0.05, 0.0), 2)
    assert (hold["start"], hold["threshold"], hold["stayed"]) == ((0.0, 0.0, 0.05, 0.0), 1.0, True)


@pytest.mark.parametrize(("share", "stays"), [(1.001, True), (0.999, False)])
def test_effort_below_the_weight_is_a_finding(request_for: Any, planar: Any, *, share: float, stays: bool) -> None:
    """An effort below what gravity asks is a notice with the joint, the torque and the joint vector."""
    effort = share * STATIC_LOAD
    joints = tuple(
        replace(joint, limits=replace(joint.limits, effort=effort)) if joint.name == "shoulder" else joint
        for joint in planar.robot.joints
    )
    text = planar.urdf.replace('effort="60"', f'effort="{effort}"')
    poses = {"poses": planar.poses[:1], "expected": {"tool0": planar.expected[:1]}}
    report = run(request_for(text, replace(planar.robot, joints=joints), **poses))
    assert report.hold["stayed"] is stays
    assert [(finding.severity, finding.joint, finding.field) for finding in report.findings] == (
        [] if stays else [("notice", "shoulder", "limits.effort")]
    )
    if not stays:
        assert "q = (0.0, 0.0, 0.05, 0.0) gravity asks 13.34 N·m" in report.findings[0].message


def test_arm_too_long_for_its_memory_is_weighed_only(request_for: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of an arm of more joints than Pinocchio has memory for, joints and masses are compared; that is said."""
    monkeypatch.setattr(pinocchio_loader, "MEASURED_JOINTS", 3)
    report = LOADER.open(request_for(), OPTIONS)
    assert len(report.joints) == 4
    assert report.mass == pytest.approx(6.7)
    assert (report.position_error, report.hold) == (None, {})
    (finding,) = report.findings
    assert (finding.severity, finding.found) == ("notice", "4 moving joints")
