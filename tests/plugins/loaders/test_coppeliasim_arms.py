"""Every published arm in CoppeliaSim, by the profile for it and by the portable file: what the real one said is kept.

CI has no CoppeliaSim: there the loader asks the peer, which has to confirm and refuse the same arms. Where
DH2URDF_COPPELIASIM starts a CoppeliaSim (see `coppeliasim_server`), the real one is asked again; `--renew` keeps it.
"""

import json
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.errors import LoaderError
from dh2urdf.stages import LoadRequest
from dh2urdf_plugins.loaders.simulators import LOADERS, CoppeliaSimOptions

pytest.importorskip("coppeliasim_zmqremoteapi_client")
pytest.importorskip("zmq")

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
try:
    from coppeliasim_peer import Peer
    from coppeliasim_server import COMMAND, Real
finally:
    sys.path.remove(str(HERE))

RECORD = HERE / "coppeliasim_4_10_0_arms.json"
"""By arm, frames and profile: the largest position error [m], or null where the loader refuses the arm."""
FRAMES, PROFILES = ("aligned", "dh"), ("coppeliasim", "portable")
BOUND = 1e-11
"""What an arm may be off there [m]: its importer knows π to twelve digits."""


def error_of(port: int, request: LoadRequest) -> float | None:
    """The largest position error [m]; None where the loader finds another arm."""
    try:
        report = LOADERS[-1].open(request, CoppeliaSimOptions(host="127.0.0.1", port=port))
    except LoaderError as error:
        assert "does not answer" not in str(error)
        return None
    assert report.mass_error == 0.0
    assert report.position_error is not None
    return report.position_error


def inside(request: LoadRequest, most: int) -> LoadRequest:
    """The request with some of its poses, none beyond a limit: there CoppeliaSim puts no joint."""
    limits = [joint.limits for joint in request.robot.moving_joints]
    kept = [
        number
        for number, q in enumerate(request.poses)
        if all(
            each.lower is None or each.upper is None or each.lower <= value <= each.upper
            for each, value in zip(limits, q, strict=True)
        )
    ][:most]
    expected = {tip: tuple(poses[number] for number in kept) for tip, poses in request.expected.items()}
    return replace(request, poses=tuple(request.poses[number] for number in kept), expected=expected)


def read_record() -> dict[str, dict[str, dict[str, float | None]]]:
    return dict(json.loads(RECORD.read_text("utf-8")))


@pytest.fixture(scope="module")
def peer() -> Iterator[Any]:
    with Peer() as running:
        yield running


def test_the_profile_makes_every_arm_right() -> None:
    """With frames of both kinds; the portable file does so of some arms only, which is why there is a profile."""
    record = read_record()
    assert len(record) == 21
    for frames in FRAMES:
        errors = {name: found[frames] for name, found in record.items()}
        assert all(each["coppeliasim"] is not None and each["coppeliasim"] < BOUND for each in errors.values())
        assert any(each["portable"] is None for each in errors.values())


@pytest.mark.parametrize("profile", PROFILES)
def test_the_peer_confirms_and_refuses_the_same_arms(
    peer: Any, reference_robot: Any, published_request: Any, profile: str
) -> None:
    """By any file; what it confirms is as near."""
    kept = read_record()[reference_robot.id]["aligned"][profile]
    found = error_of(peer.port, inside(published_request(reference_robot, profile), 2))
    assert (found is None) == (kept is None)
    assert found is None or found < BOUND


def test_the_real_one_says_what_is_kept(
    reference_robots: Sequence[Any], published_request: Callable[..., LoadRequest], *, renew: bool
) -> None:
    """Where a command starts CoppeliaSim, every arm is in it what is kept, to the power of ten."""
    if not COMMAND:
        assert RECORD.is_file()
        return
    with Real() as real:
        found = {
            robot.id: {
                frames: {
                    profile: error_of(real.port, inside(published_request(robot, profile, frames=frames), 8))
                    for profile in PROFILES
                }
                for frames in FRAMES
            }
            for robot in reference_robots
        }
    if renew:
        lines = [f"{json.dumps(name)}: {json.dumps(each)}" for name, each in found.items()]
        RECORD.write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")
    kept = read_record()
    assert found.keys() == kept.keys()
    for name, by_frames in found.items():
        for frames, by_profile in by_frames.items():
            for profile, error in by_profile.items():
                other = kept[name][frames][profile]
                assert (error is None) == (other is None), (name, frames, profile)
                assert error is None or other is None or math.isclose(error, other, abs_tol=BOUND)
