import math
import re
import socket
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.conversion.loads import load_in_child
from dh2urdf.errors import LoaderError, MissingProgramError
from dh2urdf.robot import Collision, Mesh
from dh2urdf.stages import LoadReport, LoadRequest
from dh2urdf_plugins.loaders import coppeliasim
from dh2urdf_plugins.loaders.coppeliasim import OPTIONS, turn
from dh2urdf_plugins.loaders.simulators import LOADERS, CoppeliaSimOptions

LOADER = next(each for each in LOADERS if each.name == "coppeliasim")


pytest.importorskip("coppeliasim_zmqremoteapi_client")
pytest.importorskip("zmq")


@pytest.fixture
def peers(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The class of CoppeliaSims for tests."""
    monkeypatch.syspath_prepend(Path(__file__).parent)
    from coppeliasim_peer import Peer

    return Peer


@pytest.fixture
def planar_urdf(planar: Any) -> str:
    """The text of the planar arm for this importer: the rail, which cannot be at 0, may be there in the file."""
    return str(planar.urdf).replace('lower="0.05" upper="0.2"', 'lower="0" upper="0.2"')


@pytest.fixture
def request_for(request_for: Any, planar: Any, planar_urdf: str) -> Any:
    """The request to load a text, that of the planar arm where none is given."""

    def make(urdf: str = "", robot: Any = None) -> LoadRequest:
        request: LoadRequest = request_for(urdf or planar_urdf, robot or planar.robot)
        return request

    return make


@pytest.fixture
def peer(peers: Any) -> Iterator[Any]:
    with peers() as running:
        yield running


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give up after a moment."""
    monkeypatch.setattr(coppeliasim, "ANSWERS_WITHIN", 0.3)
    monkeypatch.setattr(coppeliasim, "LOAD_TIME_LIMIT", 1.0)


def run(peer: Any, request: LoadRequest, **options: Any) -> LoadReport:
    return LOADER.open(request, CoppeliaSimOptions(host="127.0.0.1", port=peer.port, **options))


def refusal(peer: Any, request: LoadRequest) -> LoaderError:
    with pytest.raises(LoaderError) as caught:
        run(peer, request)
    return caught.value


def test_what_it_has_otherwise_is_a_finding(peer: Any, request_for: Any) -> None:
    """The importer reads no mass of 0: tool0 weighs 1 kg; links without collision are static, but for the base, which shall."""
    report = run(peer, request_for())
    assert report.mass == pytest.approx(6.7 + 1.0)
    (finding,) = [finding for finding in report.findings if "without mass" in finding.message]
    assert (finding.severity, "'tool0' (1 kg)" in finding.message) == ("notice", True)
    (finding,) = [finding for finding in report.findings if "static" in finding.message]
    assert finding.message.endswith("'forearm', 'hand'")


def test_frame_without_inertial_weighs_nothing(peer: Any, request_for: Any, planar: Any, planar_urdf: str) -> None:
    """Written without an inertial, tool0 is measured all the same, and weighs nothing."""
    text, count = re.subn(r'<link name="tool0">.*?</link>', '<link name="tool0"/>', planar_urdf, flags=re.DOTALL)
    assert count == 1
    links = tuple(link if link.name != "tool0" else type(link)(name="tool0") for link in planar.robot.links)
    report = run(peer, request_for(text, type(planar.robot)(name="planar", links=links, joints=planar.robot.joints)))
    assert report.mass == pytest.approx(6.7)
    assert not [finding for finding in report.findings if "without mass" in finding.message]


def test_importer_is_asked_for_the_arm_as_it_is(peer: Any, request_for: Any) -> None:
    """The arm is left where it is, every link becomes an object, and the contact masks stay; the scene stays clean."""
    before = dict(peer.scene.things)
    run(peer, request_for())
    assert peer.options == OPTIONS == 8 | 32
    assert peer.scene.things == before
    assert peer.calls.count("simURDF.importFile") == 1


def test_limits_of_the_table_are_given_back(peer: Any, request_for: Any) -> None:
    """A joint whose limits the file has had to widen has those of the table in CoppeliaSim, and is measured there."""
    slide = run(peer, request_for()).joints[2]
    assert (slide["lower"], slide["upper"]) == (0.05, pytest.approx(0.2, rel=1e-15))
    assert peer.calls.count("sim.setJointInterval") == 1


@pytest.mark.parametrize(
    ("written", "instead", "joint"),
    [
        ('lower="0" upper="0.2"', 'lower="0.05" upper="0.2"', "slide"),
        ('xyz="0 0 0.3"/>', 'xyz="0 0 0.3" rpy="1.5707963267948966 0 0"/>', "shoulder"),
    ],
)
def test_what_the_importer_misreads_names_the_profile(
    peer: Any, request_for: Any, planar: Any, planar_urdf: str, *, written: str, instead: str, joint: str
) -> None:
    """Of a file for everybody, an arm that this importer misreads is refused, and the error says which file it needs."""
    text, robot = planar_urdf.replace(written, instead, 1), planar.robot
    if joint == "shoulder":  # The same axis, by a frame in which it is -z.
        text = text.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 0 -1"/>', 1)
        place = replace(robot.moving_joints[0].origin, rpy=(math.pi / 2, 0.0, 0.0))
        robot = planar.with_joint(joint, origin=place, axis=(0.0, 0.0, -1.0))
    message = str(refusal(peer, request_for(text, robot)))
    assert f"misreads the joint '{joint}': write the URDF with the profile coppeliasim" in message


def test_names_are_those_of_the_table(peer: Any, request_for: Any, planar: Any, planar_urdf: str) -> None:
    """A name that CoppeliaSim changes is found again, of a joint and of a link, and reported as it was written."""
    names = {"elbow": "el-bow", "forearm": "fore.arm"}
    text = planar_urdf
    for name, other in names.items():
        text = text.replace(f'"{name}"', f'"{other}"')
    links = tuple(replace(each, name=names.get(each.name, each.name)) for each in planar.robot.links)
    parts = ("name", "parent", "child")
    joints = tuple(
        replace(each, **{part: names.get(getattr(each, part), getattr(each, part)) for part in parts})
        for each in planar.robot.joints
    )
    report = run(peer, request_for(text, replace(planar.robot, links=links, joints=joints)))
    assert [joint["name"] for joint in report.joints] == ["shoulder", "el-bow", "slide", "wrist"]
    assert report.mass_error == 0.0


@pytest.mark.parametrize("blind", [False, True])
def test_meshes_are_found(peers: Any, request_for: Any, planar_urdf: str, tmp_path: Path, *, blind: bool) -> None:
    """A mesh beside the file is found by the path of the file, and by its own where CoppeliaSim does not see the file."""
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "part.stl")
    cylinder = '<cylinder radius="0.03" length="0.1"/>'
    assert planar_urdf.count(cylinder) == 1
    text = planar_urdf.replace(cylinder, '<mesh filename="part.stl"/>')
    with peers(blind=blind) as server:
        assert run(server, request_for(text)).mass_error == 0.0
        assert server.calls.count("simURDF.importFile") == 1 + blind


