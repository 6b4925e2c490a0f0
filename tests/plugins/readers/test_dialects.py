"""Tables whose meaning is known, written in random dialects, must be read back as the same arms."""

from __future__ import annotations

import codecs
import json
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from hypothesis import given, settings
from hypothesis import strategies as st

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.rotations import HALF_PI
from dh2urdf_plugins.readers import csv, yaml
from dh2urdf_plugins.readers.plain_rows import PlainRows
from dh2urdf_plugins.readers.statements import TableOptions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.stages import Rejected

LENGTH_UNITS = {"m": 0, "cm": 2, "mm": 3, "µm": 6}
HEADERS = {
    "joint": ["joint", "Joint name", "NAME", "joint-name"],
    "type": ["type", "Joint Type", "kind", "sigma"],
    "a": ["a", "A", "r", "a_i", "aᵢ", "$a_i$", "link length"],
    "alpha": ["alpha", "ALPHA", "α", "alpha_i", "α_{i}", "twist", r"\alpha_i", "Link_Twist"],
    "d": ["d", "d_i", "dᵢ", "Link offset"],
    "theta": ["theta", "θ", "Theta_i", "joint angle", "θᵢ"],
    "offset": ["offset", "joint_offset"],
    "sign": ["sign", "Direction"],
    "lower": ["lower", "q_min", "lower limit"],
    "upper": ["upper", "qmax", "max"],
}
PREVIOUS = {"a": ["a_{i-1}", "aᵢ₋₁", "a(i-1)", "a_i-1"], "alpha": ["alpha_{i-1}", "αᵢ₋₁", "α_{i−1}", "alpha_im1"]}
TYPES = {
    JointType.REVOLUTE: ["revolute", "R", "Rotational", "0", "REVOLUTE"],
    JointType.PRISMATIC: ["prismatic", "P", "linear", "T", "1"],
    JointType.CONTINUOUS: ["continuous", "C"],
    JointType.FIXED: ["fixed", "F", "Fixed"],
}
ENCODINGS = ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"]


@dataclass(frozen=True)
class Row:
    """A row in units that are written exactly: lengths in whole µm, angles in whole hundredths of a degree."""

    joint: str
    type: JointType
    a: int
    alpha: int
    d: int
    theta: int
    offset: int
    sign: int
    limits: tuple[int, int] | None


def length(micrometres: int) -> float:
    return float(f"{micrometres}e-6")


def angle(hundredths: int) -> float:
    return float(f"{hundredths}e-2") / 90 * HALF_PI


def meaning(row: Row, number: int) -> DHRow:
    joint = length if row.type is JointType.PRISMATIC else angle
    lower, upper = map(joint, row.limits) if row.limits else (None, None)
    return DHRow(
        joint=row.joint,
        link=f"link_{number}",
        type=row.type,
        a=length(row.a),
        alpha=angle(row.alpha),
        d=length(row.d),
        theta=angle(row.theta),
        offset=joint(row.offset),
        sign=row.sign,
        limits=Limits(lower=lower, upper=upper),
    )


lengths = st.integers(-2_000_000, 2_000_000)
angles = st.sampled_from([0, 9000, -9000, 18000]) | st.integers(-18000, 18000)
visible = st.characters(codec="utf-16", exclude_categories=["Cc", "Cf", "Cs", "Zl", "Zp", "Zs", "Co", "Cn"])
names = st.text(visible, min_size=1, max_size=8).filter(lambda name: not name.startswith("#"))


@st.composite
def rows(draw: st.DrawFn, joint: str) -> Row:
    kind = draw(st.sampled_from(JointType))
    fixed = kind is JointType.FIXED
    bounded = kind in (JointType.REVOLUTE, JointType.PRISMATIC)
    limits = tuple(sorted(draw(st.tuples(angles, angles)))) if bounded and draw(st.booleans()) else None
    return Row(
        joint=joint,
        type=kind,
        a=draw(lengths),
        alpha=draw(angles),
        d=draw(lengths),
        theta=draw(angles),
        offset=0 if fixed else draw(angles),
        sign=1 if fixed else draw(st.sampled_from([1, -1])),
        limits=limits,  # type: ignore[arg-type] - two of them
    )


