"""Tables that are in no file, such as standard input: a file for their readers, under the name that messages say."""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

STEM = "robot"
"""Name of a manipulator whose table has neither a name nor a file."""
_SystemPath: type[Path] = type(Path())


class SpooledPath(_SystemPath):  # type: ignore[misc, valid-type]
    """The path of a temporary file, which messages know by another name.

    It is opened like any path. Its text is the name: marks and messages say the name, and the paths that a table names,
    such as those of meshes, start at the working directory.

    Attributes:
        shown_as: the name.
    """

    shown_as: str = ""

    def __str__(self) -> str:
        return self.shown_as or super().__str__()

    def __fspath__(self) -> str:
        return os.path.join(*self.parts)  # noqa: PTH118 - Path.__fspath__ is the text, which is the name here


@contextmanager
def spooled(content: bytes, name: str, suffix: str = "", *, stem: str = STEM) -> Iterator[SpooledPath]:
    """A file that holds some content, as long as the context is open.

    Args:
        content: what is in the file.
        name: what messages call the file.
        suffix: the suffix of the file, with its dot.
        stem: the name of the file without its suffix, which a manipulator has that its table does not name.
    """
    import tempfile  # Most commands need none.

    with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
        path = SpooledPath(os.path.join(folder, f"{stem}{suffix}"))  # noqa: PTH118
        path.write_bytes(content)
        path.shown_as = name
        yield path
