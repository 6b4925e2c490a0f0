"""The robot of a table, in the variant that the options name, with what is wrong or odd about the table."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.errors import TransformError
from dh2urdf.manipulator import JointType
from dh2urdf.source import Messages, Problem
from dh2urdf.variations.drawn_links import other_lengths
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.checks import (
    angle_notices,
    follower_notices,
    is_weighed,
    paper_problems,
    row_problem,
    table_problems,
    with_inertias,
)
from dh2urdf_plugins.transforms.exact import exact, exact_columns

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.manipulator import Manipulator, MeshShape
    from dh2urdf.robot import Robot

say = Messages(__file__)


def alpha_swap(manipulator: Manipulator, options: AlphaSwapOptions) -> Robot:
    """The robot of a manipulator.

    Raises:
        TransformError: no arm can be made of the table; all its problems are named.
    """
    manipulator, raised = with_inertias(manipulator, options.inertias, options.inertia_floor)
    given, problems, is_paper = manipulator, table_problems(manipulator), options.variant == "paper"
    if options.near_parallel == "split" and not is_paper and not problems:
        from dh2urdf_plugins.extraction.splitting import with_split_links

        manipulator, problems = with_split_links(manipulator)
    problems += [*paper_problems(manipulator, options.snap)] if is_paper else []
    with_meshes = names_meshes(manipulator)
    if with_meshes:
        problems += of_meshes(manipulator, placed=not is_paper)
    problems += without_effect(manipulator, options)
    if any(problem.severity == "error" for problem in problems):
        raise TransformError([problem.about(robot=manipulator.name, mark=manipulator.mark) for problem in problems])
    if is_paper:
        from dh2urdf_plugins.transforms.paper import paper

        robot = paper(manipulator, options)
    else:
        robot = exact(manipulator, options)
        problems += [*raised, *angle_notices(given), *follower_notices(given)]
        problems += other_lengths(given) if with_meshes else ()
    notices = tuple(notice.about(robot=robot.name, mark=manipulator.mark) for notice in problems)
    return replace(robot, notices=notices, manipulator=None if manipulator is given else manipulator)


def alpha_swap_columns(
    columns: ManipulatorColumns, options: AlphaSwapOptions
) -> list[tuple[list[int], RobotColumns]] | None:
    """The robots of many manipulators, in groups.

    None for the paper's variant and for split rows, which nobody makes by the thousand.
    """
    if options.variant == "paper" or options.near_parallel == "split":
        return None
    has_notices = names_meshes(columns.table) and any(of_meshes(columns.table))
    if has_notices or (len(columns) and any(without_effect(columns.pick(0), options))):
        return []
    return exact_columns(columns, options)


def names_meshes(manipulator: Manipulator) -> bool:
    """Whether a table has meshes; most have none."""
    meshes = [manipulator.base_visual, manipulator.base_collision]
    return any(meshes) or any(row.visual or row.collision for row in manipulator.rows)


def of_meshes(manipulator: Manipulator, *, placed: bool = True) -> Iterable[Problem]:
    """What is wrong with the meshes of a table."""
    from dh2urdf_plugins.transforms.meshes import mesh_problems, unplaced_meshes

    return mesh_problems(manipulator) if placed else unplaced_meshes(manipulator)


def without_effect(manipulator: Manipulator, options: AlphaSwapOptions) -> Iterator[Problem]:
    """Shapes, radii and densities of a table that change nothing, and a shape that the base cannot have."""
    base, whole, rows = manipulator.base_geometry, manipulator.geometry, manipulator.rows
    is_paper, usual = options.variant == "paper", AlphaSwapOptions()
    said = [base.shape, base.radius, whole.shape, whole.radius, manipulator.density, *(row.radius for row in rows)]
    if not is_paper and said.count(None) == len(said):
        return
    base_shows, shown = (False, [False for _ in rows]) if is_paper else _shown(manipulator, options)
    needs_radius = any(shows and row.radius is None for row, shows in zip(rows, shown, strict=True))
    boxes = "the paper's variant draws boxes of its own"
    masses = [manipulator.base_mass, *(row.mass for row in rows)]
    payload = manipulator.payload
    no_base = "no shape of the base is drawn, and none says what the base weighs"
    all_radii = "every link that is drawn has a radius of its own, or a mesh"
    for field, is_given, why in (
        *(
            (name, is_paper and getattr(options, name) != getattr(usual, name), f"{boxes}, and has a chain of its own")
            for name in ("frames", "near_parallel", "shape", "radius")
        ),
        ("base.geometry", (base.shape or base.radius) and not base_shows, boxes if is_paper else no_base),
        (
            "defaults.geometry.shape",
            whole.shape and not any(shown) and not (base_shows and base.shape is None),
            boxes if is_paper else "no shape is drawn",
        ),
        (
            "defaults.geometry.radius",
            whole.radius and not needs_radius and not (base_shows and base.radius is None),
            boxes if is_paper else all_radii,
        ),
        (
            "defaults.density",
            manipulator.density is not None and None not in masses and not (payload and payload.inertia is None),
            "every link and the base have masses of their own",
        ),
    ):
        if is_given:
            yield say("no-effect", field=field, why=why)
    if base_shows and base.shape in ("capsule", "arm"):
        yield say("base-shape-drawn-otherwise", field="base.geometry.shape", found=base.shape)
    why = boxes if is_paper else "no shape of the link is drawn, and none says what the link weighs"
    for row, shows in zip(rows, shown, strict=True):
        if row.radius is not None and not shows:
            yield row_problem(row, "no-effect", field="radius", found=row.radius, why=why)


def _shown(manipulator: Manipulator, options: AlphaSwapOptions) -> tuple[bool, list[bool]]:
    """Whether the shapes of the base and of every link show: seen, touching, or as what says what a link weighs."""
    seen = options.visuals == "all" if manipulator.visuals is None else manipulator.visuals
    touching = options.collisions == "all" if manipulator.collisions is None else manipulator.collisions

    def shows(visual: MeshShape | None, collision: MeshShape | None, *, weighed: bool, touching: bool) -> bool:
        return (visual is None and (seen or not weighed)) or (collision is None and touching)

    rows = manipulator.rows
    shown = [shows(row.visual, row.collision, weighed=is_weighed(row), touching=touching) for row in rows]
    weighed = manipulator.base_mass == 0.0  # of any other mass, the inertia at least is that of its shape
    base, touches = (manipulator.base_visual, manipulator.base_collision), touching and options.base_collision
    base_shows = shows(*base, weighed=weighed, touching=touches)
    # The rail of a prismatic joint has the joint's radius, and is a part of the link before.
    before = zip(rows, shown, [base_shows, *shown], strict=False)
    return base_shows, [own or (row.type is JointType.PRISMATIC and carries) for row, own, carries in before]