arms = st.lists(names, min_size=1, max_size=6, unique_by=str.casefold).flatmap(
    lambda joints: st.tuples(*(rows(f"j{joint}") for joint in joints))
)


def decimal(number: int, power: int, *, comma: bool) -> str:
    text = f"{Decimal(number).scaleb(-power):f}"
    return text.replace(".", ",") if comma else text


def cells(row: Row, draw: st.DrawFn, unit: str, *, comma: bool) -> dict[str, str]:
    def of_length(micrometres: int) -> str:
        return decimal(micrometres, 6 - LENGTH_UNITS[unit], comma=comma)

    def of_joint(number: int) -> str:
        """A value whose unit depends on the joint, with its own unit: no column has one for both."""
        if row.type is JointType.PRISMATIC:
            return f"{decimal(number, 3, comma=comma)} mm"
        return f"{decimal(number, 2, comma=comma)}{draw(st.sampled_from([' deg', '°', 'deg']))}"

    lower, upper = map(of_joint, row.limits) if row.limits else ("", "")
    return {
        "joint": row.joint,
        "type": draw(st.sampled_from(TYPES[row.type])),
        "a": of_length(row.a),
        "alpha": decimal(row.alpha, 2, comma=comma),
        "d": of_length(row.d),
        "theta": decimal(row.theta, 2, comma=comma),
        "offset": of_joint(row.offset),
        "sign": str(row.sign),
        "lower": lower,
        "upper": upper,
    }


def quoted(text: str, delimiter: str, *, always: bool) -> str:
    if always or delimiter in text or '"' in text:
        return '"' + text.replace('"', '""') + '"'
    return text


@st.composite
def dialects(draw: st.DrawFn) -> tuple[tuple[Row, ...], Convention, bytes]:
    """An arm, its convention, and a CSV file that says both."""
    arm = draw(arms)
    convention = draw(st.sampled_from(Convention))
    delimiter = draw(st.sampled_from([",", ";", "\t"]))
    comma = delimiter != "," and draw(st.booleans())
    unit = draw(st.sampled_from(sorted(LENGTH_UNITS)))
    previous = convention is Convention.MODIFIED and draw(st.booleans())
    spelling = HEADERS | (PREVIOUS if previous else {})
    if previous:
        spelling = {**spelling, "d": ["d_i", "d"], "theta": ["theta_i", "θ"]}
    order = draw(st.permutations(sorted(HEADERS)))
    header = []
    for name in order:
        text = draw(st.sampled_from(spelling[name]))
        if name == "type" and text == "sigma":  # beside r they are other letters' meaning, and refused
            spelling = {**spelling, "a": [word for word in spelling["a"] if word != "r"]}
        if name == "a" and text == "r":
            spelling = {**spelling, "type": [word for word in spelling["type"] if word != "sigma"]}
        units = {"a": unit, "d": unit, "alpha": "deg", "theta": "°"}
        header.append(
            text + draw(st.sampled_from([" [{}]", "({})", " ({})"])).format(units[name]) if name in units else text
        )
    always = draw(st.booleans())
    # CSV knows no space before a quote.
    bare = not always and not any(delimiter in row.joint or '"' in row.joint for row in arm)
    space = draw(st.sampled_from(["", " "])) if bare else ""
    lines = [delimiter.join(quoted(text, delimiter, always=always) for text in header)]
    for row in arm:
        texts = cells(row, draw, unit, comma=comma)
        lines.append(delimiter.join(space + quoted(texts[name], delimiter, always=always) for name in order))
        lines += draw(st.sampled_from([[], [""], ["# a comment, with; delimiters"], [delimiter * (len(order) - 1)]]))
    word = draw(
        st.sampled_from(["standard", "DH", "Classic"] if convention is Convention.STANDARD else ["MDH", "craig"])
    )
    top = [f"# Convention: {word}", "# Source: somebody's manual, p. 12", ""]
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    text = end.join([*top, *lines]) + draw(st.sampled_from(["", end]))
    encoding = draw(st.sampled_from(ENCODINGS))
    bom = {"utf-16-le": codecs.BOM_UTF16_LE, "utf-16-be": codecs.BOM_UTF16_BE}.get(encoding, b"")
    return arm, convention, bom + text.encode(encoding)


