"""Simulators that load different arms: a child process for each load, against one that is kept for all.

    python benchmarks/loads.py                  20 arms through PyBullet, MuJoCo, Pinocchio, Drake and sdformat
    python benchmarks/loads.py --arms 50 drake  other numbers, or some of the loaders

Both sides load the same files, in turn, and must report the same. The arms have six axes, no two are alike, and no
pictures are taken.
"""

from __future__ import annotations

import argparse
import tempfile
from functools import partial
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any, NamedTuple

from arms import LONG, write_table
from measuring import in_turn, machine, seconds, table

from dh2urdf.conversion.loads import load_in_child
from dh2urdf.conversion.robots import make_robot
from dh2urdf.isolation.kept_children import KeptChildren
from dh2urdf.kinematics.expected_poses import ExpectedPoses, joint_vectors
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system.calls import Call
from dh2urdf.plugin_system.catalog import load
from dh2urdf.stages import LoadRequest

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Loader, LoadReport

PACKAGES = ("dh2urdf", "pybullet", "mujoco", "pin", "drake")
LOADERS = ("pybullet", "mujoco", "pinocchio", "drake", "gazebo")


class Work(NamedTuple):
    """What a loader is asked, and its options."""

    loader: Loader[Any]
    options: Any
    requests: list[LoadRequest]


def work(name: str, catalog: Catalog, manipulators: list[Manipulator], folder: Path) -> Work:
    """The arms as files that a loader takes."""
    loader = catalog.get("loader", name)
    transform, emitter = catalog.get("transform", "alpha-swap"), catalog.get("emitter", loader.formats[0])
    options = loader.options(**({"picture": False} if name in {"pybullet", "mujoco"} else {}))
    requests = []
    for manipulator in manipulators:
        robot, expected = (
            make_robot(manipulator, Call(stage=transform, options=transform.options())),
            ExpectedPoses.of(manipulator),
        )
        first, *others = emitter.emit(robot, manipulator.name, emitter.options())
        for file in (first, *others):
            (folder / file.name).write_bytes(file.content)
        poses = joint_vectors(expected, robot, loader.poses(options))
        (tip,) = expected.tips
        frames = tuple(_elements(*tip.pose(q)) for q in poses)
        requests.append(LoadRequest(path=folder / first.name, robot=robot, poses=poses, expected={tip.link: frames}))
    return Work(loader, options, requests)


def _elements(r: tuple[float, ...], t: tuple[float, ...]) -> tuple[float, ...]:
    return (*r[0:3], t[0], *r[3:6], t[1], *r[6:9], t[2], 0.0, 0.0, 0.0, 1.0)


def one_each(todo: Work, _folder: Path) -> list[LoadReport]:
    """The reports of children that load one arm each."""
    return [load_in_child(todo.loader, request, todo.options) for request in todo.requests]


def kept(todo: Work, _folder: Path) -> list[LoadReport]:
    """The reports of a child that loads all arms."""
    with KeptChildren() as children:
        return [load_in_child(todo.loader, request, todo.options, None, children) for request in todo.requests]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("loaders", nargs="*", default=LOADERS, metavar="LOADER", help=f"of {', '.join(LOADERS)}")
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    catalog = load()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        print(machine(place, PACKAGES))
        write_table(place / "arms.csv", asked.arms, lengths=LONG)
        reader = catalog.get("reader", "csv")
        items = reader.read(place / "arms.csv", reader.options(convention="standard"))
        manipulators = [item for item in items if isinstance(item, Manipulator)]
        if len(manipulators) != asked.arms:
            raise SystemExit(f"{len(manipulators)} of {asked.arms} arms were read")
        for loader in asked.loaders:
            (folder := place / loader).mkdir()
            todo = work(loader, catalog, manipulators, folder)
            (turns := place / f"{loader} turns").mkdir()
            sides = {"each": partial(one_each, todo), "kept": partial(kept, todo)}
            times = in_turn(sides, asked.rounds, turns)
            if any(turn.value != times["each"][0].value for side in times.values() for turn in side):
                raise SystemExit(f"{loader} does not report the same in both ways")
            ratio = median(more.seconds / less.seconds for more, less in zip(*times.values(), strict=True))
            ms = [f"{1000 * seconds(side) / asked.arms:.0f}" for side in times.values()]
            rows.append([loader, *ms, f"{ratio:.1f}"])
    print(f"\n{asked.arms} arms of six axes, all different; median of {asked.rounds} rounds\n")
    table(["a load", "own child [ms]", "kept child [ms]", "own / kept"], rows)


if __name__ == "__main__":
    main()
