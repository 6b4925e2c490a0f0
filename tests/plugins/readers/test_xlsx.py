from __future__ import annotations

import datetime as dt
import io
import math
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from openpyxl import Workbook
from openpyxl.chart import BarChart
from openpyxl.styles import Font

from dh2urdf.errors import MissingDependencyError, TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.sources import workbook
from dh2urdf_plugins.readers.sources.workbook import ShownOtherwiseError, shown_unit

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

HEADER = ["joint", "type", "a", "alpha", "d", "theta"]
FIRST = ["shoulder", "R", 0, "pi/2", 0.089159, None]
SECOND = ["elbow", "R", -0.425, 0, 0, None]
QUARTER = math.pi / 2


def read(path: str = "arm.xlsx", **options: Any) -> list[Manipulator | Rejected]:
    return list(stages.XLSX.read(Path(path), stages.XLSX.options(**{"convention": "standard", **options})))


def read_one(path: str = "arm.xlsx", **options: Any) -> Manipulator:
    (arm,) = read(path, **options)
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    return arm


def refusal(path: str = "arm.xlsx", **options: Any) -> str:
    try:
        items = read(path, **options)
    except TableError as error:
        return str(error)
    return "\n".join(str(problem) for item in items if isinstance(item, Rejected) for problem in item.problems)


def codes() -> list[str | None]:
    """Which messages refuse the one manipulator of a workbook."""
    (arm,) = read()
    assert isinstance(arm, Rejected)
    return [problem.code for problem in arm.problems]


def notices(arm: Manipulator) -> str:
    return "\n".join(map(str, arm.notices))


@pytest.fixture(autouse=True)
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def sheet() -> Worksheet:
    """The one sheet of a new workbook."""
    worksheet = Workbook().active
    assert worksheet is not None
    worksheet.title = "Sheet2"
    return worksheet


def fill(sheet: Worksheet, *rows: list[Any], at: str = "A1") -> Worksheet:
    """Writes rows, the first cell of the first one at a place, and saves the workbook."""
    corner = sheet[at]
    for down, row in enumerate(rows):
        for right, value in enumerate(row):
            sheet.cell(corner.row + down, corner.column + right).value = value
    save(sheet)
    return sheet


def save(sheet: Worksheet) -> None:
    sheet.parent.save("arm.xlsx")


def edit(pattern: str, replacement: str, part: str = "xl/worksheets/sheet1.xml", path: str = "arm.xlsx") -> None:
    """Replaces some of the XML of a part, which must be there."""
    with zipfile.ZipFile(path) as archive:
        parts = {info.filename: archive.read(info) for info in archive.infolist()}
    text, count = re.subn(pattern, replacement, parts[part].decode())
    assert count
    parts[part] = text.encode()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)


# --- Where the table stands -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("at", ["A1", "C4", "AA30"])
def test_a_table_may_stand_anywhere(sheet: Worksheet, at: str) -> None:
    """Empty rows and columns before it mean nothing."""
    fill(sheet, HEADER, FIRST, SECOND, at=at)
    arm = read_one()
    assert [(row.joint, row.a, row.alpha, row.d) for row in arm.rows] == [
        ("shoulder", 0.0, QUARTER, 0.089159),
        ("elbow", -0.425, 0.0, 0.0),
    ]
    assert (arm.name, arm.notices) == ("arm", ())
    sheet[sheet.dimensions.partition(":")[0]].offset(2, 2).value = "x"
    save(sheet)
    (wrong,) = read()
    place = sheet[sheet.dimensions.partition(":")[0]].offset(2, 2).coordinate
    assert [str(problem.mark) for problem in wrong.problems] == [f"arm.xlsx:Sheet2!{place}"]  # type: ignore[union-attr]


