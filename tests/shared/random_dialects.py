"""Tables of random arms in random dialects of CSV."""

import codecs
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import strategies as st

from dh2urdf.manipulator import Convention, JointType, Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.table import TableOptions

LENGTH_UNITS = {"m": 0, "cm": 2, "mm": 3, "µm": 6}
HEADERS = {
    "joint": ["joint", "Joint name", "NAME", "joint-name", "Axis", "Gelenk", "articulation"],
    "type": ["type", "Joint Type", "kind", "sigma", "Typ", "tipo"],
    "a": ["a", "A", "a_i", "aᵢ", "$a_i$", "link length", "DH a", "Länge", "a†"],
    "alpha": ["alpha", "ALPHA", "α", "alpha_i", "α_{i}", "twist", r"\alpha_i", "Link_Twist"],
    "d": ["d", "d_i", "dᵢ", "Link offset"],
    "theta": ["theta", "θ", "Theta_i", "joint angle", "θᵢ"],
    "offset": ["offset", "joint_offset"],
    "sign": ["sign", "Direction", "joint sign", "Vorzeichen"],
    "lower": ["lower", "q_min", "lower limit", "q_lo", "Min. angle", "untere Grenze", "límite inferior"],
    "upper": ["upper", "qmax", "max", "upper_bound", "obere Grenze", "limite supérieure"],
}
PREVIOUS = {"a": ["a_{i-1}", "aᵢ₋₁", "a(i-1)", "a_i-1"], "alpha": ["alpha_{i-1}", "αᵢ₋₁", "α_{i−1}", "alpha_im1"]}
TYPES = {
    JointType.REVOLUTE: ["revolute", "R", "Rotational", "REVOLUTE"],
    JointType.PRISMATIC: ["prismatic", "P", "linear", "T"],
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


def read(content: bytes) -> list[Manipulator | Rejected]:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "arm.csv"
        path.write_bytes(content)
        return list(stages.CSV.read(path, TableOptions()))
