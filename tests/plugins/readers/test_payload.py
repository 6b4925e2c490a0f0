"""What an arm carries: read from tables and options, written back, and refused where it means nothing."""

from pathlib import Path

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, DHRow, Inertia, Manipulator, Payload
from dh2urdf.stages import Rejected, WritesTables
from dh2urdf.table_text.texts import table_text
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.table import TableOptions

WHOLE = "{mass: 2.5, com: [0, 0.01, 50 mm], inertia: {ixx: 0.01, iyy: 0.012, izz: 0.004, iyz: -0.001}}"
MATRIX = "{mass: 2.5 kg, com: [0, 10 mm, 0.05], inertia: [[0.01, 0, 0], [0, 0.012, -0.001], [0, -0.001, 0.004]]}"
EXPECTED = Payload(
    mass=2.5, com=(0.0, 0.01, 0.05), inertia=Inertia(ixx=0.01, iyy=0.012, izz=0.004, ixy=0.0, ixz=0.0, iyz=-0.001)
)
READERS = {".csv": stages.CSV, ".yaml": stages.YAML, ".json": stages.YAML}


def read(text: str, folder: Path, suffix: str, **options: object) -> Manipulator | Rejected:
    path = folder / f"arm{suffix}"
    path.write_text(text, encoding="utf-8")
    (arm,) = READERS[suffix].read(path, TableOptions(convention="standard", **options))  # type: ignore[arg-type]
    return arm


def table(payload: str | None, suffix: str) -> str:
    if suffix == ".csv":
        return (f"# payload: {payload}\n" if payload else "") + "a,alpha,d\n0.3,0,0.1\n"
    rows = "joints: [{a: 0.3, alpha: 0, d: 0.1}]\n"
    return (f"payload: {payload}\n" if payload else "") + rows


def accepted(arm: Manipulator | Rejected) -> Manipulator:
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    return arm


@pytest.mark.parametrize("text", [WHOLE, MATRIX])
@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_a_table_or_an_option_says_it(text: str, suffix: str, tmp_path: Path) -> None:
    """In every form, with the same meaning; and both, where they agree."""
    for said, option in ((text, None), (None, text), (text, WHOLE)):
        arm = accepted(read(table(said, suffix), tmp_path, suffix, payload=option))
        assert (arm.payload, arm.notices) == (EXPECTED, ())


@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_two_payloads_are_refused(suffix: str, tmp_path: Path) -> None:
    """And so are two masses of the base; a mass in an option goes with a transform in the table."""

    def codes(text: str, **options: object) -> list[str | None]:
        try:
            arm = read(text, tmp_path, suffix, **options)
        except TableError as error:
            return [problem.code for problem in error.problems]
        return [problem.code for problem in getattr(arm, "problems", ())]

    mark = "# " if suffix == ".csv" else ""
    heavy = f"{mark}base: {{xyz: [0, 0, 1], mass: 3}}\n{table(None, suffix)}"
    assert codes(table(WHOLE, suffix), payload="{mass: 1, com: [0, 0, 0]}") == ["said-twice"]
    assert (codes(heavy, base="{mass: 0}"), codes(heavy, base="{mass: 3}")) == (["said-twice"], [])
    placed = f"{mark}base: {{xyz: [0, 0, 1]}}\n{table(None, suffix)}"
    arm = accepted(read(placed, tmp_path, suffix, base="{mass: 0}"))
    assert (arm.base.translation, arm.base_mass) == ((0.0, 0.0, 1.0), 0.0)


@pytest.mark.parametrize("units", [("m", "rad"), ("mm", "rad")])
@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
@pytest.mark.parametrize(
    "payload", [EXPECTED, Payload(mass=1 / 3, com=(1 / 3, 0.0, -0.1), inertia=Inertia(ixx=1 / 7, iyy=1 / 7, izz=1 / 7))]
)
def test_what_is_written_is_read_back(payload: Payload, suffix: str, units: tuple[str, str], tmp_path: Path) -> None:
    """To the last bit, beside a base of mass 0."""
    row = DHRow(joint="joint_1", link="link_1", a=0.3, alpha=0.0, d=0.1)
    arm = Manipulator(name="arm", convention=Convention.STANDARD, rows=(row,), base_mass=0.0, payload=payload)
    write = READERS[suffix].can(WritesTables).write
    found = accepted(read(write([table_text(arm, *units)]).content.decode(), tmp_path, suffix))
    assert (found.payload, found.base_mass) == (payload, 0.0)
