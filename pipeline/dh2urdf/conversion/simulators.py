"""Hands a written file to simulators, one after the other, and says what each should find there."""

from __future__ import annotations

import time
from contextlib import contextmanager, suppress
from dataclasses import replace
from types import NoneType
from typing import TYPE_CHECKING, Any

from dh2urdf.cells.floating import start_of, without_world
from dh2urdf.conversion.loads import load_in_child
from dh2urdf.conversion.outcome import NotLoaded, Outcome, Verdict
from dh2urdf.documents.text_files import is_file
from dh2urdf.errors import InputError, ManipulatorError, MissingDependencyError, MissingProgramError, OutputError
from dh2urdf.kinematics.chain import as_matrices, link_poses
from dh2urdf.kinematics.expected_poses import ExpectedPoses, joint_vectors
from dh2urdf.plugin_system.calls import Call, a_plain_name, a_record, blaming, depending_on
from dh2urdf.robot import with_followers
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import Messages, shown
from dh2urdf.stages import Loader, LoadReport, LoadRequest, ReadsBack

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.conversion.one_manipulator import Recipe, Written
    from dh2urdf.isolation.kept_children import KeptChildren
    from dh2urdf.robot import Robot

say = Messages(__file__)


def missing_of(recipe: Recipe) -> dict[str, str]:
    """Return what is not installed that optional loaders need, by their names.

    Raises:
        PluginError: what another loader needs is not installed, or a loader is broken.
    """
    missing: dict[str, str] = {}
    for call in recipe.loaders:
        try:
            require(call)
        except (MissingDependencyError, MissingProgramError) as error:
            if call.stage.name not in recipe.optional:
                raise
            missing[call.stage.name] = str(error)
    return missing


def require(call: Call[Any]) -> None:
    """Ask a loader or an executor whether all is there that it needs.

    Raises:
        PluginError: something is not, or the stage is broken.
    """
    with depending_on(call, "require"):
        a_record(call.stage.require(call.options), NoneType)


def time_limit_of(recipe: Recipe, loaders: Sequence[Call[Loader[Any]]]) -> float | None:
    """Return how long a manipulator may take with some loaders [s]; None where one of them has no limit."""
    whole: float = recipe.time_limit
    for call in loaders:
        with suppress(ManipulatorError), blaming(call, "time_limit"):  # It fails when it is called, too.
            limit = a_record(call.stage.time_limit(call.options), int, float, NoneType)
            if limit is None:
                return None
            whole += limit
    return whole


def not_loaded(recipe: Recipe, outcome: Outcome, *, is_sampled: bool) -> dict[str, NotLoaded]:
    """Return the loaders of a run that a manipulator did not go through, and why."""
    why: NotLoaded = "no file" if outcome.status == "failed" or is_sampled else "not in the sample"
    return {call.stage.name: why for call in recipe.loaders if call.stage.name not in outcome.loads}


def picture_endings(recipe: Recipe) -> list[str]:
    """Return what the names of the pictures of each loader have behind the stem; the first has none of its own."""
    is_free = all(".png" not in call.stage.suffixes for call in recipe.emitters)
    names = [call.stage.name for call in recipe.loaders]
    return [".png" if number == 0 and is_free else f".{name}.png" for number, name in enumerate(names)]


def load_with_all(  # noqa: PLR0917 - what is known of a manipulator with files
    expected: ExpectedPoses,
    robot: Robot,
    recipe: Recipe,
    written: Sequence[Written],
    folder: Path,
    stem: str,
    seconds: dict[str, float],
    children: KeptChildren,
) -> tuple[dict[str, Verdict], dict[str, bytes], list[ManipulatorError | InputError]]:
    """Ask all loaders of a recipe about the files of a manipulator; whatever one says, the next is asked.

    Args:
        expected: what the tables declare about it.
        robot: the robot.
        recipe: what is done with every manipulator.
        written: its files.
        folder: where they are, and where pictures go.
        stem: the stem of their names.
        seconds: takes how long each loader took [s].
        children: the children of loaders that are kept.

    Returns:
        What came of each loader and the pictures, by their names, and what the loaders raised that may not fail.

    Raises:
        PluginError: what a loader needs is not installed, and the loader is not optional.
    """
    verdicts: dict[str, Verdict] = {}
    pictures: dict[str, bytes] = {}
    failures: list[ManipulatorError | InputError] = []
    formats = {emitted.stage for emitted in written}
    calls = zip(recipe.loaders, picture_endings(recipe), strict=True)
    for call, ending in ((call, ending) for call, ending in calls if formats.intersection(call.stage.formats)):
        name, is_optional = call.stage.name, call.stage.name in recipe.optional
        unmeasured = LoadReport(simulator=name, version="")
        if why := recipe.missing.get(name):
            verdicts[name] = _missing(unmeasured, why)
            continue
        picture, started = folder / f"{stem}{ending}", time.perf_counter()
        try:
            report = _load(expected, robot, recipe, call, written, children, picture)
        except OutputError:
            raise
        except (MissingDependencyError, MissingProgramError) as error:
            if not is_optional:
                raise
            verdicts[name] = _missing(unmeasured, str(error))
        except (ManipulatorError, InputError) as error:
            errors = [problem.about(robot=robot.name, mark=expected.mark) for problem in error.problems]
            if is_optional:
                errors = [replace(problem, severity="notice") for problem in errors]
            else:
                failures.append(error)
            verdicts[name] = Verdict(report=unmeasured, status="failed", optional=is_optional, errors=tuple(errors))
        else:
            verdicts[name] = Verdict(report=report, optional=is_optional)
            if report.picture:
                pictures[report.picture] = picture.with_name(report.picture).read_bytes()
        finally:
            seconds[f"load {name}"] = time.perf_counter() - started
    return verdicts, pictures, failures


