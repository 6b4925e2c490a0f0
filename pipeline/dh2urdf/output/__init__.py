"""Files that are written whole or not at all, and under which names they go where."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.output.name_set import NameSet as NameSet
    from dh2urdf.output.whole_files import write_whole as write_whole
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "name_set": "NameSet",
            "whole_files": "write_whole",
        },
    )