def test_what_stands_above_beside_and_below(sheet: Worksheet) -> None:
    """Statements hold; titles and notes are no rows."""
    fill(sheet, ["UR5 of the lab"], ["units: {length: mm, angle: deg}"], ["# convention", "standard"], ["# a remark"])
    fill(sheet, HEADER, ["j1", "R", 100, 90, 0], ["j2", "R", 0, 0, 50], [], ["Source: data sheet"], ["rev. B"], at="A6")
    fill(sheet, ["to be checked"], at="I7")
    arm = read_one(convention=None)
    assert [(row.a, row.alpha, row.d) for row in arm.rows] == [(0.1, QUARTER, 0.0), (0.0, 0.0, 0.05)]


# --- Headers ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "units", [["-", "-", "[mm]", "[°]", "[mm]", "[°]"], [None, None, "(mm)", "(deg)", "(mm)", None]]
)
def test_a_row_of_units_below_the_header(sheet: Worksheet, units: list[Any]) -> None:
    """Is part of it."""
    fill(sheet, HEADER, units, ["j1", "R", 100, 90, 0, None])
    row = read_one().rows[0]
    assert (row.a, row.alpha) == (0.1, QUARTER)


@pytest.mark.parametrize("is_empty", [True, False])
def test_a_sheet_that_is_a_chart_is_passed_over(sheet: Worksheet, is_empty: bool) -> None:  # noqa: FBT001 - a parameter of the test
    """One without a chart was an error of Python: 'list' object has no attribute 'find'."""
    chart = sheet.parent.create_chartsheet("Chart", 0)
    if not is_empty:
        chart.add_chart(BarChart())
    fill(sheet, HEADER, FIRST, SECOND)
    assert len(read_one().rows) == 2


def test_titles_over_several_columns(sheet: Worksheet) -> None:
    """A merged title gives the columns below it its unit."""
    fill(
        sheet, ["", "", "DH parameters", "", "", "Limits [deg]"], ["joint", "type", "a", "alpha", "d", "lower", "upper"]
    )
    fill(sheet, ["j1", "R", 0, 0, 0.5, -170, 170], at="A3")
    sheet.merge_cells("C1:E1")
    sheet.merge_cells("F1:G1")
    save(sheet)
    arm = read_one()
    assert (arm.rows[0].limits.lower, arm.rows[0].limits.upper) == pytest.approx(
        (-math.radians(170), math.radians(170))
    )


# --- Merged cells -----------------------------------------------------------------------------------------------------


def test_cells_merged_down_have_their_value_in_each_row(sheet: Worksheet) -> None:
    """The manipulator's name, and a number."""
    fill(sheet, ["robot", *HEADER], ["A", *FIRST], [None, *SECOND], ["B", *FIRST], [None, *SECOND])
    for cells in ("A2:A3", "A4:A5", "F2:F3"):
        sheet.merge_cells(cells)
    save(sheet)
    arms = [arm for arm in read() if isinstance(arm, Manipulator)]
    assert [(arm.name, [row.d for row in arm.rows]) for arm in arms] == [
        ("A", [0.089159, 0.089159]),
        ("B", [0.089159, 0.0]),
    ]


@pytest.mark.parametrize("cells", ["C2:D2", "C2:D3"])
def test_cells_merged_across_columns_are_refused(sheet: Worksheet, cells: str) -> None:
    """Whose value would it be?"""
    fill(sheet, HEADER, FIRST, SECOND)
    sheet.merge_cells(cells)
    save(sheet)
    assert (
        "arm.xlsx:Sheet2!C2: error: joint 'joint_1', field 'a': the cell with '0' is merged across several columns"
        in refusal()
    )


# --- Cells ------------------------------------------------------------------------------------------------------------


UNITS = {
    "": ["General", "0.00", "#,##0.00", "0.00E+00", "0.00;[Red]-0.00", "0_);(0)", "# ?/?", "@", "#'##0.00"],
    "mm": ['0.00" mm"', "0.0\\ \\m\\m", '[>100]0" mm";0" mm"', '+0.0" mm";-0.0" mm"', '#\'##0.00" mm"'],
    "°": ["0.0°", '0.0"°"'],
    "m": ['0.0" m";-0.0" m";0'],
}


