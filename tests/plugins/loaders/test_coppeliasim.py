from __future__ import annotations

import re
import socket
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import LoaderError, MissingDependencyError, MissingProgramError
from dh2urdf.isolation import load_in_child
from dh2urdf_plugins.loaders import coppeliasim
from dh2urdf_plugins.loaders.coppeliasim import LOADER, CoppeliaSimOptions, load, require
from dh2urdf_plugins.loaders.coppeliasim_arm import OPTIONS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.stages import LoadReport, LoadRequest

pytest.importorskip("coppeliasim_zmqremoteapi_client")
pytest.importorskip("zmq")


@pytest.fixture
def peers(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The class of CoppeliaSims for tests."""
    monkeypatch.syspath_prepend(Path(__file__).parent)
    from coppeliasim_peer import Peer

    return Peer


@pytest.fixture
def peer(peers: Any) -> Iterator[Any]:
    with peers() as running:
        yield running


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give up after a moment."""
    monkeypatch.setattr(coppeliasim, "ANSWERS_WITHIN", 0.3)
    monkeypatch.setattr(coppeliasim, "_time_limit", lambda _options: 1.0)


def run(peer: Any, request: LoadRequest) -> LoadReport:
    return load(request, CoppeliaSimOptions(host="127.0.0.1", port=peer.port))


def refusal(peer: Any, request: LoadRequest) -> LoaderError:
    with pytest.raises(LoaderError) as caught:
        run(peer, request)
    return caught.value


def test_right_arm_is_confirmed(peer: Any, request_for: Any, planar: Any) -> None:
    """An arm that was written right has its joints, masses and poses in CoppeliaSim."""
    report = run(peer, request_for())
    assert (report.simulator, report.version, report.poses) == ("CoppeliaSim", "4.9.0", len(planar.poses))
    assert report.position_error is not None
    assert report.angle_error is not None
    assert report.inertia_error is not None
    assert report.position_error < 1e-14
    assert report.angle_error < 1e-14
    assert report.mass_error == 0.0
    assert report.inertia_error < 1e-15
    assert report.hold == {}


def test_joints_are_reported_as_coppeliasim_has_them(peer: Any, request_for: Any) -> None:
    """Types, limits and efforts are CoppeliaSim's; the axis, which is z in CoppeliaSim, is told in the link's frame."""
    shoulder, _, slide, wrist = run(peer, request_for()).joints
    assert shoulder == {
        "name": "shoulder",
        "type": "revolute",
        "axis": (0.0, 1.0, 0.0),
        "lower": -2.0,
        "upper": 2.5,
        "velocity": 3.0,
        "effort": 60.0,
    }
    assert (slide["type"], slide["lower"], slide["upper"]) == ("prismatic", 0.05, pytest.approx(0.2, rel=1e-15))
    assert (wrist["type"], wrist["axis"], wrist["lower"], wrist["upper"]) == ("continuous", (1.0, 0.0, 0.0), None, None)


def test_links_without_mass_weigh_a_kilogram(peer: Any, request_for: Any) -> None:
    """The importer reads no mass of 0: tool0 weighs 1 kg, which the total says, and a finding."""
    report = run(peer, request_for())
    assert report.mass == pytest.approx(6.7 + 1.0)
    (finding,) = [finding for finding in report.findings if "without mass" in finding.message]
    assert (finding.severity, "'tool0' (1 kg)" in finding.message) == ("notice", True)


def test_frame_without_inertial_weighs_nothing(peer: Any, request_for: Any, planar: Any) -> None:
    """Written without an inertial, tool0 is measured all the same, and weighs nothing."""
    text, count = re.subn(r'<link name="tool0">.*?</link>', '<link name="tool0"/>', planar.urdf, flags=re.DOTALL)
    assert count == 1
    links = tuple(link if link.name != "tool0" else type(link)(name="tool0") for link in planar.robot.links)
    report = run(peer, request_for(text, type(planar.robot)(name="planar", links=links, joints=planar.robot.joints)))
    assert report.mass == pytest.approx(6.7)
    assert not [finding for finding in report.findings if "without mass" in finding.message]


def test_link_without_collision_is_static(peer: Any, request_for: Any) -> None:
    """Links that CoppeliaSim holds static are a finding; the base, which shall stand still, is none."""
    (finding,) = [finding for finding in run(peer, request_for()).findings if "static" in finding.message]
    assert finding.message.endswith("'forearm', 'hand'")


def test_importer_is_asked_for_the_arm_as_it_is(peer: Any, request_for: Any) -> None:
    """The arm is left where it is, every link becomes an object, and the contact masks stay; the scene stays clean."""
    before = dict(peer.things)
    run(peer, request_for())
    assert peer.options == OPTIONS == 8 | 32 | 128
    assert peer.things == before
    assert peer.calls.count("simURDF.importFile") == 1


def test_old_importer_is_asked_by_its_keyword(peers: Any, request_for: Any) -> None:
    """Where the importer is still called `import`, and constants have their old names, it is found all the same."""
    with peers(old=True) as old:
        assert run(old, request_for()).mass_error == 0.0
        assert "simURDF.import" in old.calls


@pytest.mark.parametrize("beginning", ["", "\n", "\ufeff"])
def test_text_begins_with_a_declaration(peer: Any, request_for: Any, planar: Any, beginning: str) -> None:
    """A file without a declaration, or with something before it, is told from a path all the same."""
    text = beginning + planar.urdf.partition("?>")[2].lstrip()
    if beginning == "\ufeff":
        text = beginning + planar.urdf
    assert run(peer, request_for(text)).poses == len(planar.poses)


@pytest.mark.parametrize(
    ("written", "instead", "message"),
    [
        ('xyz="0.4 0 0"', 'xyz="0.401 0 0"', "tool0 in another place, 0.001 m"),
        ('xyz="0.4 0 0"', 'xyz="-0.4 0 0"', "tool0 in another place, 0.8 m"),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>', r"axis \(0\.0, -1\.0, 0\.0\) where"),
        ('type="continuous"', 'type="fixed"', "lost the joint"),
        ('name="elbow"', 'name="knee"', "a joint that was not written"),
        ('lower="-2" upper="2.5"', 'lower="-2" upper="2.6"', r"upper 2\.(6|59+\d) where 2\.5 was written"),
        ('effort="60"', 'effort="61"', r"effort 61\.0 where 60\.0"),
        ('velocity="0.5"', 'velocity="5"', r"velocity 5\.0 where 0\.5"),
        ('mass value="1"', 'mass value="1.1"', r"another mass of the link 'forearm', by 0\.1 kg"),
        ('xyz="0.2 0.01 0"', 'xyz="0.2 0.011 0"', r"another com of the link 'upper_arm', by 0\.001 m"),
        ('ixy="0.0003"', 'ixy="-0.0003"', r"another inertia of the link 'upper_arm', by 0\.0006 kg·m²"),
        ('link="tool0"', 'link="tool1"', "refused: 'tool1'"),
    ],
)
def test_another_arm_is_refused(
    peer: Any, request_for: Any, planar: Any, *, written: str, instead: str, message: str
) -> None:
    """A file that differs from the robot in a pose, joint or mass property is refused; the scene stays clean."""
    assert written in planar.urdf
    before = dict(peer.things)
    with pytest.raises(LoaderError, match=message):
        raise refusal(peer, request_for(planar.urdf.replace(written, instead, 1)))
    assert peer.things == before


def test_nothing_imported_is_an_error(peer: Any, request_for: Any, planar: Any) -> None:
    """CoppeliaSim says only on its console that it cannot read a file: an empty import is an error that says so."""
    assert "imported nothing; its console says why" in str(refusal(peer, request_for(planar.urdf[:400])))


def test_missing_file_is_refused(peer: Any, request_for: Any, tmp_path: Path) -> None:
    """A file that is not there is an error of this manipulator."""
    request = request_for()
    (tmp_path / "planar.urdf").unlink()
    assert "cannot be read" in str(refusal(peer, request))


def test_running_simulation_is_left_alone(peers: Any, request_for: Any) -> None:
    """Where a simulation runs, nothing is imported into it."""
    with peers(running=True) as busy:
        assert "stop it" in str(refusal(busy, request_for()))
        assert "simURDF.importFile" not in busy.calls


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("function", ["simURDF.importFile", "sim.getObjectMatrix"])
def test_crash_is_reported(peers: Any, request_for: Any, function: str) -> None:
    """A CoppeliaSim that falls silent in the middle fails this manipulator, and is not waited for."""
    with peers(dies_at=function) as dying:
        assert "does not answer any more" in str(refusal(dying, request_for()))


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("listens", [False, True])
def test_silence_says_how_to_start_one(request_for: Any, *, listens: bool) -> None:
    """Where nobody listens, or another program that does not answer, the error says soon how to start CoppeliaSim."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        if not listens:
            server.close()
        with pytest.raises(MissingProgramError, match=rf"127\.0\.0\.1:{port}: start one .*coppeliaSim\.sh -h"):
            load(request_for(), CoppeliaSimOptions(host="127.0.0.1", port=port))


def test_published_arms_are_confirmed(peer: Any, reference_robot: Any, published_request: Any) -> None:
    """Every published arm is the same arm in CoppeliaSim, as far as its importer's source can say."""
    report = run(peer, published_request(reference_robot))
    assert report.poses == len(reference_robot.q)
    assert report.mass_error == 0.0


def test_it_works_in_a_child_process(peer: Any, request_for: Any) -> None:
    """In the process of its own, in which loaders are called, it says the same and ends by itself."""
    report = load_in_child(LOADER, request_for(), CoppeliaSimOptions(host="127.0.0.1", port=peer.port))
    assert report.mass_error == 0.0
    assert report.output == ""


def test_missing_client_names_the_extra(request_for: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the client the error says what to install."""
    monkeypatch.setitem(sys.modules, "coppeliasim_zmqremoteapi_client", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'dh2urdf\[coppeliasim\]'"):
        load(request_for(), CoppeliaSimOptions())


def test_run_asks_for_the_client_before_it_begins() -> None:
    """Where the client is installed there is nothing to say before a run."""
    require(CoppeliaSimOptions())


@pytest.mark.parametrize(("options", "message"), [({"poses": 0}, "from 1 on"), ({"port": 0}, "from 1 to 65535")])
def test_options_are_checked(options: dict[str, int], message: str) -> None:
    """There is at least one pose to measure, and a port that there can be."""
    with pytest.raises(ValueError, match=message):
        CoppeliaSimOptions(**options)
