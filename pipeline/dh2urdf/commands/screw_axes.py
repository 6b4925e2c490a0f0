"""Screw axes that a program has at hand, as tables."""

# ruff: noqa: N803 - Slist, M, H, P and R are the names of the books and of other libraries

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.commands.arguments import word_of
from dh2urdf.commands.extract import description_reader, the_one
from dh2urdf.commands.given_tables import as_file
from dh2urdf.plugin_system.catalog import load
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.manipulator import Manipulator

_FUNCTION = "dh2urdf.from_screws()"
_READER = "screws"


def from_screws(
    Slist: object = None,
    M: object = None,
    *,
    Blist: object = None,
    H: object = None,
    P: object = None,
    R: object = None,
    joints: Sequence[str | Mapping[str, object]] | None = None,
    name: str = "robot",
    **options: object,
) -> Manipulator:
    """The table of an arm of screw axes.

    ::

        arm = dh2urdf.from_screws(Slist, M)
        arm = dh2urdf.from_screws(H=H, P=P, joints=["pan", {"name": "rail", "type": "prismatic"}])

    Arrays and nested lists mean what they mean in a file for the reader ``screws``, in m and rad.

    Args:
        Slist: a 6xN matrix, a column ω, v for each joint, in the frame of the base; or Blist.
        M: the 4x4 pose of the tool at q = 0.
        Blist: a 6xN matrix, a column ω, v for each joint, in the frame of the tool.
        H: a 3xN matrix, the axes at q = 0; with P, in place of Slist and M.
        P: a 3x(N+1) matrix, from the base to a point on the first axis, on to the next ones, and to the tool.
        R: the 3x3 rotation of the tool at q = 0; none without it.
        joints: the name of each joint, or a mapping with ``name``, ``link``, ``type``, ``limits``, ``damping``,
            ``friction`` and ``armature``. With H, a joint slides where its type is ``prismatic``.
        name: the name of the manipulator.
        options: options of the reader: ``convention``, ``tolerance``, ``near_parallel``, ``origins``.

    Returns:
        The manipulator. Its notices say how far the table is from the axes.

    Raises:
        TableError: the axes are none of an arm; the column is named.
        ConfigError: an option is unknown or its value wrong.
    """
    given = {"name": name, "Slist": Slist, "M": M, "Blist": Blist, "H": H, "P": P, "R": R, "joints": joints}
    text = word_of({key: value for key, value in given.items() if value is not None})
    mark, catalog = Mark(file=_FUNCTION), load()
    with as_file(text.encode(), "reader", _READER, catalog, "reader=NAME") as path:
        words = {key: word_of(value) for key, value in options.items()}
        return the_one(description_reader(catalog, path, mark, reader=_READER, given=words), path)
