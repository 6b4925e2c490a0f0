"""Files that are written whole or not at all, and under which names they go where."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.output.whole_files import NameSet as NameSet, write_whole as write_whole
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "whole_files": "NameSet write_whole",
        },
    )