def test_mesh_that_is_not_found_is_named_as_the_reason(
    peer: Any, request_for: Any, planar: Any, planar_urdf: str
) -> None:
    """CoppeliaSim says that an object does not exist, which nobody understands."""
    cylinder = '<cylinder radius="0.03" length="0.1"/>'
    links = tuple(
        replace(each, collisions=(Collision(geometry=Mesh(filename="nowhere.stl")),)) if each.name == "slider" else each
        for each in planar.robot.links
    )
    text = planar_urdf.replace(cylinder, '<mesh filename="nowhere.stl"/>')
    before = dict(peer.scene.things)
    message = str(refusal(peer, request_for(text, replace(planar.robot, links=links))))
    assert "object does not exist." in message
    assert "(its console says more)" in message
    assert "reports a missing mesh in this way" in message
    assert peer.scene.things == before


def test_workers_take_turns(peer: Any, request_for: Any) -> None:
    """Loads by several processes at once do not see each other's arms, and none is in the scene in the end."""
    before = dict(peer.scene.things)
    options = CoppeliaSimOptions(host="127.0.0.1", port=peer.port)
    request = request_for()
    with ThreadPoolExecutor(3) as threads:
        futures = [threads.submit(load_in_child, LOADER, request, options) for _ in range(3)]
        assert [future.result().mass_error for future in futures] == [0.0] * 3
    assert peer.scene.things == before
    importing = [call for call in peer.calls if call in {"simURDF.importFile", "sim.removeObjects"}]
    assert importing == ["simURDF.importFile", "sim.removeObjects"] * 3


