"""What CoppeliaSim did with a file for every rule, and that the table of rules says so.

CI has no CoppeliaSim: what 4.10.0 did is kept in `coppeliasim_4_10_0.json`. Where DH2URDF_COPPELIASIM starts one (see
`coppeliasim_server` beside the loaders' tests), it is asked again; `--renew` keeps what it did.
"""

import contextlib
import json
import socket
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from faulty_files import PROOFS, SOUND, write_all

from dh2urdf_check.inspection import inspect_urdf
from dh2urdf_check.rules import Outcome, rules

pytest.importorskip("coppeliasim_zmqremoteapi_client")
pytest.importorskip("zmq")

LOADERS = str(Path(__file__).parents[1] / "plugins" / "loaders")
sys.path.insert(0, LOADERS)
try:
    from coppeliasim_server import COMMAND, STARTS_WITHIN, Real
finally:
    sys.path.remove(LOADERS)

RECORD = Path(__file__).with_name("coppeliasim_4_10_0.json")
"""By rule: how the import ended, and which objects were others than those of the sound file."""
ENDS = {"imports": None, "imports nothing": Outcome.REFUSES, "raises": Outcome.REFUSES, "crashes": Outcome.CRASHES}
TAKEN: dict[str, list[str]] = json.loads(Path(__file__).with_name("coppeliasim_taken.json").read_text("utf-8"))
"""What the record does not show of itself."""
AS_THE_FILE_SAYS = {*TAKEN["as the file says"]}
"""Files in which there are other objects than in the sound one, and right ones."""
NOT_SEEN_IN_OBJECTS = {*TAKEN["not seen in objects"]}
"""What it alters is nothing of the sound robot: a part is ignored, or the value that it takes is the sound one."""
OF_THE_SOUND_FILE = {"root-without-inertial", "named-colour"}
"""Rules that the sound file breaks, too."""


NEWER = {"free-root", "empty-root", "usd-name", "blanks-around-a-number"}
"""Rules that the record does not have."""


def ask(port: int, path: Path) -> dict[str, Any]:
    """How an import ends, and the objects that it makes, by name."""
    import zmq
    from coppeliasim_zmqremoteapi_client import RemoteAPIClient

    client = RemoteAPIClient("127.0.0.1", port)
    client.socket.setsockopt(zmq.LINGER, 0)
    client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * STARTS_WITHIN))
    sim, importer = client.require("sim"), client.require("simURDF")
    client.socket.setsockopt(zmq.RCVTIMEO, 30000)
    try:
        _, models = importer.importFile(str(path), 8 | 32)
    except zmq.ZMQError:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1):
            raise AssertionError(f"no answer about {path.name} in time") from None
        return {"end": "crashes"}
    except Exception:  # noqa: BLE001 - the client raises nothing else
        found: dict[str, Any] = {"end": "raises"}
    else:
        found = {"end": "imports" if models else "imports nothing", "models": len(models)}
    handles = list(sim.getObjectsInTree(sim.handle_scene))
    if found["end"] == "imports":
        found["objects"] = {sim.getObjectAlias(handle)[:80]: described(sim, handle) for handle in handles}
    if handles:
        sim.removeObjects(handles)
    return found


def described(sim: Any, handle: int) -> list[Any]:
    """An object, in numbers that are rounded."""
    kind = sim.getObjectType(handle)
    found = [kind, *(round(number, 6) + 0.0 for number in sim.getObjectMatrix(handle, -1))]
    if kind == sim.sceneobject_joint:
        cyclic, interval = sim.getJointInterval(handle)
        found += [cyclic, *(round(number, 6) + 0.0 for number in interval), sim.getJointTargetForce(handle)]
        found += [sim.getObjectFloatParam(handle, sim.jointfloatparam_maxvel)]
    elif kind == sim.sceneobject_shape:
        static = bool(sim.getObjectInt32Param(handle, sim.shapeintparam_static))
        moments, body = sim.getShapeInertia(handle)
        colour = sim.getShapeColor(handle, None, sim.colorcomponent_ambient_diffuse)[1]
        found += [static, *(round(number, 9) + 0.0 for number in (sim.getShapeMass(handle), *moments))]
        found += [round(number, 6) + 0.0 for number in (*body[3::4], *sim.getShapeBB(handle)[0], *colour)]
    return found


