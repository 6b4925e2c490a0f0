"""What a person reads: the whole text of every kind of message, as prose to be reviewed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import in_file_order

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.stages import Rejected


class Case(NamedTuple):
    """A table and what is said of it."""

    kind: str
    suffix: str
    options: dict[str, str]
    table: str | bytes
    message: str


CASES = [
    Case(
        "empty file",
        ".csv",
        {"convention": "standard"},
        "",
        "arm.csv: error: the file is empty: there is no header\n"
        "    accepted: a header with at least the columns a, alpha and d, and one row for each joint",
    ),
    Case(
        "header only",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\n",
        "arm.csv: error: manipulator 'arm', field 'joints': there are no joints: a manipulator has one row for each",
    ),
    Case(
        "no header",
        ".csv",
        {"convention": "standard"},
        "j1,revolute,0,0,0.1,0\n",
        "arm.csv:1: error: this line is no header whose columns are known: 'j1,revolute,0,0,0.1,0'\n"
        "    accepted: a header with at least the columns a, alpha and d, such as `joint,type,a,alpha,d,theta`, with one delimiter: comma, semicolon or tab",
    ),
    Case(
        "columns aligned with spaces",
        ".csv",
        {"convention": "standard"},
        "joint  a  alpha  d\nj1  0  0  0.1\n",
        "arm.csv:1: error: this line is no header whose columns are known: 'joint  a  alpha  d'\n"
        "    accepted: a header with at least the columns a, alpha and d, such as `joint,type,a,alpha,d,theta`, with one delimiter: comma, semicolon or tab\n"
        "    columns aligned with spaces or bars cannot be told apart; put commas between them",
    ),
    Case(
        "a workbook",
        ".csv",
        {"convention": "standard"},
        b"PK\x03\x04\x14\x00",
        "arm.csv: error: this is an Excel workbook (xlsx) or another zip archive, not a text file\n"
        "    accepted: text in UTF-8 or UTF-16, with commas, semicolons or tabs between the cells\n"
        "    name it .xlsx if it is a workbook, or save the sheet as CSV (UTF-8)",
    ),
    Case(
        "latin-1",
        ".csv",
        {"convention": "standard"},
        b"joint,type,a,alpha,d,theta\nGr\xfcn,revolute,0,0,0.1,0\n",
        "arm.csv:2: error: byte 0xfc is no UTF-8 text; this may be Latin-1 or Windows-1252\n"
        "    accepted: text in UTF-8 or UTF-16, with commas, semicolons or tabs between the cells\n"
        "    save the file as UTF-8 (in Excel: CSV UTF-8)",
    ),
    Case(
        "NUL bytes",
        ".csv",
        {"convention": "standard"},
        b"joint,a\x00b\n",
        "arm.csv: error: this is no text file: it holds NUL bytes\n"
        "    accepted: text in UTF-8 or UTF-16, with commas, semicolons or tabs between the cells\n"
        "    save the table as CSV (UTF-8)",
    ),
    Case(
        "a missing column",
        ".csv",
        {"convention": "standard"},
        "joint,a,d\nj1,0,0.1\n",
        "arm.csv:1: error: field 'alpha': there is no column for alpha in the header\n"
        "    accepted: one of the headers alpha, α, twist, link twist, twist angle, link twist angle; its unit may follow, as in `alpha [deg]`",
    ),
    Case(
        "a misspelt header",
        ".csv",
        {"convention": "standard"},
        "joint,a,alhpa,d\nj1,0,0,0.1\n",
        "arm.csv:1:9: error: field 'alhpa': no column is called 'alhpa'\n"
        "    accepted: robot, convention, index, joint, link, type, a, alpha, d, theta, offset, beta, gamma, b, sign, flip, limits, lower, upper, velocity, effort, mass, com, com_x, com_y, com_z, inertia, ixx, iyy, izz, ixy, ixz, iyz, radius, damping, friction, armature\n"
        "    did you mean 'alpha'?",
    ),
    Case(
        "a duplicate header",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,twist,d\nj1,0,0,0,0.1\n",
        "arm.csv:1:15: error: field 'alpha': two columns are alpha: 'alpha' and 'twist' (a duplicate)\n"
        "    accepted: one column for each field",
    ),
    Case(
        "an unknown column",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,remark\nj1,0,0,0.1,x\n",
        "arm.csv:1:17: notice: manipulator 'arm': the column 'remark' is left out: no field is called so",
    ),
    Case(
        "an unknown unit",
        ".csv",
        {"convention": "standard"},
        "joint,a [furlong],alpha,d\nj1,0,0,0.1\n",
        "arm.csv:1:7: error: field 'a': 'furlong' is no unit of length that is known\n"
        "    accepted: m, cm, mm, µm, in, ft, mil",
    ),
    Case(
        "a unit of something else",
        ".csv",
        {"convention": "standard"},
        "joint,a [deg],alpha,d\nj1,0,0,0.1\n",
        "arm.csv:1:7: error: field 'a': 'deg' is a unit of angle, and one of length is needed\n"
        "    accepted: m, cm, mm, µm, in, ft, mil",
    ),
    Case(
        "units of header and option",
        ".csv",
        {"convention": "standard", "length_unit": "m"},
        "joint,a [mm],alpha,d\nj1,0,0,0.1\n",
        "arm.csv:1: error: field 'a': the header 'a [mm]' declares mm, and an option declares m\n"
        "    accepted: one unit for a column",
    ),
    Case(
        "one column without unit",
        ".csv",
        {"convention": "standard"},
        "joint,a [mm],alpha,d\nj1,300,0,0\n",
        "arm.csv:1: notice: manipulator 'arm', field 'd': d has no unit, while the unit of a is mm: only 0 is read without one\n"
        "    declare it: `d [mm]`",
    ),
    Case(
        "a ragged row",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,425,0,0,0\n",
        "arm.csv:2: error: joint 'joint_1': row 1 has 7 cells, and the header has 6 columns\n"
        "    accepted: one cell for each column, with a comma between them\n"
        "    is there a decimal comma in it, or a comma in a text without quotes?",
    ),
    Case(
        "an unclosed quote",
        ".csv",
        {"convention": "standard"},
        'joint,type,a,alpha,d,theta\n"j1,revolute,0,0,0,0\n',
        "arm.csv:2:1: error: a cell opens with a quote that is not closed: '\"j1,revolute,0,0,0,0'\n"
        '    accepted: a quote at both ends, "like this"\n'
        "    a quote that is part of the text is written twice",
    ),
    Case(
        "a cell over several lines",
        ".csv",
        {"convention": "standard"},
        'joint,type,a,alpha,d,theta\n"j1\n2",revolute,0,0,0,0\n',
        "arm.csv:2:1: error: joint 'joint_1', field 'joint': the cell that begins with 'j1' runs over several lines\n"
        "    accepted: a cell on one line\n"
        "    is its closing quote missing?",
    ),
    Case(
        "text in a number",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,abc,0,0,0\n",
        "arm.csv:2:13: error: joint 'j1', field 'a': 'abc' cannot be read: 'abc' is no number, unit, constant or function that is known\n"
        "    accepted: a number such as 0.5 or an expression such as 0.1 + 0.02, bare or with a unit (m, cm, mm, µm)",
    ),
    Case(
        "a decimal comma",
        ".csv",
        {"convention": "standard"},
        'joint,type,a,alpha,d,theta\nj1,revolute,"1,425",0,0,0\n',
        "arm.csv:2:13: error: joint 'joint_1', field 'a': '1,425' can be read in two ways: the comma is a decimal sign or separates thousands, and no other number of the manipulator shows which\n"
        "    accepted: numbers without separators of thousands\n"
        "    write 1,4250, or 1425",
    ),
    Case(
        "a point that may separate thousands",
        ".csv",
        {"convention": "standard"},
        "joint;type;a;alpha;d;theta\nj1;revolute;1.234;0;0;0\nj2;revolute;0,5;0;0;0\n",
        "arm.csv:2:13: error: joint 'joint_1': '1.234' can be read in two ways, since '0,5' in line 3 has a decimal comma: the point may separate thousands\n"
        "    accepted: decimal commas alone, or decimal points alone, without separators of thousands",
    ),
    Case(
        "a comma that may separate thousands",
        ".csv",
        {"convention": "standard"},
        "joint;type;a [mm];alpha;d;theta\nj1;revolute;1,250;0;0;0\nj2;revolute;80.5;0;0;0\n",
        "arm.csv:1: notice: manipulator 'arm', field 'd': d has no unit, while the unit of a is mm: only 0 is read without one\n"
        "    declare it: `d [mm]`\n"
        "arm.csv:2:13: error: joint 'joint_1': '1,250' can be read in two ways, since '80.5' in line 3 has a decimal point: the comma may separate thousands\n"
        "    accepted: decimal commas alone, or decimal points alone, without separators of thousands",
    ),
    Case(
        "a header with a sign",
        ".csv",
        {"convention": "standard"},
        "joint,-a,alpha,d\nj1,0.1,0,0\n",
        "arm.csv:1:7: error: field 'a': '-a' may be the negative of a\n"
        "    accepted: a, and its numbers with their signs",
    ),
    Case(
        "a misspelt header with a unit",
        ".csv",
        {"convention": "standard"},
        "a,alpha,d,tehta [deg]\n0,0,0.1,90\n",
        "arm.csv:1:11: error: field 'tehta': no column is called 'tehta [deg]'\n"
        "    accepted: robot, convention, index, joint, link, type, a, alpha, d, theta, offset, beta, gamma, b, sign, flip, limits, lower, upper, velocity, effort, mass, com, com_x, com_y, com_z, inertia, ixx, iyy, izz, ixy, ixz, iyz, radius, damping, friction, armature\n"
        "    did you mean 'theta'?",
    ),
    Case(
        "too many joints",
        ".csv",
        {"convention": "standard"},
        "a,alpha,d\n" + "0.01,0,0\n" * 5001,
        "arm.csv:2: error: manipulator 'arm', field 'joints': the manipulator has 5,001 joints\n"
        "    accepted: at most 5,000 joints in one manipulator\n"
        "    a table of several manipulators has a column robot",
    ),
    Case(
        "too many joints in YAML",
        ".yaml",
        {"convention": "standard"},
        "joints:\n" + "- {a: 0.01, alpha: 0, d: 0}\n" * 5001,
        "arm.yaml:2:1: error: the list that begins here has more than 5,000 entries\n"
        "    accepted: at most 5,000 entries",
    ),
    Case(
        "not a number",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,NaN,0,0,0\n",
        "arm.csv:2:13: error: joint 'j1', field 'a': 'NaN' cannot be read: 'NaN' is no number, unit, constant or function that is known\n"
        "    accepted: a number such as 0.5 or an expression such as 0.1 + 0.02, bare or with a unit (m, cm, mm, µm)\n"
        "    write a finite number",
    ),
    Case(
        "an empty cell",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,,0,0,0\n",
        "arm.csv:2:13: error: joint 'j1', field 'a': a is empty\n"
        "    accepted: a number, 0 included: nothing is filled in for geometry",
    ),
    Case(
        "an attack",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,__import__('os').system('true'),0,0,0\n",
        "arm.csv:2:13: error: joint 'j1', field 'a': '__import__('os').system('true')' cannot be read: '__import__' is no function that is known\n"
        "    accepted: a number such as 0.5 or an expression such as 0.1 + 0.02, bare or with a unit (m, cm, mm, µm)\n"
        "    the functions are sqrt, abs, sin, cos, tan, asin, acos, atan, atan2, radians",
    ),
    Case(
        "degrees that nobody declared",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,90,0,90\n",
        "arm.csv:2:15: error: joint 'j1', field 'alpha': '90' is more than a full turn in rad, and no unit is declared for it\n"
        "    accepted: at most 2π rad where no unit is declared\n"
        "    if these are degrees, say so: `alpha [deg]` in the header, `units: {angle: deg}`, or `--angle-unit deg`\n"
        "arm.csv:2:20: notice: joint 'j1', field 'theta': '90' is more than a full turn\n"
        "    if these are degrees, say so: `theta [deg]`",
    ),
    Case(
        "a limit without a unit beside one in degrees",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta,lower,upper (deg)\nj1,R,0.3,0,0.1,0,-1,90\nj2,P,0.3,0,0.1,0,-1,1 m\n",
        "arm.csv:2:18: error: joint 'j1', field 'lower': '-1' has no unit, and the unit of upper is deg\n"
        "    accepted: 0, or a number with a unit: rad, deg, rev\n"
        "    name its unit: '-1 deg', or `units: {angle: deg}`\n"
        "arm.csv:3:18: error: joint 'j2', field 'lower': '-1' has no unit, and the unit of upper is deg\n"
        "    accepted: 0, or a number with a unit: m, cm, mm, µm, in, ft, mil\n"
        "    name its unit: '-1 m', or `units: {length: m}`",
    ),
    Case(
        "pi in degrees",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha [deg],d\nj1,0,pi/2,0.1\n",
        "arm.csv:2:6: error: joint 'j1', field 'alpha': 'pi/2' is a multiple of π, and the unit declared for numbers here is degrees\n"
        "    accepted: a number such as 0.5 or an expression such as pi/2, bare or with a unit (rad, deg, °)\n"
        "    write the angle in degrees, or name its unit: 'pi/2 rad'",
    ),
    Case(
        "1.57",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,1.57,0.1,0\n",
        "arm.csv:2:15: notice: joint 'j1', field 'alpha': '1.57' is kept as it is; pi/2 was probably meant\n"
        "    write pi/2",
    ),
    Case(
        "a long arm",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,400,0,0.1,0\n",
        "arm.csv:2: notice: manipulator 'arm': the arm is 400.1 m long\n"
        "    if its lengths are in mm, declare it: `a [mm]`, `units: {length: mm}` or `--length-unit mm`",
    ),
    Case(
        "an immeasurable arm",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,1e300,0,0.1,0\n",
        "arm.csv:2: error: joint 'j1', field 'a': a is 1e+300 m, and the arm is 1e+300 m long: positions on it cannot be computed to a micrometre\n"
        "    accepted: an arm of at most 1e+09 m",
    ),
    Case(
        "another row's variable",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,0,0.1,q2\n",
        "arm.csv:2:21: error: joint 'j1', field 'theta': 'q2' names the variable of row 2, and this is row 1\n"
        "    accepted: q1, or no number: rows are counted from 1, fixed ones too",
    ),
    Case(
        "a variable where nothing slides",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,0,q1,0\n",
        "arm.csv:2:17: error: joint 'j1', field 'd': 'q1' names the joint variable q1, which cannot be in d of this row\n"
        "    accepted: a number here; q1 may be in theta of a revolute joint or in d of a prismatic one\n"
        "    give the row the type prismatic if the joint slides",
    ),
    Case(
        "an unknown type",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolut,0,0,0.1,0\n",
        "arm.csv:2:4: error: joint 'j1', field 'type': 'revolut' is no type of joint\n"
        "    accepted: revolute, r, rotational, rotary, rotation, hinge, 0; prismatic, p, linear, t, translational, translation, sliding, 1; continuous, c; fixed, f, static, rigid\n"
        "    did you mean 'revolute'?",
    ),
    Case(
        "a flange without a type",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d\nEE,0,0,0.1\n",
        "arm.csv:2: error: joint 'EE', field 'type': the row 'EE' has no type, and by its name it hardly is a revolute joint\n"
        "    accepted: revolute, r, rotational, rotary, rotation, hinge, 0; prismatic, p, linear, t, translational, translation, sliding, 1; continuous, c; fixed, f, static, rigid\n"
        "    write fixed if nothing moves there, or revolute if it does",
    ),
    Case(
        "a header with a sign",
        ".csv",
        {"convention": "standard"},
        "joint,-a,alpha,d\nj1,1,0,0.1\n",
        "arm.csv:1:7: error: field 'a': '-a' may be the negative of a\n"
        "    accepted: a, and its numbers with their signs",
    ),
    Case(
        "a fixed row called like a frame of ours",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d\nj1,R,0,0,0.1\nflange,fixed,0,0,0.1\n",
        "arm.csv:3:1: notice: joint 'flange', field 'joint': the joint is named 'flange_joint': 'flange' is a link of every robot description",
    ),
    Case(
        "an empty type",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,,0,0,0.1,0\n",
        "arm.csv:2:4: notice: joint 'j1', field 'type': the type is empty; the joint is taken as revolute",
    ),
    Case(
        "a fixed joint that moves",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,offset,flip\nj1,fixed,0,0,0.1,0.2,true\n",
        "arm.csv:2:18: error: joint 'j1', field 'offset': a fixed joint has no variable that an offset could be added to\n"
        "    accepted: 0\n"
        "arm.csv:2:22: error: joint 'j1', field 'flip': a fixed joint has no direction that could be turned\n"
        "    accepted: 1, or flip false",
    ),
    Case(
        "half a limit",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,lower,upper\nj1,0,0,0.1,-1,\n",
        "arm.csv:2:15: error: joint 'j1', field 'upper': there is lower and no upper\n"
        "    accepted: both lower and upper, or neither",
    ),
    Case(
        "limits exchanged",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,lower,upper\nj1,0,0,0.1,1,-1\n",
        "arm.csv:2:12: error: joint 'j1', field 'lower': lower, '1' is above upper, '-1'\n"
        "    accepted: lower at most upper\n"
        "    are they exchanged?",
    ),
    Case(
        "limits in degrees",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,lower,upper\nj1,0,0,0.1,-170,170\n",
        "arm.csv:2:12: error: joint 'j1', field 'lower': '-170' is more than ten turns in rad, and no unit is declared for it\n"
        "    accepted: at most 20π rad where no unit is declared\n"
        "    if these are degrees, say so: `lower [deg]` in the header, `units: {angle: deg}`, or `--angle-unit deg`; if the joint turns without end, give it the type continuous\n"
        "arm.csv:2:17: error: joint 'j1', field 'upper': '170' is more than ten turns in rad, and no unit is declared for it\n"
        "    accepted: at most 20π rad where no unit is declared\n"
        "    if these are degrees, say so: `upper [deg]` in the header, `units: {angle: deg}`, or `--angle-unit deg`; if the joint turns without end, give it the type continuous",
    ),
    Case(
        "limits of another unit",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,lower [deg],upper [deg]\nj1,P,0,0,0.1,0,1\n",
        "arm.csv:2:16: error: joint 'j1', field 'upper': '1' is in a column of deg, and upper of a prismatic joint is a length\n"
        "    accepted: 0, or a number with its own unit: m, cm, mm, µm, in, ft, mil",
    ),
    Case(
        "limits of a continuous joint",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,lower,upper\nj1,continuous,0,0,0.1,-1,1\n",
        "arm.csv:2:23: notice: joint 'j1', field 'lower': a continuous joint has no bounds; lower '-1' is left out\n"
        "arm.csv:2:26: notice: joint 'j1', field 'upper': a continuous joint has no bounds; upper '1' is left out",
    ),
    Case(
        "no velocity",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,velocity\nj1,0,0,0.1,0\n",
        "arm.csv:2:12: error: joint 'j1', field 'velocity': '0' is not positive\n"
        "    accepted: a number above 0, or nothing where it is not known",
    ),
    Case(
        "half an inertia",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,mass,ixx,iyy,izz\nj1,0,0,0.1,1,1,1,\n",
        "arm.csv:2:18: error: joint 'j1', field 'izz': a part of the inertia tensor is given, and izz is not\n"
        "    accepted: ixx, iyy and izz, and ixy, ixz, iyz where they are not 0",
    ),
    Case(
        "an inertia without mass",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,ixx,iyy,izz\nj1,0,0,0.1,1,1,1\n",
        "arm.csv:2: error: joint 'j1', field 'mass': an inertia tensor is given and no mass\n"
        "    accepted: both, or neither: they are computed from the link's shape and density then",
    ),
    Case(
        "a control character",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj\x1b[31m,revolute,0,0,0.1,0\n",
        "arm.csv:2:1: error: joint 'joint_1', field 'joint': the name 'j\\x1b[31m' holds U+001B, which is a control character\n"
        "    accepted: 1 to 200 visible characters",
    ),
    Case(
        "a long name",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\njjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjj,revolute,0,0,0.1,0\n",
        "arm.csv:2:1: error: joint 'joint_1', field 'joint': the name 'jjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjj…' has 300 characters\n"
        "    accepted: 1 to 200 visible characters",
    ),
    Case(
        "a reserved name",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\ntool0,revolute,0,0,0.1,0\n",
        "arm.csv:2:1: error: joint 'tool0', field 'joint': the joint cannot be named 'tool0': it is the name of a link that every robot description has\n"
        "    accepted: a name of its own: links and joints share one set of names, and world, base_link, base_link_inertia, flange, tool0 are in it\n"
        "    name it otherwise, such as tool0_joint",
    ),
    Case(
        "a name twice",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,0,0.1,0\nj1,revolute,0,0,0.1,0\n",
        "arm.csv:2:1: notice: manipulator 'arm', field 'joint': the numbers of the joints, 'j1, j1', do not rise from row to row\n"
        "    rows are in the order from the base to the tool\n"
        "arm.csv:3:1: error: joint 'j1', field 'joint': the joint cannot be named 'j1': a joint of arm.csv:2 has it already\n"
        "    accepted: a name of its own: links and joints share one set of names, and world, base_link, base_link_inertia, flange, tool0 are in it\n"
        "    name it otherwise, such as j1_joint",
    ),
    Case(
        "a joint's name twice, whose like is taken too",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d\nelbow_joint,0,0,0.1\nelbow_joint,0,0,0.1\nelbow_joint_2,0,0,0.1\n",
        "arm.csv:3:1: error: joint 'elbow_joint', field 'joint': the joint cannot be named 'elbow_joint': a joint of arm.csv:2 has it already\n"
        "    accepted: a name of its own: links and joints share one set of names, and world, base_link, base_link_inertia, flange, tool0 are in it\n"
        "    name it otherwise, such as elbow_joint_3",
    ),
    Case(
        "names that differ in case",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nElbow,revolute,0,0,0.1,0\nelbow,revolute,0,0,0.1,0\n",
        "arm.csv:3:1: notice: joint 'elbow', field 'joint': the joint 'elbow' and 'Elbow' differ only in case or in how a letter is coded; they are kept apart",
    ),
    Case(
        "a wrong index",
        ".csv",
        {"convention": "standard"},
        "i,a,alpha,d\n0,0,0,0.1\n",
        "arm.csv:2:1: error: joint 'joint_1', field 'index': the index is '0', and this is row 1\n"
        "    accepted: 1, 2, 3 … in the order of the rows, from the base outwards\n"
        "    a row 0 that leads from the base to the first joint has the type fixed",
    ),
    Case(
        "rows that return",
        ".csv",
        {"convention": "standard"},
        "robot,a,alpha,d\nA,0,0,1\nB,0,0,1\nA,0,0,1\n",
        "arm.csv:2:1: error: manipulator 'A', field 'robot': rows of 'A' are in several places of the file\n"
        "    accepted: all rows of a manipulator together\n"
        "arm.csv:4:1: error: manipulator 'A', field 'robot': rows of 'A' are in several places of the file\n"
        "    accepted: all rows of a manipulator together",
    ),
    Case(
        "a merged cell",
        ".csv",
        {"convention": "standard"},
        "robot,a,alpha,d\nA,0,0,1\n,0,0,1\n",
        "arm.csv:3:1: error: joint 'joint_2', field 'robot': row 2 does not say which manipulator it belongs to; the row above says 'A'\n"
        "    accepted: the name of the manipulator in every row\n"
        "    a spreadsheet that has merged cells leaves all but the first of them empty",
    ),
    Case(
        "a spreadsheet error",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\n#REF!,revolute,0,0,0.1,0\n",
        "arm.csv:2:1: error: joint 'joint_1', field 'joint': '#REF!' is what a spreadsheet writes for an error, not the name of a joint\n"
        "    accepted: a name\n"
        "    fix the formula in the spreadsheet, and save the table again",
    ),
    Case(
        "geometry that no field holds",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,mu\nj1,0,0,0.1,0.2\n",
        "arm.csv:2:12: error: joint 'joint_1', field 'mu': 'mu' is whether a joint is driven, in Khalil and Kleinfinger's convention, which no column holds, and it is '0.2'\n"
        "    accepted: 0 in this column, or a table of a, alpha, d and theta (or offset) without it",
    ),
    Case(
        "no convention",
        ".csv",
        {},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,0,0.1,0\n",
        "arm.csv:2: error: manipulator 'arm', field 'convention': the table does not say which Denavit-Hartenberg convention it is written in, and that is never guessed\n"
        "    accepted: standard (classic, distal): A = Rz(theta) Tz(d) Tx(a) Rx(alpha); modified (Craig, proximal): A = Rx(alpha) Tx(a) Rz(theta) Tz(d), where a row has a and alpha of the link before\n"
        "    write `# convention: standard` above a CSV header, `convention: standard` in YAML, or give `--convention standard`",
    ),
    Case(
        "an unknown convention",
        ".csv",
        {"convention": "khalil"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,0,0.1,0\n",
        "error: field 'convention': 'khalil' is no convention that is known\n"
        "    accepted: standard, dh, sdh, classic, classical, distal, spong, paul for A = Rz(theta) Tz(d) Tx(a) Rx(alpha); modified, mdh, modified dh, craig, proximal for A = Rx(alpha) Tx(a) Rz(theta) Tz(d)",
    ),
    Case(
        "two conventions",
        ".csv",
        {"convention": "standard"},
        "# convention: Craig\njoint,type,a,alpha,d,theta\nj1,revolute,0,0,0.1,0\n",
        "an option: error: field 'convention': 'standard' means the standard convention, and arm.csv:1:15 says modified\n"
        "    accepted: one convention for the whole table",
    ),
    Case(
        "a standard table with i-1",
        ".csv",
        {"convention": "standard"},
        "a_{i-1},alpha_{i-1},d,theta\n0,0,0.1,q1\n",
        "an option: error: field 'convention': 'standard' means the standard convention, and arm.csv:1 says modified\n"
        "    accepted: one convention for the whole table",
    ),
    Case(
        "a misspelt statement",
        ".csv",
        {"convention": "standard"},
        "# convetion: Craig\njoint,type,a,alpha,d,theta\nj1,revolute,0,0,0.1,0\n",
        "arm.csv:1:3: error: the comment line says 'convetion', which nothing is called\n"
        "    accepted: name, convention, units, base, tool, payload, defaults\n"
        "    did you mean 'convention'?",
    ),
    Case(
        "a statement below the header",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\n# tool: {xyz: [0, 0, 1]}\nj1,revolute,0,0,0.1,0\n",
        "arm.csv:2: error: '# tool: {xyz: [0, 0, 1]}' is below the header, and would not hold for the rows above\n"
        "    accepted: such lines above the header",
    ),
    Case(
        "a base that is not rigid",
        ".csv",
        {"convention": "standard"},
        "# base: [[1,0,0,0],[0,1,0,0],[0,0,2,0],[0,0,0,1]]\njoint,type,a,alpha,d,theta\nj1,revolute,0,0,0.1,0\n",
        "arm.csv:1:9: error: field 'base': the matrix of base is no rotation: |RᵀR − 1| is 3, so that it stretches, skews or mirrors\n"
        "    accepted: axes of length 1, square to each other and right-handed, to 0.0001",
    ),
    Case(
        "a base that mirrors",
        ".yaml",
        {},
        "base: [[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]\nconvention: standard\njoints:\n- {a: 0, alpha: 0, d: 1}\n",
        "arm.yaml:1:7: error: manipulator 'arm', field 'base': the matrix of base is no rotation: |RᵀR − 1| is 2, so that it stretches, skews or mirrors\n"
        "    accepted: axes of length 1, square to each other and right-handed, to 0.0001",
    ),
    Case(
        "a base of four digits",
        ".yaml",
        {},
        "base: [[0.7071,-0.7071,0,0],[0.7071,0.7071,0,0],[0,0,1,0],[0,0,0,1]]\nconvention: standard\njoints:\n- {a: 0, alpha: 0, d: 1}\n",
        "arm.yaml:1:7: notice: manipulator 'arm', field 'base': the matrix of base is a rotation only to 2e-05; the nearest rotation is used\n"
        "    write its elements with more digits, or as expressions such as sqrt(2)/2",
    ),
    Case(
        "a tool in degrees",
        ".yaml",
        {},
        "tool: {rpy: [0, 0, 90]}\nconvention: standard\njoints:\n- {a: 0, alpha: 0, d: 1}\n",
        "arm.yaml:1:20: error: manipulator 'arm', field 'tool.rpy': '90' is more than a full turn in rad, and no unit is declared for it\n"
        "    accepted: at most 2π rad where no unit is declared\n"
        "    if these are degrees, say so: '90 deg'",
    ),
    Case(
        "two bases",
        ".yaml",
        {"base": "{xyz: [0, 0, 1]}"},
        "base: {xyz: [0, 0, 2]}\nconvention: standard\njoints:\n- {a: 0, alpha: 0, d: 1}\n",
        "an option:1:1: error: manipulator 'arm', field 'base': base is given twice, with different values: in the table and in an option\n"
        "    accepted: one base",
    ),
    Case(
        "CSV in YAML",
        ".yaml",
        {},
        "joint,type,a,alpha,d,theta\nj1,revolute,0,0,0.1,0\n",
        "arm.yaml:1:1: error: a table is a mapping with the key joints, and this is the text 'joint,type,a,alpha,d,theta j1,revolute,0,0,0.1,0'\n"
        "    accepted: the keys name, convention, units, base, tool, payload, defaults, visuals, collisions, joints, or robots with a list of such mappings\n"
        "    this looks like CSV: give the file the suffix .csv",
    ),
    Case(
        "an unknown key of a joint",
        ".yaml",
        {},
        "convention: standard\njoints:\n- {a: 0, alhpa: 0, d: 1}\n",
        "arm.yaml:3:3: error: joint 'joint_1', field 'alpha': there is no alpha\n"
        "    accepted: a number, 0 included: nothing is filled in for geometry\n"
        "arm.yaml:3:10: error: joint 'joint_1', field 'alhpa': 'alhpa' is no key of a joint\n"
        "    accepted: name, index, link, type, a, alpha, d, theta, offset, beta, gamma, b, sign, flip, mass, radius, damping, friction, armature, limits, com, inertia, visual, collision, mesh\n"
        "    did you mean 'alpha'?",
    ),
    Case(
        "a truth value",
        ".yaml",
        {},
        "convention: standard\njoints:\n- {a: true, alpha: 0, d: 1}\n",
        "arm.yaml:3:7: error: joint 'joint_1', field 'a': a is the truth value true, not a number\n"
        "    accepted: a number or an expression",
    ),
    Case(
        "nothing",
        ".yaml",
        {},
        "convention: standard\njoints:\n- {a: ~, alpha: 0, d: 1}\n",
        "arm.yaml:3:7: error: joint 'joint_1', field 'a': a is empty\n"
        "    accepted: a number, 0 included: nothing is filled in for geometry",
    ),
    Case(
        "an empty item",
        ".yaml",
        {},
        "convention: standard\njoints:\n- {a: 0, alpha: 0, d: 1}\n-\n",
        "arm.yaml:4:2: error: manipulator 'arm', field 'joints': joint 2 is an empty value, not a mapping\n"
        "    accepted: a mapping such as {name: shoulder, type: revolute, a: 0, alpha: pi/2, d: 0.1, theta: 0}\n"
        "    remove the dash if there is no such joint",
    ),
    Case(
        "an unknown key",
        ".yaml",
        {},
        "conventoin: standard\nconvention: standard\njoints:\n- {a: 0, alpha: 0, d: 1}\n",
        "arm.yaml:1:1: error: manipulator 'arm', field 'conventoin': 'conventoin' is no key of a manipulator\n"
        "    accepted: name, convention, units, base, tool, payload, defaults, visuals, collisions, joints\n"
        "    did you mean 'convention'?",
    ),
    Case(
        "units that are none",
        ".yaml",
        {},
        "units: {length: furlong, angel: deg}\nconvention: standard\njoints:\n- {a: 0, alpha: 0, d: 1}\n",
        "arm.yaml:1:17: error: manipulator 'arm', field 'units.length': 'furlong' is no unit of length that is known\n"
        "    accepted: m, cm, mm, µm, in, ft, mil\n"
        "arm.yaml:1:26: error: manipulator 'arm', field 'units.angel': 'angel' is nothing that has a unit of its own\n"
        "    accepted: length, angle, mass, inertia, effort, velocity, damping\n"
        "    did you mean 'angle'?",
    ),
    Case(
        "an inertia that is not symmetric",
        ".yaml",
        {},
        "convention: standard\njoints:\n- {a: 0, alpha: 0, d: 1, mass: 1, inertia: [[1,0,0],[0,1,0.5],[0,0.4,1]]}\n",
        "arm.yaml:3:66: error: joint 'joint_1', field 'inertia': the inertia tensor is not symmetric: iyz is '0.5' and here '0.4'\n"
        "    accepted: a symmetric matrix",
    ),
    Case(
        "a far centre of mass",
        ".yaml",
        {},
        "convention: standard\njoints:\n- {a: 0, alpha: 0, d: 1, com: [198, 0, 0]}\n",
        "arm.yaml:3:3: notice: joint 'joint_1', field 'com': the centre of mass is 198 m from the joint's frame, and the whole arm is 1 m long\n"
        "    is it in another unit?",
    ),
    Case(
        "a date of a spreadsheet",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,2020-01-02,0,0.1,0\n",
        "arm.csv:2:13: error: joint 'j1', field 'a': '2020-01-02' cannot be read: it is a date\n"
        "    accepted: a number such as 0.5 or an expression such as 0.1 + 0.02, bare or with a unit (m, cm, mm, µm)\n"
        "    a spreadsheet makes dates of fractions: format the column as text; for a difference or a quotient, put spaces around its signs",
    ),
    Case(
        "a number of an accountant",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,(425),0,0.1,0\n",
        "arm.csv:2:13: error: joint 'j1', field 'a': '(425)' cannot be read: a number in brackets is negative to a spreadsheet and positive to a person: -425, or 425\n"
        "    accepted: a number such as 0.5 or an expression such as 0.1 + 0.02, bare or with a unit (m, cm, mm, µm)\n"
        "    write -425 or 425, without the brackets",
    ),
    Case(
        "a star of two meanings",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0.1,0,0.1,q1*-1\n",
        "arm.csv:2:23: error: joint 'j1', field 'theta': 'q1*-1' cannot be read: it means q1 times -1, or q1 - 1 where the star marks a joint variable\n"
        "    accepted: a number such as 0.5 or an expression such as pi/2, bare or with a unit (rad, deg, °)\n"
        "    write -q1 or q1 - 1, without the star",
    ),
    Case(
        "a cosine of degrees or radians",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha [deg],d,theta [deg]\nj1,revolute,0.3*cos(60),0,0.1,0\n",
        "arm.csv:2:13: error: joint 'j1', field 'a': '0.3*cos(60)' cannot be read: cos is taken of 60, which has no unit, and angles are declared in degrees\n"
        "    accepted: a number such as 0.5 or an expression such as 0.1 + 0.02, bare or with a unit (m, cm, mm, µm)\n"
        "    name the unit of the angle: cos(60 deg), or cos(60 rad)",
    ),
    Case(
        "a cosine of many turns",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d,theta\nj1,revolute,0.3*cos(60),0,0.1,0\n",
        "arm.csv:2:13: error: joint 'j1', field 'a': '0.3*cos(60)' cannot be read: cos is taken of 60, more than a full turn in rad, and no unit is declared for it\n"
        "    accepted: a number such as 0.5 or an expression such as 0.1 + 0.02, bare or with a unit (m, cm, mm, µm)\n"
        "    name the unit of the angle: cos(60 deg), or cos(60 rad)",
    ),
    Case(
        "points in an arm that may all separate thousands",
        ".csv",
        {"convention": "standard"},
        "joint;a [mm];alpha;d [mm]\nj1;1.250;0;1.100\n",
        "arm.csv:2:4: error: joint 'joint_1', field 'a': '1.250' can be read in two ways: the point is a decimal sign or separates thousands, and no other number of the manipulator shows which\n"
        "    accepted: numbers without separators of thousands\n"
        "    write 1.25, or 1250",
    ),
    Case(
        "degrees in an offset",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,offset\nj1,0,0,0.1,90\n",
        "arm.csv:2:12: notice: joint 'j1', field 'offset': '90' is more than a full turn\n"
        "    if these are degrees, say so: `offset [deg]`",
    ),
    Case(
        "a degree sign that has become a 0",
        ".csv",
        {"convention": "standard"},
        "# base: {rpy: [0, 0, 900 deg]}\njoint,a,alpha [deg],d\nj1,0,-900,0.1\n",
        "arm.csv:1:22: notice: manipulator 'arm', field 'base.rpy': '900 deg' is more than a full turn\n"
        "arm.csv:3:6: notice: joint 'j1', field 'alpha': '-900' is more than a full turn\n"
        "    is the 0 at its end a degree sign? write -90°",
    ),
    Case(
        "limits that may be degrees",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,lower,upper\nj1,0,0,0.1,-45,45\n",
        "arm.csv:2:12: notice: joint 'j1', field 'lower': '-45' is more than two turns in rad\n"
        "    if these are degrees: `lower [deg]`\n"
        "arm.csv:2:16: notice: joint 'j1', field 'upper': '45' is more than two turns in rad\n"
        "    if these are degrees: `upper [deg]`",
    ),
    Case(
        "units of the geometry alone",
        ".csv",
        {"convention": "standard"},
        "joint,a [mm],alpha [deg],d [mm],offset,upper,lower\nj1,0,90,100,45,90,-90\n",
        "arm.csv:1: notice: manipulator 'arm', field 'offset': no unit is declared for offset, upper, lower: the units of the geometry hold, mm and deg\n"
        "    declare the unit in each header",
    ),
    Case(
        "a row of units",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d\nas drawn,mm,deg,mm\nj1,0,0,0.1\n",
        "arm.csv:2: error: joint 'joint_1', field 'a': row 1 holds units, not a joint\n"
        "    accepted: units in the headers, such as `a [mm]`",
    ),
    Case(
        "a header that returns",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d\nj1,0,0,0.1\njoint,a,alpha,d\n",
        "arm.csv:3: error: joint 'joint_2': row 2 is the header of line 1 again\n"
        "    accepted: one header; tables of several manipulators have a column robot",
    ),
    Case(
        "a header that returns in the middle",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,theta\nj1,0,0,0.1,q1\nj2,0.3,0,0,q2\njoint,a,alpha,d,theta\nj3,0.2,0,0,q3\n",
        "arm.csv:4: error: joint 'joint_3': row 3 is the header of line 1 again\n"
        "    accepted: one header; tables of several manipulators have a column robot",
    ),
    Case(
        "units above joint variables",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,theta\nas drawn,mm,deg,mm,deg\nj1,0,0,0.1,q1\nj2,0.3,0,0,q2\n",
        "arm.csv:2: error: joint 'joint_1', field 'a': row 1 holds units, not a joint\n"
        "    accepted: units in the headers, such as `a [mm]`",
    ),
    Case(
        "a first row that is shorter than the header",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d\nj1\n",
        "arm.csv:2: error: joint 'joint_1': row 1 has 1 cells, and the header has 4 columns\n"
        "    accepted: one cell for each column, with a comma between them",
    ),
    Case(
        "degrees that are added to a joint variable",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,theta\nj1,0.1,pi/2,0.1,q1\nj2,0.3,0,0,q2-90\n",
        "arm.csv:3:12: error: joint 'j2', field 'theta': 'q2-90' is more than a full turn in rad, and no unit is declared for it\n"
        "    accepted: at most 2π rad where no unit is declared\n"
        "    if these are degrees, say so: `theta [deg]` in the header, `units: {angle: deg}`, or `--angle-unit deg`",
    ),
    Case(
        "a joint variable whose letter became a zero",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,theta\nj1,0.1,pi/2,0.1,0₁\n",
        "arm.csv:2:17: error: joint 'j1', field 'theta': '0₁' cannot be read: '₁' is no unit that is known\n"
        "    accepted: a number such as 0.5 or an expression such as pi/2, bare or with a unit (rad, deg, °)\n"
        "    write the joint variable as q1, and what is added to it behind: q1 + pi/2",
    ),
    Case(
        "a row behind a hash",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d\n#1,0,0,0.1\n#2,0,0,0.1\nj3,0,0,0.1\n",
        "arm.csv:2: notice: manipulator 'arm': '#1,0,0,0.1' is a comment, since it begins with #, and no row\n"
        "    put the first cell in quotes if this is a row\n"
        "arm.csv:3: notice: manipulator 'arm': '#2,0,0,0.1' is a comment, since it begins with #, and no row\n"
        "    put the first cell in quotes if this is a row",
    ),
    Case(
        "types under another header",
        ".csv",
        {"convention": "standard"},
        "joint,kinematics,a,alpha,d\nj1,prismatic,0,0,0.1\n",
        "arm.csv:1:7: notice: manipulator 'arm': the column 'kinematics' is left out: no field is called so\n"
        "arm.csv:2: error: joint 'joint_1', field 'type': 'prismatic' seems to be a type, and no field is called 'kinematics': the joint would be taken as revolute\n"
        "    accepted: one of the headers type, joint type, kind, sigma, σ, r/p, p/r, type of joint, axis type\n"
        "    if it is to be left out, begin its header with _: '_kinematics'",
    ),
    Case(
        "a minus before a type",
        ".csv",
        {"convention": "standard"},
        "joint,type,a,alpha,d\nj1,-1,0,0,0.1\n",
        "arm.csv:2:4: error: joint 'j1', field 'type': '-1' is no type of joint\n"
        "    accepted: revolute, r, rotational, rotary, rotation, hinge, 0; prismatic, p, linear, t, translational, translation, sliding, 1; continuous, c; fixed, f, static, rigid",
    ),
    Case(
        "an angle that may be theta",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,phi\nj1,0,0,0.1,0\nj2,0,0,0.1,pi/2\n",
        "arm.csv:3:12: error: joint 'joint_2', field 'phi': 'phi' is an angle that may be theta or an offset, which no column holds, and it is 'pi/2'\n"
        "    accepted: 0 in this column, or a table of a, alpha, d and theta (or offset) without it\n"
        "    if it is one of them, call it so: theta or offset",
    ),
    Case(
        "letters in another order",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,tetha\nj1,0,0,0.1,1\n",
        "arm.csv:1:17: error: field 'tetha': no column is called 'tetha'\n"
        "    accepted: robot, convention, index, joint, link, type, a, alpha, d, theta, offset, beta, gamma, b, sign, flip, limits, lower, upper, velocity, effort, mass, com, com_x, com_y, com_z, inertia, ixx, iyy, izz, ixy, ixz, iyz, radius, damping, friction, armature\n"
        "    did you mean 'theta'?",
    ),
    Case(
        "the letters of Khalil",
        ".csv",
        {"convention": "standard"},
        "j,sigma,alpha,d,theta,r\n1,0,0,0.1,0,0.2\n",
        "arm.csv:1: error: field 'a': 'r' beside 'sigma' may be the r of Khalil and Kleinfinger, which is d here, while their d is a\n"
        "    accepted: a for the length along x, d for the length along z",
    ),
    Case(
        "a header that is missing and one too many",
        ".csv",
        {"convention": "standard"},
        "joint,a [mm,alpha,d\nj1,0,0,0.1\n",
        "arm.csv:1: error: field 'a': there is no column for a in the header\n"
        "    accepted: one of the headers a, r, link length, length; its unit may follow, as in `a [mm]`\n"
        "    no field is called 'a [mm'",
    ),
    Case(
        "an endless header",
        ".csv",
        {"convention": "standard"},
        "a," * 60_000 + "\n",
        "arm.csv:1: error: this line should be the header, and has 120000 characters\n"
        "    accepted: at most 100000 characters",
    ),
    Case(
        "multiples of π",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha [pi],d\nj1,0,0.5,0.1\n",
        "arm.csv:1:9: error: field 'alpha': 'pi' is no unit of angle that is known\n"
        "    accepted: rad, deg, rev\n"
        "    write rad, and the multiples of π in the cells: 0.5*pi",
    ),
    Case(
        "German degrees",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha [Grad],d\nj1,0,90,0.1\n",
        "arm.csv:1:9: error: field 'alpha': 'Grad' is no unit of angle that is known\n"
        "    accepted: rad, deg, rev\n"
        "    write deg for degrees; gradians have to be converted: 1 gon is 0.9 deg",
    ),
    Case(
        "a comment that says nothing",
        ".csv",
        {"convention": "standard"},
        "# convention:\njoint,a,alpha,d\nj1,0,0,0.1\n",
        "arm.csv:1:3: error: field 'convention': the comment line says nothing behind 'convention'\n"
        "    accepted: # convention: standard, or modified",
    ),
    Case(
        "another convention, without a space",
        ".csv",
        {"convention": "standard"},
        "#DH-convention=modified\njoint,a,alpha,d\nj1,0,0,0.1\n",
        "an option: error: field 'convention': 'standard' means the standard convention, and arm.csv:1:16 says modified\n"
        "    accepted: one convention for the whole table",
    ),
    Case(
        "another convention in prose",
        ".csv",
        {"convention": "standard"},
        "# from modified DH parameters (Craig)\njoint,a,alpha,d\nj1,0,0,0.1\n",
        "arm.csv:1: notice: manipulator 'arm', field 'convention': this comment speaks of the modified convention, and the table is read as standard\n"
        "    if it means this table, write `# convention: modified`",
    ),
    Case(
        "joints counted backwards",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d\nj3,0,0,0.1\nj2,0,0,0.1\nj1,0,0,0.1\n",
        "arm.csv:2:1: notice: manipulator 'arm', field 'joint': the numbers of the joints, 'j3, j2, j1', do not rise from row to row\n"
        "    rows are in the order from the base to the tool",
    ),
    Case(
        "a heavy link",
        ".csv",
        {"convention": "standard"},
        "joint,a,alpha,d,mass,radius\nj1,0,0,0.1,3700000,40\n",
        "arm.csv:2: notice: joint 'j1', field 'mass': the link weighs 3.7e+06 kg\n"
        "    is it in another unit?\n"
        "arm.csv:2: notice: joint 'j1', field 'radius': the link is 40 m thick\n"
        "    is it in another unit?",
    ),
    Case(
        "a far base",
        ".csv",
        {"convention": "standard"},
        "# base: {xyz: [0, 0, 300]}\njoint,a,alpha,d\nj1,0,0,0.1\n",
        "arm.csv:1:9: notice: manipulator 'arm', field 'base': base is 300 m away\n"
        "    if its xyz is in mm, declare it: `units: {length: mm}`, or write '300 mm'",
    ),
    Case(
        "an immeasurable tool",
        ".yaml",
        {},
        "convention: standard\ntool: {xyz: [0, 0, 1e300]}\njoints:\n- {a: 0, alpha: 0, d: 1}\n",
        "arm.yaml:2:7: error: manipulator 'arm', field 'tool': tool is 1e+300 m away: positions cannot be computed to a micrometre there\n"
        "    accepted: a translation of at most 1e+09 m",
    ),
    Case(
        "an empty base",
        ".csv",
        {"convention": "standard", "base": " "},
        "joint,a,alpha,d\nj1,0,0,0.1\n",
        "an option:1:1: error: field 'base': base is an empty value\n"
        "    accepted: {xyz: [0, 0, 0.3], rpy: [0, 0, pi]}, or a rigid 4x4 matrix as a list of four rows",
    ),
    Case(
        "a base that is no YAML",
        ".csv",
        {"convention": "standard", "base": "{xyz"},
        "joint,a,alpha,d\nj1,0,0,0.1\n",
        "an option:1:1: error: field 'base': this is not valid YAML: did not find expected ',' or '}', at '{xyz'\n"
        "    close the bracket that opens here, or put a comma between the values",
    ),
    Case(
        "no angle of atan2",
        ".csv",
        {"convention": "standard"},
        'joint,a,alpha,d\nj1,0,"atan2(0, 0)",0.1\n',
        "arm.csv:2:6: error: joint 'j1', field 'alpha': 'atan2(0, 0)' cannot be read: atan2 has no value there\n"
        "    accepted: a number such as 0.5 or an expression such as pi/2, bare or with a unit (rad, deg, °)",
    ),
    Case(
        "no joints",
        ".yaml",
        {},
        "convention: standard\njoints: []\n",
        "arm.yaml:1:1: error: manipulator 'arm', field 'joints': there are no joints: a manipulator has one row for each",
    ),
]


@pytest.mark.parametrize("case", CASES, ids=[case.kind for case in CASES])
def test_a_message_says_where_what_and_what_to_do(
    case: Case, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """File, line, column, joint and field, the text found, what is accepted, and what was probably meant."""
    try:
        arms = read(case.table, case.suffix, **case.options)
        said = [
            problem
            for arm in arms
            for problem in in_file_order((*arm.notices, *(() if isinstance(arm, Manipulator) else arm.problems)))
        ]
        text = "\n".join(map(str, said))
    except TableError as error:
        text = str(error)
    assert text == case.message
