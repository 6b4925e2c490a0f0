"""Names from a user's file are text in all that is written for people: Markdown, and tables that spreadsheets open."""

import json
import re
import shutil
import subprocess
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from command_line import Cli
from markdown import markdown
from markdown_it import MarkdownIt

import dh2urdf as api
from dh2urdf.source import markdown_text

RENDERERS: dict[str, Callable[[str], str]] = {
    "Python-Markdown": lambda text: markdown(
        text, extensions=["tables", "attr_list", "fenced_code", "def_list", "md_in_html", "pymdownx.tilde"]
    ),
    "CommonMark": MarkdownIt("commonmark").enable(["table", "strikethrough"]).render,
}
HOSTILE = [
    *("q<img src=x onerror=window.P=40>", "a|b", "*x*", "[l](javascript:alert(1))", "![i](x.png)", "`c` ``d``", "```"),
    *("~~s~~ ~sub~", "a\nb", "1. x", "# h #", "&lt;b&gt; &amp; &#60;b&#62;", "a_b_c", "x {: onclick=alert(1) }"),
    *("<!-- x -->", "</td></table><script>alert(1)</script>"),
]


class Page(HTMLParser):
    """The elements of a page, with their attributes, and its text."""

    def __init__(self, html: str) -> None:
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, list[tuple[str, str | None]]]] = []
        self.text = ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, attrs))

    def handle_comment(self, data: str) -> None:
        self.elements.append(("comment", [("", data)]))

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.mark.parametrize("renderer", RENDERERS)
@pytest.mark.parametrize("form", ["# {}\n", "- {}\n", "A {} b.\n", "| a | b |\n|---|---|\n| {} | 1 |\n"])
def test_a_name_in_markdown_is_text(renderer: str, form: str) -> None:
    """Rendered, it is the same text in one line, among the elements that a plain name has there."""
    plain = Page(RENDERERS[renderer](form.format("NAME")))
    for name in HOSTILE:
        page = Page(RENDERERS[renderer](form.format(markdown_text(name))))
        assert page.elements == plain.elements, name
        assert page.text == plain.text.replace("NAME", " ".join(name.split()))


def table_with(folder: Path, robot: str, joint: str, link: str) -> Path:
    path = folder / "arm.yaml"
    path.write_text(
        f"name: {json.dumps(robot)}\nconvention: standard\njoints:\n"
        f"- {{name: {json.dumps(joint)}, link: {json.dumps(link)}, type: revolute, a: 0.3, alpha: 0, d: 0.1}}\n"
        "- {name: j2, type: revolute, a: -0.425, alpha: -1.5707963267948966, d: 0}\n"
    )
    return path


def every_markdown(cli: Cli, folder: Path, names: tuple[str, str, str]) -> dict[str, str]:
    """All Markdown that is written of an arm: its table, what `info` says, and the READMEs of its ROS packages."""
    folder.mkdir()
    path = table_with(folder, *names)
    cli("convert", path, "-o", folder / "arm.md")
    found = {"info": cli("info", path, "--markdown").stdout}
    path = table_with(folder, names[0], "j1", "l1")  # ROS takes no other names of joints and links
    cli("convert", path, "-o", folder / "ws", "--to", "ros2", "--set", "package=arm", "--set", "moveit=true")
    return found | {str(each.relative_to(folder)): each.read_text() for each in sorted(folder.rglob("*.md"))}


@pytest.mark.parametrize("renderer", RENDERERS)
def test_no_element_of_a_page_comes_from_a_name(cli: Cli, tmp_path: Path, renderer: str) -> None:
    """Markup in the names of a robot, a joint and a link; the same pages as of plain names, but for the names."""
    pytest.importorskip("pinocchio")  # It finds the collision pairs of one of the packages.
    hostile = ("q<img src=x onerror=window.P=40>", "j|*x*[l](javascript:alert(1))`c`", "l<svg onload=window.P=43>")
    pages = every_markdown(cli, tmp_path / "hostile", hostile)
    plain = every_markdown(cli, tmp_path / "plain", ("robot", "joint", "link"))
    assert list(pages) == list(plain)
    assert len(pages) == 4
    for name, text in pages.items():
        page, other = Page(RENDERERS[renderer](text)), Page(RENDERERS[renderer](plain[name]))
        lists = "li"  # A notice on hostile names is one item more.
        assert [each for each in page.elements if each[0] not in (lists, "ul", "p")] == [
            each for each in other.elements if each[0] not in (lists, "ul", "p")
        ]
        assert hostile[0] in page.text


COMPUTED = ["=1+1", "+1+1", "-1", "@SUM(1;2)", "=cmd|' /C calc'!A0", '=HYPERLINK("http://x";"y")', "'=1", "''=1", "'q"]


def test_names_come_back_from_csv(cli: Cli, tmp_path: Path) -> None:
    """An apostrophe stands before the signs that a spreadsheet computes; the reader takes it away, and no other."""
    for number, name in enumerate(COMPUTED):
        path = table_with(tmp_path, f"x,{name}", name, f"{name}.")
        cli("convert", path, "-o", tmp_path / f"{number}.csv")
        again, given = api.read(tmp_path / f"{number}.csv"), api.read(path)
        assert (again.name, again.rows[0].joint, again.rows[0].link) == (given.name, name, f"{name}.")
        assert [row.a for row in again.rows] == [0.3, -0.425]
    text = (tmp_path / "0.csv").read_text()
    assert text.splitlines()[3].startswith("'=1+1,'=1+1.,")
    assert ",-0.425,-pi/2,0" in text


@pytest.mark.skipif(shutil.which("soffice") is None, reason="LibreOffice is not installed")
def test_a_spreadsheet_computes_no_name(cli: Cli, tmp_path: Path) -> None:
    """LibreOffice finds no formula in a table; bare, `=1+1` is one. Numbers are numbers there."""
    rows = "".join(
        f"- {{name: {name!r}, link: {'l' + name!r}, type: revolute, a: -0.425, alpha: 0, d: 0.1}}\n"
        for name in ("=1+1", "@SUM(1)")
    )
    (tmp_path / "arm.yaml").write_text(f'name: "x,=1+1;=2"\nconvention: standard\njoints:\n{rows}')
    cli("convert", tmp_path / "arm.yaml", "-o", tmp_path / "arm.csv")
    cli("convert", tmp_path / "arm.yaml", "-o", tmp_path / "arm.urdf")
    cli("extract", tmp_path / "arm.urdf", "-o", tmp_path / "extracted.csv")
    (tmp_path / "bare.csv").write_text("joint,a\n=1+1,-0.425\n")
    sheets = {}
    for name in ("arm", "extracted", "bare"):
        subprocess.run(
            [str(shutil.which("soffice")), f"-env:UserInstallation=file://{tmp_path}/profile", "--headless", "--convert-to", "fods", f"{name}.csv"],
            cwd=tmp_path, check=True, capture_output=True, timeout=120,
        )  # fmt: skip
        sheets[name] = ET.parse(tmp_path / f"{name}.fods").getroot()  # noqa: S314 - of LibreOffice
    formulas = {
        name: [value for cell in sheet.iter() for key, value in cell.attrib.items() if key.endswith("}formula")]
        for name, sheet in sheets.items()
    }
    assert formulas == {"arm": [], "extracted": [], "bare": ["of:=1+1"]}
    for sheet in sheets.values():
        assert any(
            value == "-0.425" for cell in sheet.iter() for key, value in cell.attrib.items() if key.endswith("}value")
        )
    assert any(re.fullmatch("'=1\\+1", "".join(cell.itertext())) for cell in sheets["arm"].iter())
