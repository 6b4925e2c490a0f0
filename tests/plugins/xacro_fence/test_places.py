"""Every element of an expanded xacro is found at its place in the sources, and so is every call of a macro."""

import re
from itertools import count
from pathlib import Path

import pytest
from lxml import etree

from dh2urdf.errors import ProofError
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign
from dh2urdf_plugins.xacro_fence.places import Place

ROBOT = '<?xml version="1.0"?>\n<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">\n{}\n</robot>\n'
ARM = """
<!-- a comment
     of two lines --><link name="base"/>
<xacro:include filename="parts/part.xacro"/>
<xacro:if value="${1 > 0}"><link name="if"/></xacro:if>
<xacro:unless value="true"><link name="never"/></xacro:unless>
  <xacro:pair prefix="a"><origin xyz="0 0 1"/></xacro:pair>
<xacro:pair
    prefix="b">
  <origin xyz="0 0 2"/></xacro:pair>
<xacro:property name="which" value="finger"/>
<xacro:call macro="${which}" name="dynamic"/>
"""
PART = """<link name="of_part"/> <xacro:macro name="pair" params="prefix *where">
  <link name="${prefix}"><visual><xacro:insert_block name="where"/><xacro:insert_block name="where"/></visual></link>
  <xacro:finger name="${prefix}_left"/>
    <xacro:finger name="${prefix}_right"/>
</xacro:macro>
<xacro:macro name="finger" params="name"><link name="${name}">
  <inertial><mass value="1"/></inertial></link></xacro:macro>"""


def write(folder: Path) -> tuple[Path, dict[str, tuple[Path, int]]]:
    """The files, each element with a number of its own, and the file and offset where each begins."""
    numbers, starts = count(), dict[str, tuple[Path, int]]()
    (folder / "parts").mkdir()
    for name, text in {"arm.xacro": ARM, "parts/part.xacro": PART}.items():
        path = folder / name
        numbered = re.sub(r"<[a-z]\w*(?=[ >/])", lambda tag: f'{tag[0]} n="{next(numbers)}"', text)
        path.write_text(ROBOT.format(numbered))
        for found in re.finditer(r'<\w+ n="(\d+)"', path.read_text()):
            starts[found[1]] = (path, found.start())
    return folder / "arm.xacro", starts


def offset(place: Place) -> tuple[Path, int]:
    text = Path(place.file).read_text()
    return Path(place.file), sum(len(line) for line in text.splitlines(keepends=True)[: place.line - 1]) + (
        place.column - 1
    )


def test_every_element_is_where_it_was_written(tmp_path: Path) -> None:
    """In the file, in included files, in macros, in blocks that are inserted twice, and behind conditions."""
    path, starts = write(tmp_path)
    expanded = expand_foreign(path)
    elements = list(etree.fromstring(expanded.content).iter("*"))
    assert len(elements) == len(expanded.places)
    numbered = [
        (element, place) for element, place in zip(elements, expanded.places, strict=True) if "n" in element.attrib
    ]
    assert len(numbered) == 1 + 1 + 1 + 2 * (4 + 2 * 3) + 3
    for element, place in numbered:
        assert place is not None
        assert offset(place) == starts[element.attrib["n"]]


def test_calls_are_told_from_the_innermost_on(tmp_path: Path) -> None:
    """Of a macro in a macro both, each in the file where it stands; of an element outside macros none."""
    path, _ = write(tmp_path)
    expanded = expand_foreign(path)
    elements = etree.fromstring(expanded.content).iter("*")
    calls = {
        element.attrib["name"]: [offset(call) for call in place.calls]
        for element, place in zip(elements, expanded.places, strict=True)
        if element.tag == "link" and place
    }
    arm, part = path, tmp_path / "parts" / "part.xacro"

    def at(file: Path, text: str) -> tuple[Path, int]:
        return file, file.read_text().index(text)

    assert calls["base"] == calls["of_part"] == calls["if"] == []
    assert calls["a"] == [at(arm, '<xacro:pair prefix="a"')]
    outer = at(arm, "<xacro:pair\n")
    assert calls["b"] == [outer]
    assert calls["b_left"] == [at(part, '<xacro:finger name="${prefix}_left"'), outer]
    assert calls["b_right"] == [at(part, '<xacro:finger name="${prefix}_right"'), outer]
    assert calls["dynamic"] == [at(arm, "<xacro:call")]


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("arm.xacro", '<xacro:if value="${1 > 0}"', '<xacro:if value="${nobody}"'),
        ("parts/part.xacro", '<mass n="10" value="1"', '<mass n="10" value="${nobody}"'),
        ("arm.xacro", '<xacro:include filename="parts', '<xacro:include filename="nowhere'),
    ],
)
def test_a_failure_is_placed(tmp_path: Path, file: str, old: str, new: str) -> None:
    """At the innermost element that xacro was at, in whatever file."""
    path, _ = write(tmp_path)
    text = (tmp_path / file).read_text()
    assert text.count(old) == 1, text
    (tmp_path / file).write_text(text.replace(old, new))
    with pytest.raises(ProofError) as caught:
        expand_foreign(path)
    mark = caught.value.problems[0].mark
    assert mark is not None
    assert mark.file == str(tmp_path / file)
    line = (tmp_path / file).read_text().splitlines()[(mark.line or 0) - 1]
    assert line[(mark.column or 0) - 1 :].startswith(new)


def test_files_are_named_as_the_first_one_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first as it was given; others relative to the current folder, where they are in it and the first is."""
    write(tmp_path)
    monkeypatch.chdir(tmp_path / "parts")
    assert {place.file for place in expand_foreign(Path("../arm.xacro")).places if place} == {
        "../arm.xacro",
        "part.xacro",
    }
    monkeypatch.chdir(tmp_path)
    assert {place.file for place in expand_foreign(Path("arm.xacro")).places if place} == {
        "arm.xacro",
        "parts/part.xacro",
    }
