"""What holds for each loader: an arm that was written right is confirmed, and any other arm is refused."""

import json
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from command_line import Cli

from dh2urdf.conversion.loads import load_in_child
from dh2urdf.errors import LoaderError, MissingDependencyError, PluginError
from dh2urdf.isolation.kept_children import KeptChildren
from dh2urdf.plugin_system import load as load_catalog
from dh2urdf.robot import Collision, Cylinder, Origin
from dh2urdf.stages import Finding, Loader, LoadReport, LoadRequest

CONFIGS = Path(__file__).parents[3] / "configs"
CATALOG = load_catalog()
EVERY = ("pybullet", "mujoco", "pinocchio", "drake", "gazebo", "coppeliasim")
HERE = tuple(name for name in EVERY if name != "coppeliasim")
"""Those that need no program which somebody else has started."""
MOVING = ("pybullet", "mujoco", "drake")
"""Those whose hold test lets the arm move."""


class Subject(NamedTuple):
    """A loader, and the planar arm as it takes it.

    Attributes:
        loader: the loader.
        options: its options.
        urdf: the text of the arm.
    """

    loader: Loader[Any]
    options: Any
    urdf: str

    def load(self, request: LoadRequest) -> LoadReport:
        """Its report, made in this process."""
        return self.loader.open(request, self.options)


@pytest.fixture
def subject(
    request: pytest.FixtureRequest, planar: Any, monkeypatch: pytest.MonkeyPatch, require_loaders: Callable[..., None]
) -> Iterator[Subject]:
    """A loader that is installed; CoppeliaSim is the one for tests."""
    loader, urdf = CATALOG.get("loader", request.param), planar.urdf
    if request.param == "mujoco":
        monkeypatch.setenv("MUJOCO_GL", "disable")  # It would set this itself, in this process.
        urdf = planar.for_mujoco
    if request.param == "coppeliasim":
        pytest.importorskip("coppeliasim_zmqremoteapi_client")
        monkeypatch.syspath_prepend(Path(__file__).parent)
        from coppeliasim_peer import Peer

        urdf = urdf.replace('lower="0.05" upper="0.2"', 'lower="0" upper="0.2"')  # 0 has to be within the limits.
        with Peer() as peer:
            yield Subject(loader, loader.options(host="127.0.0.1", port=peer.port), urdf)
        return
    require_loaders(loader.name)
    yield Subject(loader, loader.options(), urdf)


@pytest.fixture(scope="module")
def children() -> Iterator[KeptChildren]:
    """Child processes that serve many loads, as in a run: a simulator is imported once."""
    with KeptChildren() as kept:
        yield kept


@pytest.fixture
def run(subject: Subject, children: KeptChildren) -> Callable[[LoadRequest], LoadReport]:
    """A report made as in a run."""
    return lambda request: load_in_child(subject.loader, request, subject.options, None, children)


OF_EVERY_ARM = ("no actuators", "Gazebo has no frame", "without mass", "static", "hold test")
"""What a finding has in it that a loader has of any arm: each has a test of its own."""


def surprises(report: LoadReport) -> list[Finding]:
    return [each for each in report.findings if not any(known in each.message for known in OF_EVERY_ARM)]


# --- The right arm ----------------------------------------------------------------------------------------------------


BOUNDS = {
    "pybullet": ("PyBullet", 6e-7, 2e-6, 6e-7, 0.0, 1e-8),
    "mujoco": ("MuJoCo", 1e-13, 1e-13, 1.2e-12, 0.0, 1e-15),
    "pinocchio": ("Pinocchio", 1e-13, 1e-13, 1.2e-12, 0.0, 1e-16),
    "drake": ("Drake", 1e-14, 1e-14, 1e-11, 0.0, 1e-16),
    "gazebo": ("sdformat", 1e-14, 1e-14, 1e-11, 1e-14, 1e-15),
    "coppeliasim": ("CoppeliaSim", 1e-12, 1e-12, 2e-6, 0.0, 1e-14),
}
"""What a loader calls itself, and what it may be off of the planar arm: the position of tool0 [m], its angle [rad], the
tolerance that the loader states itself [m], the mass of all links [kg], and the inertia of any [kg·m²]."""


