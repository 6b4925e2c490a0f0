"""The folders and files that an emitter names itself: two robots of a run do not share one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import EmitterError
from dh2urdf.source import Problem, shown
from dh2urdf.stage_calls.calls import blaming, items_of
from dh2urdf.stages import WritesFolders

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.stage_calls.calls import Call
    from dh2urdf.stages import EmittedFile, Emitter


def refuse_one_folder(call: Call[Emitter[Any]], stem: str) -> None:
    """Refuses options with which two robots would be written into one folder.

    Raises:
        EmitterError: the folder of the stem is that of another stem, too.
    """
    writes = call.stage.can(WritesFolders)
    if writes is None:
        return
    with blaming(call, "in_folders"):
        own, others = (set(items_of(writes.in_folders(each, call.options), "names")) for each in (stem, f"{stem}_"))
    if shared := sorted(own & others):
        raise EmitterError(
            Problem(
                message=f"the options of the emitter {call.stage.name!r} name the folder of one robot, and the run "
                "has several",
                found=shared[0],
                accepted="options that leave the name of the folder to the robot",
                suggestion="name the tables as their packages, or convert them one by one",
            )
        )


def refuse_undeclared_files(
    call: Call[Emitter[Any]], stems: Iterable[str], files: Iterable[Sequence[EmittedFile]]
) -> None:
    """Refuses files of a run with an ending that the emitter's record does not have.

    Stems are given out so that no two of them make one name with the endings that are declared: where ``ur5`` has a
    file ``ur5_parts.csv``, no other robot has the stem ``ur5_parts`` beside the ending ``.csv``.

    Args:
        call: the emitter.
        stems: the stem of each robot.
        files: the files of each.

    Raises:
        ManipulatorError: there is such a file.
    """
    if call.stage.can(WritesFolders):
        return
    declared = {ending.casefold() for ending in call.stage.endings}
    with blaming(call):
        for stem, own in zip(stems, files, strict=True):
            for file in own:
                if (ending := file.name[len(stem) :]).casefold() not in declared:
                    raise ValueError(
                        f"{shown(file.name)} has {shown(ending)} behind the stem, which is none of the suffixes and "
                        "other_endings of its record: another robot of the run may have a file of this name"
                    )


def same_file(first: str, second: str, name: str) -> EmitterError:
    """The error that two emitters of a robot, or one that stands twice, would write one file."""
    if first == second:
        message, suggestion = f"the emitter {first!r} stands twice and would write {shown(name)} twice", "name it once"
    else:
        message = f"the emitters {first!r} and {second!r} both write {shown(name)}"
        suggestion = f"leave out {first!r} or {second!r}, or write each into a folder of its own"
    return EmitterError(
        Problem(message=message, accepted="files whose names differ in more than case", suggestion=suggestion)
    )
