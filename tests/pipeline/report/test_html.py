from __future__ import annotations

import base64
import csv
import hashlib
import io
import json
import math
import re
import shutil
import subprocess
import tracemalloc
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from lxml import etree, html
from PIL import Image

from dh2urdf.conversion.outcome import Outcome, proof_facts, to_line
from dh2urdf.kinematics.proof import Proof
from dh2urdf.plugin_system import load
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.running.run import execute
from dh2urdf.tasks.batch_report import BatchReport, Result

pytest.importorskip("jinja2")
pytest.importorskip("matplotlib")

from collections.abc import Iterable

from dh2urdf.report.figures import Workspace, arm_skeleton
from dh2urdf.report.html import page
from dh2urdf.report.manifest import EXAMPLES, FULL, ManifestWriter, reproduction, write_reports
from dh2urdf.report.overview import LISTED, SAMPLED, Overview
from reference_arms import ReferenceRobot

if TYPE_CHECKING:
    from lxml.html import HtmlElement

ROOT = Path(__file__).parents[3]
CONFIGS = ROOT / "configs"
SCREENSHOT = ROOT / "docs" / "report.png"
RUN = "inputs: arms.csv\nemitters: [urdf, xacro]\noutput: {directory: out}\n"
HEADER = ["robot", "joint", "a", "alpha", "d", "theta"]
HOSTILE = (
    "<script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    "\"'><svg onload=alert(1)>",
    "{{ 7*7 }}{% raw %}",
    "&lt;b&gt;",
    "</style></script><!--",
    "\u202egnp.elif",
    "$\\alpha$",
    "javascript:alert(1)",
)


