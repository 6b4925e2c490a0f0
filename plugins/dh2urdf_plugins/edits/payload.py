"""The edit ``payload``: something that the arm carries at tool0.

It goes into the table, so transforms treat it as a payload that the table itself has: ``alpha-swap`` makes it a link of
its own, ``payload``, on a fixed joint at tool0, and counts it among what the joints carry.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.stages import Edit, EditsInColumns
from dh2urdf_plugins.edits.payload_options import PayloadOptions

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator


def edit_table(manipulator: Manipulator, options: PayloadOptions) -> Manipulator:
    """The manipulator with the payload; one that it has already is carried together with the new one.

    Raises:
        EditError: the options have no mass, or two payloads cannot be joined, since one has no inertia.
    """
    from dh2urdf_plugins.edits.carrying import carrying

    return carrying(manipulator, options)


EDIT = Edit(
    name="payload",
    summary="something that the arm carries at tool0: mass, centre of mass and inertia",
    options=PayloadOptions,
    edit_table=edit_table,
    capabilities=(EditsInColumns(),),
)
