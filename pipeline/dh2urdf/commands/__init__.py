"""What the command line, the Python API and the studio do: one way for each command."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.commands.written import left_out_of as left_out_of, table_content as table_content
else:
    __all__, __getattr__, __dir__ = late_names(__name__, {"written": "left_out_of table_content"})