def run(folder: Path, config: str, *, resume: bool = False) -> HtmlElement:
    """The page of a run, as a person in that folder does it; it works in this process, which is there already."""
    (folder / "run.yaml").write_text(config, "utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        execute(make_plan(load_config(Path("run.yaml"), ["execution.options.workers=1"]), load()), resume=resume)
    return parsed(folder / "out")


def parsed(out: Path) -> HtmlElement:
    return html.document_fromstring((out / "report.html").read_bytes().decode("utf-8"))


def report(out: Path) -> dict[str, Any]:
    return dict(json.loads((out / "report.json").read_bytes()))


def table(names: Iterable[str]) -> str:
    text = io.StringIO()
    text.write("# convention: standard\n")
    writer = csv.writer(text)
    writer.writerow(HEADER)
    for name in names:
        writer.writerow([name, f"1{name}", 0, "pi/2", 0.2, 0])
        writer.writerow([name, f"2{name}", 0.4, 0, 0.1, "-90 deg"])
    return text.getvalue()


def cells(tree: HtmlElement, kind: str) -> list[list[HtmlElement]]:
    """The cells of a table's body."""
    (found,) = tree.xpath(f"//table[contains(@class, '{kind}')]")
    return [list(row) for row in found.xpath("tbody/tr")]


def numbers(cell: HtmlElement) -> list[float]:
    return [float(data.get("value")) for data in cell.iter("data")]


def text(element: HtmlElement) -> str:
    return " ".join(element.text_content().split())


@pytest.fixture(scope="module")
def ur5(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the main job was done."""
    pytest.importorskip("pybullet")
    folder = tmp_path_factory.mktemp("ur5")
    shutil.copytree(CONFIGS / "tables", folder / "tables")
    config = "inputs: tables/ur5.csv\nemitters: [urdf, xacro]\nloaders: pybullet\noutput: out\n"
    run(folder, config)
    return folder / "out"


@pytest.fixture(scope="module")
def variants(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run of many, some of which failed."""
    folder = tmp_path_factory.mktemp("variants")
    vary = "[{joints: 2, field: a, scale: [0.8, 1.2]}, {joints: 3, field: lower, uniform: [-3, 3.5]}]"
    config = (
        f"inputs: {CONFIGS}/tables/ur5.csv\noutput: out\nvariations: {{of: ur5, count: 40, seed: 3, vary: {vary}}}\n"
    )
    run(folder, config)
    return folder / "out"


@pytest.fixture
def same_drawings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every manipulator has the same drawings, where they are not what is looked at: two take a third of a second."""
    monkeypatch.setattr("dh2urdf.report.html.skeleton_figure", lambda *_: "<svg></svg>")
    monkeypatch.setattr(Workspace, "figure", lambda _workspace, _key: "<svg></svg>")


class TestOneManipulator:
    def test_the_agreement_is_that_of_the_report(self, ur5: Path) -> None:
        """Errors, tolerances, joint vectors and numbers of poses are there to the last digit, with a verdict."""
        (row,) = report(ur5)["manipulators"]
        asked = {**row["proof"], **row["loaders"]}
        found = cells(parsed(ur5), "agreement")
        assert [text(line[0]).split(" ")[0] for line in found] == list(asked)
        for line, facts in zip(found, asked.values(), strict=True):
            assert numbers(line[2]) == [facts["position_error"]]
            assert numbers(line[3]) == [facts["tolerance"]]
            assert numbers(line[4]) == [facts["angle_error"]]
            assert numbers(line[5]) == [facts.get("angle_tolerance", 1e-9)]
            assert int(text(line[6])) == facts["poses"]
            assert numbers(line[7]) == facts["q"]
            assert text(line[1]) == "same arm"

    def test_the_table_is_the_given_one(self, ur5: Path) -> None:
        """The DH table is there as the person gave it, in SI units."""
        given = [line for line in (CONFIGS / "tables" / "ur5.csv").read_text().splitlines() if line[0] != "#"]
        angle = {"pi/2": math.pi / 2, "-pi/2": -math.pi / 2, "0": 0.0}
        found = cells(parsed(ur5), "dh")
        for line, row in zip(found, csv.DictReader(given, skipinitialspace=True), strict=True):
            assert (text(line[1]), text(line[3])) == (row["joint"], row["type"])
            values = [number for cell in line[4:7] for number in numbers(cell)]
            assert values == [float(row["a"]), angle[row["alpha"]], float(row["d"])]

    def test_limits_and_masses_are_those_of_the_file(self, ur5: Path) -> None:
        """They are the numbers of the URDF that was written; where a mass comes from is said."""
        urdf = etree.parse(ur5 / "ur5.urdf").getroot()
        tree = parsed(ur5)
        limits = {text(line[0]): [numbers(cell)[0] for cell in line[2:6]] for line in cells(tree, "limits")}
        assert limits == {
            joint.get("name"): [float(joint.find("limit").get(key)) for key in ("lower", "upper", "velocity", "effort")]
            for joint in urdf.findall("joint")
            if joint.find("limit") is not None
        }
        masses = {text(line[0]): line for line in cells(tree, "masses")}
        bodies = [link for link in urdf.findall("link") if link.xpath("inertial/mass[@value != 0]")]
        assert list(masses) == [link.get("name") for link in bodies]
        for link in bodies:
            line = masses[link.get("name")]
            assert numbers(line[1]) == [float(link.find("inertial/mass").get("value"))]
            assert numbers(line[2]) == [float(word) for word in link.find("inertial/origin").get("xyz").split()]
            inertia = link.find("inertial/inertia")
            keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
            assert [numbers(cell)[0] for cell in line[3:9]] == [float(inertia.get(key)) for key in keys]
            assert text(line[9]) == "computed from the shape"

    def test_files_and_simulators_are_those_of_the_report(self, ur5: Path) -> None:
        """Every file with its size and hash; the hold test with its verdict; what the simulator printed."""
        (row,) = report(ur5)["manipulators"]
        tree = parsed(ur5)
        found = [(text(line[0]), text(line[1]), numbers(line[2])[0], text(line[3])) for line in cells(tree, "files")]
        assert found == [(file["path"], file["stage"], file["bytes"], file["sha256"]) for file in row["files"]]
        (line,) = cells(tree, "simulators")
        load_ = row["loaders"]["pybullet"]
        assert text(line[0]) == f"{load_['simulator']} {load_['version']}"
        assert [numbers(cell)[0] for cell in line[2:5]] == [load_["mass"], load_["mass_error"], load_["inertia_error"]]
        assert text(line[5]).startswith("yes")
        assert numbers(line[6]) == [load_["hold"]["largest_displacement"]]
        (printed,) = tree.xpath("//details/pre")
        assert printed.text_content().splitlines() == load_["output"].splitlines()

    def test_the_picture_is_in_the_page(self, ur5: Path) -> None:
        """It is the file that the simulator wrote, with words for who cannot see it."""
        (image,) = parsed(ur5).xpath("//img")
        head, _, data = image.get("src").partition(",")
        assert head == "data:image/png;base64"
        assert base64.b64decode(data) == (ur5 / "ur5.png").read_bytes()
        assert "ur5" in image.get("alt")
        assert "PyBullet" in image.get("alt")

    @pytest.mark.long
    def test_again_it_is_the_same_bytes(self, ur5: Path, tmp_path: Path) -> None:
        """Another run in another folder, resumed or not, has the same page; nothing in it is a date or a place."""
        first = (ur5 / "report.html").read_bytes()
        shutil.copytree(ur5.parent, tmp_path / "copy")
        (tmp_path / "copy" / "out" / "report.html").unlink()
        config = (ur5.parent / "run.yaml").read_text()
        for resume in (True, False):
            run(tmp_path / "copy", config, resume=resume)
            assert (tmp_path / "copy" / "out" / "report.html").read_bytes() == first
        assert str(ur5.parent).encode() not in first


class TestAnyPage:
    @pytest.mark.parametrize("which", ["ur5", "variants"])
    def test_it_asks_nothing_of_any_network(self, which: str, request: pytest.FixtureRequest) -> None:
        """There is no address to load from, in no attribute and no style; its own policy forbids it besides."""
        out: Path = request.getfixturevalue(which)
        tree = parsed(out)
        for element in tree.iter():
            for name, value in element.attrib.items():
                if name in {"src", "href", "data", "action", "poster", "srcset"} or name.endswith("href"):
                    assert value.startswith(("#", "data:image/png;base64,")), (element.tag, name, value[:80])
                assert "url(http" not in value
                assert not name.startswith("on")
        content = (out / "report.html").read_text("utf-8")
        assert "http:" not in content
        assert "https:" not in content
        assert "@import" not in content
        (policy,) = tree.xpath("//meta[@http-equiv='Content-Security-Policy']/@content")
        assert "default-src 'none'" in policy
        assert tree.xpath("//link | //iframe | //object | //embed") == []

    @pytest.mark.parametrize("which", ["ur5", "variants"])
    def test_the_only_script_is_its_own(self, which: str, request: pytest.FixtureRequest) -> None:
        """The hash in the policy is that of the one script."""
        tree = parsed(request.getfixturevalue(which))
        (script,) = tree.xpath("//script")
        digest = base64.b64encode(hashlib.sha256(script.text.encode()).digest()).decode()
        assert f"script-src 'sha256-{digest}';" in tree.xpath("//meta[@http-equiv]/@content")[0]

    @pytest.mark.parametrize("which", ["ur5", "variants"])
    def test_it_can_be_read_by_everybody(self, which: str, request: pytest.FixtureRequest) -> None:
        """Tables have captions and scopes, pictures have words, names in the page are there once, links lead somewhere."""
        tree = parsed(request.getfixturevalue(which))
        assert tree.get("lang") == "en"
        for found in tree.xpath("//table"):
            assert text(found.find("caption"))
        assert tree.xpath("//th[not(@scope)]") == []
        assert tree.xpath("//img[not(@alt)]") == []
        ids = tree.xpath("//@id")
        assert len(set(ids)) == len(ids)
        assert {link[1:] for link in tree.xpath("//a/@href | //use/@href")} <= set(ids)
        assert set(tree.xpath("//@aria-labelledby")) <= set(ids)
        assert set(re.findall(r"url\(#([^)]*)\)", " ".join(tree.xpath("//@*")))) <= set(ids)


class TestManyManipulators:
    def test_failures_come_first(self, variants: Path) -> None:
        """Every manipulator has a line, with its status, its errors and what was drawn; failures say why."""
        rows = report(variants)["manipulators"]
        failed = [row for row in rows if row["status"] == "failed"]
        assert 0 < len(failed) < len(rows) == 41
        wanted = [*failed, *(row for row in rows if row["status"] != "failed")]
        (overview,) = parsed(variants).xpath("//table[@id='overview']")
        heads = [text(head) for head in overview.xpath("thead/tr/th")]
        lines = overview.xpath("tbody/tr")
        assert [text(line[heads.index("name")]) for line in lines] == [row["name"] for row in wanted]
        assert [line.get("data-status") for line in lines] == [row["status"] for row in wanted]
        for line, row in zip(lines, wanted, strict=True):
            proof = row["proof"].get("urdf")
            assert numbers(line[heads.index("urdf")]) == ([proof["position_error"]] if proof else [])
            assert numbers(line[heads.index("a_2")]) == ([row["drawn"]["a_2"]] if row["drawn"] else [])
            reason = text(line[heads.index("first error")])
            assert reason == (f"{row['kind']}: {row['errors'][0]['message']}" if row["errors"] else "")

    def test_the_first_are_shown_in_full(self, variants: Path) -> None:
        """Of a run that is too long the first few; what was drawn is marked in their tables."""
        tree = parsed(variants)
        names = tree.xpath("//section[contains(@class, 'manipulator')]/@data-name")
        assert names == [row["name"] for row in report(variants)["manipulators"][:EXAMPLES]]
        marked = tree.xpath("//section[@id='m2']//table[contains(@class, 'dh')]//td[contains(@class, 'drawn')]")
        drawn = report(variants)["manipulators"][1]["drawn"]
        assert [number for cell in marked for number in numbers(cell)] == [drawn["a_2"]]

    @pytest.mark.usefixtures("same_drawings")
    def test_a_short_run_is_shown_in_full(self, tmp_path: Path) -> None:
        """Up to two dozen manipulators, the one that failed included, which has a reason in place of a robot."""
        names = [f"arm{number}" for number in range(FULL)]
        (tmp_path / "arms.csv").write_text(table(names).replace("1arm3,0,pi/2,0.2", "1arm3,0,pi/2,nan"))
        tree = run(tmp_path, RUN)
        sections = tree.xpath("//section[contains(@class, 'manipulator')]")
        assert [section.get("data-name") for section in sections] == names
        assert [len(section.xpath(".//figure")) for section in sections] == [0 if n == "arm3" else 2 for n in names]
        (errors,) = sections[3].xpath(".//div[contains(@class, 'problems error')]")
        assert report(tmp_path / "out")["manipulators"][3]["errors"][0]["message"] in text(errors)

    @pytest.mark.long
    def test_a_longer_run_takes_no_more_memory(self, tmp_path: Path) -> None:
        """The table of all is cut, failures first, with a message; the page is no longer than that of fewer."""
        proof = Proof(position_error=1e-16, angle_error=0.0, q=(0.0,), tolerance=1e-9, poses=3)
        arm = Outcome(name="arm", status="ok", source="arm.csv", drawn={"a_1": 0.125})
        facts = {**arm.row("00", []), "proof": {"urdf": proof_facts(proof)}}
        good = to_line(facts)
        bad = to_line({**facts, "status": "failed", "kind": "proof", "errors": [{"message": "it is off"}]})
        plan = make_plan(load_config(_file(tmp_path, "run.yaml", RUN, arms=table(["arm"]))), load())

        def made(count: int) -> tuple[bytes, int]:
            with (tmp_path / "rows").open("w+b") as rows:
                tracemalloc.start()
                manifest = ManifestWriter(rows, "rows", reproduction(None, [], plan.recipe, []))
                overview = Overview(FULL)
                for number in range(count):
                    row = bad if number % 10 == 0 else good
                    line = row.replace(b'"arm"', b'"arm%06d"' % number).replace(b"0.125", b"0.%06d" % (number + 1))
                    manifest.add(BatchReport(first=0, rows=line))
                write_reports(plan.store, manifest, Result(), None, overview)
                _, peak = tracemalloc.get_traced_memory()
                tracemalloc.stop()
            return page(manifest, overview, plan), peak

        few, small = made(22_000)
        many, large = made(30_000)
        assert large < 1.2 * small
        assert len(many) < 1.2 * len(few)
        tree = html.document_fromstring(many.decode())
        lines = tree.xpath("//table[@id='overview']/tbody/tr")
        assert len(lines) == LISTED
        assert {line.get("data-status") for line in lines} == {"failed"}
        (sampled,) = [
            int(number.replace(",", "")) for number in re.findall(r", for ([\d,]+) of the manip", many.decode())
        ]
        assert sampled == SAMPLED
        assert "1,000 of 30,000 manipulators" in text(tree.xpath("//table[@id='overview']/caption")[0])


def _file(folder: Path, name: str, content: str, **tables: str) -> Path:
    for stem, rows in tables.items():
        (folder / f"{stem}.csv").write_text(rows, "utf-8")
    (folder / name).write_text(content, "utf-8")
    return folder / name


class TestNames:
    @pytest.mark.long
    def test_names_are_text(self, tmp_path: Path) -> None:
        """Whatever robots and joints are called, no element, attribute or script comes of it, and no template runs."""
        (tmp_path / "arms.csv").write_text(table(HOSTILE), "utf-8")
        tree = run(tmp_path, RUN.replace("emitters: [urdf, xacro]\n", ""))
        assert len(tree.xpath("//script")) == 1
        assert tree.xpath("//img") == []
        assert not [name for element in tree.iter() for name in element.attrib if name.startswith("on")]
        shown = [text(link) for link in tree.xpath("//table[@id='overview']/tbody/tr/th")]
        # The one that turns the direction of writing is refused by the check of robots, and so comes first.
        assert sorted(shown) == sorted(name.replace("\u202e", "\\u202e") for name in HOSTILE)
        joints = [text(cell) for cell in tree.xpath("//section[@id='m1']//table[contains(@class, 'dh')]/tbody/tr/th")]
        assert joints == [f"{number}<script>alert(1)</script>" for number in (1, 2)]
        assert "\u202e" not in tree.text_content()

    def test_messages_and_paths_are_text(self, tmp_path: Path) -> None:
        """What a table has in place of a number, and the name of its file, come from strangers too."""
        (tmp_path / "<i>.csv").write_text("# convention: standard\na,alpha,d\n<blink>x</blink>,0,0\n")
        (tmp_path / "arms.csv").write_text(table(["arm"]))
        tree = run(tmp_path, RUN.replace("arms.csv", "[arms.csv, <i>.csv]"))
        assert tree.xpath("//i[not(@style)] | //blink") == []
        assert "<blink>x</blink>" in text(tree.xpath("//div[contains(@class, 'problems error')]")[0])
        assert "<i>" in text(tree.xpath("//h2[@id='m2-name']")[0])


class TestRuns:
    def test_a_cell_has_all_its_arms(self, tmp_path: Path) -> None:
        """The arms, the table of each kind once, one drawing, and how far each tool0 gets."""
        arms = (
            "[{name: left, of: arm, xyz: [0, 0.5, 0]}, {name: right, of: arm}, {name: up, of: leg, parent: left/tool0}]"
        )
        (tmp_path / "arms.csv").write_text(table(["arm", "leg"]))
        tree = run(tmp_path, f"{RUN}cells: {{name: pair, arms: {arms}}}\n")
        (cell,) = tree.xpath("//section[@data-name='pair']")
        assert [text(line[0]) for line in cells(cell, "arms")] == ["left", "right", "up"]
        assert [text(found.find("caption")) for found in cell.xpath(".//table[contains(@class, 'dh')]")] == [
            "DH table of arm (left, right) as given, standard convention",
            "DH table of leg (up) as given, standard convention",
        ]
        tips = [text(extent).split(":")[0] for extent in cell.xpath(".//span[@class='extent']")]
        assert tips == ["left_tool0", "right_tool0", "up_tool0"]

    @pytest.mark.long
    @pytest.mark.usefixtures("same_drawings")
    @pytest.mark.parametrize("layout", ["folders", "shards"])
    def test_pictures_are_found_in_every_layout(self, tmp_path: Path, layout: str) -> None:
        """Also in folders of one manipulator, and in tar files."""
        pytest.importorskip("pybullet")
        (tmp_path / "arms.csv").write_text(table(["arm", "leg"]))
        config = RUN.replace("directory: out", f"directory: out, layout: {layout}, size: 1")
        tree = run(tmp_path, f"{config}loaders: {{stage: pybullet, options: {{poses: 1}}}}\n")
        assert [image.get("alt").split(" ")[0] for image in tree.xpath("//img")] == ["arm", "leg"]


class TestDrawings:
    def test_the_skeleton_ends_where_tool0_is(self, reference_robot: ReferenceRobot) -> None:
        """Joint axes and frames of every published table are those of its DH product at zero, in both conventions."""
        from dh2urdf.kinematics import forward_kinematics
        from dh2urdf.kinematics.expected_poses import ExpectedPoses

        table_ = reference_robot.manipulator
        arm = arm_skeleton(ExpectedPoses.of(table_).tips[0])
        zero = [0.0] * len(table_.moving_rows)
        expected = forward_kinematics(table_, zero)
        np.testing.assert_allclose(arm.tips[0], expected.translation, atol=1e-12)
        assert len(arm.axes) == len(zero)
        # A joint turns tool0 about its drawn axis, or moves it along it: by central differences.
        for index, (_, at, direction, slides) in enumerate(arm.axes):
            step = 1e-6
            ends = []
            for sign in (1.0, -1.0):
                q = [0.0] * len(zero)
                q[index] = sign * step
                ends.append(np.array(forward_kinematics(table_, q).translation))
            speed = (ends[0] - ends[1]) / (2 * step)
            lever = np.array(expected.translation) - np.array(at)
            wanted = np.array(direction) if slides else np.cross(direction, lever)
            np.testing.assert_allclose(speed, wanted, atol=1e-6)

    def test_the_workspace_is_inside_the_reach(self, reference_robot: ReferenceRobot) -> None:
        """No point is farther from the root than the table's lengths together, and some are not near."""
        from dh2urdf.conversion.one_manipulator import Call
        from dh2urdf.conversion.robots import make_robot
        from dh2urdf.kinematics.expected_poses import ExpectedPoses

        stage = load().get("transform", "alpha-swap")
        robot = make_robot(reference_robot.manipulator, Call(stage=stage, options=stage.options()))
        expected = ExpectedPoses.of(reference_robot.manipulator)
        workspace = Workspace(expected, robot)
        extent = workspace.extent("tool0")
        limits = [joint.limits for joint in robot.moving_joints if joint.type.value == "prismatic"]
        travel = sum(max(abs(limit.lower or 0.0), abs(limit.upper or 0.0)) for limit in limits)
        bound = expected.tips[0].reach([[0.0] * len(expected.joints)]) + travel
        assert 0.2 * (bound - travel) < extent["distance"] <= bound + 1e-9
        assert extent["radius"] <= extent["distance"]
        assert extent["low"] <= extent["high"]


# --- In a browser ---------------------------------------------------------------------------------------------------


def chromium(*words: str | Path) -> subprocess.CompletedProcess[str]:
    """A browser without a window."""
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        pytest.skip("there is no chromium: apt-get install chromium")
    command = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"]
    return subprocess.run(
        [*command, "--enable-logging=stderr", *map(str, words)],
        capture_output=True,
        encoding="utf-8",
        check=True,
        timeout=240,
    )


class TestBrowser:
    @pytest.mark.parametrize("which", ["ur5", "variants"])
    def test_it_has_nothing_to_complain_of(self, which: str, request: pytest.FixtureRequest) -> None:
        """No error of a script, no refused style or picture, no request."""
        done = chromium("--dump-dom", (request.getfixturevalue(which) / "report.html").as_uri())
        assert "CONSOLE" not in done.stderr
        assert "</html>" in done.stdout

    @pytest.mark.long
    def test_a_click_sorts_and_a_filter_filters(self, variants: Path, tmp_path: Path) -> None:
        """A click on a header sorts by its column, what is empty last; the radio buttons choose a status."""
        content = (variants / "report.html").read_text("utf-8")
        content = re.sub(r"script-src '[^']*'", "script-src 'unsafe-inline'", content)
        clicks = "[...document.querySelectorAll('#overview th button')].find(b => b.parentNode.textContent === 'a_2').click();"
        clicks += "document.querySelector('input[value=ok]').click();"
        (tmp_path / "clicked.html").write_text(content.replace("</body>", f"<script>{clicks}</script></body>"), "utf-8")
        done = chromium("--dump-dom", (tmp_path / "clicked.html").as_uri())
        assert "CONSOLE" not in done.stderr
        tree = html.document_fromstring(done.stdout)
        (head,) = tree.xpath("//th[@aria-sort='ascending']")
        column = head.getparent().index(head)
        values = [numbers(line[column]) for line in tree.xpath("//table[@id='overview']/tbody/tr")]
        assert values == [*sorted(value for value in values if value), []]
        hidden = tree.xpath("//table[@id='overview']/tbody/tr[@hidden]/@data-status")
        failed = [row for row in report(variants)["manipulators"] if row["status"] == "failed"]
        assert hidden == ["failed"] * len(failed)
        assert text(tree.xpath("//output")[0]) == f"{41 - len(failed)} shown"

    @pytest.mark.long
    def test_the_screenshot_of_the_docs(self, ur5: Path, tmp_path: Path, *, renew: bool) -> None:
        """docs/report.png is the top of the page of the UR5, which shows something, and so does the page as it is."""
        chromium(f"--screenshot={tmp_path / 'page.png'}", "--window-size=1240,1500", (ur5 / "report.html").as_uri())
        if renew:
            small = Image.open(tmp_path / "page.png").convert("RGB").quantize(160)
            small.save(SCREENSHOT, optimize=True)
        for path in (tmp_path / "page.png", SCREENSHOT):
            pixels = np.asarray(Image.open(path).convert("RGB"), dtype=int)
            assert pixels.shape == (1500, 1240, 3)
            assert len(np.unique(pixels @ (1, 256, 65536))) > 100
            assert (np.ptp(pixels, axis=2) > 60).mean() > 0.01
