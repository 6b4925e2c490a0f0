"""Tables that are in no file: texts, streams, arrays, data frames; tables and robots as texts; runs of mappings."""

import io
import math
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings, strategies as st

import dh2urdf
from dh2urdf.errors import ConfigError, RecordValueError, RobotError, TableError
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, LinkGeometry, Manipulator, Payload
from dh2urdf.rotations import IDENTITY, RigidTransform

CONFIGS = Path(__file__).parents[3] / "configs"
UR5 = CONFIGS / "tables" / "ur5.csv"
ARRAY = np.array([[0.1, 0.2, 0.3, math.pi / 2], [0.0, 0.05, -0.4, -0.25]])
ORDER = ["theta", "d", "a", "alpha"]
CSV = "# convention: standard\nname,theta,d,a,alpha\nfirst,0.1,0.2,0.3,pi/2\nsecond,0,0.05,-0.4,-0.25\n"


class TestReading:
    def test_texts_bytes_and_streams_are_the_file(self, tmp_path: Path) -> None:
        """With the name of a reader; an open file has a suffix that says it, and a stem that names the manipulator."""
        text, arm = f"# name: ur5\n{UR5.read_text('utf-8')}", dh2urdf.read(UR5)
        for source in (text, text.encode(), bytearray(text.encode()), io.StringIO(text), io.BytesIO(text.encode())):
            assert dh2urdf.read(source, reader="csv") == arm
        bare = tmp_path / "any.csv"
        bare.write_text(CSV, "utf-8")
        with bare.open() as words, bare.open("rb") as content:
            assert dh2urdf.read(words) == dh2urdf.read(content) == dh2urdf.read(bare)
        assert [item.name for item in dh2urdf.read_all(text, reader="csv")] == ["ur5"]
        assert dh2urdf.convert(text, reader="csv").text == dh2urdf.convert(UR5).text

    def test_messages_name_the_text(self) -> None:
        """The line and the column are those of the text; no temporary file is named."""
        with pytest.raises(TableError, match=r"^the text:3:1[0-9]*: error: joint 'first', field 'd'"):
            dh2urdf.read(CSV.replace("0.2", "two"), reader="csv")


def forms(pandas: Any) -> dict[str, Callable[[], Manipulator]]:
    """One table in every form."""
    more: dict[str, Any] = {"convention": "standard", "joints": ["first", "second"]}
    dicts = [dict(zip(ORDER, row, strict=True)) for row in ARRAY.tolist()]
    structured = np.array([tuple(row) for row in ARRAY.tolist()], dtype=[(name, float) for name in ORDER])
    frame = pandas.DataFrame(ARRAY, columns=ORDER)
    from_dh = Manipulator.from_dh
    return {
        "array": lambda: from_dh(ARRAY, columns=ORDER, **more),
        "list": lambda: from_dh(ARRAY.tolist(), columns=ORDER, **more),
        "list with a header": lambda: from_dh([ORDER, *ARRAY.tolist()], **more),
        "objects": lambda: from_dh(ARRAY.astype(object), columns=ORDER, **more),
        "mappings": lambda: from_dh(dicts, **more),
        "columns": lambda: from_dh(dict(zip(ORDER, ARRAY.T, strict=True)), **more),
        "structured array": lambda: from_dh(structured, **more),
        "data frame": lambda: from_dh(frame, **more),
        "data frame with an index": lambda: from_dh(frame.set_axis(["first", "second"]), convention="standard"),
        "data frame without names": lambda: from_dh(pandas.DataFrame(ARRAY), columns=ORDER, **more),
        "expressions": lambda: from_dh(
            [[0.1, 0.2, 0.3, "pi/2"], ["0", "0.05", "-0.4", "-0.25"]], columns=ORDER, **more
        ),
        "units": lambda: from_dh(
            [[0.1, 200, 300, "pi/2"], [0, 50, -400, -0.25]], columns=ORDER, units={"length": "mm"}, **more
        ),
        "units in the names": lambda: from_dh(
            [[0.1, 200, 300, "pi/2"], [0, 50, -400, -0.25]], columns=["theta", "d [mm]", "a [mm]", "alpha"], **more
        ),
        "columns as mappings": lambda: from_dh(
            {name: dict(enumerate(ARRAY[:, number].tolist(), start=5)) for number, name in enumerate(ORDER)}, **more
        ),
        "text": lambda: from_dh(CSV),
    }


FORMS = list(forms(type("pandas", (), {"DataFrame": staticmethod(lambda *_, **__: None)})))