def read(content: bytes, suffix: str, **options: Any) -> list[Manipulator | Rejected]:
    reader = csv.READER if suffix == ".csv" else yaml.READER
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"arm{suffix}"
        path.write_bytes(content)
        return list(reader.read(path, TableOptions(**options)))


def same(arm: Manipulator | Rejected, rows: Sequence[Row], convention: Convention) -> None:
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    assert arm.convention is convention
    assert arm.rows == tuple(meaning(row, number) for number, row in enumerate(rows, start=1))


@given(dialects())
@settings(max_examples=200)
def test_a_csv_table_means_the_same_in_every_dialect(table: tuple[tuple[Row, ...], Convention, bytes]) -> None:
    """Delimiters, decimal commas, units, headers, encodings, line ends, quotes, comments: the same doubles."""
    rows, convention, content = table
    (arm,) = read(content, ".csv")
    same(arm, rows, convention)


@given(arms, st.sampled_from(Convention), st.booleans())
def test_a_yaml_table_means_the_same_as_its_rows(rows: tuple[Row, ...], convention: Convention, texts: bool) -> None:  # noqa: FBT001 - a drawn value
    """Numbers, and numbers in quotes, in the units that the table declares."""

    def number(value: int, power: int) -> str | float:
        text = decimal(value, power, comma=False)
        return text if texts else float(text)

    joints = []
    for row in rows:
        power = 3 if row.type is JointType.PRISMATIC else 2
        joint = {
            "name": row.joint,
            "type": row.type,
            "a": number(row.a, 3),
            "alpha": number(row.alpha, 2),
            "d": number(row.d, 3),
            "theta": number(row.theta, 2),
            "offset": number(row.offset, power),
            "flip": row.sign < 0,
        }
        if row.limits:
            joint["limits"] = {"lower": number(row.limits[0], power), "upper": number(row.limits[1], power)}
        joints.append(joint)
    units = {"length": "mm", "angle": "deg"}
    table = {"convention": convention, "units": units, "joints": joints}
    (arm,) = read(json.dumps(table).encode(), ".yaml")
    same(arm, rows, convention)


plain_numbers = st.sampled_from(
    ["0", "0.5", "-0.25", "1.5707963267948966", "-0", "1e-3", "+2.", ".5", "3", "0.0", "12.5", "1.25", "50"]
)
odd_cells = st.sampled_from(
    (
        "",
        " ",
        "1.57",
        "pi/2",
        "90 deg",
        "nan",
        "inf",
        "-inf",
        "1_0",
        "٣",
        "1e400",
        "400",
        "7",
        "x",
        "#REF!",
        "j1",
        "world",
        "1,5",
        "0x10",
        "flange",
        "é",
        "\x1f",
        "fixed",
        "continuous",
        "P",
        '"a"',
        "-5",
        "1\xa0",
        "0",
        "DH",
        "craig",
        "q1",
        "flange ",
        "J1",
        "link_1-tool0",
        "base_link",
        "2e4",
        "-1e-400",
        '"1\n2"',
        '"revolute\n"',
    )
)
COLUMNS = ["robot", "joint", "link", "i", "type", "a", "alpha", "d", "theta", "offset", "lower", "upper", "velocity"]
WORDS = ["revolute", "revolute", "R", "prismatic", "continuous", "fixed"]
EXPRESSIONS = ["pi/2", "-pi/2", "0", "90deg", "0.1 + 0.02", "-0.25", "1e-3", "50 mm"]
LIMITS = {
    "lower": ["-1", "-2", "", "-0.5"],
    "upper": ["1", "2", "", "pi"],
    "velocity": ["1", "", "2"],
    "effort": ["5", ""],
}
UNITS = {"a": "mm", "d": "cm", "alpha": "deg", "theta": "deg", "offset": "deg", "lower": "deg", "upper": "deg"}


