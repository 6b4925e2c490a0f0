"""What a file costs grows with its length: every place of text, every reader and every rule of `check`, with n and 4 n.

Four times as much takes less than eight times as long, in processor time of one process; with a square it would be
sixteen. What takes too little to be measured passes.
"""

import gc
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.errors import Dh2UrdfError
from dh2urdf_check.inspection import inspect_mjcf, inspect_sdf, inspect_urdf
from dh2urdf_plugins.formats import foreign_mjcf as read_mjcf, foreign_sdf as read_sdf
from dh2urdf_plugins.formats.urdf.reader import read_urdf
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

pytestmark = pytest.mark.long
MOST = 8.0
"""How many times as long four times as much may take."""
MEASURABLE = 0.1
"""Processor time below which nothing is said of it [s]."""
ATOMS = ("1 mm ", "a-1", ",", "a")
"""What a long text repeats."""
CSV = "# convention: standard\n{}joint,a,alpha,d,theta{}\nj1,0.1,0,0.2,0{}\nj2,0.1,0,0.2,0\n"
YAML = "convention: standard\njoints:\n- {a: 0.1, alpha: 0, d: 0.2}\n- {a: 0.1, alpha: 0, d: 0.2}\n"


def cost(content: str | bytes, path: Path, read: Callable[[Path], object]) -> float:
    """Processor time of reading a file, the smaller one of two [s]; that it is refused does not matter."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    times = []
    gc.collect()
    gc.disable()  # It looks at everything that the tests before have left, too.
    try:
        while len(times) < 2 and (not times or times[0] >= MEASURABLE):
            begun = time.process_time()
            with suppress(Dh2UrdfError):
                read(path)
            times.append(time.process_time() - begun)
    finally:
        gc.enable()
    return min(times)


def grows(make: Callable[[int], str | bytes], n: int, path: Path, read: Callable[[Path], object]) -> str:
    """How much longer four times as much takes, where each of five measurements says more than it may be; else nothing.

    A square is one each time; a processor that others use, too, is slow in one measurement and not in the next.
    """
    said = ""
    for _ in range(5):
        large = cost(make(4 * n), path, read)
        if large < MEASURABLE or large <= MOST * (small := cost(make(n), path, read)):
            return ""
        said = f"{small:.2f} s and {large:.2f} s"
    return said


def of_text(place: Callable[[str], str | bytes], path: Path, read: Callable[[Path], object], n: int = 2000) -> None:
    """Asserts that it does not matter what a long text in some place repeats."""
    cost(place("x"), path, read)  # What is imported at first is not counted.
    slow = {atom: found for atom in ATOMS if (found := grows(lambda n, a=atom: place((a * n)[:n]), n, path, read))}  # type: ignore[misc]
    assert not slow


def table(reader: str) -> Callable[[Path], object]:
    """What reads all tables of a file."""
    plugin: Any = {"csv": stages.CSV, "yaml": stages.YAML, "xlsx": stages.XLSX, "parquet": stages.PARQUET}[reader]
    return lambda path: list(plugin.read(path, plugin.options()))


# --- Places of text ---------------------------------------------------------------------------------------------------

CSV_TEXTS: dict[str, Callable[[str], str]] = {
    "a comment": lambda text: CSV.format(f"# x {text}\n", "", ""),
    "a title": lambda text: CSV.format(f"x {text}\n", "", ""),
    "a header": lambda text: CSV.format("", "", "").replace("theta", f"theta {text}"),
    "a cell": lambda text: CSV.format("", "", "").replace("0.1", text, 1),
}
YAML_TEXTS: dict[str, Callable[[str], str]] = {
    "a comment": lambda text: f"# x {text}\n{YAML}",
    "a number": lambda text: YAML.replace("0.1", quoted(text), 1),
    "a key": lambda text: f"{quoted(text)}: 1\n{YAML}",
}


def quoted(text: str) -> str:
    return "'" + text.replace("'", "") + "'"


@pytest.mark.parametrize("place", CSV_TEXTS)
def test_a_long_text_in_csv(place: str, tmp_path: Path) -> None:
    """Comments took the square of their length, 16,000 characters 24 s; so did titles, headers and cells."""
    of_text(CSV_TEXTS[place], tmp_path / "arm.csv", table("csv"))


@pytest.mark.parametrize("place", YAML_TEXTS)
def test_a_long_text_in_yaml(place: str, tmp_path: Path) -> None:
    """As in CSV; JSON is read in the same way."""
    of_text(YAML_TEXTS[place], tmp_path / "arm.yaml", table("yaml"))


def in_xml(text: str) -> str:
    return text.replace("&", "&amp;").replace('"', "")


URDF_NAMES = (
    '<robot name="{0}"><link name="{0}"><visual><geometry><mesh filename="{0}" scale="{0}"/></geometry><material name="{0}"/>'
    '</visual></link><link name="b"/><joint name="{0}" type="{0}"><parent link="x{0}"/><child link="b"/>'
    '<mimic joint="{0}"/></joint><gazebo reference="{0}"><mu1>{0}</mu1></gazebo>{0}</robot>'
)
SDF_TEXTS = (
    '<sdf version="{0}"><model name="m{0}"><link name="x"><pose>{0}</pose><visual name="{0}"><geometry><box><size>{0}</size>'
    "</box></geometry><material><diffuse>{0}</diffuse></material></visual></link><link name='y'/><joint name='j' type='{0}'>"
    '<parent>x</parent><child>{0}</child><axis><xyz expressed_in="{0}">{0}</xyz></axis></joint><frame name="f"'
    ' attached_to="{0}"><pose relative_to="{0}"/></frame></model></sdf>'
)
MJCF_TEXTS = (
    '<mujoco model="{0}"><compiler meshdir="{0}" eulerseq="{0}" angle="{0}"/><asset><mesh name="x" file="{0}" vertex="{0}"/>'
    '</asset><worldbody><body name="{0}" pos="{0}" quat="{0}" childclass="{0}"><joint name="{0}" type="{0}" range="{0}"/>'
    '<geom size="{0}" mesh="{0}" fromto="{0}" rgba="{0}"/></body></worldbody></mujoco>'
)
XML_TEXTS = {"urdf names": (".urdf", URDF_NAMES), "sdf": (".sdf", SDF_TEXTS), "mjcf": (".mjcf", MJCF_TEXTS)}
READ_AND_CHECKED: dict[str, tuple[Callable[[Path], object], Callable[[Path], object]]] = {
    ".urdf": (read_urdf, inspect_urdf),
    ".sdf": (read_sdf, inspect_sdf),
    ".mjcf": (read_mjcf, inspect_mjcf),
    ".xacro": (expand_foreign, expand_foreign),
}


@pytest.mark.parametrize("place", XML_TEXTS)
@pytest.mark.parametrize("asked", ["read", "checked"])
def test_a_long_text_in_a_description(place: str, asked: str, tmp_path: Path) -> None:
    """In names, numbers and what is between elements. A version of 5,000 digits ended in an internal error."""
    suffix, form = XML_TEXTS[place]
    read = READ_AND_CHECKED[suffix][asked == "checked"]
    of_text(lambda text: form.replace("{0}", in_xml(text)), tmp_path / f"arm{suffix}", read)


@pytest.mark.parametrize("suffix", READ_AND_CHECKED)
def test_a_long_comment_in_a_description(suffix: str, tmp_path: Path) -> None:
    """A comment is passed over, however long it is."""
    root = {
        ".sdf": '<sdf version="1.9">{}<model name="m"><link name="a"/></model></sdf>',
        ".mjcf": "<mujoco>{}</mujoco>",
    }
    form = root.get(suffix, '<robot name="r">{}<link name="a"/></robot>')
    for read in READ_AND_CHECKED[suffix]:
        of_text(lambda text: form.format(f"<!-- {text.replace('-', '=')} -->"), tmp_path / f"arm{suffix}", read)


# --- Many of one kind -------------------------------------------------------------------------------------------------


def each(form: str, n: int) -> str:
    """A text n times, with the number (i), the one before (h) and the one behind (k) in it."""
    return "".join(form.format(i=i, h=i - 1, k=i + 1) for i in range(n))


def chain(n: int, more: str = "", parent: str = "l{i}") -> str:
    """A URDF of n joints."""
    link = (
        '<link name="l{i}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        '<visual><geometry><box size="1 1 1"/></geometry></visual></link>'
    )
    joint = (
        f'<joint name="j{{i}}" type="revolute"><parent link="{parent}"/><child link="l{{k}}"/><axis xyz="0 0 1"/>'
        f'<limit lower="-1" upper="1" effort="1" velocity="1"/>{more}</joint>'
    )
    return each(link, n + 1) + each(joint, n)


URDF: dict[str, Callable[[int], str]] = {
    "links": chain,
    "misspelt parents": lambda n: chain(n, parent="lnk{i}x"),
    "two joints to each link": lambda n: (
        chain(n) + each('<joint name="k{i}" type="fixed"><parent link="l{i}"/><child link="l{k}"/></joint>', n)
    ),
    "joints that follow each other": lambda n: chain(n, more='<mimic joint="j{h}"/>'),
}
SDF_LINKS = '<link name="l{i}"><inertial><mass>1</mass></inertial></link>'
SDF_JOINT = (
    '<joint name="j{i}" type="revolute"><parent>l{i}</parent><child>l{k}</child><axis><xyz>0 0 1</xyz></axis></joint>'
)


def sdf_chain(n: int, joint: str = SDF_JOINT) -> str:
    return each(SDF_LINKS, n + 1) + each(joint, n)


SDF: dict[str, Callable[[int], str]] = {
    "links": sdf_chain,
    "misspelt parents": lambda n: sdf_chain(n, joint=SDF_JOINT.replace("<parent>l{i}", "<parent>lnk{i}x")),
    "frames in a ring": lambda n: (
        '<link name="a"/>'
        + each('<frame name="f{k}" attached_to="f{i}"/>', n)
        + f'<frame name="f0" attached_to="f{n}"/>'
    ),
}


def bodies(n: int) -> str:
    inside = each('<body name="b{i}"><joint name="jnt{i}"/><geom size="1"/><site name="s{i}"/></body>', n)
    return f"<worldbody>{inside}</worldbody>"


MJCF: dict[str, Callable[[int], str]] = {
    "bodies": bodies,
    "misspelt classes": lambda n: (
        "<default>"
        + each('<default class="class{i}"><geom size="1"/></default>', n)
        + "</default><worldbody>"
        + each('<body><geom class="clas{i}x"/></body>', n)
        + "</worldbody>"
    ),
    "misspelt joints of actuators": lambda n: (
        bodies(n) + "<actuator>" + each('<motor name="a{i}" joint="jont{i}x"/>', n) + "</actuator>"
    ),
}
DESCRIPTIONS = {
    **{f"urdf: {name}": (".urdf", '<robot name="r">{}</robot>', make) for name, make in URDF.items()},
    **{
        f"sdf: {name}": (".sdf", '<sdf version="1.9"><model name="m">{}</model></sdf>', make)
        for name, make in SDF.items()
    },
    **{f"mjcf: {name}": (".mjcf", "<mujoco>{}</mujoco>", make) for name, make in MJCF.items()},
    "xacro: properties of each other": (
        ".xacro",
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r"><xacro:property name="p0" value="1"/>{}</robot>',
        lambda n: each('<xacro:property name="p{k}" value="${{p0 + {i}}}"/><link name="a${{p{k}}}"/>', n),
    ),
    "xacro: macros": (
        ".xacro",
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">{}</robot>',
        lambda n: each(
            '<xacro:macro name="m{i}" params="x"><link name="l${{x}}"/></xacro:macro><xacro:m{i} x="{i}"/>', n
        ),
    ),
}


@pytest.mark.parametrize("case", DESCRIPTIONS)
def test_many_parts_of_a_description(case: str, tmp_path: Path) -> None:
    """Misspelt names were compared with all others, chains walked from each of their parts: 1,200 joints took 75 s."""
    suffix, form, make = DESCRIPTIONS[case]
    path = tmp_path / f"arm{suffix}"
    for read in dict.fromkeys(READ_AND_CHECKED[suffix]):
        cost(form.replace("{}", make(2)), path, read)
        assert not grows(lambda n: form.replace("{}", make(n)), 150, path, read), read


TABLES: dict[str, tuple[str, Callable[[int], str]]] = {
    "csv: comments": (".csv", lambda n: CSV.format("# x 1 mm\n" * n, "", "")),
    "csv: columns": (".csv", lambda n: CSV.format("", each(",c{i}", n), ",1" * n)),
    "csv: rows": (".csv", lambda n: CSV.format("", "", "") + each("k{i},0.1,0,0.2,0\n", n)),
    "yaml: merges": (".yaml", lambda n: YAML.replace("- {", "- &x {", 1) + "- {<<: *x, d: 1}\n" * n),
}


@pytest.mark.parametrize("case", TABLES)
def test_many_parts_of_a_table(case: str, tmp_path: Path) -> None:
    """Columns, comments, rows that hold nothing, and what YAML repeats."""
    suffix, make = TABLES[case]
    path = tmp_path / f"arm{suffix}"
    cost(make(2), path, table(suffix[1:]))
    assert not grows(make, 750, path, table(suffix[1:]))
