"""A load in a fork of a child that is kept reports what a load in a child of its own does."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import LoaderError, PluginError
from dh2urdf.isolation import Child
from dh2urdf.isolation.loads import KeptChildren, load_in_child
from dh2urdf.kinematics.expected_poses import ExpectedPoses, joint_vectors
from dh2urdf.plugin_system import load
from dh2urdf.stages import LoadRequest
from dh2urdf.testing import plain_robot, reference_manipulators
from dh2urdf.testing.oracle import table_pose

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Loader, LoadReport

CATALOG = load()
MANY = ("pybullet", "mujoco", "pinocchio", "drake")
"""Loaders whose child serves many loads; one load of sdformat starts two programs, and the contract of loaders, which
`tests/test_contract.py` holds it to, compares loads of one child with those of children of their own."""


def options_of(loader: Loader[Any], *, picture: bool = False) -> Any:
    """Options without a picture, unless one is wanted."""
    return loader.options(**({"picture": picture} if loader.name in {"pybullet", "mujoco"} else {}))


def request_of(manipulator: Manipulator, loader: Loader[Any], folder: Path) -> LoadRequest:
    """A written file; every arm has the same name of a file, in a folder of its own."""
    robot, expected = plain_robot(manipulator), ExpectedPoses.of(manipulator)
    emitter = CATALOG.get("emitter", loader.formats[0])
    folder.mkdir()
    for file in (files := emitter.emit(robot, "arm", emitter.options())):
        (folder / file.name).write_bytes(file.content)
    poses = joint_vectors(expected, robot, loader.poses(options_of(loader)))
    frames = tuple(tuple(number for row in table_pose(manipulator, q) for number in row) for q in poses)
    return LoadRequest(path=folder / files[0].name, robot=robot, poses=poses, expected={"tool0": frames})


def outcome(loader: Loader[Any], request: LoadRequest, children: KeptChildren | None) -> LoadReport | str:
    """A report, or a refusal."""
    try:
        return load_in_child(loader, request, options_of(loader), None, children)
    except LoaderError as error:
        return str(error)


@pytest.fixture
def loader(request: pytest.FixtureRequest) -> Loader[Any]:
    loader: Loader[Any] = CATALOG.get("loader", request.param)
    try:
        loader.require(options_of(loader))
    except PluginError as error:
        pytest.skip(str(error))
    return loader


@pytest.fixture
def children_started(monkeypatch: pytest.MonkeyPatch) -> list[Child]:
    """The children of kept loaders."""
    found: list[Child] = []

    def started() -> Child:
        found.append(Child())
        return found[-1]

    monkeypatch.setattr(Child, "started", started)
    return found


@pytest.mark.parametrize("loader", MANY, indirect=True)
@pytest.mark.long
def test_loads_of_one_child_report_what_loads_of_their_own_do(
    loader: Loader[Any], tmp_path: Path, children_started: list[Child]
) -> None:
    """Several arms, in any order, through one child: each report, with findings and output, is that of a new child."""
    arms = reference_manipulators()
    requests = [request_of(arm, loader, tmp_path / str(number)) for number, arm in enumerate(arms)]
    alone = [outcome(loader, request, None) for request in requests]
    order = [number % len(arms) for number in range(20)]
    random.Random(5).shuffle(order)  # noqa: S311 - not for secrets
    with KeptChildren() as children:
        before = len(children_started)
        kept = [outcome(loader, requests[number], children) for number in order]
    assert kept == [alone[number] for number in order]
    assert not any(isinstance(report, str) for report in alone)
    assert len(children_started) == before + 1


@pytest.mark.long
@pytest.mark.parametrize("loader", [*MANY, "gazebo"], indirect=True)
def test_a_file_is_read_anew(loader: Loader[Any], tmp_path: Path, children_started: list[Child]) -> None:
    """A file that has changed under its name is loaded as it is; a bad one is refused, and the good one passes again."""
    first, other = (request_of(arm, loader, tmp_path / arm.name) for arm in reference_manipulators()[:2])
    good = first.path.read_bytes()
    with KeptChildren() as children:
        report = outcome(loader, first, children)
        assert not isinstance(report, str)
        for content in (other.path.read_bytes(), b"<no arm"):
            first.path.write_bytes(content)
            assert isinstance(outcome(loader, first, children), str)
            first.path.write_bytes(good)
            assert outcome(loader, first, children) == report
    assert len(children_started) == 1


@pytest.mark.parametrize("loader", ["pybullet", "mujoco"], indirect=True)
@pytest.mark.long
def test_pictures_are_the_same(loader: Loader[Any], tmp_path: Path) -> None:
    """Pixel by pixel, whichever load of a child took them."""
    pytest.importorskip("PIL.Image")
    options = options_of(loader, picture=True)
    for number, arm in enumerate(reference_manipulators()[:2]):
        request = request_of(arm, loader, tmp_path / str(number))
        pictures = [tmp_path / f"{number}_{place}.png" for place in range(4)]
        requests = [
            LoadRequest(
                path=request.path,
                robot=request.robot,
                poses=request.poses,
                expected=request.expected,
                picture=picture,
            )
            for picture in pictures
        ]
        load_in_child(loader, requests[0], options)
        with KeptChildren() as children:
            for each in requests[1:]:
                load_in_child(loader, each, options, None, children)
        if pictures[0].exists():  # Without a graphics library MuJoCo takes none, which is a finding.
            assert len({picture.read_bytes() for picture in pictures}) == 1