@pytest.mark.parametrize(("number_format", "unit"), [(words, unit) for unit in UNITS for words in UNITS[unit]])
def test_what_a_number_format_shows(number_format: str, unit: str) -> None:
    """The unit behind the number, whatever else the format does."""
    assert shown_unit(number_format) == unit


@pytest.mark.parametrize(
    "number_format",
    [
        *("0%", "0.00%", "0,", '0.0" pcs"', "#,##0.00 [$€-407]", "$0.00", '"d = "0.00', '"mm "0.0'),
        *(";;;", ";;", ";-0.0", '0.0"\'"', "0.0'", "0.0\"''\""),
        *('0" mm";-0" m"', '[<1]0.0" mm";0.000" m"', '[Red][<1]0.0" mm";0" m"', '[=0]0;0" mm"'),
    ],
)
def test_formats_that_show_something_else(number_format: str) -> None:
    """A percentage, thousands, one unit or another, nothing, feet or minutes, and what is no unit."""
    with pytest.raises(ShownOtherwiseError):
        shown_unit(number_format)


_ACCOUNTING = '_(* #,##0.00_);_(* \\(#,##0.00\\);_(* "-"??_);_(@_)'


@pytest.mark.parametrize(
    ("number_format", "is_signed"),
    [
        *(("0.00;0.00", False), ('0" mm";0" mm"', False), ("General;General", False), ("0.0;0.0;-0.0", False)),
        *((words, True) for words in ("0.00", "0.00;-0.00", "0.00;[Red]0.00", "0_);(0)", "#,##0;−#,##0", _ACCOUNTING)),
    ],
)
def test_a_negative_number_is_shown_with_its_sign(number_format: str, is_signed: bool) -> None:  # noqa: FBT001 - a case
    """Its own section has a minus, brackets or a colour for it; that of other numbers has none, and zero may."""
    assert shown_unit(number_format, 1) == shown_unit(number_format)
    if is_signed:
        assert shown_unit(number_format, -1) == ""
    else:
        with pytest.raises(ShownOtherwiseError, match="another sign"):
            shown_unit(number_format, -1)


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("number_format", ['"-"0.0', "\\-0.00", "-0", "(0.0)"])
def test_a_format_has_no_sign_of_its_own(number_format: str, sign: int) -> None:
    with pytest.raises(ShownOtherwiseError, match="another sign"):
        shown_unit(number_format, sign)


def test_a_long_number_format_is_read_in_seconds() -> None:
    """A file from a stranger may have a million sections."""
    with pytest.raises(ShownOtherwiseError, match="nothing"):
        shown_unit(";" * 10**6)


def test_units_that_number_formats_show_are_read(sheet: Worksheet) -> None:
    """425 shown as `425 mm` is 0.425 m; with another unit in the header the cell's own counts, as in every table."""
    fill(sheet, HEADER, ["j1", "R", 425, 90, 0.5, None])
    sheet["C2"].number_format = '0" mm"'
    sheet["D2"].number_format = '0"°"'
    save(sheet)
    row = read_one().rows[0]
    assert (row.a, row.alpha, row.d) == (0.425, QUARTER, 0.5)
    sheet["E2"].number_format = "0%"
    save(sheet)
    assert codes() == ["shown-otherwise"]


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (dt.date(2024, 3, 4), "the cell holds a date, 2024-03-04"),
        (dt.time(1, 30), "the cell holds a time, 01:30:00"),
        (dt.timedelta(hours=30), "the cell holds a duration, 1 day, 6:00:00"),
        ("#REF!", "the cell shows the error #REF!"),
        (True, "'true' cannot be read"),
    ],
)
def test_what_is_no_number_is_refused(sheet: Worksheet, value: Any, said: str) -> None:
    """With sheet, cell, joint and field."""
    fill(sheet, HEADER, ["j1", "R", value, 0, 0])
    assert re.search(rf"arm\.xlsx:Sheet2!C2: error: joint 'j(oint_)?1', field 'a': {re.escape(said)}", refusal())


