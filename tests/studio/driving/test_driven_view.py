"""A program drives the robots of `dh2urdf view`, and a browser shows it; pages from elsewhere drive nothing."""

import http.client
import json
import math
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.viewing import View, load_figures

UR5 = Path(__file__).parents[3] / "configs" / "tables" / "ur5.csv"
GRIPPER = """<robot name="gripper"><link name="palm"/><link name="left"/><link name="right"/>
<joint name="l" type="prismatic"><parent link="palm"/><child link="left"/><axis xyz="0 1 0"/>
  <limit lower="0" upper="0.08" effort="1" velocity="1"/></joint>
<joint name="r" type="prismatic"><parent link="palm"/><child link="right"/><axis xyz="0 1 0"/>
  <limit lower="-0.08" upper="0" effort="1" velocity="1"/><mimic joint="l" multiplier="-1"/></joint></robot>"""
PAN, LIFT, LEFT = "ur5/shoulder_pan_joint", "ur5/shoulder_lift_joint", "gripper/l"


class Program:
    """A program that talks to the server, with headers of its own."""

    def __init__(self, address: str) -> None:
        self.here = urlsplit(address).netloc

    def ask(self, method: str, path: str, body: bytes = b"", **headers: str) -> tuple[int, str]:
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        connection = http.client.HTTPConnection(self.here, timeout=20)
        connection.request(method, path, body or None, named)
        answer = connection.getresponse()
        told = answer.read().decode()
        connection.close()
        return answer.status, told

    def set(self, content_type: str = "application/json", /, **values: Any) -> tuple[int, Any]:
        body = json.dumps({"names": list(values), "positions": list(values.values())}).encode()
        status, told = self.ask("POST", "/set_joint_positions", body, Content_Type=content_type)
        return status, json.loads(told)

    def get(self) -> dict[str, float]:
        status, told = self.ask("GET", "/get_joint_positions")
        assert status == 200
        found = json.loads(told)
        return dict(zip(found["names"], found["positions"], strict=True))