@st.composite
def large_tables(draw: st.DrawFn) -> str:
    """Several manipulators, plain for the most part, with an odd cell now and then."""
    more = st.lists(st.sampled_from([*COLUMNS, "effort", "convention"]), max_size=9, unique=True)
    columns = ["a", "alpha", "d", *draw(more)]
    columns = list(dict.fromkeys(columns))
    if draw(st.booleans()) and "lower" in columns:
        columns = list(dict.fromkeys([*columns, "lower", "upper", "velocity", "effort"]))
    headers = [
        f"{name} [{UNITS[name]}]" if name in UNITS and draw(st.integers(0, 3)) == 0 else name for name in columns
    ]
    delimiter = draw(st.sampled_from([",", ",", ";"]))
    lines = [delimiter.join([*headers, ""])]
    mixed, own_names = draw(st.booleans()), draw(st.booleans())
    expressions = draw(st.sets(st.sampled_from(["a", "alpha", "d", "theta", "offset"]), max_size=2))
    for robot in range(draw(st.integers(1, 4))):
        end = f"_{robot}" if own_names else ""
        for number in range(1, draw(st.integers(1, 4)) + 1):
            words = {"robot": f"arm{robot}", "joint": f"j{number}{end}", "link": f"l{number}", "i": str(number)}
            words |= {"type": "revolute", "velocity": "1", "effort": "2", "upper": "3", "convention": "DH"}
            words |= {name: draw(st.sampled_from(EXPRESSIONS)) for name in sorted(expressions)}
            if mixed:
                words["type"] = draw(st.sampled_from(WORDS))
                words |= {name: draw(st.sampled_from(texts)) for name, texts in LIMITS.items()}
            line = [words[name] if name in words else draw(plain_numbers) for name in columns]
            if draw(st.integers(0, 5)) == 0:
                line[draw(st.integers(0, len(line) - 1))] = draw(odd_cells)
            lines.append(delimiter.join([*line, ""]))
    return "\n".join(lines)


@given(large_tables())
@settings(max_examples=600)
def test_the_fast_way_reads_what_the_careful_one_reads(content: str) -> None:
    """Every manipulator, every notice and every error is the same with and without it."""
    fast = PlainRows.read
    taken: list[int] = []

    def careful(*_arguments: Any) -> None:
        return None

    def counted(*arguments: Any) -> Any:
        result = fast(*arguments)
        taken.append(len(result or ()))
        return result

    results = []
    try:
        for way in (counted, careful):
            PlainRows.read = way  # type: ignore[assignment, method-assign]
            try:
                options = {} if "convention" in content.partition("\n")[0] else {"convention": "standard"}
                read_back = read(content.encode(), ".csv", **options)
                results.append([(arm, [str(p) for p in problems(arm)], marks(arm)) for arm in read_back])
            except TableError as error:
                results.append(str(error))
    finally:
        PlainRows.read = fast  # type: ignore[method-assign]
    assert strip_folder(results[0]) == strip_folder(results[1])


def problems(arm: Manipulator | Rejected) -> tuple[Any, ...]:
    return arm.notices if isinstance(arm, Manipulator) else arm.problems


def marks(arm: Manipulator | Rejected) -> list[int | None]:
    return [row.mark.line if row.mark else None for row in arm.rows] if isinstance(arm, Manipulator) else []


def strip_folder(result: Any) -> str:
    import re

    return re.sub(r"[\w/.-]*arm\.csv", "arm.csv", repr(result))


def test_the_fast_way_is_taken_by_plain_tables(tmp_path: Path, monkeypatch: Any) -> None:
    """A table of a benchmark's kind, units and limits included, goes the fast way as a whole."""
    header = "robot,i,joint,type,a [mm],alpha [deg],d [mm],theta [deg],lower [deg],upper [deg],velocity [rad/s],effort"
    lines = [
        f"r{robot},{joint},joint_{joint},revolute,{joint}.5,90,{robot}.25,-45,-180,180,3.14,50"
        for robot in range(2000)
        for joint in range(1, 7)
    ]
    path = tmp_path / "arms.csv"
    path.write_text("\n".join([header, *lines]))
    counts: list[int] = []
    fast = PlainRows.read

    def counted(self: PlainRows, rows: Any, lines: Any, sizes: Any) -> Any:
        result = fast(self, rows, lines, sizes)
        counts.append(len(sizes) if result else 0)
        return result

    monkeypatch.setattr(PlainRows, "read", counted)
    arms = list(csv.READER.read(path, TableOptions(convention="standard")))
    assert (len(arms), sum(counts)) == (2000, 2000)
    assert {type(row) for arm in arms if isinstance(arm, Manipulator) for row in arm.rows} == {DHRow}