def _missing(report: LoadReport, why: str) -> Verdict:
    errors = (say("simulator-missing", reason=why),)
    return Verdict(report=report, status="missing", optional=True, errors=errors)


def _load(  # noqa: PLR0917 - what is known of a manipulator with files
    expected: ExpectedPoses,
    robot: Robot,
    recipe: Recipe,
    call: Call[Loader[Any]],
    written: Sequence[Written],
    children: KeptChildren,
    picture: Path,
) -> LoadReport:
    """Return what a simulator reports about the file that was written beside where the picture goes.

    Where the transform does not keep the kinematics, the simulator is held against the robot, not against the tables.
    """
    loader = call.stage
    names = {emitted.stage: emitted.files[0].name for emitted in written}
    wanted = next(each for each in loader.formats if each in names)
    path = picture.with_name(names[wanted])
    with blaming(call, "poses"):
        count = a_record(loader.poses(call.options), int)
    with blaming(call, "picture"):
        is_pictured = a_record(loader.picture(call.options), bool)
    reads = next(each.stage.can(ReadsBack) for each in recipe.emitters if each.stage.name == wanted)
    of_file, to_root = robot, IDENTITY
    if robot.floating and reads is not None and reads.floats_by_root:
        of_file = without_world(robot)
        to_root = start_of(robot, of_file.root).inverse
    poses = joint_vectors(expected, robot, count)
    own = [joint.name for joint in robot.actuated_joints if joint.name not in expected.joints]
    others = ExpectedPoses(name=expected.name, tips=(), joints=tuple(own))
    whole = [(*q, *more) for q, more in zip(poses, joint_vectors(others, robot, count), strict=True)]
    joints, followers = (*expected.joints, *others.joints), robot.followers
    values = [with_followers(dict(zip(joints, q, strict=True)), followers) for q in whole]
    placed = [link_poses(robot, q) for q in values]
    found = {link: [links[link] for links in placed] for link in (*(tip.link for tip in expected.tips), *_ends(robot))}
    for tip in expected.tips if recipe.keeps_kinematics else ():
        starts = [links[tip.root or expected.root] for links in placed]
        found[tip.link] = [start @ tip.pose(q) for start, q in zip(starts, poses, strict=True)]
    frames = {
        link: tuple([tuple(as_matrices(to_root @ pose).ravel().tolist()) for pose in poses_of])
        for link, poses_of in found.items()
    }
    request = LoadRequest(
        path=path,
        robot=of_file,
        poses=tuple(tuple(q[joint.name] for joint in robot.moving_joints) for q in values),
        expected=frames,
        mark=expected.mark,
        picture=picture if is_pictured else None,
    )
    with blaming(call), _kept(path.parent, written if call.plugin and not call.plugin.is_builtin else ()):
        report = load_in_child(loader, request, call.options, f"the {call.attribution}", children)
        if report.picture and not is_file(picture.with_name(a_plain_name(report.picture))):
            raise ValueError(f"it reported a picture {shown(report.picture)} and wrote none")
        return report


def _ends(robot: Robot) -> list[str]:
    """The links of attachments that hold no other link."""
    holders = {joint.parent for joint in robot.joints}
    names = [each.prefix + link.name for each in robot.attachments for link in each.robot.links]
    return [name for name in names if name not in holders]


@contextmanager
def _kept(folder: Path, written: Sequence[Written]) -> Iterator[None]:
    """Have the next loader, too, find the files as they were written.

    Raises:
        ValueError: they were changed or removed meanwhile.
    """
    changed = []
    try:
        yield
    finally:
        for file in (file for each in written for file in each.files):
            path = folder / file.name
            if not is_file(path) or path.read_bytes() != file.content:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(file.content)
                changed.append(file.name)
    if changed:
        raise ValueError(f"it changed or removed the file {shown(changed[0])} that it was given")