@pytest.mark.parametrize("subject", EVERY, indirect=True)
def test_the_right_arm_is_confirmed(
    subject: Subject, run: Callable[..., LoadReport], request_for: Callable[..., LoadRequest], planar: Any
) -> None:
    """It has its poses, masses and joints in the simulator, within what the loader states, and nothing is found."""
    report: Any = run(request_for(subject.urdf))
    simulator, position, angle, tolerance, mass, inertia = BOUNDS[subject.loader.name]
    assert (report.simulator, report.poses, report.picture) == (simulator, len(planar.poses), None)
    assert report.q in planar.poses
    assert surprises(report) == []
    assert report.position_error < min(position, report.tolerance)
    assert report.angle_error < min(angle, report.angle_tolerance)
    assert report.tolerance < tolerance
    without_mass = 1.0 if subject.loader.name == "coppeliasim" else 0.0  # it weighs all the same
    assert report.mass == pytest.approx(6.7 + without_mass, rel=1e-15)
    assert report.mass_error <= mass
    assert report.inertia_error < inertia
    if subject.loader.name in ("mujoco", "pinocchio", "drake"):
        assert report.output == ""


@pytest.mark.parametrize("subject", EVERY, indirect=True)
def test_joints_are_those_of_the_simulator(
    subject: Subject, run: Callable[..., LoadReport], request_for: Callable[..., LoadRequest]
) -> None:
    """Types, limits, and axes in the link's frame. MuJoCo has no velocities, and Drake no efforts without actuators."""
    shoulder, elbow, slide, wrist = run(request_for(subject.urdf)).joints
    name = subject.loader.name
    effort = {} if name == "drake" else {"effort": 60.0}
    velocity = None if name == "mujoco" else 3.0
    about = {"name": "shoulder", "type": "revolute", "axis": (0.0, 1.0, 0.0), "lower": -2.0, "upper": 2.5}
    assert shoulder == {**about, "velocity": velocity, **effort}
    assert elbow["name"] == "elbow"
    assert (slide["type"], slide["axis"], slide["lower"]) == ("prismatic", (1.0, 0.0, 0.0), 0.05)
    assert slide["upper"] == pytest.approx(0.2, rel=1e-15)
    assert (wrist["type"], wrist["axis"], wrist["lower"], wrist["upper"]) == ("continuous", (1.0, 0.0, 0.0), None, None)
    assert wrist.get("effort") == (None if name == "drake" else 10.0)
    assert wrist["velocity"] == (None if name == "mujoco" else 6.0)


# --- Another arm ------------------------------------------------------------------------------------------------------

CHANGES: tuple[tuple[tuple[str, ...], str, str, str], ...] = (
    (EVERY, 'xyz="0.4 0 0"', 'xyz="0.401 0 0"', "tool0 in another place, 0.001 m"),
    (("mujoco", "pinocchio"), 'xyz="0.4 0 0"', 'xyz="0.400000001 0 0"', "tool0 in another place, 1e-09 m"),
    (("pybullet",), 'xyz="0.4 0 0"', 'xyz="0.4 0 0" rpy="0.00001 0 0"', "and 1e-05 rad away"),
    (("mujoco", "pinocchio"), 'xyz="0.4 0 0"', 'xyz="0.4 0 0" rpy="0.00000001 0 0"', "and 1e-08 rad away"),
    (EVERY, '<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>', r"axis \(0\.0, -1\.0, 0\.0\) where"),
    (("gazebo",), '<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>', r"axis \(0\.0, 2\.0, 0\.0\) where"),
    (EVERY, 'type="continuous"', 'type="fixed"', "lost the joint"),
    (EVERY, 'name="elbow"', 'name="knee"', "a joint that was not written"),
    (EVERY, 'lower="-2" upper="2.5"', 'lower="-2" upper="2.6"', r"upper 2\.(6|59+\d) where 2\.5 was written"),
    (("mujoco",), 'lower="-2" upper="2.5"', 'lower="2.5" upper="-2"', "type continuous where revolute was written"),
    (tuple(set(EVERY) - {"drake"}), 'effort="60"', 'effort="61"', r"effort 61\.0 where 60\.0"),
    (tuple(set(EVERY) - {"mujoco"}), 'velocity="0.5"', 'velocity="5"', r"velocity 5\.0 where 0\.5"),
    (EVERY, 'mass value="1"', 'mass value="1.1"', r"another mass of the link 'forearm', by 0\.1 kg"),
    (("mujoco", "pinocchio"), 'mass value="1"', 'mass value="1.000001"', "mass of the link 'forearm', by 1e-06 kg"),
    (EVERY, 'xyz="0.2 0.01 0"', 'xyz="0.2 0.011 0"', r"another com of the link 'upper_arm', by 0\.001 m"),
    (EVERY, 'ixy="0.0003"', 'ixy="-0.0003"', r"another inertia of the link 'upper_arm', by 0\.0006 kg·m²"),
    (("pybullet", "drake"), 'iyy="0.03"', 'iyy="0.3"', "another inertia of the link 'upper_arm'"),  # impossible: zeroed
    (("drake",), '"base_link"', '"base"', "lost the link 'base_link'"),
    (("pinocchio",), '"tool0"', '"tool"', "Pinocchio has lost the link 'tool0'"),
)
"""Loaders, what is written, what stands in its place, and what the loader says."""
EVERYWHERE = ('"base_link"', '"tool0"')
"""Names, which are changed wherever they are."""


