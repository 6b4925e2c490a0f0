"""Rules about what is hardly meant: degrees for radians, millimetres for metres, masses that are elsewhere."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

from dh2urdf.documents import is_file
from dh2urdf.kinematics.mass import principal_moments
from dh2urdf.rotations import ZERO, add, rotate
from dh2urdf.source import shown
from dh2urdf_check.document.description import Hit
from dh2urdf_check.merged import inertial_of, pose_of
from dh2urdf_check.meshes import LONGEST
from dh2urdf_check.shapes import mesh_files, resolved

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.rotations import Vec3
    from dh2urdf_check.document.description import Description, JointNode, LinkNode
    from dh2urdf_check.document.tree import Element

MOST_TURNS = 20.0
"""A limit of so many radians, more than three turns, that is a whole number is taken for degrees [rad]."""
MOST_DEGREES = 720.0
"""A limit beyond two turns of degrees stands for no limit, such as 1000 or 1e16 [deg]."""
WHOLE_TURN = 2 * math.pi + 0.01
_STEP = 0.5
"""What angles in degrees are multiples of [deg]."""
_NO_LIMIT = {100.0, 200.0, 500.0}
"""Round numbers that are written for no limit [rad]."""
TOO_WIDE = 2.0
"""How much wider than the shapes a body may be: shapes are simplified, and motors have no shape."""
TOO_FAR = 2.0
"""How many diagonals of its shapes a centre of mass may be outside of them."""
SMALLEST = 0.05
"""What a body without larger shapes may measure [m]: a rotor that is not drawn, a frame with a placeholder."""


def hits(description: Description) -> Iterator[Hit]:
    """Findings about sizes, angles and masses."""
    for joint in description.joints:
        yield from _limits(joint)
    for element in description.root.walk():
        if element.tag == "origin" and (angles := element.numbers("rpy", 3)) and _in_degrees(angles):
            yield Hit("angles-in-degrees", element, f"the rpy is {shown(element.get('rpy') or '')}")
    for joint in description.joints:
        origin = joint.element.first("origin")
        xyz = origin.numbers("xyz", 3) if origin else None
        if origin and xyz and max(map(abs, xyz)) >= LONGEST:
            message = f"joint {shown(joint.name)} is {max(map(abs, xyz)):g} m from its parent's frame"
            yield Hit("length-in-millimetres", origin, message)
    yield from _meshes(description)
    for link in description.links:
        yield from _link(link, is_ground=not description.joints)


def _whole(angle: float) -> bool:
    return math.isclose(angle / _STEP, round(angle / _STEP), abs_tol=1e-9)


def _in_degrees(angles: tuple[float, ...]) -> bool:
    return WHOLE_TURN < max(map(abs, angles)) <= MOST_DEGREES and all(map(_whole, angles))


def _limits(joint: JointNode) -> Iterator[Hit]:
    limit = joint.element.first("limit")
    if limit is None:
        return
    lower, upper = limit.number("lower"), limit.number("upper")
    if joint.kind == "revolute" and lower is not None and upper is not None:
        ends = (lower, upper)
        largest = max(map(abs, ends))
        if MOST_TURNS <= largest <= MOST_DEGREES and all(map(_whole, ends)) and largest not in _NO_LIMIT:
            message = f"joint {shown(joint.name)} turns from {lower:g} to {upper:g} rad"
            yield Hit("limits-in-degrees", limit, message)


def _meshes(description: Description) -> Iterator[Hit]:
    """Meshes that are too large, once for all of them; a single link may be the ground."""
    files = description.once(mesh_files)
    found: list[tuple[Element, float]] = []
    for mesh, path in _mesh_files(description) if description.joints else ():
        file = files.get(path)
        sides = [file.unit * side for side in file.sides] if file and file.sides else None
        scale = mesh.numbers("scale", 3) or (1.0, 1.0, 1.0)
        largest = max(abs(side * factor) for side, factor in zip(sides or ZERO, scale, strict=True))
        if largest >= LONGEST:
            found.append((mesh, largest))
    if found:
        mesh, largest = found[0]
        first = f"{shown(mesh.get('filename') or '')} measures {largest:.4g} m"
        message = f"the mesh {first}" if len(found) == 1 else f"{len(found)} meshes are too large; the first, {first}"
        yield Hit("length-in-millimetres", mesh, message)


def _mesh_files(description: Description) -> Iterator[tuple[Element, Path]]:
    """Meshes whose files are there."""
    for link in description.links:
        for shape in link.shapes:
            mesh = shape.first("geometry", "mesh")
            path = resolved(mesh.get("filename") or "", description) if mesh else None
            if mesh and path and is_file(path):
                yield mesh, path


def _link(link: LinkNode, *, is_ground: bool) -> Iterator[Hit]:
    """Findings about shapes and masses; a single link may be the ground."""
    corners: list[Vec3] = []
    is_whole = True
    for shape in link.shapes:
        body = next(iter(geometry.children), None) if (geometry := shape.first("geometry")) else None
        half = _half_sizes(body) if body else None
        pose = pose_of(shape.first("origin"))
        if half is None or pose is None:
            is_whole = False
            continue
        if body and max(half) * 2 >= LONGEST and not is_ground:
            message = f"a {body.tag} of link {shown(link.name)} measures {2 * max(half):g} m"
            yield Hit("length-in-millimetres", body, message)
        for i, j, k in product((-1, 1), repeat=3):
            corner = (i * half[0], j * half[1], k * half[2])
            corners.append(add(pose.translation, rotate(pose.rotation, corner)))
    if corners and is_whole and (inertial := link.inertial):
        yield from _mass(link, inertial, corners)


def _half_sizes(body: Element) -> tuple[float, float, float] | None:
    """Half of the extents of a shape in its own frame [m]; None of a mesh, whose extents are not known."""
    radius, length = body.number("radius"), body.number("length")
    if body.tag == "box" and (size := body.numbers("size", 3)):
        return size[0] / 2, size[1] / 2, size[2] / 2
    if body.tag == "sphere" and radius is not None:
        return radius, radius, radius
    if body.tag == "cylinder" and radius is not None and length is not None:
        return radius, radius, length / 2
    return None


def _mass(link: LinkNode, inertial: Element, corners: list[Vec3]) -> Iterator[Hit]:
    pose, body = pose_of(inertial.first("origin")), inertial_of(inertial)
    if pose is None or body is None or body.mass <= 0.0:
        return
    com = pose.translation
    low, high = [min(axis) for axis in zip(*corners, strict=True)], [max(axis) for axis in zip(*corners, strict=True)]
    diagonal = max(math.dist(low, high), SMALLEST)
    outside = math.hypot(*(max(a - c, c - b, 0.0) for a, b, c in zip(low, high, com, strict=True)))
    about = f"link {shown(link.name)}"
    if outside > TOO_FAR * diagonal:
        message = f"the centre of mass of {about} is {outside:.3g} m outside its shapes, which measure {diagonal:.3g} m"
        yield Hit("centre-of-mass-far-off", inertial, message)
        return
    # No point of a body is farther from its centre of mass than its radius of gyration asks for: I = m·k², k ≤ r.
    reach = TOO_WIDE * max(*(math.dist(corner, com) for corner in corners), SMALLEST)
    gyration = math.sqrt(max(*principal_moments(body.inertia), 0.0) / body.mass)
    if gyration > reach:
        message = (
            f"the inertia of {about} is that of {body.mass:g} kg at a distance of {gyration:.3g} m, "
            f"and its shapes reach {reach / TOO_WIDE:.3g} m"
        )
        yield Hit("inertia-of-a-larger-body", inertial, message)