@pytest.mark.parametrize("beginning", ["", "\n", "\ufeff"])
def test_text_begins_with_a_declaration(
    peers: Any, request_for: Any, planar: Any, planar_urdf: str, beginning: str
) -> None:
    """A file without a declaration, or with something before it, is distinguished from a path all the same."""
    text = beginning + planar_urdf.partition("?>")[2].lstrip()
    if beginning == "\ufeff":
        text = beginning + planar_urdf
    with peers(blind=True) as server:
        assert run(server, request_for(text)).poses == len(planar.poses)


SILENT = "does not answer any more"
REFUSED: dict[str, tuple[dict[str, Any], Callable[[str], str], str]] = {
    "an importer that tells no handles": ({"old": True}, str, "too old"),
    "a simulation that runs": ({"running": True}, str, "stop it"),
    "a crash while it imports": ({"dies_at": "simURDF.importFile"}, str, SILENT),
    "a crash while it measures": ({"dies_at": "sim.getObjectMatrix"}, str, SILENT),
    "a joint to a link that is not there": ({}, lambda text: text.replace('link="tool0"', 'link="tool1"', 1), SILENT),
    "another arm": ({}, lambda text: text.replace('"0.4 0 0"', '"0.401 0 0"', 1), "tool0 in another place, 0.001 m"),
    "no robot": ({}, lambda _: '<?xml version="1.0"?><sdf/>', "imported nothing; its console says more"),
    "no XML": ({}, lambda text: text[:400], "the file is not XML"),
}


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("case", REFUSED)
def test_what_it_cannot_load_is_refused(peers: Any, request_for: Any, planar_urdf: str, case: str) -> None:
    """A program that is too old, busy or silent, which is not waited for, and files that are no arm; the scene stays clean."""
    program, change, says = REFUSED[case]
    with peers(**program) as server:
        before = dict(server.scene.things)
        assert says in str(refusal(server, request_for(change(planar_urdf))))
        assert says == SILENT or server.scene.things == before


def test_program_that_others_use_is_not_waited_for_without_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where another process does not end its turn, the error says so; where it ended in any way, the turn is free."""
    monkeypatch.setattr(coppeliasim.tempfile, "gettempdir", lambda: str(tmp_path))
    again = turn("program-1", "the program", 0.05)
    with turn("program-1", "the program", 1.0), pytest.raises(LoaderError, match="the program was busy"):
        again.__enter__()
    with turn("program-1", "the program", 0.05), turn("program-2", "another", 0.05):
        pass


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("listens", [False, True])
def test_silence_says_how_to_start_one(request_for: Any, *, listens: bool) -> None:
    """Where nobody listens, or another program that does not answer, the error says soon how to start CoppeliaSim."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        if not listens:
            server.close()
        with pytest.raises(MissingProgramError, match=rf"127\.0\.0\.1:{port}: start one .*coppeliaSim\.sh -H"):
            LOADER.open(request_for(), CoppeliaSimOptions(host="127.0.0.1", port=port))


class TestHold:
    """The hold test of an engine that is asked for."""

    def test_an_arm_that_stands_still(self, peer: Any, request_for: Any) -> None:
        """With MuJoCo the arm stays, and engine and scene are as they were before."""
        report = run(peer, request_for(), engine="mujoco")
        assert (report.hold["stayed"], report.hold["largest_displacement"], report.hold["seconds"]) == (True, 0.0, 2.0)
        assert [finding for finding in report.findings if "engine" in finding.message] == []
        assert (peer.engine, peer.stepping, peer.running) == (peer.BULLET, False, False)
        assert sorted(thing.alias for thing in peer.scene.things.values()) == ["Floor", "tool0_respondable"]

    def test_joints_that_come_apart(self, peer: Any, request_for: Any) -> None:
        """What counts is where the tip is, not what the joints tell of themselves."""
        report = run(peer, request_for(), engine="bullet")
        assert not report.hold["stayed"]
        assert report.hold["largest_displacement"] == pytest.approx(0.0858)
        (apart,) = [finding for finding in report.findings if "come apart" in finding.message]
        assert apart.severity == "notice"
        assert float(re.search(r"'tool0' got (\S+) m away", apart.message)[1]) > 1.0  # type: ignore[index]

    def test_an_engine_that_is_not_there(self, peer: Any, request_for: Any) -> None:
        """CoppeliaSim does not mention it, and the arm just stands still: that is no hold test that was passed."""
        with pytest.raises(LoaderError, match="has no engine newton"):
            run(peer, request_for(), engine="newton")
        assert (peer.engine, peer.running) == (peer.BULLET, False)
        assert sorted(thing.alias for thing in peer.scene.things.values()) == ["Floor", "tool0_respondable"]