class TestFromDh:
    @pytest.mark.parametrize("form", FORMS)
    def test_every_form_is_the_table_of_the_file(self, form: str) -> None:
        """Array, list, mappings, data frame: the same manipulator, to the last bit."""
        pandas = (
            pytest.importorskip("pandas") if "frame" in form else type("P", (), {"DataFrame": lambda *_, **__: None})
        )
        expected = replace(dh2urdf.read(CSV, reader="csv"), name="robot")
        assert forms(pandas)[form]() == expected

    def test_the_rest_is_said_by_arguments(self) -> None:
        """Types, names, units, base and tool; every argument has its effect."""
        arm = Manipulator.from_dh(
            [[0, 100, 90, 10], [0, 200, 0, 0]],
            columns=["theta", "a", "alpha", "d"],
            convention=Convention.MODIFIED,
            units={"length": "mm", "angle": "deg"},
            types="RP",
            joints=["turn", "slide"],
            name="two",
            base={"xyz": [0, 0, 500], "rpy": [0, 0, 0]},
            tool=np.diag([1.0, 1.0, 1.0, 1.0]).tolist(),
        )
        assert (arm.name, arm.convention, [row.joint for row in arm.rows]) == (
            "two",
            Convention.MODIFIED,
            ["turn", "slide"],
        )
        assert [row.type for row in arm.rows] == [JointType.REVOLUTE, JointType.PRISMATIC]
        assert (arm.rows[0].a, arm.rows[0].alpha, arm.base.translation) == (0.1, math.pi / 2, (0.0, 0.0, 0.5))


NUMBERS = st.floats(-2, 2).map(lambda number: number if abs(number) > 1e-9 else 0.0)
POSITIVE = st.floats(1e-3, 10)
INERTIAS = st.just(Inertia(ixx=0.02, iyy=1 / 30, izz=0.025, ixy=1 / 3000, ixz=-0.002))
ANGLES = st.one_of(
    st.sampled_from([0.0, math.pi / 2, -math.pi / 2, math.pi / 3]),
    st.floats(-3, 3).filter(lambda angle: abs(angle) > 1e-6),
)
TRANSFORMS = st.builds(
    RigidTransform.from_xyz_rpy, st.tuples(NUMBERS, NUMBERS, NUMBERS), st.tuples(ANGLES, ANGLES, ANGLES)
)

PLACES = (
    IDENTITY,
    RigidTransform.from_xyz_rpy((0.1, 0.0, -1 / 3), (0.5, 0.0, 0.25)),
    RigidTransform.from_xyz_rpy((0.0, 0.0, 0.3), (math.pi, 0.0, -math.pi / 2)),
)


@st.composite
def arms(draw: Any) -> Manipulator:
    """Manipulators with everything that a table of texts has a place for."""

    def maybe(strategy: Any) -> Any:
        return draw(st.none() | strategy)

    rows = []
    for number in range(1, draw(st.integers(1, 4)) + 1):
        kind = draw(st.sampled_from(JointType))
        moves, bounded = kind is not JointType.FIXED, kind in (JointType.REVOLUTE, JointType.PRISMATIC)
        ends = sorted((draw(NUMBERS), draw(NUMBERS))) if bounded and draw(st.booleans()) else (None, None)
        mass = maybe(POSITIVE)
        rows.append(
            DHRow(
                joint=draw(st.sampled_from(["axis", "Gelenk", "j o i n t", "joint, left"])) + f" {number}",
                link=draw(st.sampled_from([f"link_{number}", f"arm {number}"])),
                type=kind,
                a=draw(NUMBERS),
                alpha=draw(ANGLES),
                d=draw(NUMBERS),
                theta=draw(ANGLES),
                offset=draw(NUMBERS) if moves else 0.0,
                sign=draw(st.sampled_from([1, -1])) if moves else 1,
                limits=Limits(lower=ends[0], upper=ends[1], velocity=maybe(POSITIVE), effort=maybe(POSITIVE))
                if moves
                else Limits(),
                mass=mass,
                com=maybe(st.tuples(NUMBERS, NUMBERS, NUMBERS)),
                inertia=mass and maybe(INERTIAS),
                radius=maybe(POSITIVE),
                damping=maybe(POSITIVE) if moves else None,
                friction=maybe(POSITIVE) if moves else None,
                armature=maybe(POSITIVE) if moves else None,
            )
        )
    has_body = draw(st.booleans())  # A base with a body has its placement as xyz and rpy, not as a matrix.
    payload = st.builds(Payload, mass=POSITIVE, com=st.tuples(NUMBERS, NUMBERS, NUMBERS), inertia=st.none() | INERTIAS)
    return Manipulator(
        name=draw(st.sampled_from(["arm", "Größe 2", "a: b"])),
        convention=draw(st.sampled_from(Convention)),
        rows=rows,  # type: ignore[arg-type]  # any sequence
        tool=draw(TRANSFORMS),
        base=draw(st.sampled_from(PLACES) if has_body else TRANSFORMS),
        geometry=LinkGeometry(shape=maybe(st.sampled_from(["box", "capsule", "arm"])), radius=maybe(POSITIVE)),
        density=maybe(POSITIVE),
        base_mass=maybe(st.just(0.0) | POSITIVE) if has_body else None,
        base_geometry=LinkGeometry(shape=maybe(st.sampled_from(["box", "capsule", "arm"])), radius=maybe(POSITIVE))
        if has_body
        else LinkGeometry(),
        payload=maybe(payload),
    )