# --- Formulas ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("value", ["<v>0.25</v>", "", "<v></v>", "<v/>"])
def test_formulas_have_the_value_that_the_workbook_holds(sheet: Worksheet, value: str) -> None:
    """As a spreadsheet program has computed it; a program that computes none has written the others."""
    fill(sheet, HEADER, ["j1", "R", 0.25, 0, 0])
    edit(r'(<c r="C2"[^>]*>)<v>0.25</v>', rf"\1<f>1/4</f>{value}")
    assert codes() == ["formula-without-a-value"] if "2" not in value else read_one().rows[0].a == 0.25


def test_a_formula_whose_value_is_an_empty_text_is_an_empty_cell(sheet: Worksheet) -> None:
    """Such as ``=IF(B2="P";0.1;"")``."""
    fill(sheet, HEADER, ["j1", "R", 0, 0, 0, 0.25])
    edit(r'<c r="F2"[^>]*><v>0.25</v>', r'<c r="F2" t="str"><f>""</f><v></v>')
    assert read_one().rows[0].theta == 0.0


# --- What is not shown ------------------------------------------------------------------------------------------------


def test_hidden_rows_and_columns_are_read_with_a_notice(sheet: Worksheet) -> None:
    """A filter hides rows, too; those that are empty or beside the table do not matter."""
    fill(sheet, HEADER, FIRST, SECOND)
    for row in (3, 9):
        sheet.row_dimensions[row].hidden = True
    for column in ("F", "K"):
        sheet.column_dimensions[column].hidden = True
    save(sheet)
    arm = read_one()
    assert len(arm.rows) == 2
    assert "row 3, column F" in notices(arm)


def test_struck_cells_are_refused(sheet: Worksheet) -> None:
    """Someone meant to delete them."""
    fill(sheet, HEADER, FIRST, SECOND)
    sheet["C3"].font = Font(strike=True)
    save(sheet)
    assert "arm.xlsx:Sheet2!C3: error" in refusal()


FONTS = {
    "a footnote": (
        "<r><t>300</t></r><r><rPr><vertAlign val='superscript'/></rPr><t>1</t></r>",
        "'300¹' cannot be read",
    ),
    "a correction": ("<r><rPr><strike/></rPr><t>0.2</t></r><r><t>0.3</t></r>", "is struck through"),
    "degrees": ("<r><t>90</t></r><r><rPr><vertAlign val='superscript'/></rPr><t>o</t></r>", None),
    "bold digits": ("<r><t>pi/</t></r><r><rPr><b/></rPr><t>2</t></r>", None),
}


def put_text(name: str, blocks: str, *, shared: bool) -> None:
    """Puts a text with fonts into a cell, as Excel (among the texts of the workbook) or as openpyxl writes it."""
    inline = rf'<c r="{name}" t="inlineStr"><is>.*?</is></c>'
    if not shared:
        edit(inline, f'<c r="{name}" t="inlineStr"><is>{blocks}</is></c>')
        return
    edit(inline, f'<c r="{name}" t="s"><v>0</v></c>')
    kind = "application/vnd.openxmlformats-officedocument.spreadsheetml.sharedStrings+xml"
    edit(
        "</Types>", f'<Override PartName="/xl/sharedStrings.xml" ContentType="{kind}"/></Types>', "[Content_Types].xml"
    )
    text = f'<sst xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><si>{blocks}</si></sst>'
    with zipfile.ZipFile("arm.xlsx", "a") as archive:
        archive.writestr("xl/sharedStrings.xml", text)


@pytest.mark.parametrize("shared", [False, True], ids=["inline", "shared"])
@pytest.mark.parametrize("case", FONTS)
def test_parts_of_a_text_that_have_fonts_of_their_own(sheet: Worksheet, case: str, *, shared: bool) -> None:
    """A raised footnote was one more digit: 3001 for 300¹."""
    blocks, said = FONTS[case]
    fill(sheet, ["joint", "a", "alpha", "d"], ["J1", "300" if said else 0, 0 if said else "0", 0.1])
    put_text("B2" if said else "C2", blocks, shared=shared)
    if said:
        assert said in refusal()
    else:
        assert read_one().rows[0].alpha == QUARTER