@pytest.fixture(scope="module")
def address(serving: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    gripper = tmp_path_factory.mktemp("live") / "gripper.urdf"
    gripper.write_text(GRIPPER)
    with serving("view", UR5, gripper) as served:
        yield served


def shows(page: Any, name: str, value: float) -> None:
    """Waits until a slider shows a joint value, in its unit."""
    script = """([name, value]) => {
        const slider = document.querySelector(`.joint-slider input[type=range][aria-label="${name}"]`);
        return slider && Math.abs(slider.valueAsNumber - value) < 1e-6;
    }"""
    page.wait_for_function(script, arg=[name, value])


def drive(page: Any, program: Program) -> float:
    """Drives two joints 100 times a second until 20 poses were drawn; gives the last value of one."""
    script = """() => {
        const node = document.querySelector('.arm-view').scene.getObjectByName('ur5/tool0');
        return (window.poses ??= new Set()).add(node.matrix.elements.join()).size >= 20;
    }"""
    stop, sent = threading.Event(), [0.5]

    def send() -> None:
        while not stop.wait(0.01):
            sent[0] += 0.001
            program.set(**{PAN: sent[0], LIFT: -sent[0]})

    driving = threading.Thread(target=send)
    driving.start()
    try:
        page.wait_for_function(script)  # which asks for every picture
    finally:
        stop.set()
        driving.join()
    return sent[0]


@pytest.mark.long
def test_a_program_drives_the_robots(address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """Scene and sliders of every tab follow, pose by pose; a person's joints are read by the program."""
    program = Program(address)
    assert set(program.get().values()) == {0.0}
    tab, second = (new_tab(address, width=640, height=400) for _ in range(2))
    for each in (tab, second):
        each.page.goto(address)
        each.page.wait_for_function("document.querySelector('.arm-view')?.shown > 0")

    assert program.set(**{PAN: 0.5, LEFT: 0.05}) == (200, {"is_ok": True, "reason": "", "limited": []})
    view = View(load_figures([UR5], catalog))
    view.move({"shoulder_pan_joint": 0.5})
    tool0 = [node.name for node in view.drawing.nodes].index("tool0")
    for each in (tab, second):
        each.page.bring_to_front()
        shows(each.page, PAN, math.degrees(0.5))
        shows(each.page, LEFT, 0.05)
        each.wait_for_pose("ur5/tool0", view.drawing.poses(view.q)[tool0])
    assert program.get() | {PAN: 0.5, LEFT: 0.05, "gripper/r": -0.05} == program.get()
    assert program.set(**{LEFT: 1.0})[1] == {"is_ok": True, "reason": "", "limited": [LEFT]}
    status, told = program.set(**{PAN: 0.7, "ur5/shoulder_pam_joint": 0.1})
    assert (status, told["is_ok"]) == (400, False)
    assert "no joint that moves is called 'ur5/shoulder_pam_joint'" in told["reason"]
    assert f"did you mean '{PAN}'?" in told["reason"]
    assert program.get()[PAN] == 0.5

    # What is not seen draws too, in headless Chromium: it would take half of the pictures.
    second.page.close()
    last = drive(tab.page, program)
    shows(tab.page, PAN, math.degrees(last))

    # A person moves on from there; the program reads that. A reload and a new tab have what the program gave.
    slider = tab.page.get_by_role("slider", name=LEFT)
    slider.focus()
    for _ in range(10):
        tab.page.keyboard.press("ArrowLeft")
    shows(tab.page, LEFT, 0.07)
    tab.page.locator(".joint-sliders[aria-busy=false]").wait_for()
    assert program.get()[LEFT] == pytest.approx(0.07)
    tab.page.reload()
    shows(tab.page, LEFT, 0.07)
    third = new_tab(address)
    third.page.goto(address)
    shows(third.page, LEFT, 0.08)
    program.set(**{LEFT: 0.02})
    for each in (tab, third):
        each.page.bring_to_front()
        shows(each.page, LEFT, 0.02)

    # What a program sets while a page is away is there when it comes back; the page speaks of no table.
    tab.page.evaluate("socket.disconnect()")
    tab.page.get_by_text("The view does not answer").wait_for()
    program.set(**{LEFT: 0.03})
    tab.page.evaluate("socket.connect()")
    shows(tab.page, LEFT, 0.03)
    tab.page.get_by_text("The view does not answer").wait_for(state="hidden")


FORMS = ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x", "", "text/json"]


def test_requests_from_elsewhere_drive_nothing(address: str) -> None:
    """By another origin, by another name (DNS rebinding), or as what a page may send without asking first."""
    program = Program(address)
    port, before = urlsplit(address).port, program.get()
    body = json.dumps({"names": [PAN], "positions": [1.0]}).encode()
    own = {"Content_Type": "application/json"}
    evil = f"evil.example:{port}"
    for headers in (
        {"Origin": "http://evil.example"},
        {"Origin": f"http://{evil}", "Host": evil},
        {"Sec_Fetch_Site": "same-site", "Sec_Fetch_Mode": "cors"},
    ):
        assert program.ask("POST", "/set_joint_positions", body, **own, **headers)[0] == 403, headers
        assert program.ask("GET", "/get_joint_positions", **headers)[0] == 403, headers
    assert program.ask("OPTIONS", "/set_joint_positions", Origin="http://evil.example")[0] == 403
    for content_type in FORMS:
        status, told = program.ask("POST", "/set_joint_positions", body, Content_Type=content_type)
        assert (status, json.loads(told)["is_ok"]) == (415, False), content_type
    status, told = Program(address).ask("POST", "/set_joint_positions", b" " * (2**20 + 1), **own)
    assert (status, json.loads(told)["is_ok"]) == (413, False)
    assert program.get() == before
    assert program.ask("POST", "/set_joint_positions", body, **own, Origin=address.rstrip("/"))[0] == 200
    assert program.get()[PAN] == 1.0
