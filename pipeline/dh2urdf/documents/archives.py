"""ZIP archives from strangers."""

from __future__ import annotations

import lzma
import zipfile
import zlib

BROKEN_ARCHIVE = (
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    EOFError,
    NotImplementedError,
    OSError,
    RuntimeError,
    UnicodeError,
)
"""What Python's zipfile raises for an archive that is broken, encrypted, or packed in a way it does not know."""