@pytest.mark.parametrize("shared", [False, True], ids=["inline", "shared"])
def test_a_header_with_raised_and_lowered_letters_is_read(sheet: Worksheet, *, shared: bool) -> None:
    """As it is seen: `d¹`, with a footnote, is d."""
    fill(sheet, ["joint", "a [m]", "alpha", "d1 [mm]"], ["J1", 0.3, 0, 100])
    raised = "<r><rPr><vertAlign val='superscript'/></rPr><t>1</t></r>"
    put_text("D1", f"<r><t>d</t></r>{raised}<r><t xml:space='preserve'> [mm]</t></r>", shared=shared)
    assert read_one().rows[0].d == 0.1


def test_empty_cells_that_are_formatted_are_empty(sheet: Worksheet) -> None:
    """Down to the last row of the sheet."""
    fill(sheet, HEADER, FIRST, SECOND)
    for place in ("A4", "Z9", "A1048576"):
        sheet[place].font = Font(bold=True)
    save(sheet)
    arm = read_one()
    assert (len(arm.rows), arm.notices) == (2, ())


def test_what_a_sheet_says_of_its_size_is_not_believed(sheet: Worksheet) -> None:
    """Some programs write a wrong one."""
    fill(sheet, HEADER, FIRST, SECOND)
    edit(r'<dimension ref="[^"]*"/>', '<dimension ref="A1:B2"/>')
    assert len(read_one().rows) == 2


# --- Sheets -----------------------------------------------------------------------------------------------------------


@pytest.fixture
def two(sheet: Worksheet) -> Worksheet:
    """A workbook with a sheet of notes, two with a table, and a hidden one."""
    fill(sheet, HEADER, FIRST, SECOND)
    book = sheet.parent
    fill(book.create_sheet("Notes", 0), ["measured by Tom"])
    fill(book.create_sheet("UR10"), HEADER, FIRST)
    hidden = fill(book.create_sheet("Old"), HEADER, SECOND)
    hidden.sheet_state = "hidden"
    save(sheet)
    return sheet


@pytest.mark.usefixtures("two")
def test_every_sheet_with_a_table_is_a_manipulator() -> None:
    """It has the sheet's title; what is not read is spoken of once."""
    arms = [arm for arm in read() if isinstance(arm, Manipulator)]
    assert [(arm.name, len(arm.rows)) for arm in arms] == [("Sheet2", 2), ("UR10", 1)]
    assert ["'Old'" in notices(arm) for arm in arms] == [True, False]


@pytest.mark.usefixtures("two")
@pytest.mark.parametrize(("title", "joints"), [("UR10", 1), ("ur10", 1), ("Sheet2", 2), ("Old", 1)])
def test_the_option_names_the_sheet(title: str, joints: int) -> None:
    """A hidden one too; the manipulator has the file's name then."""
    arm = read_one(sheet=title)
    assert (arm.name, len(arm.rows)) == ("arm", joints)


def test_one_bad_sheet_does_not_spoil_the_others(sheet: Worksheet) -> None:
    """It is refused, and the others are read."""
    fill(sheet, HEADER, FIRST)
    fill(sheet.parent.create_sheet("bad"), ["a", "alpha", "x"], [0, 0, 0])
    first, second = read()
    assert isinstance(first, Manipulator)
    assert isinstance(second, Rejected)
    assert (second.name, second.problems[0].message) == ("bad", "there is no column for d in the header")


# --- The file ---------------------------------------------------------------------------------------------------------


def archive(**parts: str) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as file:
        for name, text in parts.items():
            file.writestr(name, text)
    return content.getvalue()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "the file is empty"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "this is a workbook of Excel 97 to 2003, or one with a password"),
        (archive(mimetype="x", **{"content.xml": "<x/>"}), "OpenDocument"),
        (archive(**{"[Content_Types].xml": "x"}), "the workbook cannot be read: "),
        (b"PK\x03\x04 and then nothing", "the workbook is broken: "),
    ],
)
def test_files_of_another_kind_are_refused(content: bytes, said: str) -> None:
    """With advice."""
    Path("arm.xlsx").write_bytes(content)
    assert said in refusal()