class TestWriting:
    @settings(max_examples=20, deadline=None, phases=[Phase.generate])
    @given(arms())
    def test_what_is_written_is_read_back_to_the_last_bit(self, arm: Manipulator) -> None:
        """All fields, through CSV and YAML."""
        for text, reader in ((arm.to_csv(), "csv"), (arm.to_yaml(), "yaml")):
            again = dh2urdf.read(text, reader=reader)
            assert again == arm
            assert (again.fk([0.1] * len(arm.moving_rows)) == arm.fk([0.1] * len(arm.moving_rows))).all()

    @pytest.mark.parametrize("write", ["to_csv", "to_yaml"])
    @pytest.mark.parametrize("name", ["a.sdf", "a.CSV", "a.yaml"])
    def test_a_name_of_another_format_is_refused(self, tmp_path: Path, write: str, name: str) -> None:
        """What is written is what the name says: the reader of the suffix reads the arm back, or nothing is written."""
        arm, file = replace(dh2urdf.read(UR5), name="a"), tmp_path / name
        if file.suffix.lower()[1:] == write[3:]:
            getattr(arm, write)(file)
            assert dh2urdf.read(file) == arm
        else:
            with pytest.raises(ConfigError):
                getattr(arm, write)(file)
            assert list(tmp_path.iterdir()) == []

    def test_what_a_format_has_no_place_for_is_refused_by_name(self) -> None:
        """Nothing is lost in silence."""
        arm = dh2urdf.read(UR5)
        continuous = replace(arm.rows[0], type="continuous")  # type: ignore[arg-type]
        turned = RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0), (0.7385872757200564, 1.7295128255395404, 0.123))
        odd = replace(arm, visuals=False, base=turned, base_mass=1.0, rows=(continuous, *arm.rows[1:]))
        bounds = ["rows[0].limits.lower", "rows[0].limits.upper"]
        for write, drawn in ((odd.to_csv, ["visuals"]), (odd.to_yaml, [])):
            with pytest.raises(RecordValueError) as raised:
                write()
            # Roll, pitch and yaw that are this base to the last bit are not found: it is written as a matrix.
            assert [problem.field for problem in raised.value.problems] == [*bounds, *drawn]
        with pytest.raises(TableError, match="mass"):
            replace(arm, rows=(replace(arm.rows[0], mass=-1),)).to_csv()


class TestRobots:
    def test_descriptions_are_what_convert_writes(self, tmp_path: Path) -> None:
        """URDF, SDF and MJCF, with options of the emitter."""
        made = dh2urdf.convert(UR5, formats=["urdf", "sdf", "mjcf"])
        robot = made.robot
        texts = [content.decode() for content in made.files.values()]
        assert [robot.to_urdf(), robot.to_sdf(), robot.to_mjcf()] == texts
        assert robot.to_urdf(tmp_path / "arm.urdf") == (tmp_path / "arm.urdf").read_text("utf-8")
        assert robot.to_urdf(profile="ros") == dh2urdf.convert(UR5, profile="ros").text
        with pytest.raises(ConfigError):
            robot.to_urdf(profil="ros")
        with pytest.raises(RobotError):
            replace(robot, links=(*robot.links, robot.links[0])).to_urdf()

    def test_descriptions_are_checked(self, tmp_path: Path) -> None:
        """A file, a text, a stream and a robot have the same findings."""
        robot = dh2urdf.convert(UR5).robot
        text = robot.to_urdf(tmp_path / "arm.urdf")
        rules = [finding.rule for finding in dh2urdf.check(tmp_path / "arm.urdf").findings]
        assert rules
        for source in (text, io.StringIO(text), robot):
            assert [finding.rule for finding in dh2urdf.check(source, emitter="urdf").findings] == rules
        bad = dh2urdf.check("<robot name='a'>\n<link/>\n</robot>", emitter="urdf").findings
        assert any(finding.severity == "error" for finding in bad)
        with pytest.raises(ConfigError):
            dh2urdf.check(text)


class TestRuns:
    def test_a_mapping_is_a_run_file(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """Its paths start at the working directory; settings change it."""
        shutil.copy(UR5, tmp_path)
        monkeypatch.chdir(tmp_path)
        config = {"inputs": ["ur5.csv"], "output": {"directory": "out"}, "proof": {"poses": 2}}
        report = dh2urdf.run(config, settings={"emitters": ["urdf"]})
        assert (report["exit_status"], report["manipulators"][0]["status"]) == (0, "ok")
        assert (tmp_path / "out" / "ur5.urdf").is_file()
        with pytest.raises(ConfigError, match=r"^dh2urdf.run\(\)"):
            dh2urdf.run({"inputs": ["ur5.csv"], "emiters": ["urdf"]})