@pytest.mark.parametrize(
    ("subject", "written", "instead", "message"),
    [(name, *change) for names, *change in CHANGES for name in EVERY if name in names],
    indirect=["subject"],
)
def test_another_arm_is_refused(
    subject: Subject, request_for: Callable[..., LoadRequest], *, written: str, instead: str, message: str
) -> None:
    """A file that differs from the robot in a pose, joint or mass property is refused, and the message says in what."""
    if subject.loader.name == "coppeliasim":
        written = written.replace('"0.05"', '"0"')
    assert written in subject.urdf
    text = subject.urdf.replace(written, instead, -1 if written in EVERYWHERE else 1)
    with pytest.raises(LoaderError, match=message) as caught:
        subject.load(request_for(text))
    assert caught.value.problems[0].robot == "planar"


@pytest.mark.parametrize("subject", HERE, indirect=True)
def test_a_file_is_read_anew(
    subject: Subject, run: Callable[..., LoadReport], request_for: Callable[..., LoadRequest]
) -> None:
    """By a child that has loaded it before: another arm is refused, and the right one passes again as before."""
    report = run(request_for(subject.urdf))
    with pytest.raises(LoaderError, match=r"tool0 in another place, 0\.001 m") as caught:
        run(request_for(subject.urdf.replace('xyz="0.4 0 0"', 'xyz="0.401 0 0"', 1)))
    assert caught.value.problems[0].robot == "planar"
    assert run(request_for(subject.urdf)) == report


@pytest.mark.parametrize("subject", EVERY, indirect=True)
def test_a_missing_file_is_refused(
    subject: Subject, run: Callable[..., LoadReport], request_for: Callable[..., LoadRequest]
) -> None:
    """A file that is not there is an error of this manipulator."""
    request = request_for(subject.urdf)
    with pytest.raises(LoaderError):
        run(replace(request, path=request.path.with_name("elsewhere.urdf")))


# --- The hold test ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("subject", MOVING, indirect=True)
def test_a_strong_arm_stays(
    subject: Subject, run: Callable[..., LoadReport], request_for: Callable[..., LoadRequest]
) -> None:
    """An arm whose efforts hold its weight stays for two seconds; the test starts inside the limits."""
    hold = run(request_for(subject.urdf)).hold
    assert hold["stayed"] is True
    assert 0.0 < hold["largest_displacement"] < hold["threshold"] == 0.01
    assert (hold["seconds"], hold["start"], hold["contacts"]) == (2.0, (0.0, 0.0, 0.05, 0.0), [])
    if subject.loader.name == "drake":
        assert hold["largest_displacement"] < 0.001  # its springs give their full effort at 0.001


@pytest.mark.parametrize("subject", MOVING, indirect=True)
def test_a_weak_arm_does_not_stay(
    subject: Subject, run: Callable[..., LoadReport], request_for: Callable[..., LoadRequest], planar: Any
) -> None:
    """An arm whose efforts are below its weight sinks in the hold test; that is a finding, not a failure."""
    report = run(request_for(subject.urdf.replace('effort="60"', 'effort="1"'), planar.with_effort(1.0)))
    assert (report.hold["stayed"], report.hold["joint"]) == (False, "shoulder")
    assert report.hold["largest_displacement"] > 0.5
    (finding,) = [each for each in report.findings if "did not stay in place" in each.message]
    assert (finding.severity, finding.joint, finding.field, finding.found) == (
        *("notice", "shoulder", "limits.effort", "1.0"),
    )
    assert surprises(report) in ([], [finding])


