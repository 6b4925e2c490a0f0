"""The robot of a table, in the variant that the options name, with what is wrong or odd about the table.

What a table declares about shapes and densities that no description shows: each of it is worth a notice.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.drawn_links import other_lengths
from dh2urdf.errors import TransformError
from dh2urdf.manipulator import JointType
from dh2urdf.source import Problem
from dh2urdf_plugins.transforms.alpha_swap_options import AlphaSwapOptions
from dh2urdf_plugins.transforms.checks import (
    angle_notices,
    is_weighed,
    paper_problems,
    row_problem,
    table_problems,
    with_inertias,
)
from dh2urdf_plugins.transforms.exact import exact

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.manipulator import LinkGeometry, Manipulator, MeshShape
    from dh2urdf.robot import Robot


class Drawn(NamedTuple):
    """Whether links are seen, and whether they touch."""

    seen: bool
    touching: bool

    @classmethod
    def of(cls, manipulator: Manipulator, options: AlphaSwapOptions) -> Drawn:
        """What the table declares about it, else the options."""
        return cls(
            options.visuals == "all" if manipulator.visuals is None else manipulator.visuals,
            options.collisions == "all" if manipulator.collisions is None else manipulator.collisions,
        )

    def shows(self, visual: MeshShape | None, collision: MeshShape | None, *, weighed: bool) -> bool:
        """Whether the shape of a link shows: it is seen, it touches, or it says what the link weighs."""
        return (visual is None and (self.seen or not weighed)) or (collision is None and self.touching)


def unused_shapes(manipulator: Manipulator, options: AlphaSwapOptions) -> Iterator[Problem]:
    """Shapes, radii and densities without effect in the exact variant, and a shape that the base cannot have."""
    drawn = Drawn.of(manipulator, options)
    shown = [drawn.shows(row.visual, row.collision, weighed=is_weighed(row)) for row in manipulator.rows]
    # The rail of a prismatic joint has the joint's radius, and is a part of the link before.
    of_base = Drawn(drawn.seen, drawn.touching and options.base_collision)
    # Of a base that weighs something, the inertia at least is that of its shape.
    weightless = manipulator.base_mass == 0.0
    base_shows = of_base.shows(manipulator.base_visual, manipulator.base_collision, weighed=weightless)
    before = [base_shows, *shown]
    shown = [
        shows or (row.type is JointType.PRISMATIC and carries)
        for row, shows, carries in zip(manipulator.rows, shown, before, strict=False)
    ]
    for row, shows in zip(manipulator.rows, shown, strict=True):
        if row.radius is not None and not shows:
            message = "radius has no effect: no shape of the link is drawn, and none says what the link weighs"
            yield row_problem(row, message, field="radius", found=row.radius, severity="notice")
    yield from _of_the_base(manipulator.base_geometry, shows=base_shows)
    whole, base = manipulator.geometry, manipulator.base_geometry
    with_radius = [shows and row.radius is None for row, shows in zip(manipulator.rows, shown, strict=True)]
    if whole.shape and not any(shown) and not (base_shows and base.shape is None):
        yield _unused("defaults.geometry.shape", "no shape is drawn")
    if whole.radius and not any(with_radius) and not (base_shows and base.radius is None):
        yield _unused("defaults.geometry.radius", "every link that is drawn has a radius of its own, or a mesh")
    yield from unused_density(manipulator)


def unused_density(manipulator: Manipulator) -> Iterator[Problem]:
    """A notice of a density that nothing is computed from, because every body has its mass."""
    payload = manipulator.payload
    if (
        manipulator.density is not None
        and manipulator.base_mass is not None
        and all(row.mass is not None for row in manipulator.rows)
        and not (payload and payload.inertia is None)
    ):
        yield _unused("defaults.density", "every link and the base have masses of their own")


def unused_in_paper(manipulator: Manipulator, options: AlphaSwapOptions) -> Iterator[Problem]:
    """The same of the paper's variant, which draws boxes of its own, and options that the exact one has."""
    why = "the paper's variant draws boxes of its own"
    for name in ("frames", "near_parallel", "shape", "radius"):
        if getattr(options, name) != getattr(AlphaSwapOptions(), name):
            yield _unused(name, "the paper's variant has a chain and boxes of its own")
    for name, geometry in (("defaults.geometry", manipulator.geometry), ("base.geometry", manipulator.base_geometry)):
        if geometry.shape or geometry.radius:
            yield _unused(name, why)
    for row in manipulator.rows:
        if row.radius is not None:
            yield row_problem(row, f"radius has no effect: {why}", field="radius", found=row.radius, severity="notice")
    yield from unused_density(manipulator)


def _of_the_base(geometry: LinkGeometry, *, shows: bool) -> Iterator[Problem]:
    if (geometry.shape or geometry.radius) and not shows:
        yield _unused("base.geometry", "no shape of the base is drawn, and none says what the base weighs")
    elif geometry.shape in ("capsule", "arm"):
        why = "its body is too flat for a capsule" if geometry.shape == "capsule" else "it has no joint for a housing"
        message = f"the base is drawn as a cylinder: {why}"
        accepted = "cylinder or box for the base"
        yield Problem(
            message=message, severity="notice", field="base.geometry.shape", found=geometry.shape, accepted=accepted
        )


def _unused(field: str, why: str) -> Problem:
    return Problem(message=f"{field} has no effect: {why}", severity="notice", field=field)


def robot_of(manipulator: Manipulator, options: AlphaSwapOptions) -> Robot:
    """The robot of a manipulator.

    Raises:
        TransformError: no arm can be made of the table; all its problems are named.
    """
    manipulator, raised = with_inertias(manipulator, options.inertias, options.inertia_floor)
    given, problems = manipulator, table_problems(manipulator)
    if options.near_parallel == "split" and options.variant == "exact" and not problems:
        from dh2urdf_plugins.extraction.splitting import with_split_links

        manipulator, problems = with_split_links(manipulator)
    table = None if manipulator is given else manipulator
    if options.variant == "paper":
        problems += [*paper_problems(manipulator, options.snap), *of_meshes(manipulator, placed=False)]
        problems += unused_in_paper(manipulator, options)
    else:
        problems += [*of_meshes(manipulator), *unused_shapes(manipulator, options)]
    if any(problem.severity == "error" for problem in problems):
        raise TransformError([problem.about(robot=manipulator.name, mark=manipulator.mark) for problem in problems])
    if options.variant == "paper":
        from dh2urdf_plugins.transforms.paper import paper

        robot = paper(manipulator, options)
    else:
        robot = exact(manipulator, options)
        problems += [*raised, *angle_notices(given), *other_lengths(given)]
    notices = tuple(notice.about(robot=robot.name, mark=manipulator.mark) for notice in problems)
    return replace(robot, notices=notices, manipulator=table)


def of_meshes(manipulator: Manipulator, *, placed: bool = True) -> Iterable[Problem]:
    """What is wrong with the meshes of a table; most tables have none."""
    meshes = [manipulator.base_visual, manipulator.base_collision]
    if not any(meshes) and not any(row.visual or row.collision for row in manipulator.rows):
        return ()
    from dh2urdf_plugins.transforms.meshes import mesh_problems, unplaced_meshes

    return mesh_problems(manipulator) if placed else unplaced_meshes(manipulator)
