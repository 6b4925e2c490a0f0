"""What a run has left, to be compared with what another one leaves."""

import hashlib
from pathlib import Path


def tree(folder: "Path") -> dict[str, str]:
    """The files of a run by their names, as hashes; not its durations."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != "timing.json"]
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