def test_a_workbook_of_gigabytes_is_refused(sheet: Worksheet, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before any of it is unpacked."""
    fill(sheet, HEADER, FIRST)
    monkeypatch.setattr(workbook, "MAX_UNPACKED", 1000)
    assert re.match(r"arm.xlsx: error: the workbook holds 0 MiB in \d+ parts when unpacked\n", refusal())


@pytest.mark.parametrize("part", ["xl/worksheets/sheet1.xml", "xl/workbook.xml"])
def test_entities_are_refused(sheet: Worksheet, part: str) -> None:
    """A few lines of them unfold to gigabytes."""
    fill(sheet, HEADER, FIRST)
    edit(r"^(<\?xml[^>]*\?>)?", r'\1<!DOCTYPE x [<!ENTITY a "b">]>', part)
    assert f"its part {part} has a document type" in refusal()


@pytest.mark.parametrize("part", ["xl/worksheets/sheet1.xml", "xl/workbook.xml"])
def test_a_broken_part_is_an_error_of_the_table(sheet: Worksheet, part: str) -> None:
    """Whichever it is."""
    fill(sheet, HEADER, FIRST)
    edit(r"(?s)>.*", "><", part)
    assert "arm.xlsx: error: the workbook cannot be read: " in refusal()


def test_without_openpyxl(sheet: Worksheet, monkeypatch: pytest.MonkeyPatch) -> None:
    """The error says what installs it."""
    fill(sheet, HEADER, FIRST)
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'dh2urdf\[xlsx\]'"):
        read()


# --- The same as CSV --------------------------------------------------------------------------------------------------


@pytest.mark.skipif(shutil.which("soffice") is None, reason="LibreOffice is not installed")
def test_a_workbook_that_libreoffice_has_saved(sheet: Worksheet, tmp_path: Path) -> None:
    """It computes the formulas that openpyxl has written, and keeps formats and merged cells."""
    fill(sheet, ["joint", "type", "a", "alpha", "d", "Limits [deg]", ""], ["", "", "mm", "deg", "mm", "lower", "upper"])
    fill(
        sheet, ["j1", "R", "=400+25", "=DEGREES(PI()/2)", 0, -170, 170], ["j2", "P", 0, 0, 0, "0 mm", "50 mm"], at="A3"
    )
    sheet["C3"].number_format = '0" mm"'
    sheet.merge_cells("F1:G1")
    save(sheet)
    subprocess.run(
        [str(shutil.which("soffice")), f"-env:UserInstallation=file://{tmp_path}/profile", "--headless", "--convert-to", "xlsx:Calc MS Excel 2007 XML", "--outdir", "saved", "arm.xlsx"],
        check=True,
        capture_output=True,
        timeout=120,
    )  # fmt: skip
    arm = read_one("saved/arm.xlsx")
    assert [(row.a, row.alpha) for row in arm.rows] == [(0.425, QUARTER), (0.0, 0.0)]
    assert arm.rows[0].limits.upper == pytest.approx(math.radians(170))
    assert (arm.rows[1].limits.upper, arm.notices) == (0.05, ())


def test_a_strict_workbook_is_answered_with_how_to_save_it(sheet: Worksheet) -> None:
    """Its elements have the names of ISO/IEC 29500-1, which openpyxl does not know: no sheet was found."""
    for row in (HEADER, FIRST, SECOND):
        sheet.append(row)
    save(sheet)
    for part in ("xl/workbook.xml", "xl/worksheets/sheet1.xml", "xl/styles.xml"):
        edit(
            "http://schemas.openxmlformats.org/spreadsheetml/2006/main",
            "http://purl.oclc.org/ooxml/spreadsheetml/main",
            part,
        )
    assert "this is a workbook in the format Strict Open XML" in refusal()