@pytest.mark.parametrize("subject", MOVING, indirect=True)
def test_an_overlap_is_found(
    subject: Subject, run: Callable[..., LoadReport], request_for: Callable[..., LoadRequest], planar: Any
) -> None:
    """Collision shapes that overlap at the start are a finding; the arm stays all the same."""
    along_x = Origin(xyz=(0.2, 0.0, 0.0), rpy=(0.0, math.pi / 2, 0.0))
    longer = (Collision(geometry=Cylinder(radius=0.04, length=1.2), origin=along_x),)
    links = tuple(replace(link, collisions=longer) if link.name == "upper_arm" else link for link in planar.robot.links)
    text = subject.urdf.replace('radius="0.04" length="0.3"', 'radius="0.04" length="1.2"')
    report = run(request_for(text, replace(planar.robot, links=links)))
    assert (report.hold["contacts"], report.hold["stayed"]) == ([("upper_arm", "slider")], True)
    assert ["'upper_arm' and 'slider'" in each.message for each in report.findings if "overlap" in each.message] == [
        True
    ]
    assert [each for each in surprises(report) if "overlap" not in each.message] == []


# --- Published arms and cells -----------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize(("config", "tips", "joints"), [("pair", 2, 12), ("ur5_on_track", 2, 7)])
def test_a_cell_is_confirmed(cli: Cli, tmp_path: Path, config: str, tips: int, joints: int) -> None:
    """Every tool0 of every arm of a cell is where the run file has it, in every simulator; all arms hold their weight.

    The root `world` of a cell is Drake's own world, and no link in SDF.
    """
    loaders = [name for name in HERE if is_installed(name)]
    words = [{"stage": name, "options": {"poses": 5}} for name in loaders]
    for each in words:
        if each["stage"] in ("pybullet", "mujoco"):
            each["options"]["picture"] = False  # type: ignore[index]
    cli("run", CONFIGS / f"{config}.yaml", "-o", tmp_path / "out", "--set", f"loaders={json.dumps(words)}")
    records = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))["manipulators"]
    (cell,) = [record for record in records if record["name"] == config]
    assert cell["status"] == "ok"
    assert len(cell["proof"]["urdf"]["tips"]) == tips
    for name in loaders:
        entry = cell["loaders"][name]
        assert len(entry["joints"]) == joints
        assert entry["position_error"] < (1e-5 if name == "pybullet" else 1e-13)
        assert entry["position_error"] < entry["tolerance"]
        assert entry["hold"].get("stayed") is (None if name == "gazebo" else True)
        known = (*OF_EVERY_ARM, "overlap") if name in ("drake", "gazebo") else ()
        assert [each for each in entry["findings"] if not any(word in each["message"] for word in known)] == []


def is_installed(name: str) -> bool:
    loader = CATALOG.get("loader", name)
    try:
        loader.require(loader.options())
    except PluginError:
        return False
    return True


# --- What is missing or wrong -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("subject", "module", "package"),
    [
        ("pybullet", "pybullet", "pybullet"),
        ("mujoco", "mujoco", "mujoco"),
        ("mujoco", "PIL.Image", "pillow"),
        ("drake", "pydrake", "drake"),
        ("coppeliasim", "coppeliasim_zmqremoteapi_client", "coppeliasim-zmqremoteapi-client"),
    ],
    indirect=["subject"],
)
def test_a_missing_package_names_the_extra(
    subject: Subject,
    request_for: Callable[..., LoadRequest],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    *,
    module: str,
    package: str,
) -> None:
    """Without the simulator, or without Pillow where a picture is wanted, the error says what to install."""
    monkeypatch.setitem(sys.modules, module, None)
    more = {"picture": tmp_path / "planar.png"} if package == "pillow" else {}
    with pytest.raises(MissingDependencyError) as caught:
        subject.load(request_for(**more))
    assert (caught.value.package, caught.value.extra) == (package, f"dh2urdf[{subject.loader.name}]")
