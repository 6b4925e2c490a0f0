"""What the bytes of a manipulator's files depend on, as a hash: whether an earlier run's files are still right.

A key covers the manipulator as its table says it, the stages with their options, the versions of their distributions
and their code, what the proof and the sample ask of it, and where its files go. Two runs that give one manipulator the
same key give it the same files and the same row of the manifest.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import lru_cache
from hashlib import file_digest, sha256
from importlib.util import find_spec
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf._version import __version__
from dh2urdf.columns import COMMON, INERTIA, LIMITS, NUMBERS, WORDS
from dh2urdf.documents.text_files import is_file, is_folder
from dh2urdf.errors import InputError, ManipulatorError
from dh2urdf.plugin_system.calls import Call, blaming
from dh2urdf.stages import DependsOn

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.columns import ManipulatorColumns
    from dh2urdf.conversion.one_manipulator import Recipe

DIGITS = 32
"""Hexadecimal digits of a key: 128 bits, so that no two of a million manipulators share one by chance."""


def recipe_key(recipe: Recipe) -> str:
    """Return the key of all that is done with every manipulator."""
    stages: list[tuple[object, ...]] = []
    files: list[tuple[str, str | None]] = []
    for call in recipe.calls:
        version = code = ""  # of the plugin; the code is unknown where no entry point names it
        if call.plugin is not None:
            version, entry = call.plugin.distribution, call.plugin.name.partition(" = ")[2]
            code = code_hash(entry, call.plugin.distribution_name) if entry and call.plugin.is_installed else ""
        stages.append((call.kind, call.stage.name, (version, code), whole(call.options)))
        for path in call.files:
            digest = None  # where it cannot be read, which its stage reports
            with suppress(OSError), path.open("rb") as file:
                digest = file_digest(file, "sha256").hexdigest()
            files.append((str(path), digest))
        files += _read_besides(call)
    python = sys.version_info[:2]
    told = (sorted(recipe.optional), sorted(recipe.missing.items()), sorted(recipe.only.items()))
    own = key_of(code_hash(__package__.partition(".")[0], ""), __version__)
    return key_of((python, stages, recipe.poses, recipe.mesh_prefix, recipe.mesh_conversion, told, files), own)


def _read_besides(call: Call[Any]) -> list[tuple[str, str | None]]:
    """What a stage reads that its options do not name, as a key; nothing where that fails, which the stage reports."""
    if reads := call.stage.can(DependsOn):
        with suppress(ManipulatorError, InputError), blaming(call):
            return [(call.stage.name, key_of(whole(reads.read(call.options)), ""))]
    return []


# --- Code -------------------------------------------------------------------------------------------------------------

_IMPORTS = re.compile(rb"^[ \t]*(?:from|import)[ \t]+(.+)", re.MULTILINE)
_WORD = re.compile(rb"\w+")


@lru_cache(maxsize=64)
def code_hash(entry: str, distribution: str) -> str:
    """Return the hash of a plugin's code: its version may stand still while its code changes.

    The code is every file of the top-level package that the entry point names, data files included, or that module
    alone; and of the modules and packages beside it, those that it imports. In a folder of installed distributions,
    only modules of the plugin's own distribution count as beside it: for all others, their versions stand. (The 700
    files of dh2urdf take 30 ms.)

    Args:
        entry: what the entry point names: a module, or ``module:name``.
        distribution: the name of the distribution.
    """
    parts = entry.partition(":")[0].strip().split(".")
    # The first part of a name may be a namespace, in which many distributions have a package each. A module in a zip
    # file has the code of the file.
    specs = (find_spec(".".join(parts[: count + 1])) for count in range(len(parts)))
    origin = next(filter(None, (getattr(spec.loader, "archive", spec.origin) for spec in specs if spec)), None)
    if origin is None:
        return ""
    place = Path(origin)
    top = place.parent if place.name == "__init__.py" else place
    beside = _beside(top, distribution)
    waiting, hashes = [top], list[tuple[str, str]]()
    while waiting:
        for path in _files(waiting.pop()):
            try:
                with open(path, "rb") as file:  # noqa: PTH123
                    content = file.read()
            except OSError:
                continue  # Python could not import it either.
            hashes.append((path.removeprefix(str(top.parent)), sha256(content).hexdigest()))
            if beside:
                words = {word.decode() for line in _IMPORTS.findall(content) for word in _WORD.findall(line)}
                waiting += [beside.pop(word) for word in words if word in beside]
    return key_of(sorted(hashes), "")


def _beside(top: Path, distribution: str) -> dict[str, Path]:
    """Return what a plugin may import from the folder that it is in: modules and packages by their names."""
    home = top.parent
    places = set(home.iterdir())
    if home.name.endswith("-packages") or any(home.glob("*.dist-info/RECORD")):
        from importlib.metadata import PackageNotFoundError, files

        places = set()
        with suppress(PackageNotFoundError, ValueError):
            places = {home / path.parts[0] for path in files(distribution) or () if path.suffix == ".py"}
    return {place.stem: place for place in places - {top} if place.suffix == ".py" or is_file(place / "__init__.py")}


def _files(place: Path) -> Iterator[str]:
    """Yield a file, or all files in a folder; not what is hidden, and not what Python compiles."""
    if not is_folder(place):
        yield str(place)
    for folder, folders, names in os.walk(place):
        folders[:] = [name for name in folders if name != "__pycache__" and not name.startswith(".")]
        # not a `Path` for each: it takes as long as the hash
        yield from (f"{folder}/{name}" for name in names if not name.startswith(".") and not name.endswith(".pyc"))


def column_keys(columns: ManipulatorColumns, recipe: str, contexts: Sequence[object]) -> list[str]:
    """The keys of manipulators that differ in numbers only; where their rows are in a file does not matter.

    Args:
        columns: the manipulators.
        recipe: the key of the recipe.
        contexts: what besides its table counts for each: where it goes, where it comes from, how it is looked at.
    """
    import numpy as np

    table = columns.table
    numbers: list[Any] = []
    forms: list[Any] = []
    for row in table.rows:
        inertia = [getattr(row.inertia, name) for name in INERTIA] if row.inertia else []
        entries = [*_numbers_of(row), *(row.com or ()), *inertia]
        numbers += [entry for entry in entries if entry is not None]
        given = tuple([entry is not None for entry in entries])
        words = [word.value if isinstance(word, Enum) else word for word in _words_of(row)]
        forms.append((*words, given))
    common = key_of((table.convention.value, _others_of(table), forms, table.notices), recipe)
    of_members = np.zeros((len(columns), len(numbers)))
    for index, column in enumerate(numbers):
        of_members[:, index] += column  # added to 0: the sign of a zero tells nothing
    rows = zip(columns.names, contexts, of_members, strict=True)
    return [key_of((name, context), common, row.tobytes()) for name, context, row in rows]


def whole(what: object) -> object:
    """Anything with all that is in it: the text of a record may leave out most, as that of a Manipulator does."""
    if is_dataclass(what) and not isinstance(what, type):
        return type(what).__qualname__, [(field.name, whole(getattr(what, field.name))) for field in fields(what)]
    if isinstance(what, Mapping):
        return [(whole(key), whole(value)) for key, value in what.items()]
    if isinstance(what, (set, frozenset)):
        return sorted(repr(whole(entry)) for entry in what)  # their order is another one in every process
    if isinstance(what, (tuple, list)):
        return [whole(entry) for entry in what]
    return what


def key_of(what: object, recipe: str, numbers: bytes = b"") -> str:
    """The key of anything, by its text, and of numbers by their bytes; `whole` is for records."""
    text = f"{recipe} {what!r}".encode(errors="surrogatepass")
    return sha256(b"%b\0%b" % (text, numbers) if numbers else text).hexdigest()[:DIGITS]


_others_of = attrgetter(*(name for name in COMMON if name not in {"convention", "notices"}))
_words_of = attrgetter(*WORDS)
_numbers_of = attrgetter(*NUMBERS, *(f"limits.{name}" for name in LIMITS))
