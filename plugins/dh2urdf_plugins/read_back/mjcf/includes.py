"""The files that an MJCF includes, put where it includes them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.documents import is_file, read_bytes
from dh2urdf.errors import InputError, ProofError
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.read_back.xml_files import FILE, LARGEST, mark_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

_MOST = 1000


class Missing(NamedTuple):
    """A file that could not be included.

    Attributes:
        include: the element that names it.
        message: what is wrong.
    """

    include: etree._Element
    message: str


def include_files(root: etree._Element, path: Path) -> list[Missing]:
    """Puts the elements of included files in the place of what includes them, as MuJoCo does.

    A path leads from the folder of the main file, else from that of the file that includes it. It stays in the main
    file's folder or in one beside it, and each file is included once.

    Args:
        root: the outermost element of the main file; it is changed.
        path: the main file.

    Returns:
        What could not be included; it is taken out.
    """
    missing: list[Missing] = []
    taken = {path.resolve()}
    waiting = [*_includes_in(root)][::-1]
    while waiting:
        include = waiting.pop()
        own = mark_of(include, str(path)).file
        try:
            file = _file(include, path, Path(own).parent, taken)
            included = tree_of(read_bytes(file, InputError, limit=LARGEST), str(file), is_deep=True)
            waiting += [*_includes_in(included)][::-1]
            for child in list(included):
                child.set(FILE, str(file))
                include.addprevious(child)
        except (InputError, ProofError) as error:
            missing.append(Missing(include, error.problems[0].message))
        include.set(FILE, own)  # It is taken out, and messages may name its place.
        if (parent := include.getparent()) is not None:
            parent.remove(include)
    return missing


def _includes_in(root: etree._Element) -> Iterator[etree._Element]:
    """The elements that include files, in their order; one in another goes with that."""
    return (each for each in root.iter("include") if next(each.iterancestors("include"), None) is None)


def _file(include: etree._Element, path: Path, beside: Path, taken: set[Path]) -> Path:
    """The file that an element includes; it counts as taken from now on.

    Raises:
        InputError: it is not there, or may not be included.
    """
    name = (include.get("file") or "").replace("\\", "/")
    file = next((each for folder in (path.parent, beside) if is_file(each := folder / name)), None)
    if file is None:
        raise InputError(Problem(message=f"the included file {shown(name)} is not there"))
    if not file.resolve().is_relative_to(path.resolve().parent.parent):
        message = f"the included file {shown(name)} is not in the folder of the file, nor in one beside that"
        raise InputError(Problem(message=message))
    if file.resolve() in taken:
        raise InputError(Problem(message=f"the file {shown(name)} is included a second time"))
    if len(taken) > _MOST:
        raise InputError(Problem(message=f"more than {_MOST} files are included"))
    taken.add(file.resolve())
    return file
