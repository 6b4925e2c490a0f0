"""The edit `payload`: what the arm carries, also beside what it carries already."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from lxml import etree

from dh2urdf.manipulator import Inertia, Payload
from dh2urdf.testing import reference_manipulators
from dh2urdf_plugins.edits.payload import PayloadOptions, edit_table

UR5 = reference_manipulators()[0]
TABLE = "# convention: standard\na, alpha, d\n0.4, pi/2, 0.1\n0.3, 0, 0\n"


def matrix(inertia: Inertia | None) -> Any:
    assert inertia is not None
    i = inertia
    return np.array([[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]])


def carried(options: PayloadOptions) -> Payload:
    payload = edit_table(UR5, options).payload
    assert payload is not None
    return payload


def test_a_box_and_a_ball_are_solid() -> None:
    """m/12·(b² + c²) and 2/5·m·r²: textbook inertias about the centre of mass."""
    box = carried(PayloadOptions(mass=3.0, size=(0.1, 0.2, 0.3)))
    assert np.diag(matrix(box.inertia)) == pytest.approx([0.25 * 0.13, 0.25 * 0.10, 0.25 * 0.05])
    ball = carried(PayloadOptions(mass=3.0, radius=0.1))
    assert matrix(ball.inertia) == pytest.approx(np.eye(3) * 0.012)
    given = carried(PayloadOptions(mass=3.0, inertia=(3.0, 2.0, 2.5, 0.1, 0.2, 0.3)))
    assert given.inertia == Inertia(ixx=3.0, iyy=2.0, izz=2.5, ixy=0.1, ixz=0.2, iyz=0.3)


def test_two_payloads_are_one_body() -> None:
    """Mass, centre and inertia are those of two clouds of points with the same moments, taken together."""
    gripper = Payload(mass=0.9, com=(0.0, 0.02, 0.06), inertia=Inertia(ixx=2e-3, iyy=3e-3, izz=1.5e-3, ixy=1e-4))
    edited = edit_table(
        replace(UR5, payload=gripper), PayloadOptions(mass=2.0, com=(0.1, 0.0, 0.2), size=(0.1, 0.1, 0.2))
    )
    part = Payload(mass=2.0, com=(0.1, 0.0, 0.2), inertia=Inertia(ixx=1 / 6 * 0.05, iyy=1 / 6 * 0.05, izz=1 / 6 * 0.02))
    points, weights = map(np.concatenate, zip(cloud(gripper), cloud(part), strict=True))
    centre = weights @ points / weights.sum()
    arms = points - centre
    whole = sum(w * (np.dot(r, r) * np.eye(3) - np.outer(r, r)) for w, r in zip(weights, arms, strict=True))
    assert edited.payload is not None
    assert edited.payload.mass == pytest.approx(2.9)
    assert edited.payload.com == pytest.approx(centre)
    assert matrix(edited.payload.inertia) == pytest.approx(whole)


def cloud(body: Payload) -> tuple[Any, Any]:
    """Six points of equal weight with the mass, the centre and the inertia of a body: Σ m·r·rᵀ = tr(I)/2·1 − I."""
    inertia = matrix(body.inertia)
    values, axes = np.linalg.eigh(np.trace(inertia) / 2 * np.eye(3) - inertia)
    reach = axes * np.sqrt(3 * values / body.mass)
    return np.concatenate([np.array(body.com) + reach.T, np.array(body.com) - reach.T]), np.full(6, body.mass / 6)


def test_it_is_a_link_of_every_file(cli: Cli, tmp_path: Path) -> None:
    """The link `payload` has its mass, hangs on the last link by a fixed joint, and the efforts carry it."""
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text("inputs: arm.csv\nedits: []\noutput: out\nreport: {html: false}\n")
    cli("run", "run.yaml")
    bare = efforts(tmp_path / "out" / "arm.urdf")
    cli("run", "run.yaml", "--set", "edits=[{stage: payload, options: {mass: 20, com: [0, 0, 0.1]}}]")
    loaded = etree.parse(tmp_path / "out" / "arm.urdf")
    assert loaded.find("link[@name='payload']/inertial/mass").get("value") == "20"
    assert loaded.find("joint/child[@link='payload']/..").get("type") == "fixed"
    assert all(more > less for more, less in zip(efforts(tmp_path / "out" / "arm.urdf"), bare, strict=True))


def efforts(path: Path) -> list[float]:
    return [float(limit.get("effort")) for limit in etree.parse(path).iter("limit")]