def compared(found: Mapping[str, Any], sound: Mapping[str, Any]) -> dict[str, Any]:
    """What is kept of an outcome."""
    if "objects" not in found:
        return {"end": found["end"]}
    objects, others = found["objects"], sound["objects"]
    names = sorted(name for name in objects.keys() | others.keys() if objects.get(name) != others.get(name))
    kept: dict[str, Any] = {"end": found["end"], "others": names[:8]}
    if found["models"] != sound["models"]:
        kept["others"].insert(0, f"{found['models']} models")
    if link := objects.get("link_2_respondable"):
        kept["mass of link_2"] = link[14]
    link = objects.get("link_1_visual")
    if link and (found is sound or "link_1_visual" in names):
        kept["link_1_visual"] = {"static": link[13], "mass": link[14], "size": link[-6:-3], "colour": link[-3:]}
    return kept


def read_record() -> dict[str, dict[str, Any]]:
    return dict(json.loads(RECORD.read_text("utf-8")))


def test_the_real_one_does_what_is_kept(tmp_path: Path, *, renew: bool) -> None:
    """Where a command starts CoppeliaSim, it does with every file what is kept of it."""
    if not COMMAND:
        assert RECORD.is_file()
        return
    found = {}
    with Real() as real:
        for name, path in write_all(tmp_path).items():
            found[name] = ask(real.port, path)
            if found[name]["end"] == "crashes":
                real.end()
                real.start()
    kept = {name: compared(each, found["sound"]) for name, each in found.items()}
    if renew:
        lines = [f"{json.dumps(name)}: {json.dumps(each)}" for name, each in kept.items()]
        RECORD.write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")
    assert kept == read_record()


def test_the_table_says_what_it_did(files: dict[str, Path]) -> None:
    """It refuses, crashes or imports as the table has it; and where objects are others, the table says something."""
    record, wrong = read_record(), []
    for rule, kept in record.items():
        if rule == "sound":
            continue
        broken = {rule, *PROOFS[rule].besides}
        named = [finding for finding in inspect_urdf(files[rule]).findings if finding.rule in broken]
        outcomes = [
            rules()[finding.rule].outcomes["coppeliasim"]
            for finding in named
            if any(effect.consumer == "coppeliasim" for effect in finding.effects)
        ]
        fatal = [outcome for outcome in outcomes if outcome in {Outcome.REFUSES, Outcome.CRASHES}]
        if ENDS[kept["end"]] != min(fatal, default=None):
            wrong.append(f"{rule}: it {kept['end']}, the table says {outcomes}")
        elif kept["end"] == "imports" and kept["others"] and not outcomes and rule not in AS_THE_FILE_SAYS:
            wrong.append(f"{rule}: it makes others of {kept['others']}, the table says nothing")
        elif kept["end"] == "imports" and not kept["others"] and outcomes and rule not in NOT_SEEN_IN_OBJECTS:
            wrong.append(f"{rule}: it makes the same of it as of the sound file, the table says {outcomes}")
    assert wrong == []


def test_every_rule_was_tried() -> None:
    """An empty cell means that CoppeliaSim was seen to take the file, but for what is newer than the record."""
    assert rules().keys() - read_record().keys() == {
        *OF_THE_SOUND_FILE,
        *NEWER,
        "xacro-fails",  # Without a description there is nothing to import.
    }


@pytest.mark.parametrize("blank", [" {}", "{} ", "{}&#9;", "{}&#10;"])
def test_blanks_around_a_number_are_found(tmp_path: Path, blank: str) -> None:
    """It reads 0 then, also of a mass: the record of its importer has such files. Between three numbers it takes any."""
    path = tmp_path / "arm.urdf"
    for number in ('value="1"', 'upper="2"', 'ixx="0.005"', 'radius="0.02"', 'xyz="0.3 0 0"'):
        text = number.partition('"')[2].strip('"')
        path.write_text(SOUND.replace(text.join('""'), blank.format(text).join('""')), "utf-8")
        found = [
            finding.rule
            for finding in inspect_urdf(path).findings
            if any(effect.consumer == "coppeliasim" and effect.severity != "note" for effect in finding.effects)
        ]
        assert set(found) == (set() if number.startswith("xyz") else {"blanks-around-a-number"})
